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

/// The density of noise in the upper sideband of each tone over that in the lower.
using SidebandRatios = std::array<float, MfskWaveform::tones>;
constexpr SidebandRatios equal_sidebands() {
    SidebandRatios ratios{};
    ratios.fill(1.0F);
    return ratios;
}

/// Weighs the tones by the exact non-coherent statistic.
///
/// `sums` are scaled so that noise has E|G|² = `energy` and the tone adds |G| = energy. Tone k is then likelier than
/// none by I0(2|G_k|) exp(−energy). `energy` is the expected E/N0 of the symbol, from the carrier. Source:
/// [proakis-digital-communications].
///
/// `in_phase` are the same sums of the component in phase with the carrier. A tone has no such component, because its
/// two sidebands are alike; a spectral line in the samples has one. So a tone is weighed not only against noise but
/// also against a line of any strength at either sideband. `ratios`: for each tone, the noise in its upper sideband
/// divided by that in its lower one; a filter makes it differ from one.
ToneEvidence tone_evidence_of(const ToneSums& sums, const ToneSums& in_phase, const SidebandRatios& ratios,
                              double energy);

}  // namespace aeolis::telemetry
