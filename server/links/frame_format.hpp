// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "telemetry/packet_source.hpp"
#include "telemetry/station/foreign_station.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace aeolis::server {

/// The format of a packet stream, as far as the user gives it.
struct PacketStreamFormat {
    std::string name = "packets";  ///< packets, tm, aos, cadu or pltu
    std::size_t skip = 0;          ///< octets before each packet or bare frame
    // None: found by trial.
    std::optional<std::size_t> frame_octets{}, check_octets{};
    std::optional<bool> crc{}, randomised{};
    std::optional<bool> coded{};  ///< in Reed–Solomon codeblocks, by which frames are corrected
    std::optional<std::size_t> check_symbols{}, interleave{};  ///< of the code: of a word, 32 or 16; 1 … 8
    std::optional<telemetry::ReedSolomonCode::Basis> basis{};
    FrameAgreement agreed{};  ///< except its `crc`
    std::optional<std::uint8_t> virtual_channel{};
};

/// Refuses a format that there is not, and options that the format does not use or that contradict each other, by name.
Result<void> check_format(const PacketStreamFormat& format);

/// Makes the packet source for a stream, from its format and its first octets. Fails on an unknown format, on what
/// check_format() refuses, or when `beginning` does not reveal the layout of frames.
/// @param ended  no more octets come
Result<telemetry::RecognisedSource> packet_source(const PacketStreamFormat& format,
                                                  std::span<const std::uint8_t> beginning, bool ended);
/// The same, for the streams of a station.
telemetry::ForeignStation::Recognise recognise_by(const PacketStreamFormat& format);

/// Advice when nothing, not even idle data, was found in all that was received; empty: something was found.
/// @param counted  frames or packets with a count were found
std::string nothing_found(const PacketStreamFormat& format, const telemetry::LinkCounters& link,
                          const telemetry::PacketCounters& packets, bool counted);

/// Advice on options when most first header pointers of frames contradict the packets before them; empty: they do not.
std::string pointers_contradict(const PacketStreamFormat& format, const telemetry::PointerVerdicts& pointers);

/// Whether packet_source() uses the beginning at all.
bool needs_beginning(const PacketStreamFormat& format);

}  // namespace aeolis::server
