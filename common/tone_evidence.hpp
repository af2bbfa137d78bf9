// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

// Evidence for a tone decision, in the terms shared by receiver, archive and console.
namespace aeolis {

/// State of the receiver's lock on the carrier; greater is worse.
enum class CarrierLock : std::uint8_t {
    locked,       ///< found at the predicted frequency
    fluctuating,  ///< found, but only by a wider or longer search
    coasting,     ///< not found: the frequency is extrapolated
    searching,    ///< no carrier: the whole band is searched
};
constexpr const char* to_text(CarrierLock lock) {
    switch (lock) {
    case CarrierLock::locked: return "locked";
    case CarrierLock::fluctuating: return "fluctuating";
    case CarrierLock::coasting: return "coasting";
    case CarrierLock::searching: return "searching";
    }
    return "";
}

struct ToneLikelihood {
    std::uint8_t tone = 0;
    double likelihood = 0.0;  ///< posterior probability, with all tones equally likely a priori
};
/// The five likeliest tones, likeliest first.
using BestTones = std::array<ToneLikelihood, 5>;

/// Ratio of energy to noise of the 256 tones, the greater of each pair.
/// Octet n stands for n/2 − 30 dB. The mean of noise alone is 0 dB.
using ToneSpectrum = std::array<std::uint8_t, 128>;
inline constexpr double spectrum_floor_db = -30.0, spectrum_step_db = 0.5;  ///< chosen
inline std::uint8_t spectrum_octet(double level_db) {
    return static_cast<std::uint8_t>(
        std::clamp(std::lround((level_db - spectrum_floor_db) / spectrum_step_db), 0L, 255L));
}
constexpr double spectrum_db(std::uint8_t octet) {
    return spectrum_floor_db + spectrum_step_db * octet;
}

}  // namespace aeolis
