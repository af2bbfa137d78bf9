// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/mfsk_waveform.hpp"

#include <complex>
#include <cstdint>
#include <vector>

namespace aeolis::simulation {

/// A transmitted tone: one symbol from `start_s`, in the samples' time.
struct SentTone {
    double start_s = 0.0;
    std::uint8_t tone = 0;
};

/// One tone's modulation at a sample rate: exp(j m sq) = cos m + j sin m · sq.
///
/// The square wave sq lacks the harmonics that the samples could not represent, because a front end filters them off
/// first.
class ModulatedTone {
  public:
    /// Keeps harmonics up to 0.45 of `rate_hz`.
    ModulatedTone(const MfskWaveform& waveform, int tone, double rate_hz);

    /// The signal relative to the unmodulated carrier, 1 · e^j0. `cycles`: of the subcarrier, from the rise of its
    /// square wave.
    std::complex<float> at(double cycles) const {
        const double within = cycles - static_cast<double>(static_cast<std::int64_t>(cycles));
        const auto place = static_cast<std::size_t>((within < 0.0 ? within + 1.0 : within) * places);
        return {in_phase_, quadrature_[place & (places - 1)]};
    }

  private:
    static constexpr std::size_t places = 4096;
    float in_phase_;
    std::vector<float> quadrature_;
};

}  // namespace aeolis::simulation
