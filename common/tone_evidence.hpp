// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

// On what a tone decision rests, as receiver, archive and console speak of it.
namespace aeolis {

/// The worse, the greater.
enum class CarrierLock : std::uint8_t {
    locked,       ///< found where it was predicted
    fluctuating,  ///< found, but only by a wider or longer look
    coasting,     ///< not found: frequency goes on as it last did
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
    double likelihood = 0.0;  ///< posterior probability, all tones being equally likely before
};
/// The likeliest first.
using BestTones = std::array<ToneLikelihood, 5>;

/// Energy over noise of the tones, the greater of each two: octet n stands for n/2 − 30 dB. The mean of noise alone is
/// 0 dB.
using ToneSpectrum = std::array<std::uint8_t, 128>;
inline constexpr double spectrum_floor_db = -30.0, spectrum_step_db = 0.5;  ///< ours
inline std::uint8_t spectrum_octet(double level_db) {
    return static_cast<std::uint8_t>(
        std::clamp(std::lround((level_db - spectrum_floor_db) / spectrum_step_db), 0L, 255L));
}
constexpr double spectrum_db(std::uint8_t octet) {
    return spectrum_floor_db + spectrum_step_db * octet;
}

}  // namespace aeolis
