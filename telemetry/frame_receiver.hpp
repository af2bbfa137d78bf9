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

/// How the TM or AOS frames of a stream stand in it. All frames have one length.
struct FrameStream {
    enum class Kind : std::uint8_t { tm, aos };
    Kind kind = Kind::tm;
    std::size_t frame_octets = 1115;  ///< without marker; 1115: five interleaved code words of Reed–Solomon
    bool marker = true;               ///< each behind the attached sync marker (CADU)
    std::size_t prefix_octets = 0;    ///< before each, without meaning, as a recorder at the station adds; no marker
    std::size_t suffix_octets = 0;    ///< behind each, without meaning here: the code's check symbols
    bool randomised = false;
    FrameAgreement agreed{};
};

/// Finds TM or AOS frames in a stream of octets.
///
/// In       octets as they come, in pieces of any size       Out   frames that can be read, and what is missing
/// Memory   the last piece and two frames
/// Faults   where there is a marker, the search goes on behind it after anything else than a good frame; without one,
///          a frame that cannot be read is skipped as a whole
/// Left out error correction: a stream is taken as decoded already, or free of errors
class FrameReceiver {
  public:
    struct Received {
        TransferFrame frame;               ///< until the next next() or receive()
        std::uint32_t missing_before = 0;  ///< frames of its virtual channel that did not come
    };

    explicit FrameReceiver(const FrameStream& stream);

    void receive(std::span<const std::uint8_t> octets);
    /// The next frame; none when more octets are needed.
    std::optional<Received> next();
    /// Nothing more will come: what waits to become a frame counts as skipped.
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

/// Length of the frames of a CADU stream: the most frequent distance of two markers, without the marker. None when
/// fewer than two stand in it.
std::optional<std::size_t> cadu_frame_octets(std::span<const std::uint8_t> octets);

/// Length of frames that end with a CRC-16 and stand one after another, each behind `prefix_octets`: the smallest at
/// which the first two are right, or the only one is.
std::optional<std::size_t> crc_frame_octets(std::span<const std::uint8_t> octets, std::size_t prefix_octets);

/// How the frames of a CADU stream are, found by trying: length, TM or AOS, randomised or not, check symbols of the
/// code behind them, CRC. None when no two markers stand in it.
std::optional<FrameStream> recognise_cadus(std::span<const std::uint8_t> octets);

}  // namespace aeolis::telemetry
