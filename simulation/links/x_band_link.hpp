#pragma once

#include "simulation/landing.hpp"
#include "simulation/random.hpp"
#include "simulation/scenario.hpp"

#include <optional>

namespace aeolis::simulation {

/// Direct-to-Earth tones in their statistical form: one decision for each 10 s symbol that the computer sends.
///
/// The receiver is taken to know when symbols begin; a tone that ends before its 10 s is an erasure. Power is split as the
/// waveform's modulation index says (mfsk.csv, docs/tones.md): at 32° the carrier has −1.4 dB of the total, the tone, both
/// first sidebands together, −6.4 dB. The carrier is locked while Earth is up and the carrier reaches 15.8 dB-Hz, which a
/// search over 4 s needs (CarrierSearch).
/// Erased: a decision of less than nine tenths likelihood (ours), no lock, a broken symbol, Earth setting meanwhile.
/// Tones sent after Earth set are not heard of at all.
/// Where tones come from samples, symbols are only told of, not decided.
class XBandLink {
  public:
    XBandLink(const Radio& radio, Random random) : radio_(radio), random_(random) {}

    struct Surroundings {
        Sclk now;
        double e_s = 0.0;
        double doppler_hz = 0.0; ///< one way, at 8.4 GHz
    };
    /// One cycle; a symbol that ended with it. Its `start` and `end` are still to be filled in.
    std::optional<ReceivedTone> cycle(std::optional<ToneId> tone, const Surroundings& at);

    struct Symbol {
        ToneId tone;
        Sclk started;
        int ticks = 0;
    };
    /// What it sends in the cycle that was last.
    const std::optional<Symbol>& sending() const { return symbol_; }

    bool up() const { return up_; }
    const char* reason() const { return up_ ? "nominal" : reason_; } ///< static text

    static double tone_power_db(); ///< of the tone, relative to the total
    static double carrier_power_db();

  private:
    ReceivedTone decide(bool broken, const Surroundings& at);

    Radio radio_;
    Random random_;
    std::optional<Symbol> symbol_;
    bool up_ = false;
    const char* reason_ = "not acquired";
};

} // namespace aeolis::simulation
