// SPDX-License-Identifier: Apache-2.0
#include "telemetry/mfsk/tone_receiver.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace aeolis::telemetry {
namespace {

constexpr double judged_s = 0.25;          // chosen
constexpr double moved_hz = 100.0;         // of the carrier, before lines are sought around its new frequency; chosen
constexpr double beside_hz = 200.0;        // of the carrier: nearer than any tone; chosen
constexpr double taken_out_hz = 0.3;       // of a line: nearer, it is taken out already; chosen
constexpr std::size_t besides_max = 3;     // chosen
constexpr std::size_t taken_out_max = 6;   // chosen, for the effort
constexpr double beside_s = 90.0;          // without a tone; chosen
constexpr double convincing_ratio = 15.0;  // log likelihood ratio of a tone that makes its receiver stay; chosen
constexpr double seen_of_it = 0.7;         // chosen
constexpr double waited_symbols = 3.0;  // from a tone's beginning, in which the first receiver may yet show one; chosen
constexpr double of_symbol = 0.9;       // two receptions are at least so far apart

/// Counts of `a`, and those of `b` times `sign`.
void add_counts(ReceiverStatus& a, const ReceiverStatus& b, double sign) {
    a.carrier_s += sign * b.carrier_s;
    a.without_s += sign * b.without_s;
    a.gap_s += sign * b.gap_s;
    a.acquisitions += static_cast<int>(sign) * b.acquisitions;
}

}  // namespace

Result<ToneReceiver> ToneReceiver::make(const MfskWaveform& waveform, double rate_hz, ReceiverInput input) {
    auto receiver = SingleReceiver::make(waveform, rate_hz, input);
    if (!receiver) return receiver.error();
    return ToneReceiver{waveform, rate_hz, std::move(input), std::move(*receiver)};
}

void ToneReceiver::push(std::span<const std::complex<float>> samples) {
    // Pieces end at the same samples whatever the size of the blocks.
    const auto piece = static_cast<std::int64_t>(judged_s * rate_hz_);
    while (!samples.empty()) {
        const auto now = samples.first(std::min(samples.size(), static_cast<std::size_t>(piece - received_ % piece)));
        samples = samples.subspan(now.size());
        receiver_->push(now);
        for (Beside& beside : besides_) beside.receiver.push(now);
        if (lines_) lines_->push(now);
        received_ += std::ssize(now);
        if (received_ % piece != 0) continue;
        take_from_all();
        judge_lines();
    }
    tell_status();
}

void ToneReceiver::finish() {
    if (receiver_->is_content()) besides_.clear();
    ended_ = true;
    receiver_->finish();
    for (Beside& beside : besides_) beside.receiver.finish();
    take_from_all();
    tell_status();
}

void ToneReceiver::take_from_all() {
    const auto append = [](auto& to, auto&& from) { to.insert(to.end(), from.begin(), from.end()); };
    for (Beside& beside : besides_) {
        append(beside.receptions, beside.receiver.take());
        append(beside.reports, beside.receiver.take_carrier());
    }
    const auto receptions = receiver_->take();
    const auto reports = receiver_->take_carrier();
    if (!receptions.empty()) last_begin_s_ = receptions.back().start_s;
    for (const ToneReception& each : receptions)
        if (each.tone) last_tone_s_ = each.start_s;
    if (!reports.empty()) last_report_s_ = reports.back().time_s;
    append(receptions_, receptions);
    append(reports_, reports);
    // While it hears tones there is nothing to take over, and besides would compete for the next one.
    if (receiver_->is_content()) besides_.clear();
    const auto found = std::ranges::find_if(besides_, [&](const Beside& beside) { return takes_over(beside); });
    if (found != besides_.end()) take_over(*found);
}

/// Whether a receiver beside heard a tone that this one did not, nor another shortly before.
bool ToneReceiver::takes_over(const Beside& beside) const {
    const double now_s = input_.start_s + static_cast<double>(received_) / rate_hz_;
    return std::ranges::any_of(beside.receptions, [&](const ToneReception& each) {
        return each.tone && each.seen_fraction >= seen_of_it &&
               each.evidence.log_likelihood_ratio >= convincing_ratio &&
               each.start_s > last_tone_s_ + of_symbol * waveform_.symbol_s &&
               (ended_ || each.start_s + waited_symbols * waveform_.symbol_s < now_s);
    });
}

void ToneReceiver::take_over(Beside& beside) {
    const ReceiverStatus old = receiver_->status();
    add_counts(before_, old, 1.0);
    add_counts(before_, beside.receiver.status(), -1.0);
    before_.contradicted += old.contradicted;
    before_.loudest = std::max(before_.loudest, old.loudest);
    receiver_.emplace(std::move(beside.receiver));
    for (const double hz : beside.left_out_hz) left_out_hz_.push_back(hz);
    const double from_s = last_begin_s_ + of_symbol * waveform_.symbol_s;
    for (const ToneReception& each : beside.receptions)
        if (each.start_s > from_s) {
            last_begin_s_ = each.start_s;
            if (each.tone) last_tone_s_ = each.start_s;
            receptions_.push_back(each);
        }
    for (const CarrierReport& each : beside.reports)
        if (each.time_s > last_report_s_) {
            last_report_s_ = each.time_s;
            reports_.push_back(each);
        }
    besides_.clear();
}

bool ToneReceiver::is_left_out(double line_hz) const {
    const auto same = [&](double hz) { return std::abs(hz - line_hz) < taken_out_hz; };
    return std::ranges::any_of(left_out_hz_, same) || std::ranges::any_of(input_.excluded_hz, same);
}

/// Seeks lines around the followed carrier, and takes them out or listens without them.
void ToneReceiver::judge_lines() {
    const auto carrier_hz = receiver_->carrier_hz();
    if (carrier_hz && (!lines_ || std::abs(*carrier_hz - lines_->middle_hz()) > moved_hz)) {
        lines_.emplace(rate_hz_, *carrier_hz);
        looks_judged_ = 0;
    }
    if (!lines_ || lines_->looks() == looks_judged_) return;
    looks_judged_ = lines_->looks();
    std::vector<double> still_hz;
    for (const StandingLine& line : lines_->lines())
        if (!is_left_out(line.frequency_hz) &&
            std::abs(line.frequency_hz - carrier_hz.value_or(lines_->middle_hz())) < beside_hz)
            still_hz.push_back(line.frequency_hz);
    status_.standing_hz = still_hz;
    std::erase_if(besides_, [&](const Beside& beside) {
        return static_cast<double>(received_ - beside.begun) > beside_s * rate_hz_;
    });
    if (receiver_->is_content()) {
        for (const double hz : still_hz) {
            if (left_out_hz_.size() >= taken_out_max || !receiver_->heard_apart_from(hz)) continue;
            receiver_->exclude(hz);
            left_out_hz_.push_back(hz);
        }
        return;
    }
    if (still_hz.empty() || (still_hz.size() == 1 && !lines_->holds_more())) return;
    still_hz.resize(std::min<std::size_t>(still_hz.size(), 2));
    listen_without({still_hz.front()});
    if (still_hz.size() == 1) return;
    listen_without({still_hz.back()});
    listen_without(still_hz);
}

void ToneReceiver::listen_without(const std::vector<double>& lines_hz) {
    if (besides_.size() >= besides_max || left_out_hz_.size() + lines_hz.size() > taken_out_max) return;
    for (const Beside& beside : besides_)
        if (std::ranges::equal(beside.left_out_hz, lines_hz,
                               [](double a, double b) { return std::abs(a - b) < taken_out_hz; }))
            return;
    ReceiverInput input = input_;
    input.start_s += static_cast<double>(received_) / rate_hz_;
    input.excluded_hz.insert(input.excluded_hz.end(), left_out_hz_.begin(), left_out_hz_.end());
    input.excluded_hz.insert(input.excluded_hz.end(), lines_hz.begin(), lines_hz.end());
    auto made = SingleReceiver::make(waveform_, rate_hz_, std::move(input));
    if (made) besides_.push_back({std::move(*made), lines_hz, received_, {}, {}});
}

void ToneReceiver::tell_status() {
    auto standing_hz = std::move(status_.standing_hz);
    status_ = receiver_->status();
    add_counts(status_, before_, 1.0);
    status_.contradicted += before_.contradicted;
    status_.loudest = std::max(status_.loudest, before_.loudest);
    status_.left_out_hz = left_out_hz_;
    status_.standing_hz = std::move(standing_hz);
}

std::vector<ToneReception> ToneReceiver::take() {
    return std::exchange(receptions_, {});
}

std::vector<CarrierReport> ToneReceiver::take_carrier() {
    return std::exchange(reports_, {});
}

}  // namespace aeolis::telemetry
