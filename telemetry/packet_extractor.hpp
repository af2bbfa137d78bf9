// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/space_packet.hpp"
#include "common/time.hpp"
#include "common/tm_frame.hpp"
#include "telemetry/frame_order.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace aeolis::telemetry {

/// Counters of packets in frame data.
struct PacketCounters {
    std::uint64_t packets = 0;                ///< returned
    std::uint64_t idle_packets = 0;           ///< APID 7FF, or encapsulation packets of protocol 0: fill, not returned
    std::uint64_t encapsulation_packets = 0;  ///< of another protocol: not returned
    std::uint64_t cut_packets = 0;            ///< started, never completed
    std::uint64_t lost_segments = 0;          ///< parts of packets that could not be put together
    std::uint64_t unreadable_octets = 0;      ///< octets outside readable packets

    /// Counts a packet. @return whether it is a space packet to be returned
    bool count(PacketStart::Kind kind);
    PacketCounters& operator+=(const PacketCounters& other);
    bool operator==(const PacketCounters&) const = default;
};

/// How first header pointers bear out the packets before them.
struct PointerVerdicts {
    static constexpr int shift_max = 8;  ///< octets; chosen: a control field, a CRC-16 and two more

    std::uint64_t agreed = 0;        ///< pointers to where the packet before ends
    std::uint64_t contradicted = 0;  ///< pointers to anywhere else
    /// Contradicted ones by how many octets, -shift_max … shift_max, behind the end of the packet the pointer stands:
    /// so many octets at the end of each frame are taken for its data and are not (negative: the other way round).
    std::array<std::uint64_t, 2 * shift_max + 1> shifts{};

    PointerVerdicts& operator+=(const PointerVerdicts& other);
    bool operator==(const PointerVerdicts&) const = default;
};

/// Extracts space packets from the frames of one virtual channel, across frames, by the first header pointer.
///
/// In       frames as received, each with its place in the sequence              Out   whole space packets, of any
///          mission
/// Memory   one packet and one frame
/// Holds    a packet that ends at the end of a frame's data, where a control field or a CRC may be taken for data,
///          until the channel's next frame in which a packet begins: its pointer must agree. Once `agreed_enough`
///          pointers in a row have agreed, nothing is held. Where that frame is missing or idle, or the stream ends, it is given out unless the pointer before
///          contradicted
/// Faults   a missing frame, or a pointer that contradicts the packet before it, loses the unfinished packet and what
///          is held; extraction resumes at the next pointer. Of a late frame the packets that it holds whole are
///          returned
class PacketExtractor {
  public:
    static constexpr unsigned agreed_enough = 8;  ///< chosen, like frames_to_agree
    /// At the end of a frame's data, in which a packet that ends is held: a control field and a CRC-16.
    static constexpr std::size_t doubtful_octets = 6;

    /// @param received  when the frame was
    void add(const TransferFrame& frame, FramePlace place, Ert received = {});

    /// The next whole packet; valid until the next add().
    std::optional<std::span<const std::uint8_t>> next();
    /// When the frame was received that completed the packet that next() returned last.
    Ert received() const { return given_received_; }
    /// Ends the channel: what is held comes from next(). A packet that was begun is cut; fill is not.
    void end();

    const PacketCounters& counters() const { return counters_; }
    const PointerVerdicts& pointers() const { return pointers_; }
    /// Packets that are held, of any kind.
    std::size_t held_packets() const;

  private:
    std::size_t held_octets() const { return whole_ - settled_; }
    std::size_t begun_octets() const { return octets_.size() - whole_; }
    bool trusts_pointers() const { return agreed_in_a_row_ > 0 || !contradicted_; }
    void forget_begun();
    void drop_held();
    void settle_held(bool give);
    void use(std::size_t octets);
    void begin_at(const TransferFrame& frame);
    void find_whole();
    bool pointer_agrees(const TransferFrame& frame, std::size_t begun) const;
    void judge(const TransferFrame& frame, std::size_t begun, bool agrees);
    void add_late(const TransferFrame& frame, Ert received);
    std::optional<std::span<const std::uint8_t>> next_in(const std::vector<std::uint8_t>& octets, std::size_t& used,
                                                         std::size_t end);

    std::vector<std::uint8_t> early_;  ///< whole packets to be read first: of a late frame, or held before a gap
    std::size_t early_used_ = 0;
    Ert early_received_;
    std::vector<std::uint8_t> octets_;  ///< from the start of a packet
    // Places in it, in this order.
    std::size_t used_ = 0;
    std::size_t settled_ = 0;  ///< end of packets to be given out
    std::size_t whole_ = 0;    ///< end of packets that are held; behind it stands what the last frame left unfinished
    /// Up to where in it packets were completed by which frame.
    struct Completed {
        std::size_t end = 0;
        Ert received;
    };
    std::vector<Completed> completed_;
    Ert received_, given_received_;
    bool in_step_ = false;
    unsigned agreed_in_a_row_ = 0;
    bool contradicted_ = false;  ///< by the last pointer that was judged
    PacketCounters counters_;
    PointerVerdicts pointers_;
};

}  // namespace aeolis::telemetry
