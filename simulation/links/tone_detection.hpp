// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/tone_evidence.hpp"
#include "simulation/random.hpp"

namespace aeolis::simulation {

/// Decision of an ideal non-coherent receiver on one 10 s symbol of 256 orthogonal tones.
struct ToneDecision {
    BestTones best{};
    double tone_c_n0_dbhz = 0.0;  ///< estimate from the energy of the best tone
};

/// Draws the 256 detector outputs from their exact distributions and decides.
///
/// The symbol error rate is exactly that of non-coherent orthogonal signalling, because it is the same experiment.
/// `sent`: the tone, −1 for a symbol without one. `tone_c_n0_dbhz`: power of the tone to noise density. Source:
/// [proakis-digital-communications] for the statistic, r = |√(2 E/N0) + n| against |n|, and its posterior, in
/// proportion to I0(√(2 E/N0) r).
ToneDecision detect_tone(int sent, double tone_c_n0_dbhz, double symbol_s, Random& random);

}  // namespace aeolis::simulation
