// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/station/recording_receiver.hpp"
#include "simulation/landing.hpp"
#include "telemetry/link_counters.hpp"
#include "telemetry/proximity_packets.hpp"

#include <cstdint>
#include <vector>

namespace aeolis::server {

/// Where what comes down is decoded, as it would be from a real spacecraft: octets of each UHF link into frames, those
/// into packets, and the files of the recording into the packets that are in it.
///
/// In       what reaches Earth in a cycle            Out   the same, with the packets that were found in it; PLTUs for
/// the rover Memory   some kilobytes a link: a frame that is not whole yet; files of the recording that are not Faults
/// what is no good frame is counted, and the next good one is decoded. A damaged length holds the frames behind it back
///          no longer than quiet_s after the last octet: a frame leaves the vehicle without a pause
/// A value, as the landing is whose links it hears.
class GroundStation {
  public:
    static constexpr double quiet_s = 0.5;  ///< ours: at the link's rate an octet comes each cycle

    explicit GroundStation(double light_time_s) : recording_(light_time_s) {}

    /// Stands until the next call; its spans as long as those of `landed`.
    const simulation::CycleReport& receive(const simulation::CycleReport& landed, Ert now);

    /// What one link brought.
    struct LinkReceiver {
        simulation::Link link;
        telemetry::PltuReceiver pltus{};
        telemetry::ProximityPackets packets{};
        telemetry::RateMeter rate{};
        Ert heard_at{};      ///< its last octet
        bool waits = false;  ///< something came since it was last searched to the end
    };
    /// In the order in which they were first heard.
    const std::vector<LinkReceiver>& links() const { return links_; }
    const RecordingReceiver& recording() const { return recording_; }
    std::uint64_t unreadable_file_octets() const {
        return unreadable_file_octets_;
    }  ///< of whole files, behind the last packet

    /// What the station is to send to the rover now.
    std::vector<std::vector<std::uint8_t>> take_forward() { return recording_.take_pltus(); }

  private:
    LinkReceiver& receiver_of(const simulation::Link& link);
    void receive(const simulation::ReceivedOctets& piece);
    void receive_frames(LinkReceiver& from, Ert ert);
    void note(const simulation::LinkState& state);
    void search_to_the_end(LinkReceiver& link, Ert ert);
    void take_file(std::span<const std::uint8_t> octets, Ert ert);

    std::vector<LinkReceiver> links_;
    RecordingReceiver recording_;
    bool relay_up_ = false;
    std::uint64_t unreadable_file_octets_ = 0;
    simulation::CycleReport report_;
};

}  // namespace aeolis::server
