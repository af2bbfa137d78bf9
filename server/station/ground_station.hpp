#pragma once

#include "simulation/landing.hpp"
#include "telemetry/link_counters.hpp"
#include "telemetry/proximity_packets.hpp"

namespace aeolis::server {

/// Where what comes down is decoded, as it would be from a real spacecraft: octets of the UHF link into frames, and those into
/// packets.
///
/// In       what reaches Earth in a cycle            Out   the same, with the packets that were found in it
/// Memory   some kilobytes: a frame that is not whole yet
/// Faults   what is no good frame is counted, and the next good one is decoded
/// A value, as the landing is whose links it hears.
class GroundStation {
  public:
    /// Stands until the next call; its spans as long as those of `landed`.
    const simulation::CycleReport& receive(const simulation::CycleReport& landed);

    const telemetry::LinkCounters& uhf() const { return pltus_.counters(); }
    /// Packets that UHF brought.
    const telemetry::PacketCounters& uhf_packets() const { return packets_.counters(); }

  private:
    void receive(const simulation::ReceivedOctets& piece);

    telemetry::PltuReceiver pltus_;
    telemetry::ProximityPackets packets_;
    simulation::CycleReport report_;
};

} // namespace aeolis::server
