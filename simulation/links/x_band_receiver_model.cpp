// SPDX-License-Identifier: Apache-2.0
#include "simulation/links/x_band_receiver_model.hpp"

#include "simulation/links/tone_detection.hpp"
#include "simulation/links/x_band_link.hpp"
#include "simulation/vectors.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace aeolis::simulation {
namespace {

constexpr double symbol_s = 10.0;                     // [facts]
constexpr std::int64_t symbol_us = 10'000'000;        // the same
constexpr double least_likelihood = 0.9;              // chosen, as the receiver of samples has it
constexpr double least_heard_s = symbol_s / 4.0;      // the same
constexpr std::int64_t first_search_ticks = 10 * 64;  // telemetry::ToneStation::first_search_s

}  // namespace

XBandReceiverModel::XBandReceiverModel(double total_c_n0_dbhz, TimeTable predict_hz, std::uint64_t seed,
                                       std::uint64_t case_number)
    : total_c_n0_dbhz_(total_c_n0_dbhz), predict_hz_(predict_hz),
      carrier_(total_c_n0_dbhz, std::move(predict_hz), seed, case_number), random_(seed, case_number, Stream::x_band) {}

void XBandReceiverModel::hear(const XBandField& field, telemetry::Downlink& out) {
    const bool sends = field.up && field.tone.has_value();
    if (symbol_ && (!sends || field.tone != symbol_->tone || field.tone_age_s < symbol_->age_s)) {
        if (const auto decided = decide(*symbol_)) out.tones.push_back(*decided);
        symbol_.reset();
    }
    if (const auto carrier = carrier_.hear(field)) {
        note(*carrier);
        out.carrier.push_back(*carrier);
    }
    without_ticks_ = carrier_.follows() ? 0 : without_ticks_ + 1;
    if (!carrier_.follows()) {
        found_ = false;
        lock_ = CarrierLock::searching;
    }
    if (sends) {
        if (!symbol_) {
            const auto age_us = static_cast<std::int64_t>(std::llround(field.tone_age_s * 1e6));
            symbol_ = Symbol{*field.tone, Ert{field.ert.microseconds - age_us}};
            symbol_->doppler_hz = predict_hz_.at(field.e_s);
        }
        symbol_->age_s = field.tone_age_s;
        symbol_->worst = std::max(symbol_->worst, lock_);
        if (found_) {
            ++symbol_->heard_ticks;
            symbol_->gain_sum += std::pow(10.0, 0.1 * field.gain_db);
        }
    }
    tell_link(field, out);
}

void XBandReceiverModel::note(const telemetry::ReceivedCarrier& carrier) {
    found_ = carrier.estimate.has_value();
    lock_ = carrier.lock;
    if (!symbol_ || !carrier.estimate) return;
    const double doppler_hz = carrier.predict_hz + carrier.estimate->residual_hz;
    symbol_->doppler_hz += (doppler_hz - symbol_->doppler_hz) / ++symbol_->estimates;
}

std::optional<telemetry::ReceivedTone> XBandReceiverModel::decide(const Symbol& symbol) {
    if (symbol.heard_ticks == 0) return {};
    telemetry::ReceivedTone received;
    received.start = symbol.start;
    received.end = Ert{symbol.start.microseconds + symbol_us};
    received.doppler_hz = symbol.doppler_hz;
    received.lock = symbol.worst;
    const double heard_s = symbol.heard_ticks * seconds_per_tick;
    if (heard_s < least_heard_s) return received;
    const double c_n0_dbhz = total_c_n0_dbhz_ + 10.0 * std::log10(symbol.gain_sum / symbol.heard_ticks);
    const ToneDecision decision =
        detect_tone(symbol.tone.value, c_n0_dbhz + XBandLink::tone_power_db(), heard_s, random_);
    received.best = decision.best;
    received.likelihood = decision.best[0].likelihood;
    if (received.likelihood < least_likelihood) return received;
    received.tone = ToneId{decision.best[0].tone};
    received.c_n0_dbhz = decision.tone_c_n0_dbhz - XBandLink::tone_power_db();
    return received;
}

void XBandReceiverModel::tell_link(const XBandField& field, telemetry::Downlink& out) {
    const bool up = carrier_.follows() && !out.station_out;
    if (up_ == up || !(up || up_ || without_ticks_ >= first_search_ticks)) return;
    up_ = up;
    const Ert now{field.ert.microseconds + static_cast<std::int64_t>(seconds_per_tick * 1e6)};
    out.links.push_back({telemetry::x_band_link, now, up, up ? "nominal" : ""});
}

}  // namespace aeolis::simulation
