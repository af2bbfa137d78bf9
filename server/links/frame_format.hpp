// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "telemetry/packet_source.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace aeolis::server {

/// The format of a packet stream, as far as the user gives it.
struct PacketStreamFormat {
    std::string name = "packets";  ///< packets, tm, aos, cadu or pltu
    std::size_t skip = 0;          ///< octets before each packet or bare frame
    // None: found by trying.
    std::optional<std::size_t> frame_octets{}, check_octets{};
    std::optional<bool> crc{}, randomised{};
    std::optional<bool> coded{};  ///< in Reed–Solomon codeblocks, by which frames are corrected
    std::optional<std::size_t> check_symbols{}, interleave{};  ///< of the code: of a word, 32 or 16; 1 … 8
    std::optional<telemetry::ReedSolomonCode::Basis> basis{};
    FrameAgreement agreed{};  ///< but for its `crc`
    std::optional<std::uint8_t> virtual_channel{};
};

/// A packet source, and the layout that was recognised, in words; empty: none had to be.
struct RecognisedSource {
    telemetry::PacketSource source;
    std::string layout;
};
/// Makes the packet source for a stream, from its format and its first octets. Fails on an unknown format, or when
/// `beginning` does not reveal the layout of frames.
/// @param ended  no more octets come
Result<RecognisedSource> packet_source(const PacketStreamFormat& format, std::span<const std::uint8_t> beginning,
                                       bool ended);

/// What to look at when nothing, not even idle data, was found in all that a source received; empty: something was.
std::string nothing_found(const PacketStreamFormat& format, const telemetry::PacketSource& source);

/// Whether packet_source() uses the beginning at all.
bool needs_beginning(const PacketStreamFormat& format);

}  // namespace aeolis::server
