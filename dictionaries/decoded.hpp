// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/space_packet.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace aeolis::dictionary {

/// Decoded content of one packet. Reuse one object for every decode(): its vectors keep their capacity.
struct Decoded {
    std::size_t packet = 0;  ///< index in Dictionary::packets
    TmHeader header;
    std::vector<std::uint64_t> raw;            ///< one per field: an unsigned number; of others the bits, zero-extended
    std::vector<std::optional<double>> value;  ///< one per field: calibrated; none when undefined, and of text
    /// Exact values of fields whose type needs_text(): field and text. A field without one here is undefined.
    std::vector<std::pair<std::size_t, std::string>> texts;
    std::string problem;  ///< why the rest of another mission's packet is not decoded; empty: all of it is
    bool timed = true;    ///< false: the packet holds no time, and header.time has no meaning
};

}  // namespace aeolis::dictionary
