#pragma once

#include "common/proximity_frame.hpp"
#include "common/space_packet.hpp"

#include <cstddef>
#include <cstdint>
#include <span>

namespace aeolis::flight {

/// Puts packets for UHF into Proximity-1 frames: expedited, whole packets, as many in a frame as find room.
///
/// In      whole space packets, one after another     Out   PLTUs, one after another
/// Memory  this object; a packet that no frame can hold is a bug: packet_octets_max is below a frame's data
/// Source  [ccsds-211.0-b-6]; in EDL nothing is acknowledged on the link, so frames are expedited
class ProximityFramer {
  public:
    static constexpr std::uint8_t packet_port = 1;  ///< ours

    explicit constexpr ProximityFramer(std::uint16_t spacecraft) : header_{.spacecraft = spacecraft, .port = packet_port} {}

    /// Octets that `packets` octets in so many packets become at most.
    static constexpr std::size_t framed_octets_max(std::size_t octets, std::size_t packets) {
        return octets + packets * pltu_overhead_octets;
    }

    /// Writes the frames into `into`, which has room, and returns their octets.
    std::size_t frame(std::span<const std::uint8_t> packets, std::span<std::uint8_t> into) {
        std::size_t written = 0;
        while (!packets.empty()) {
            const std::size_t now = whole_packets(packets);
            AEOLIS_CHECK(now > 0);
            written += write_pltu(header_, packets.first(now), into.subspan(written));
            ++header_.sequence;
            packets = packets.subspan(now);
        }
        return written;
    }

  private:
    static_assert(packet_octets_max <= proximity_data_octets_max);

    /// Octets of the packets at the beginning that fit a frame together.
    static std::size_t whole_packets(std::span<const std::uint8_t> packets) {
        std::size_t together = 0;
        while (true) {
            const auto next = space_packet_octets(packets.subspan(together));
            if (!next || *next > packets.size() - together || together + *next > proximity_data_octets_max) return together;
            together += *next;
        }
    }

    ProximityHeader header_;
};

}  // namespace aeolis::flight
