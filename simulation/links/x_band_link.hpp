// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/random.hpp"
#include "simulation/scenario.hpp"
#include "telemetry/port.hpp"

#include <optional>

namespace aeolis::simulation {

/// Direct-to-Earth tones in their statistical form: one decision for each 10 s symbol that the computer sends.
///
/// The receiver is taken to know when symbols begin; a tone that ends before its 10 s is an erasure. Power is split as
/// the waveform's modulation index says (mfsk.csv, docs/tones.md): at 32° the carrier has −1.4 dB of the total, the
/// tone, both first sidebands together, −6.4 dB; the scenario's C/N0 is that at an antenna's best direction, and a
/// symbol has the mean of its gain. The carrier is locked while Earth is up and the carrier reaches 15.8 dB-Hz, which a
/// search over 4 s needs (CarrierSearch). Earth sets behind the terrain, or when the scenario says so. Erased: a
/// decision of less than nine tenths likelihood (chosen), a symbol that broke off or lost its lock. Of a symbol without
/// lock throughout the receiver says nothing: it has not noticed it. Tones sent after Earth set do not count as sent.
/// Where tones come from samples, symbols are only told of, not decided.
class XBandLink {
  public:
    XBandLink(const Radio& radio, Random random) : radio_(radio), random_(random) {}

    struct Surroundings {
        Sclk now;
        double e_s = 0.0;
        double doppler_hz = 0.0;           ///< one way, at 8.4 GHz
        bool earth_up = true;              ///< above the terrain
        std::optional<double> gain = 1.0;  ///< of the antenna towards Earth, a power ratio; none: none is selected
    };
    /// A symbol that has ended.
    struct Ended {
        ToneId tone;  ///< that was sent
        Sclk at;
        std::optional<telemetry::ReceivedTone> heard;  ///< `start` and `end` are still to be filled in; none: unnoticed
    };
    /// One cycle; a symbol that ended with it.
    std::optional<Ended> cycle(std::optional<ToneId> tone, const Surroundings& at);

    struct Symbol {
        ToneId tone;
        Sclk started;
        int ticks = 0, locked_ticks = 0;
        double gain_sum = 0.0;  ///< over them
    };
    /// What it sends in the cycle that was last.
    const std::optional<Symbol>& sending() const { return symbol_; }

    bool earth_up() const { return earth_up_; }                       ///< what an antenna on Earth can hear at all
    bool up() const { return up_; }                                   ///< and the carrier strong enough
    const char* reason() const { return up_ ? "nominal" : reason_; }  ///< static text

    static double tone_power_db();  ///< of the tone, relative to the total
    static double carrier_power_db();
    /// Whether a carrier can be locked, by total power to noise density.
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
