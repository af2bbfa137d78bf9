// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace aeolis::telemetry {

/// Exact symbol error rate of non-coherent detection among `tones` orthogonal tones. `energy`: E/N0 of a symbol.
///
///   P = 1 − ∫ (1 − e^−u)^(M−1) e^−(u+E) I0(2√(uE)) du,   0 ≤ u < ∞.
///
/// Accurate to 1e-9 for energies up to 200. Source: [proakis-digital-communications].
double symbol_error(double energy, int tones);

/// The energy at which the symbol error rate is `error`, 0 < error < 1 − 1/tones.
double energy_for_symbol_error(double error, int tones);

}  // namespace aeolis::telemetry
