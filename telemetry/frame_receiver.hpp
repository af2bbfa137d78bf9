// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/tm_frame.hpp"
#include "telemetry/link_counters.hpp"
#include "telemetry/octet_window.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

namespace aeolis::telemetry {

/// The layout of TM or AOS frames in a stream. All frames have one length.
struct FrameStream {
    enum class Kind : std::uint8_t { tm, aos };
    Kind kind = Kind::tm;
    std::size_t frame_octets = 1115;  ///< without marker; 1115: five interleaved code words of Reed–Solomon
    bool marker = true;               ///< each after the attached sync marker (CADU)
    std::size_t prefix_octets = 0;    ///< ignored before each frame, as a station's recorder adds; only without marker
    std::size_t suffix_octets = 0;    ///< ignored after each frame: the code's check symbols
    bool randomised = false;
    FrameAgreement agreed{};
};

/// Finds TM or AOS frames in a stream of octets.
///
/// In       octets as received, in pieces of any size       Out   readable frames, and how many are missing
/// Memory   the last piece and two frames
/// Faults   with a marker, after anything but a good frame the search continues right behind the marker; without one,
///          an unreadable frame is skipped whole
/// Left out error correction: the stream is assumed decoded, or free of errors
class FrameReceiver {
  public:
    struct Received {
        TransferFrame frame;               ///< valid until the next next() or receive()
        std::uint32_t missing_before = 0;  ///< frames of its virtual channel that were not received
    };

    explicit FrameReceiver(const FrameStream& stream);

    void receive(std::span<const std::uint8_t> octets);
    /// The next frame; none when more octets are needed.
    std::optional<Received> next();
    /// Ends the stream: counts octets of an incomplete frame as skipped.
    void end();

    const LinkCounters& counters() const { return counters_; }

  private:
    std::size_t unit_octets() const;
    bool at_marker();
    void skip(std::size_t octets);

    FrameStream stream_;
    OctetWindow window_;
    std::vector<std::uint8_t> frame_;
    std::map<std::uint32_t, SequenceGaps> channels_;
    LinkCounters counters_;
};

/// Length of a CADU stream's frames: the most frequent distance of two markers, without the marker. None with fewer
/// than two markers.
std::optional<std::size_t> cadu_frame_octets(std::span<const std::uint8_t> octets);

/// Length of contiguous frames with a CRC-16, each after `prefix_octets`. It is the smallest at which the CRCs of the
/// first two, or of the only one, are right.
std::optional<std::size_t> crc_frame_octets(std::span<const std::uint8_t> octets, std::size_t prefix_octets);

/// Detects a CADU stream's layout by trial: frame length, TM or AOS, randomisation, the code's check symbols, CRC. None
/// without two markers.
std::optional<FrameStream> recognise_cadus(std::span<const std::uint8_t> octets);

}  // namespace aeolis::telemetry
