// SPDX-License-Identifier: Apache-2.0
#include "simulation/links/x_band_link.hpp"

#include "simulation/links/tone_detection.hpp"
#include "simulation/vectors.hpp"

namespace aeolis::simulation {
namespace {

constexpr int symbol_ticks = 640;
constexpr double symbol_s = 10.0;                           // [facts]
constexpr double modulation_index_rad = 32.0 * degree_rad;  // as in mfsk.csv; a test compares the two
constexpr double carrier_lock_dbhz = 15.8;                  // our assumption: what the receiver's search over 4 s needs
constexpr double least_likelihood = 0.9;                    // chosen

}  // namespace

double XBandLink::carrier_power_db() {
    return 20.0 * std::log10(std::cos(modulation_index_rad));
}

double XBandLink::tone_power_db() {
    constexpr double first_sidebands = 8.0 / (std::numbers::pi * std::numbers::pi);
    return 10.0 * std::log10(first_sidebands) + 20.0 * std::log10(std::sin(modulation_index_rad));
}

bool XBandLink::can_lock(double c_n0_dbhz) {
    return c_n0_dbhz + carrier_power_db() >= carrier_lock_dbhz;
}

std::optional<XBandLink::Ended> XBandLink::cycle(std::optional<ToneId> tone, const Surroundings& at) {
    earth_up_ = at.gain && (radio_.earth_set_after_entry_s ? at.e_s < *radio_.earth_set_after_entry_s : at.earth_up);
    up_ = earth_up_ && can_lock(radio_.x_band_c_n0_dbhz + 10.0 * std::log10(*at.gain));
    reason_ = !at.gain ? "not switched on" : earth_up_ ? "carrier too weak" : "Earth set";

    std::optional<Ended> ended;
    if (symbol_ && symbol_->ticks == symbol_ticks) {
        ended = decide(false, at);
    } else if (symbol_ && (!earth_up_ || !tone || *tone != symbol_->tone)) {
        ended = decide(true, at);
    }
    if (ended) symbol_.reset();
    if (tone && earth_up_ && !symbol_) symbol_ = Symbol{*tone, at.now};
    if (symbol_) {
        ++symbol_->ticks;
        if (up_) ++symbol_->locked_ticks;
        symbol_->gain_sum += *at.gain;
    }
    return ended;
}

XBandLink::Ended XBandLink::decide(bool broken, const Surroundings& at) {
    Ended ended{symbol_->tone, symbol_->started, {}};
    if (symbol_->locked_ticks == 0 || radio_.tones_from_samples.value_or(false)) return ended;
    auto& received = ended.heard.emplace();
    received.doppler_hz = at.doppler_hz;
    received.lock = up_ ? CarrierLock::locked : CarrierLock::searching;
    if (broken || !up_) return ended;
    const double c_n0_dbhz = radio_.x_band_c_n0_dbhz + 10.0 * std::log10(symbol_->gain_sum / symbol_->ticks);
    const ToneDecision decision = detect_tone(symbol_->tone.value, c_n0_dbhz + tone_power_db(), symbol_s, random_);
    received.best = decision.best;
    received.likelihood = decision.best[0].likelihood;
    received.c_n0_dbhz = decision.tone_c_n0_dbhz - tone_power_db();
    if (received.likelihood >= least_likelihood) received.tone = ToneId{decision.best[0].tone};
    return ended;
}

}  // namespace aeolis::simulation
