// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/random.hpp"
#include "simulation/scenario.hpp"
#include "telemetry/port.hpp"

#include <optional>

namespace aeolis::simulation {

/// Direct-to-Earth tones in statistical form: one decision for each 10 s symbol that the computer sends.
///
/// The receiver is assumed to know when symbols begin; a tone that ends before its 10 s is an erasure. The waveform's
/// modulation index splits the power (mfsk.csv, docs/tones.md): at 32° the carrier has −1.4 dB of the total, the tone,
/// both first sidebands together, −6.4 dB. The scenario's C/N0 is that in an antenna's best direction, and a symbol has
/// the mean of its gain. The carrier is locked while Earth is up and the carrier reaches 15.8 dB-Hz, which a search
/// over 4 s needs (CarrierSearch). Earth sets behind the terrain, or when the scenario says so. Erasures: decisions
/// with likelihood below 0.9 (chosen), and symbols that ended early or lost lock. A symbol without lock throughout goes
/// unnoticed and is not reported. Tones sent after Earth set do not count as sent. When tones come from samples,
/// symbols are only reported, not decided.
class XBandLink {
  public:
    XBandLink(const Radio& radio, Random random) : radio_(radio), random_(random) {}

    struct Surroundings {
        Sclk now;
        double e_s = 0.0;
        double doppler_hz = 0.0;           ///< one way, at 8.4 GHz
        bool earth_up = true;              ///< above the terrain
        std::optional<double> gain = 1.0;  ///< of the antenna towards Earth, a power ratio; none: none selected
    };
    /// A completed symbol.
    struct Ended {
        ToneId tone;  ///< the tone sent
        Sclk at;
        std::optional<telemetry::ReceivedTone> heard;  ///< the caller sets `start` and `end`; none: unnoticed
    };
    /// Runs one cycle; returns a symbol that ended with it.
    std::optional<Ended> cycle(std::optional<ToneId> tone, const Surroundings& at);

    struct Symbol {
        ToneId tone;
        Sclk started;
        int ticks = 0, locked_ticks = 0;
        double gain_sum = 0.0;  ///< over those ticks
    };
    /// The symbol sent in the last cycle.
    const std::optional<Symbol>& sending() const { return symbol_; }

    bool earth_up() const { return earth_up_; }  ///< whether a signal can reach an antenna on Earth
    bool up() const { return up_; }              ///< also: the carrier is strong enough
    const char* reason() const { return up_ ? "nominal" : reason_; }  ///< static text

    static double tone_power_db();  ///< relative to the total
    static double carrier_power_db();
    /// Whether a carrier can be locked at this total power to noise density.
    static bool can_lock(double c_n0_dbhz);

  private:
    Ended decide(bool broken, const Surroundings& at);

    Radio radio_;
    Random random_;
    std::optional<Symbol> symbol_;
    bool earth_up_ = false, up_ = false;
    const char* reason_ = "not acquired";
};

}  // namespace aeolis::simulation
