// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace aeolis {

/// X-band waveform: a square wave at the tone's frequency modulates the carrier's phase.
///
///   s(t) = A exp j(φ(t) + m sq(2π f_k t)),   f_k = first + k · spacing,   sq = ±1; without a tone m sq is 0.
///
/// m is the modulation index. The values come from the dictionary (mfsk.csv, docs/tones.md).
struct MfskWaveform {
    static constexpr int tones = 256;  ///< R31

    double carrier_hz = 0.0;
    double first_tone_hz = 0.0, tone_spacing_hz = 0.0;
    double symbol_s = 0.0;
    double modulation_index_rad = 0.0;

    double tone_hz(int tone) const { return first_tone_hz + tone * tone_spacing_hz; }
    double highest_tone_hz() const { return tone_hz(tones - 1); }
    /// Fraction of the total power that stays in the carrier while a tone is sent.
    double carrier_fraction() const { return std::cos(modulation_index_rad) * std::cos(modulation_index_rad); }
    /// Fraction of the total power in the two first-order sidebands, which the receiver uses.
    double tone_fraction() const {
        const double sine = std::sin(modulation_index_rad);
        return 8.0 / (std::numbers::pi * std::numbers::pi) * sine * sine;
    }
    constexpr bool operator==(const MfskWaveform&) const = default;
};

}  // namespace aeolis
