// SPDX-License-Identifier: Apache-2.0
#include "telemetry/mfsk/tone_receiver.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace aeolis::telemetry {
namespace {

constexpr double level_gain = 0.1;  // of each hop in the running mean of C/N0: 1.2 s; chosen

// A pulse is 40 dB above the mean power, which noise never is; the mean is over 1024 samples. Chosen.
constexpr double pulse_ratio = 1e4;
constexpr double power_gain = 1.0 / 1024.0;

/// Power as double, because the square of a float may overflow one.
double power_of(const std::complex<float>& sample) {
    return std::norm(std::complex<double>{sample});
}

/// Median of a block's powers: a few pulses do not move it.
double middle_power(std::span<const std::complex<float>> samples) {
    std::vector<double> powers;
    for (const auto& sample : samples)
        if (const double power = power_of(sample); std::isfinite(power)) powers.push_back(power);
    if (powers.empty()) return 0.0;
    const auto middle = powers.begin() + static_cast<std::ptrdiff_t>(powers.size() / 2);
    std::ranges::nth_element(powers, middle);
    return *middle;
}

}  // namespace

Result<ToneReceiver> ToneReceiver::make(const MfskWaveform& waveform, double rate_hz, TimeTable predict_hz,
                                        double start_s) {
    if (!(rate_hz >= rate_least_hz && rate_hz <= rate_greatest_hz))
        return Error{"a rate of " + std::to_string(rate_hz) + " Hz is outside " + std::to_string(rate_least_hz) +
                     " ... " + std::to_string(rate_greatest_hz) + " Hz"};
    if (2.5 * waveform.highest_tone_hz() > rate_hz)
        return Error{"a rate of " + std::to_string(rate_hz) + " Hz does not hold tones of up to " +
                     std::to_string(waveform.highest_tone_hz()) + " Hz to either side of the carrier"};
    return ToneReceiver{waveform, rate_hz, std::move(predict_hz), start_s};
}

ToneReceiver::ToneReceiver(const MfskWaveform& waveform, double rate_hz, TimeTable predict_hz, double start_s)
    : waveform_(waveform), layout_(rate_hz), predict_hz_(std::move(predict_hz)), start_s_(start_s),
      carrier_search_(rate_hz), tracker_(layout_, waveform.carrier_fraction()),
      correlator_(waveform, layout_.thinned_rate_hz(), layout_.thinned_samples()),
      sequence_(static_cast<int>(std::lround(waveform.symbol_s / layout_.hop_s())), layout_.hop_samples()) {}

/// Whether a sample is a pulse, or not a number. The mean follows a lasting change of level within some hundreds of
/// samples.
bool ToneReceiver::is_pulse(const std::complex<float>& sample) {
    const double power = power_of(sample);
    if (!std::isfinite(power)) return true;
    if (mean_power_ == 0.0) mean_power_ = power;
    const double limit = pulse_ratio * mean_power_;
    mean_power_ += power_gain * (std::min(power, limit) - mean_power_);
    if (power * pulse_ratio < mean_power_) mean_power_ /= 2.0;  // noise is that weak once in ten thousand samples
    return power > limit;
}

void ToneReceiver::push(std::span<const std::complex<float>> samples) {
    const std::size_t before = samples_.size();
    samples_.insert(samples_.end(), samples.begin(), samples.end());
    if (mean_power_ == 0.0) mean_power_ = middle_power(samples);
    for (std::size_t i = before; i < samples_.size(); ++i) {
        if (is_pulse(samples_[i])) samples_[i] = {};
        status_.loudest = std::max(status_.loudest, power_of(samples_[i]));
    }
    work();
}

void ToneReceiver::drop(std::size_t count) {
    head_ += count;
    first_kept_ += static_cast<std::int64_t>(count);
    if (2 * head_ < samples_.size()) return;
    samples_.erase(samples_.begin(), samples_.begin() + static_cast<std::ptrdiff_t>(head_));
    head_ = 0;
}

void ToneReceiver::work() {
    while (tracking_ ? track() : search()) {
    }
    weigh_hops();
    publish();
}

void ToneReceiver::pass_without_carrier() {
    CarrierHop hop;
    hop.first_sample = first_kept_;
    hops_.push_back(std::move(hop));
    drop(static_cast<std::size_t>(layout_.hop_samples()));
}

/// Returns true when a carrier was found.
bool ToneReceiver::search() {
    const auto unsearched = kept().subspan(static_cast<std::size_t>(searched_ - first_kept_));
    const auto found = carrier_search_.push(unsearched);
    searched_ += static_cast<std::int64_t>(unsearched.size());
    const std::int64_t needed =
        found ? search_began_ + found->first_sample : searched_ - carrier_search_.longest_window_samples();
    while (first_kept_ < needed && std::ssize(kept()) >= layout_.hop_samples() &&
           first_kept_ + layout_.hop_samples() <= searched_)
        pass_without_carrier();
    if (!found) return false;

    const double middle = 0.5 * static_cast<double>(found->first_sample + found->last_sample);
    const double since_middle_s = (static_cast<double>(first_kept_ - search_began_) - middle) / layout_.rate_hz;
    tracker_.start(first_kept_, found->frequency_hz + found->rate_hzps * since_middle_s, found->rate_hzps);
    carrier_n0_hz_ = 0.0;
    ++status_.acquisitions;
    tracking_ = true;
    return true;
}

/// Returns true when the carrier was lost and the search must continue.
bool ToneReceiver::track() {
    const auto hop_samples = static_cast<std::size_t>(layout_.hop_samples());
    while (kept().size() >= hop_samples) {
        tracker_.push(kept().first(hop_samples), hops_);
        drop(hop_samples);
        if (tracker_.lost()) {
            carrier_search_ = CarrierSearch{layout_.rate_hz};
            search_began_ = searched_ = first_kept_;
            tracking_ = false;
            return true;
        }
    }
    return false;
}

void ToneReceiver::weigh_hops() {
    for (const CarrierHop& hop : hops_) {
        const double begin_s = static_cast<double>(hop.first_sample) / layout_.rate_hz;
        HopEvidence evidence;
        evidence.first_sample = hop.first_sample;
        evidence.lock = hop.lock;
        evidence.doppler_hz = predict_hz_.at(start_s_ + begin_s + 0.5 * layout_.hop_s()) + hop.frequency_hz;
        if (hop.found) {
            carrier_n0_hz_ = carrier_n0_hz_ == 0.0 ? hop.carrier_n0_hz
                                                   : carrier_n0_hz_ + level_gain * (hop.carrier_n0_hz - carrier_n0_hz_);
            evidence.found = true;
            evidence.total_n0_hz = carrier_n0_hz_ / waveform_.carrier_fraction();
            evidence.energy = evidence.total_n0_hz * waveform_.tone_fraction() * layout_.hop_s();
            correlator_.correlate(hop.quadrature, begin_s + lead_s_, evidence.sums);
            const auto scale = static_cast<float>(std::sqrt(evidence.energy / layout_.thinned_samples()));
            for (auto& sum : evidence.sums) sum *= scale;
            status_.total_c_n0_dbhz = 10.0 * std::log10(std::max(evidence.total_n0_hz, 1e-9));
        }
        lead_s_ += evidence.doppler_hz / waveform_.carrier_hz * layout_.hop_s();
        status_.lock = hop.lock;
        status_.doppler_hz = evidence.doppler_hz;
        (hop.found ? status_.carrier_s : status_.without_s) += layout_.hop_s();
        sequence_.push(evidence, decided_);
    }
    hops_.clear();
}

void ToneReceiver::publish() {
    for (const DecidedSymbol& symbol : decided_)
        receptions_.push_back({symbol.tone, start_s_ + static_cast<double>(symbol.first_sample) / layout_.rate_hz,
                               symbol.total_c_n0_dbhz, symbol.doppler_hz, symbol.lock, symbol.seen_fraction,
                               symbol.evidence});
    decided_.clear();
}

void ToneReceiver::finish() {
    if (tracking_) {
        tracker_.finish(hops_);
        tracking_ = false;
    }
    weigh_hops();
    sequence_.finish(decided_);
    publish();
}

std::vector<ToneReception> ToneReceiver::take() {
    return std::exchange(receptions_, {});
}

}  // namespace aeolis::telemetry
