// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/space_packet.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace aeolis::dictionary {

/// Decoded content of one packet. Reuse one object for every decode(): its vectors keep their capacity.
struct Decoded {
    std::size_t packet = 0;  ///< index in Dictionary::packets
    TmHeader header;
    std::vector<std::uint64_t> raw;            ///< one per field: the bits as received, zero-extended
    std::vector<std::optional<double>> value;  ///< one per field: calibrated; none when undefined
};

}  // namespace aeolis::dictionary
