// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/tone_evidence.hpp"
#include "telemetry/mfsk/tone_correlator.hpp"

namespace aeolis::telemetry {

/// The evidence for each tone in a symbol's worth of signal.
struct ToneEvidence {
    BestTones best{};
    ToneSpectrum spectrum{};
    /// Natural logarithm of the likelihood ratio of any tone to none.
    double log_likelihood_ratio = 0.0;
};

/// Weighs the tones by the exact non-coherent statistic.
///
/// With `sums` scaled so that noise has E|G|² = `energy` and the tone adds |G| = energy, tone k is likelier than none
/// by I0(2|G_k|) exp(−energy). `energy`: expected E/N0 of the symbol, from the carrier. Source:
/// [proakis-digital-communications].
ToneEvidence weigh(const ToneSums& sums, double energy);

}  // namespace aeolis::telemetry
