// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/ids.hpp"
#include "common/time.hpp"
#include "common/tone_evidence.hpp"

#include <complex>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

// The port: what reaches a station on Earth, whoever sends it. A rehearsal's landing and another mission's line deliver
// the same. Nothing in it says what was really sent or why a link is really silent.
namespace aeolis::telemetry {

/// A way to Earth, by name: "uhf_live" through a bent pipe, "uhf_<orbiter>" recorded by one, "relay" and
/// "relay_<orbiter>" the same for files after landing, "x_band"; "downlink" of another mission.
struct Link {
    std::string name;
    bool recorded = false;  ///< it brings the recording; else what was sent live, however late
    bool operator==(const Link&) const = default;
};
inline const Link uhf_live_link{"uhf_live", false}, relay_link{"relay", true}, x_band_link{"x_band", false},
    downlink_link{"downlink", false};

/// Octets of a link, in order; what they are is for the station to find out.
struct ReceivedOctets {
    Link link;
    Ert ert;  ///< of the last
    std::vector<std::uint8_t> octets;
};

/// Samples of X-band: complex baseband with ground's predict removed, noise of power 1 a sample.
struct XBandSamples {
    Ert ert;  ///< of the first
    std::vector<std::complex<float>> samples;
};
inline constexpr double x_band_rate_hz = 16384.0;  ///< chosen: holds the tones and half of it the predict's error

/// A tone decision of a receiver, ours or a modelled one, and its evidence.
struct ReceivedTone {
    Ert start, end;                        ///< of the symbol; 10 s
    std::optional<ToneId> tone;            ///< none: erasure
    double likelihood = 0.0;               ///< 0 … 1 that the decision is right
    std::optional<BestTones> best;         ///< none: nothing was there to weigh
    std::optional<ToneSpectrum> spectrum;  ///< none: the decision does not come from samples
    double c_n0_dbhz = 0.0;                ///< total power to noise density as the receiver estimates it; 0 when erased
    double doppler_hz = 0.0;               ///< one way at 8.4 GHz
    CarrierLock lock = CarrierLock::searching;
};

/// The state of a link, as whoever receives it finds it; told when it changes.
struct LinkState {
    Link link;
    Ert ert;
    bool up = false;
    std::string reason{};  ///< "nominal", "by mro", "connected"; of one that is down only ground itself gives a reason
    bool lost = false;     ///< down, and it should be there: ground's word too
};

/// All that reached a station since the last time.
struct Downlink {
    Ert now;                   ///< Earth's clock
    bool station_out = false;  ///< the station brings nothing, and knows that
    std::vector<ReceivedOctets> octets;
    std::vector<XBandSamples> x_band;
    std::vector<ReceivedTone> tones;  ///< of a modelled receiver: in place of samples
    std::vector<LinkState> links;

    void clear() {
        octets.clear();
        x_band.clear();
        tones.clear();
        links.clear();
    }
};

}  // namespace aeolis::telemetry
