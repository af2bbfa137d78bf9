// SPDX-License-Identifier: Apache-2.0
#include "server/station/tone_station.hpp"

#include "common/check.hpp"
#include "common/time.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace aeolis::server {
namespace {

constexpr double listening_rate_hz = 16384.0;  // ours: holds the tones and half of it the predict's error
constexpr int cycle_samples = static_cast<int>(listening_rate_hz * seconds_per_tick);
constexpr std::size_t push_samples = 16384;
constexpr double same_symbol_s = 5.0;       // ours: a decision and a symbol that begin nearer are of one another
constexpr double waits_after_end_s = 30.0;  // ours: the receiver decides within 20 s

std::int64_t microseconds(double seconds) {
    return static_cast<std::int64_t>(std::llround(seconds * 1.0e6));
}

}  // namespace

ToneStation::ToneStation(const MfskWaveform& waveform, const simulation::Radio& radio, TimeTable predict_hz,
                         std::uint64_t seed, std::uint64_t case_number)
    : waveform_(waveform), total_c_n0_dbhz_(radio.x_band_c_n0_dbhz), predict_hz_(std::move(predict_hz)),
      sampler_(waveform, listening_rate_hz, seed, case_number) {}

void ToneStation::receive(const simulation::CycleReport& landed, std::vector<simulation::ReceivedTone>& tones) {
    undecided_.insert(undecided_.end(), landed.symbols.begin(), landed.symbols.end());
    for (const simulation::XBandField& field : landed.x_band) sample(field);
    if (!receiver_ || ended_) return;
    if (landed.x_band.empty()) {
        ended_ = true;  // the transmitter is off for good
        receiver_->push(samples_);
        samples_.clear();
        receiver_->finish();
        decide(std::numeric_limits<double>::infinity(), tones);
    } else if (samples_.size() >= push_samples) {
        receiver_->push(samples_);
        samples_.clear();
        decide(last_e_s_, tones);
    }
}

void ToneStation::sample(const simulation::XBandField& field) {
    if (!receiver_) {
        auto made = telemetry::ToneReceiver::make(waveform_, listening_rate_hz, predict_hz_, field.e_s);
        AEOLIS_CHECK(made.ok());
        receiver_.emplace(std::move(*made));
        last_doppler_hz_ = field.doppler_hz;
        last_e_s_ = field.e_s - seconds_per_tick;
        entry_ert_us_ = field.ert.microseconds - microseconds(field.e_s);
    }
    simulation::XBandSampler::Stretch stretch;
    stretch.samples = cycle_samples;
    stretch.residual_from_hz = last_doppler_hz_ - predict_hz_.at(field.e_s);
    stretch.residual_to_hz = field.doppler_hz - predict_hz_.at(field.e_s + seconds_per_tick);
    stretch.doppler_hz = 0.5 * (last_doppler_hz_ + field.doppler_hz);
    if (field.up) stretch.total_c_n0_dbhz = total_c_n0_dbhz_ + field.gain_db;
    sampler_.begin(stretch);
    const std::size_t before = samples_.size();
    samples_.resize(before + cycle_samples);
    std::optional<std::uint8_t> tone;
    if (field.tone) tone = static_cast<std::uint8_t>(field.tone->value);
    sampler_.take(std::span{samples_}.subspan(before), tone, field.tone_age_s);
    last_doppler_hz_ = field.doppler_hz;
    last_e_s_ = field.e_s;
}

simulation::ReceivedTone ToneStation::told(const telemetry::ToneReception& reception) const {
    simulation::ReceivedTone tone;
    tone.start = {entry_ert_us_ + microseconds(reception.start_s)};
    tone.end = {tone.start.microseconds + microseconds(waveform_.symbol_s)};
    if (reception.tone) tone.tone = ToneId{*reception.tone};
    tone.likelihood = reception.evidence.best[0].likelihood;
    tone.best = reception.evidence.best;
    tone.spectrum = reception.evidence.spectrum;
    tone.c_n0_dbhz = reception.total_c_n0_dbhz;
    tone.doppler_hz = reception.doppler_hz;
    tone.lock = reception.lock;
    return tone;
}

void ToneStation::decide(double now_e_s, std::vector<simulation::ReceivedTone>& tones) {
    for (const telemetry::ToneReception& reception : receiver_->take()) {
        simulation::ReceivedTone tone = told(reception);
        const auto same = std::ranges::find_if(undecided_, [&](const simulation::ReceivedTone& sent) {
            return std::abs(sent.start.microseconds - tone.start.microseconds) < microseconds(same_symbol_s);
        });
        if (same != undecided_.end()) {
            tone.sent = same->sent;
            tone.sent_at = same->sent_at;
            undecided_.erase(same);
        }
        tones.push_back(tone);
    }
    // What the receiver did not notice at all.
    while (!undecided_.empty() &&
           static_cast<double>(undecided_.front().end.microseconds - entry_ert_us_) * 1.0e-6 + waits_after_end_s <
               now_e_s) {
        tones.push_back(undecided_.front());
        undecided_.pop_front();
    }
}

}  // namespace aeolis::server
