// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/tone_evidence.hpp"
#include "simulation/random.hpp"

namespace aeolis::simulation {

/// What an ideal non-coherent receiver makes of one 10 s symbol of 256 orthogonal tones.
struct ToneDecision {
    BestTones best{};
    double tone_c_n0_dbhz = 0.0;  ///< estimate from the winner's energy
};

/// Draws the 256 detector outputs from their exact distributions and decides: the symbol error is that of non-coherent
/// orthogonal signalling, to the last digit, because it is the same experiment.
///
/// `tone_c_n0_dbhz`: power of the tone to noise density. A symbol without a tone is drawn with `sent` absent (−1).
/// Source: [proakis-digital-communications] for the statistic, r = |√(2 E/N0) + n| against |n|, and its posterior,
/// in proportion to I0(√(2 E/N0) r).
ToneDecision detect_tone(int sent, double tone_c_n0_dbhz, double symbol_s, Random& random);

}  // namespace aeolis::simulation
