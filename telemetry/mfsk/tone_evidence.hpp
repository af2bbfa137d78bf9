// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/tone_evidence.hpp"
#include "telemetry/mfsk/tone_correlator.hpp"

namespace aeolis::telemetry {

/// What a symbol's worth of signal says about which tone was sent.
struct ToneEvidence {
    BestTones best{};
    ToneSpectrum spectrum{};
    /// Natural logarithm of how much likelier the signal is with some tone than without one.
    double log_likelihood_ratio = 0.0;
};

/// The exact non-coherent statistic: with `sums` scaled so that noise has E|G|² = `energy` and the tone adds |G| =
/// energy, tone k is likelier than none by I0(2|G_k|) exp(−energy). `energy`: expected, E/N0 of the symbol as the
/// carrier tells. Source: [proakis-digital-communications].
ToneEvidence weigh(const ToneSums& sums, double energy);

}  // namespace aeolis::telemetry
