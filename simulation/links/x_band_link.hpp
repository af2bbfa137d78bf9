// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/ids.hpp"
#include "common/time.hpp"
#include "simulation/scenario.hpp"

#include <optional>

namespace aeolis::simulation {

/// The path of X-band's tones to Earth: symbols as they are sent, and whether anything of them can arrive.
///
/// A symbol lasts 10 s at most. The waveform's modulation index splits the power (mfsk.csv, docs/tones.md): at 32° the
/// carrier has −1.4 dB of the total, the tone, both first sidebands together, −6.4 dB. Earth sets behind the terrain,
/// or when the scenario says so; tones sent after Earth set do not count as sent. The receiver decides what is heard:
/// XBandReceiverModel, or telemetry/mfsk from samples.
class XBandLink {
  public:
    explicit XBandLink(const Radio& radio) : radio_(radio) {}

    struct Surroundings {
        Sclk now;
        double e_s = 0.0;
        bool earth_up = true;              ///< above the terrain
        std::optional<double> gain = 1.0;  ///< of the antenna towards Earth, a power ratio; none: none selected
    };
    struct Symbol {
        ToneId tone;
        Sclk started;
        int ticks = 0;
    };
    /// Runs one cycle; returns a symbol that ended with it.
    std::optional<Symbol> cycle(std::optional<ToneId> tone, const Surroundings& at);

    /// The symbol sent in the last cycle.
    const std::optional<Symbol>& sending() const { return symbol_; }

    bool earth_up() const { return earth_up_; }     ///< whether a signal can reach an antenna on Earth
    const char* reason() const { return reason_; }  ///< static text

    static double tone_power_db();  ///< relative to the total
    static double carrier_power_db();

  private:
    Radio radio_;
    std::optional<Symbol> symbol_;
    bool earth_up_ = false;
    const char* reason_ = "not switched on";
};

}  // namespace aeolis::simulation
