// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "telemetry/port.hpp"

#include <cstdint>
#include <vector>

namespace aeolis::telemetry {

/// A space packet as it reached Earth.
struct ReceivedPacket {
    Link link;
    Ert ert;
    std::vector<std::uint8_t> octets;
};

/// The time at the station, which passes even when nothing arrives.
struct EarthTime {
    Ert now;
};

/// A station's output for one Downlink.
struct Received {
    std::vector<ReceivedPacket> packets;
    std::vector<ReceivedTone> tones;
    std::vector<LinkState> links;
    std::vector<ReceivedOctets> octets;  ///< of which all that is above was made, good and bad

    void clear() {
        octets.clear();
        packets.clear();
        tones.clear();
        links.clear();
    }
};

}  // namespace aeolis::telemetry
