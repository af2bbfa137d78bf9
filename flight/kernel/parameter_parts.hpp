// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/edl/parameter_table.hpp"
#include "flight/kernel/message.hpp"

#include <algorithm>

namespace aeolis::flight {

/// Sends a table of parameters in parts that fit a message, in order.
template <typename Send>
void parameter_parts(const Parameters& parameters, Send&& send) {
    for (std::size_t first = 0; first < parameter_count; first += part_parameters_max) {
        ParameterPart part{static_cast<std::uint16_t>(first), 0, {}};
        part.count = static_cast<std::uint8_t>(std::min(part_parameters_max, parameter_count - first));
        for (std::uint16_t i = 0; i < part.count; ++i)
            part.values[i] = value_of(parameters, ParameterId{static_cast<std::uint16_t>(part.first + i)});
        send(part);
    }
}

/// Takes a part into a table. True with the last part: the table is whole.
inline bool take(Parameters& parameters, const ParameterPart& part) {
    const std::size_t first = std::min<std::size_t>(part.first, parameter_count);
    const std::size_t count = std::min({std::size_t{part.count}, part_parameters_max, parameter_count - first});
    for (std::size_t i = 0; i < count; ++i)
        set_value(parameters, ParameterId{static_cast<std::uint16_t>(first + i)}, part.values[i]);
    return count > 0 && first + count == parameter_count;
}

}  // namespace aeolis::flight
