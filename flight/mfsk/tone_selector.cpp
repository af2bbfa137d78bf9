#include "flight/mfsk/tone_selector.hpp"

namespace aeolis::flight {
namespace {

void explain(Outbox& out, ToneId tone, ExplanationVerdict verdict, double priority, double age_s, double age_limit_s) {
    out.record(packet::Explanation{.decision = Decision::tone,
                                   .verdict = verdict,
                                   .subject = tone.value,
                                   .condition_count = 2,
                                   .condition_1 = Quantity::tone_priority,
                                   .value_1 = priority,
                                   .bound_1 = priority,
                                   .comparison_1 = Comparison::ge,
                                   .holds_1 = true,
                                   .condition_2 = Quantity::request_age_s,
                                   .value_2 = age_s,
                                   .bound_2 = age_limit_s,
                                   .comparison_2 = Comparison::le,
                                   .holds_2 = age_s <= age_limit_s});
}

}  // namespace

void ToneSelector::on(const ToneRequest& asked, Outbox& out) {
    ToneRequest request = asked;
    if (role_ == Role::second_chance) {
        const auto& counterpart = tones_[asked.tone.value].second_chance;
        if (!counterpart) return;  // no tone of prime's is ever sent, whoever asks
        request.tone = *counterpart;
    }
    const auto& spec = tones_[request.tone.value];
    if (spec.supersedes)
        for (std::size_t i = outstanding_.size(); i-- > 0;)
            if (outstanding_[i].tone == *spec.supersedes) drop(i, out);
    for (auto& same : outstanding_)
        if (same.tone == request.tone) {
            same.requested = request.requested;
            return;
        }
    if (outstanding_.full()) {
        out.event(evr::MFSK_REQUESTS_FULL{.tone = request.tone.value});
        const std::size_t least = least_important();
        if (priority(outstanding_[least].tone) >= spec.priority) return;
        drop(least, out);
    }
    outstanding_.push_back(request);
}

void ToneSelector::on(const StandBy&, Outbox& out) {
    silent_ = true;
    outstanding_.clear();
    sending_.reset();
    out.bus().tone.reset();
}

void ToneSelector::on(const ClockTick& tick, Outbox& out) {
    if (silent_) return;
    drop_expired(tick.now, out);
    if (sending_ && tick.now - sending_->started >= ParameterDefaults{}.tone_duration_s) {
        sending_.reset();
        out.bus().tone.reset();
    }
    if (!sending_ && !outstanding_.empty()) {
        const std::size_t chosen = most_important();
        const ToneRequest request = outstanding_[chosen];
        outstanding_.erase_at(chosen);
        sending_ = Sending{request.tone, tick.now};
        out.bus().tone = request.tone;
        out.record(packet::ToneSelected{.tone = request.tone.value,
                                        .started_sclk = tick.now.seconds,
                                        .requested_sclk = request.requested.seconds,
                                        .priority = static_cast<std::uint8_t>(priority(request.tone)),
                                        .outstanding = static_cast<std::uint8_t>(outstanding_.size())});
        // A choice between several is worth an explanation; a lone request explains itself.
        if (!outstanding_.empty())
            explain(out, request.tone, ExplanationVerdict::chosen, priority(request.tone), tick.now - request.requested,
                    tones_[request.tone.value].expires_s);
    }
    if (at_resolution(tick.now, 1) == tick.now)
        out.send(ModuleId::edl_comm, ToneStatus{sending_ ? sending_->tone.value : std::uint8_t{0},
                                                static_cast<std::uint8_t>(outstanding_.size())});
}

void ToneSelector::drop_expired(Sclk now, Outbox& out) {
    for (std::size_t i = outstanding_.size(); i-- > 0;)
        if (now - outstanding_[i].requested > tones_[outstanding_[i].tone.value].expires_s) drop(i, out);
}

void ToneSelector::drop(std::size_t index, Outbox& out) {
    const ToneRequest request = outstanding_[index];
    outstanding_.erase_at(index);
    explain(out, request.tone, ExplanationVerdict::dropped, priority(request.tone), out.now() - request.requested,
            tones_[request.tone.value].expires_s);
}

std::size_t ToneSelector::most_important() const {
    std::size_t best = 0;
    for (std::size_t i = 1; i < outstanding_.size(); ++i) {
        const auto a = priority(outstanding_[i].tone);
        const auto b = priority(outstanding_[best].tone);
        if (a > b || (a == b && outstanding_[i].requested >= outstanding_[best].requested)) best = i;
    }
    return best;
}

std::size_t ToneSelector::least_important() const {
    std::size_t worst = 0;
    for (std::size_t i = 1; i < outstanding_.size(); ++i)
        if (priority(outstanding_[i].tone) < priority(outstanding_[worst].tone)) worst = i;
    return worst;
}

}  // namespace aeolis::flight
