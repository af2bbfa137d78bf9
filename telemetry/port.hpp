// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/ids.hpp"
#include "common/time.hpp"
#include "common/tone_evidence.hpp"
#include "telemetry/silence_class.hpp"

#include <complex>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

// The port: everything that reaches a station on Earth, simulated or real. A rehearsal's landing and another mission's
// link deliver the same types. None of them holds what was really sent or why a link is really silent.
namespace aeolis::telemetry {

/// A link to Earth, by name.
///
/// "uhf_live" is through a bent pipe, "uhf_<orbiter>" recorded by one; "relay" and "relay_<orbiter>" are the same for
/// files after landing; "x_band_telemetry" and, after it, "x_band" with tones come straight to Earth; "downlink" of
/// another mission.
struct Link {
    std::string name;
    bool recorded = false;  ///< it delivers the recording; false: what was sent live, however late
    bool operator==(const Link&) const = default;
};
inline const Link uhf_live_link{"uhf_live", false}, relay_link{"relay", true}, x_band_link{"x_band", false},
    x_band_telemetry_link{"x_band_telemetry", false}, downlink_link{"downlink", false};
/// Stands for the station's own measurements, which are packets that ground makes; not a link.
inline const Link station_link{"station", false};

/// Whether a link delivers telemetry as soon as it reaches Earth.
inline bool is_live_telemetry(std::string_view link) {
    return link == uhf_live_link.name || link == x_band_telemetry_link.name || link == downlink_link.name;
}

/// Octets of a link, in order, not yet decoded.
struct ReceivedOctets {
    Link link;
    Ert ert;  ///< of the last octet
    std::vector<std::uint8_t> octets;
    bool datagram = false;  ///< they are a datagram of their own; false: a piece of a stream
};

/// Samples of X-band: complex baseband with ground's predict removed, noise of power 1 a sample.
struct XBandSamples {
    Ert ert;  ///< of the first sample
    std::vector<std::complex<float>> samples;
};
inline constexpr double x_band_rate_hz = 16384.0;  ///< chosen: holds the tones, and as half of it the predict's error

/// A receiver's tone decision, real or modelled, with its evidence.
struct ReceivedTone {
    Ert start, end;                        ///< of the symbol; 10 s
    std::optional<ToneId> tone;            ///< none: erased
    double likelihood = 0.0;               ///< 0 … 1: probability that the decision is right
    std::optional<BestTones> best;         ///< none: there was no signal to weigh
    std::optional<ToneSpectrum> spectrum;  ///< none: the decision does not come from samples
    double c_n0_dbhz = 0.0;                ///< the receiver's estimate of total power to noise density; 0 when erased
    double doppler_hz = 0.0;               ///< one way at 8.4 GHz
    CarrierLock lock = CarrierLock::searching;
};

/// A receiver's estimate of the X-band carrier over an eighth of a second, real or modelled.
///
/// There is one for each eighth in which a carrier is followed, and one when it is lost; none while it is searched for.
struct ReceivedCarrier {
    struct Estimate {
        double residual_hz = 0.0, sigma_hz = 0.0;  ///< Doppler less the predict; its standard deviation
        double rate_hzps = 0.0;                    ///< of the residual
        double c_n0_dbhz = 0.0;                    ///< total power to noise density
    };
    Ert ert;                  ///< when the receiver had it
    Ert middle;               ///< of the eighth of a second
    double predict_hz = 0.0;  ///< Doppler predicted for it, one way at 8.4 GHz
    CarrierLock lock = CarrierLock::searching;
    std::optional<Estimate> estimate;  ///< none: the carrier was not heard then
};

/// A link's state as its receiver finds it; reported when it changes.
struct LinkState {
    Link link;
    Ert ert;
    bool up = false;
    std::string words{};         ///< "nominal", "by mro", "connected"; for a link that is down, set by ground alone
    bool lost = false;           ///< down, though it should be up; also set by ground
    std::optional<Ert> until{};  ///< when the link is predicted to be heard again, set by ground; none: not predicted
    std::optional<SilenceClass> silence{};  ///< what ground attributes the silence to; `words` say more

    std::string reason() const { return reason_text(silence, words); }
};

/// Everything that has reached a station since the last call.
struct Downlink {
    Ert now;                   ///< Earth's clock
    bool station_out = false;  ///< the station receives nothing, and knows it
    std::vector<ReceivedOctets> octets;
    std::vector<XBandSamples> x_band;
    std::vector<ReceivedTone> tones;       ///< of a modelled receiver: replace samples
    std::vector<ReceivedCarrier> carrier;  ///< of a modelled receiver, too
    std::vector<LinkState> links;

    void clear() {
        octets.clear();
        x_band.clear();
        tones.clear();
        carrier.clear();
        links.clear();
    }
};

}  // namespace aeolis::telemetry
