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

/// A table of parameters that is received in parts. It changes as a whole, with the last part. When a part is lost or
/// out of order, the table stays as it was until all parts come again.
class ReceivedParameters {
  public:
    explicit ReceivedParameters(const Parameters& first = {}) : values_(first) {}

    /// Takes a part. True when it completes a table.
    bool on(const ParameterPart& part) {
        if (part.first == 0) next_ = 0;
        const bool fits = part.first == next_ && part.count <= part_parameters_max &&
                          std::size_t{part.first} + part.count <= parameter_count;
        if (!fits || part.count == 0) {
            next_ = parameter_count;  // until the first part comes again
            return false;
        }
        for (std::size_t i = 0; i < part.count; ++i)
            set_value(coming_, ParameterId{static_cast<std::uint16_t>(next_ + i)}, part.values[i]);
        next_ += part.count;
        if (next_ < parameter_count) return false;
        values_ = coming_;
        return true;
    }
    const Parameters& values() const { return values_; }

  private:
    Parameters values_, coming_{};
    std::size_t next_ = 0;
};

}  // namespace aeolis::flight
