// SPDX-License-Identifier: Apache-2.0
#include "simulation/links/tone_waveform.hpp"

#include <cmath>
#include <numbers>

namespace aeolis::simulation {

ModulatedTone::ModulatedTone(const MfskWaveform& waveform, int tone, double rate_hz)
    : in_phase_(static_cast<float>(std::cos(waveform.modulation_index_rad))), quadrature_(places) {
    const double highest_hz = 0.45 * rate_hz;  // chosen
    for (std::size_t place = 0; place < places; ++place) {
        const double angle = 2.0 * std::numbers::pi * (static_cast<double>(place) + 0.5) / places;
        double square = 0.0;
        for (int harmonic = 1; harmonic * waveform.tone_hz(tone) < highest_hz; harmonic += 2)
            square += std::sin(harmonic * angle) / harmonic;
        square *= 4.0 / std::numbers::pi;
        quadrature_[place] = static_cast<float>(std::sin(waveform.modulation_index_rad) * square);
    }
}

}  // namespace aeolis::simulation
