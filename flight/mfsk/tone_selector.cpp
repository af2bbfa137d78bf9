// SPDX-License-Identifier: Apache-2.0
#include "flight/mfsk/tone_selector.hpp"

#include "common/check.hpp"
#include "flight/explanation/explanation.hpp"

#include <initializer_list>

namespace aeolis::flight {
namespace {

void explain(Outbox& out, ToneId tone, ExplanationVerdict verdict, std::initializer_list<gnc::Condition> conditions) {
    out.record(explanation(Decision::tone, verdict, tone.value, {conditions.begin(), conditions.size()}));
}

}  // namespace

void ToneSelector::on(const ToneRequest& asked, Outbox& out) {
    const auto tone = own(asked.tone);
    if (!tone) return;
    const ToneRequest request{*tone, asked.requested};
    const auto& spec = tones_[request.tone.value];
    if (spec.supersedes) drop_overtaken(*spec.supersedes, request.tone, out);
    for (auto& same : outstanding_)
        if (same.tone == request.tone) {
            same.requested = request.requested;
            return;
        }
    if (outstanding_.full()) refuse_or_make_room(request, out);
    if (!outstanding_.full()) outstanding_.push_back(request);
}

// The tone of this computer's set with the meaning of a prime tone. Second Chance never sends prime's tones.
std::optional<ToneId> ToneSelector::own(ToneId tone) const {
    return role_ == Role::second_chance ? tones_[tone.value].second_chance : tone;
}

void ToneSelector::on(const PhaseChanged& change, Outbox&) {
    heartbeat_.reset();
    for (std::size_t i = 0; i < tones_.size(); ++i)
        if (tones_[i].heartbeat_of == change.phase) heartbeat_ = own(ToneId{static_cast<std::uint8_t>(i)});
}

void ToneSelector::drop_overtaken(ToneId overtaken, ToneId by, Outbox& out) {
    for (std::size_t i = outstanding_.size(); i-- > 0;) {
        const ToneRequest request = outstanding_[i];
        if (request.tone != overtaken) continue;
        outstanding_.erase_at(i);
        explain(out, request.tone, ExplanationVerdict::dropped,
                {names(Quantity::overtaking_tone, by.value),
                 at_most(Quantity::request_age_s, out.now() - request.requested, expires_s(request.tone))});
    }
}

// The less important of the two is dropped: the new request, or the least important outstanding one.
void ToneSelector::refuse_or_make_room(const ToneRequest& request, Outbox& out) {
    out.event(evr::MFSK_REQUESTS_FULL{.tone = request.tone.value});
    const auto no_room = below(Quantity::tone_requests, static_cast<double>(outstanding_.size()),
                               static_cast<double>(outstanding_.capacity()));
    const std::size_t least = least_important();
    const ToneId other = outstanding_[least].tone;
    if (priority(other) >= priority(request.tone)) {
        explain(out, request.tone, ExplanationVerdict::dropped,
                {no_room, above(Quantity::tone_priority, priority(request.tone), priority(other))});
        return;
    }
    outstanding_.erase_at(least);
    explain(out, other, ExplanationVerdict::dropped,
            {no_room, at_least(Quantity::tone_priority, priority(other), priority(request.tone)),
             names(Quantity::overtaking_tone, request.tone.value)});
}

void ToneSelector::on(const StandBy& stand_by, Outbox& out) {
    silent_ = !stand_by.over;
    for (const ToneRequest& request : outstanding_)
        explain(out, request.tone, ExplanationVerdict::dropped, {is(Quantity::prime_stands_by, true)});
    outstanding_.clear();
    sending_.reset();
    out.bus().tone.reset();
}

void ToneSelector::on(const ParameterPart& part, Outbox&) {
    parameters_.on(part);
}

void ToneSelector::on(const ClockTick& tick, Outbox& out) {
    if (silent_) return;
    drop_expired(tick.now, out);
    if (sending_ && tick.now - sending_->started >= build_parameters.tone_duration_s) {
        sending_.reset();
        quiet_since_ = tick.now;
        out.bus().tone.reset();
    }
    if (!sending_ && !outstanding_.empty()) {
        const std::size_t chosen = most_important();
        const ToneRequest request = outstanding_[chosen];
        outstanding_.erase_at(chosen);
        send(request, out);
        explain_choice(request, out);
    } else if (!sending_ && heartbeat_ && tick.now - quiet_since_ >= parameters_.values().heartbeat_after_s) {
        send({*heartbeat_, tick.now}, out);
    }
    if (at_resolution(tick.now, 1) == tick.now)
        out.send(ModuleId::edl_comm, ToneStatus{sending_ ? sending_->tone.value : std::uint8_t{0},
                                                static_cast<std::uint8_t>(outstanding_.size())});
}

void ToneSelector::send(const ToneRequest& request, Outbox& out) {
    AEOLIS_CHECK(!sending_ && !silent_);  // one tone at a time, each to its end
    sending_ = Sending{request.tone, out.now()};
    out.bus().tone = request.tone;
    out.record(packet::ToneSelected{.tone = request.tone.value,
                                    .started_sclk = out.now().seconds,
                                    .requested_sclk = request.requested.seconds,
                                    .priority = static_cast<std::uint8_t>(priority(request.tone)),
                                    .outstanding = static_cast<std::uint8_t>(outstanding_.size())});
}

void ToneSelector::drop_expired(Sclk now, Outbox& out) {
    for (std::size_t i = outstanding_.size(); i-- > 0;) {
        const ToneRequest request = outstanding_[i];
        const auto age = at_most(Quantity::request_age_s, now - request.requested, expires_s(request.tone));
        if (age.holds) continue;
        outstanding_.erase_at(i);
        explain(out, request.tone, ExplanationVerdict::dropped, {age});
    }
}

// A choice between several requests is explained; a single request needs no explanation.
void ToneSelector::explain_choice(const ToneRequest& chosen, Outbox& out) const {
    if (outstanding_.empty()) return;
    const ToneRequest& next = outstanding_[most_important()];
    const double age_s = out.now() - chosen.requested;
    explain(
        out, chosen.tone, ExplanationVerdict::chosen,
        {names(Quantity::next_tone, next.tone.value),
         at_least(Quantity::tone_priority, priority(chosen.tone), priority(next.tone)),
         at_most(Quantity::request_age_s, age_s,
                 // Among requests of equal priority, the newest goes first: the age was then decisive.
                 priority(chosen.tone) == priority(next.tone) ? out.now() - next.requested : expires_s(chosen.tone))});
}

std::size_t ToneSelector::most_important() const {
    AEOLIS_CHECK(!outstanding_.empty());
    std::size_t best = 0;
    for (std::size_t i = 1; i < outstanding_.size(); ++i) {
        const auto a = priority(outstanding_[i].tone);
        const auto b = priority(outstanding_[best].tone);
        if (a > b || (a == b && outstanding_[i].requested >= outstanding_[best].requested)) best = i;
    }
    return best;
}

std::size_t ToneSelector::least_important() const {
    AEOLIS_CHECK(!outstanding_.empty());
    std::size_t worst = 0;
    for (std::size_t i = 1; i < outstanding_.size(); ++i)
        if (priority(outstanding_[i].tone) < priority(outstanding_[worst].tone)) worst = i;
    return worst;
}

}  // namespace aeolis::flight
