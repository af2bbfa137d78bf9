// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/tm_frame.hpp"
#include "telemetry/frame_order.hpp"
#include "telemetry/octet_window.hpp"
#include "telemetry/recent_map.hpp"
#include "telemetry/reed_solomon.hpp"
#include "telemetry/sequence_table.hpp"
#include "telemetry/stray_octets.hpp"
#include "telemetry/sync_search.hpp"

#include <cstdint>
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
    BitAlignment alignment{};         ///< of the first markers; others are found
    std::size_t prefix_octets = 0;    ///< ignored before each frame, as a station's recorder adds; only without marker
    std::size_t suffix_octets = 0;    ///< after each frame: the code's check symbols
    /// The code by whose check symbols, the suffix, frames are corrected; none: the suffix is ignored.
    std::optional<ReedSolomonCode> code{};
    bool randomised = false;  ///< frames with their check symbols
    FrameAgreement agreed{};
    std::optional<std::uint8_t> virtual_channel{};  ///< none: frames of all
};

/// A virtual channel of a spacecraft, as a number.
using ChannelNumber = std::uint32_t;
inline constexpr std::uint32_t virtual_channels_max = 64;
constexpr ChannelNumber channel_number(const TransferFrame& frame) {
    return frame.spacecraft * virtual_channels_max + frame.virtual_channel;
}
/// Channels followed at a time; chosen. Only damaged headers make more, and the one heard longest ago is then
/// forgotten.
inline constexpr std::size_t channels_followed_max = 256;

/// Finds TM or AOS frames in a stream of octets.
///
/// In       octets as received, in pieces of any size       Out   readable frames, and the place of each in its
///          channel's sequence. Repeated ones are only counted
/// Memory   the last piece, two frames, and 1 kB for each of channels_followed_max channels
/// Sync     markers are searched at every bit, inverted too. One right behind a good frame may have wrong bits if the
///          frame has a code or a CRC-16 to be known by. At another bit than before, a frame without either is believed
///          when a marker follows it
/// Faults   with a marker, after anything but a good frame the search continues right behind the marker; without one,
///          an unreadable frame is skipped whole. A frame that its code cannot correct is read only if its own CRC-16
///          is right
/// Left out convolutional, turbo and LDPC codes: the stream is assumed decoded by the station
class FrameReceiver {
  public:
    struct Received {
        TransferFrame frame;  ///< valid until the next next() or receive()
        FramePlace place = FramePlace::next;
    };

    explicit FrameReceiver(const FrameStream& stream);

    void receive(std::span<const std::uint8_t> octets);
    /// The next frame; none when more octets are needed.
    std::optional<Received> next();
    /// Ends the stream: counts octets of an incomplete frame as skipped.
    void end();
    /// Ends a datagram. Without markers this also ends the frame, and the next octets begin another. False when octets
    /// of an incomplete frame were left.
    bool end_datagram();

    LinkCounters counters() const;
    /// Skipped octets that are not fill.
    std::uint64_t stray_octets() const { return stray_.number(); }
    /// Totals of each virtual channel, also of those that are no longer followed.
    std::vector<SequenceTotals> sequences() const;

  private:
    std::size_t unit_octets() const;
    bool checked() const { return stream_.agreed.crc || stream_.code; }
    bool at_unit();
    bool waits_for_octets() const;
    Parsed<TransferFrame> read_unit();
    void count_good(const TransferFrame& frame);
    void count_unread(Malformed why);
    void skip(std::size_t octets);

    FrameStream stream_;
    OctetWindow window_;
    BitAlignment alignment_;           ///< of the last good frame
    BitAlignment found_;               ///< of the marker in front
    bool expected_ = false;            ///< a good frame ended where the window begins
    bool damaged_marker_ = false;      ///< in front
    std::vector<std::uint8_t> block_;  ///< frame and suffix
    Correction correction_;            ///< of that
    RecentMap<ChannelNumber, FrameOrder> orders_{channels_followed_max};
    SequenceTable<ChannelNumber> sequences_;
    StrayOctets stray_;
    LinkCounters counters_;  ///< without sequences_
};

/// The most frequent distance between two markers of one alignment, without the marker itself.
struct MarkerSpacing {
    std::size_t octets = 0;
    BitAlignment alignment;
};
/// Measures the spacing of markers; none with fewer than two.
std::optional<MarkerSpacing> marker_spacing(std::span<const std::uint8_t> octets);

/// Length in octets of a CADU stream's frames with their check symbols, from the spacing of its markers.
std::optional<std::size_t> cadu_frame_octets(std::span<const std::uint8_t> octets);

/// Length in octets of contiguous frames with a CRC-16, each after `prefix_octets`: the smallest at which the CRCs of
/// the first three frames are right. If `ended`, so that no more octets come, fewer frames suffice when nothing is left
/// behind them.
std::optional<std::size_t> crc_frame_octets(std::span<const std::uint8_t> octets, std::size_t prefix_octets,
                                            bool ended);

/// What is known about a stream's frames before any is received.
struct FrameHints {
    std::optional<std::size_t> frame_octets{}, suffix_octets{};
    /// Whether a code is to be used, and its known properties.
    std::optional<bool> coded{};
    std::optional<std::size_t> check_symbols{}, interleave{};
    std::optional<ReedSolomonCode::Basis> basis{};
    std::optional<bool> crc{}, randomised{};
    FrameAgreement agreed{};  ///< except its `crc`
    std::optional<std::uint8_t> virtual_channel{};
};

inline constexpr std::uint64_t frames_to_agree = 8;  ///< chosen: needed to accept a layout while the stream goes on

/// Detects a CADU stream's layout by trial, as far as it is not known: frame length, Reed–Solomon code, TM or AOS,
/// randomisation, check symbols, CRC. A code is accepted when two codeblocks fit it, or one without any error. None
/// when no layout reads the frames.
/// @param ended  no more octets come, so that fewer than frames_to_agree suffice
std::optional<FrameStream> recognise_cadus(std::span<const std::uint8_t> octets, const FrameHints& known, bool ended);

}  // namespace aeolis::telemetry
