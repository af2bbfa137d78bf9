// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "telemetry/packet_source.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace aeolis::server {

/// How packets stand in a stream, as far as people say.
struct DownlinkForm {
    std::string name = "packets";             ///< packets, tm, aos, cadu or pltu
    std::size_t skip = 0;                     ///< octets before each packet or bare frame
    std::optional<std::size_t> frame_octets;  ///< left out: found by trying
};

/// What finds the packets of a stream, from what was said and from its first octets. Fails when there is no such
/// format, or when nothing in `beginning` shows how long frames are.
Result<telemetry::PacketSource> packet_source(const DownlinkForm& format, std::span<const std::uint8_t> beginning);

/// Whether packet_source() looks at the beginning at all.
bool needs_beginning(const DownlinkForm& format);

}  // namespace aeolis::server
