// SPDX-License-Identifier: Apache-2.0
#include "telemetry/station/tone_station.hpp"

#include "common/check.hpp"

#include <cmath>

namespace aeolis::telemetry {
namespace {

constexpr double push_s = 0.25;  // chosen: what is seen by Doppler is told that much later at most
/// How far a fit's C/N0 may lie below its running mean. Chosen: where the carrier went, fits to its rest and to noise
/// lie further below and are many deviations off; of good fits at 22 dB-Hz less than one in a hundred does.
constexpr double faded_db = 2.0;

std::int64_t microseconds(double seconds) {
    return static_cast<std::int64_t>(std::llround(seconds * 1.0e6));
}

}  // namespace

void ToneStation::receive(const Downlink& downlink, Received& out) {
    for (const XBandSamples& piece : downlink.x_band) {
        if (!receiver_) {
            const double start_s = static_cast<double>(piece.ert.microseconds - entry_.microseconds) * 1.0e-6;
            auto made = ToneReceiver::make(waveform_, recorded_.rate_hz,
                                           {predict_hz_, start_s, recorded_.expected_hz, recorded_.excluded_hz, {}});
            AEOLIS_CHECK(made.ok());
            receiver_.emplace(std::move(*made));
            spectrum_.emplace(recorded_.rate_hz, start_s);
            if (!recorded_.expected_hz.empty()) remover_.emplace(recorded_.expected_hz, recorded_.rate_hz, start_s);
        }
        samples_.insert(samples_.end(), piece.samples.begin(), piece.samples.end());
    }
    if (!receiver_ || ended_) return;
    ended_ = downlink.x_band.empty();  // no more samples
    if (ended_ || static_cast<double>(samples_.size()) >= recorded_.rate_hz * push_s) push(downlink.now, out);
    const auto& status = receiver_->status();
    const bool carrier = !ended_ && !downlink.station_out && status.lock != CarrierLock::searching;
    if (carrier || up_ || ended_ || status.without_s >= first_search_s) tell_link(carrier, downlink.now, out);
}

void ToneStation::push(Ert now, Received& out) {
    receiver_->push(samples_);
    if (remover_) remover_->remove(samples_);
    spectrum_->push(samples_);
    samples_.clear();
    for (ThinnedRow& row : spectrum_->take()) out.spectra.push_back({now, ert_of(row.time_s), std::move(row)});
    if (ended_) receiver_->finish();
    for (const CarrierReport& report : receiver_->take_carrier()) {
        const bool follows = report.lock != CarrierLock::searching;
        if (follows || follows_) out.carrier.push_back(told(report, now));
        follows_ = follows;
    }
    for (const ToneReception& reception : receiver_->take()) out.tones.push_back(told(reception));
}

void ToneStation::tell_link(bool up, Ert now, Received& out) {
    if (up_ == up) return;
    up_ = up;
    out.links.push_back({x_band_link, now, up, up ? "nominal" : ""});
}

Ert ToneStation::ert_of(double from_entry_s) const {
    return {entry_.microseconds + microseconds(from_entry_s)};
}

ReceivedCarrier ToneStation::told(const CarrierReport& report, Ert now) const {
    const double predict_hz = predict_hz_.at(report.time_s) + recorded_.expected_hz.at(report.time_s);
    ReceivedCarrier carrier{now, ert_of(report.time_s), predict_hz, report.lock, {}};
    if (report.fit_c_n0_dbhz > report.total_c_n0_dbhz - faded_db && report.frequency_deviation_hz > 0.0)
        carrier.estimate = {report.frequency_hz, report.frequency_deviation_hz, report.rate_hzps,
                            report.total_c_n0_dbhz};
    else if (report.lock != CarrierLock::searching)
        carrier.lock = CarrierLock::coasting;
    return carrier;
}

ReceivedTone ToneStation::told(const ToneReception& reception) const {
    ReceivedTone tone;
    tone.start = ert_of(reception.start_s);
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

}  // namespace aeolis::telemetry
