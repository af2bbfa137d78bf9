// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/space_packet.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace aeolis::dictionary {

/// What one packet says. Keep one and give it to every decode(): its vectors keep their capacity.
struct Decoded {
    std::size_t packet = 0;  ///< index in Dictionary::packets
    TmHeader header;
    std::vector<std::uint64_t> raw;            ///< a field each: the bits as they stand, zero-extended
    std::vector<std::optional<double>> value;  ///< a field each: calibrated; none when undefined
};

}  // namespace aeolis::dictionary
