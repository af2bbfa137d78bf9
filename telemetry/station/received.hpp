// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "telemetry/decoded_packet.hpp"
#include "telemetry/mfsk/thinned_spectrum.hpp"
#include "telemetry/port.hpp"

#include <cstdint>
#include <memory>
#include <vector>

namespace aeolis::telemetry {

/// A space packet as it reached Earth.
struct ReceivedPacket {
    Link link;
    Ert ert;
    std::vector<std::uint8_t> octets;
    /// Its content, decoded by the first part that needs it and shared from then on; null: not decoded yet.
    std::shared_ptr<const DecodedPacket> decoded{};
};

/// The time at the station, which passes even when nothing arrives.
struct EarthTime {
    Ert now;
};

/// A step or a slope of the carrier's Doppler that shows a feature of the flight.
struct SeenByDoppler {
    enum class Feature : std::uint8_t {
        entry,
        parachute,
        heatshield,
        first_reversal,  ///< of the bank
        second_reversal,
        third_reversal,
        fourth_reversal,
    };
    Feature feature = Feature::entry;
    Ert ert;                                   ///< when it was recognised
    Ert at;                                    ///< when it reached Earth
    double evidence_hz = 0.0, sigma_hz = 0.0;  ///< departure from its earlier course, and its standard deviation
};

/// The spectrum of X-band's samples over a second, less the predict and what Doppler was told to be still in them:
/// frequency 0 is the predicted carrier.
struct ReceivedSpectrum {
    Ert ert;     ///< when the receiver had it
    Ert middle;  ///< of the second
    ThinnedRow row;
};

/// A station's output for one Downlink.
struct Received {
    std::vector<ReceivedPacket> packets;
    std::vector<ReceivedTone> tones;
    std::vector<ReceivedCarrier> carrier;
    std::vector<SeenByDoppler> seen;
    std::vector<ReceivedSpectrum> spectra;  ///< from samples only
    std::vector<LinkState> links;
    std::vector<ReceivedOctets> octets;  ///< the raw octets behind the packets, including bad ones

    void clear() {
        octets.clear();
        packets.clear();
        tones.clear();
        carrier.clear();
        seen.clear();
        spectra.clear();
        links.clear();
    }
};

}  // namespace aeolis::telemetry
