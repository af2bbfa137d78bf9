// SPDX-License-Identifier: Apache-2.0
#include "server/procedures/position_board.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace aeolis::server::procedures {
namespace {

using ActKind = PositionAct::Kind;

constexpr std::array<std::string_view, position_act_kinds> kind_names{"take", "offer", "leave", "poll", "go", "no_go"};

/// The positions that a poll asks.
constexpr bool is_asked(Position position) {
    return position != Position::flight_director;
}

}  // namespace

std::string_view name_of(PositionAct::Kind kind) {
    return kind_names[static_cast<std::size_t>(kind)];
}

std::optional<PositionAct::Kind> position_act_named(std::string_view name) {
    const auto found = std::ranges::find(kind_names, name);
    if (found == kind_names.end()) return std::nullopt;
    return static_cast<ActKind>(found - kind_names.begin());
}

bool PositionBoard::holds(Position position, std::string_view person) const {
    return !person.empty() && seat(position).person == person;
}

Result<void> PositionBoard::may_act(Position position, std::string_view person) const {
    const Seat& held = seat(position);
    if (!held.person.empty()) {
        if (held.person == person) return {};
        if (person.empty())
            return Error{fmt::format("{} is held by {}: say who you are", name_of(position), held.person)};
        return Error{fmt::format("{} is held by {}, not by {}", name_of(position), held.person, person)};
    }
    if (!directed_ || holds(Position::flight_director, person)) return {};
    return Error{
        fmt::format("{} is vacant: take it first; only the flight director stands in for it", name_of(position))};
}

std::string PositionBoard::closed() const {
    if (!directed_) return "";
    if (!poll_) return "nothing is sent before the flight director's go, and no poll was called";
    if (poll_->decision && poll_->decision->go) return "";
    if (poll_->decision)
        return fmt::format("nothing is sent: the flight director said no go to \"{}\"", poll_->subject);
    const auto against = this->against();
    return fmt::format("nothing is sent before the flight director's go to \"{}\"{}{}", poll_->subject,
                       against.empty() ? "" : ": ", against);
}

Result<void> PositionBoard::may_send(std::string_view person) const {
    if (directed_ && seat(Position::command).person.empty())
        return Error{"command is vacant: whoever sends takes it first"};
    if (auto may = may_act(Position::command, person); !may) return may;
    if (auto why = closed(); !why.empty()) return Error{std::move(why)};
    return {};
}

Result<void> PositionBoard::may_approve(std::string_view person) const {
    if (auto may = may_stop(person); !may) return may;
    if (auto why = closed(); !why.empty()) return Error{std::move(why)};
    return {};
}

Result<void> PositionBoard::may_stop(std::string_view person) const {
    if (holds(Position::flight_director, person)) return {};
    return may_act(Position::command, person);
}

std::string PositionBoard::against() const {
    if (!poll_) return "no poll was called";
    std::vector<std::string> words;
    std::vector<std::string_view> silent;
    for (const Position position : positions) {
        if (!is_asked(position)) continue;
        const auto& answer = poll_->answers[static_cast<std::size_t>(position)];
        if (answer && !answer->go)
            words.push_back(answer->reason.empty()
                                ? fmt::format("{} said no go", name_of(position))
                                : fmt::format("{} said no go ({})", name_of(position), answer->reason));
        else if (!answer && !seat(position).person.empty())
            silent.push_back(name_of(position));
    }
    if (!silent.empty())
        words.push_back(
            fmt::format("{} {} not answered", fmt::join(silent, ", "), silent.size() == 1 ? "has" : "have"));
    return fmt::format("{}", fmt::join(words, ", "));
}

std::vector<PositionAct::Kind> PositionBoard::acts(Position position) const {
    const Seat& now = seat(position);
    std::vector<ActKind> can;
    if (now.person.empty()) return {ActKind::take};
    if (!now.offered_to.empty() || position == Position::flight_director) can.push_back(ActKind::take);
    can.insert(can.end(), {ActKind::offer, ActKind::leave});
    if (position == Position::flight_director) can.push_back(ActKind::poll);
    if (poll_) can.insert(can.end(), {ActKind::go, ActKind::no_go});
    return can;
}

Result<void> PositionBoard::on(const PositionAct& act) {
    switch (act.kind) {
    case ActKind::take: return take(act);
    case ActKind::offer: return offer(act);
    case ActKind::leave: return leave(act);
    case ActKind::poll: return call_poll(act);
    case ActKind::go:
    case ActKind::no_go: return act.position == Position::flight_director ? decide(act) : answer(act);
    }
    return Error{"this is no act on a position"};
}

Result<void> PositionBoard::take(const PositionAct& act) {
    Seat& wanted = seat_of(act.position);
    if (wanted.person == act.person)
        return Error{fmt::format("{} holds {} already", act.person, name_of(act.position))};
    // A director who is away must not close the room for good: another relieves them, and says why.
    const bool relieves = act.position == Position::flight_director && !act.reason.empty();
    if (!wanted.person.empty() && wanted.offered_to != act.person && !relieves)
        return Error{fmt::format("{} is held by {}: {} has to offer it to {} first", name_of(act.position),
                                 wanted.person, wanted.person, act.person)};
    wanted = Seat{act.person, act.at, {}};
    directed_ = directed_ || act.position == Position::flight_director;
    return {};
}

Result<void> PositionBoard::offer(const PositionAct& act) {
    Seat& held = seat_of(act.position);
    if (!holds(act.position, act.person))
        return Error{fmt::format("{} does not hold {}", act.person, name_of(act.position))};
    held.offered_to = act.to == act.person ? std::string{} : act.to;  // to oneself: it is withdrawn
    return {};
}

Result<void> PositionBoard::leave(const PositionAct& act) {
    Seat& held = seat_of(act.position);
    if (held.person.empty()) return Error{fmt::format("{} is vacant", name_of(act.position))};
    if (held.person != act.person) {
        if (!holds(Position::flight_director, act.person))
            return Error{fmt::format("{} is held by {}: only they and the flight director make it vacant",
                                     name_of(act.position), held.person)};
        if (act.reason.empty())
            return Error{fmt::format("{} is held by {}: say why it becomes vacant (reason)", name_of(act.position),
                                     held.person)};
    }
    held = Seat{};
    // A go is somebody's, and nobody answers for it any more. A no go stays.
    if (!poll_) return {};
    if (act.position == Position::flight_director) end_go();
    auto& answer = poll_->answers[static_cast<std::size_t>(act.position)];
    if (answer && answer->go) answer.reset();
    return {};
}

Result<void> PositionBoard::call_poll(const PositionAct& act) {
    if (act.position != Position::flight_director)
        return Error{fmt::format("the flight director calls the poll, not {}", name_of(act.position))};
    if (!holds(Position::flight_director, act.person))
        return Error{fmt::format("{} does not hold flight_director", act.person)};
    poll_ = Poll{};
    poll_->subject = act.subject;
    poll_->person = act.person;
    poll_->at = act.at;
    return {};
}

Result<void> PositionBoard::answer(const PositionAct& act) {
    if (auto of_this = of_this_poll(act); !of_this) return of_this;
    if (!holds(act.position, act.person))
        return Error{fmt::format("{} does not hold {}", act.person, name_of(act.position))};
    poll_->answers[static_cast<std::size_t>(act.position)] =
        Answer{act.kind == ActKind::go, act.person, act.reason, act.at};
    // A go does not outlive a later no go: the flight director decides anew.
    if (act.kind == ActKind::no_go) end_go();
    return {};
}

void PositionBoard::end_go() {
    if (!poll_->decision || !poll_->decision->go) return;
    poll_->decision.reset();
    poll_->overridden.clear();
}

Result<void> PositionBoard::of_this_poll(const PositionAct& act) const {
    if (!poll_) return Error{"no poll was called"};
    if (act.subject.empty() || act.subject == poll_->subject) return {};
    return Error{fmt::format("the poll is about \"{}\" now, not about \"{}\"", poll_->subject, act.subject)};
}

Result<void> PositionBoard::decide(const PositionAct& act) {
    if (auto of_this = of_this_poll(act); !of_this) return of_this;
    if (!holds(Position::flight_director, act.person))
        return Error{fmt::format("{} does not hold flight_director", act.person)};
    std::string spoke_against;
    if (act.kind == ActKind::go) {
        spoke_against = against();
        if (!spoke_against.empty() && act.reason.empty())
            return Error{fmt::format("{}: a go in spite of that needs a reason", spoke_against)};
    }
    poll_->decision = Answer{act.kind == ActKind::go, act.person, act.reason, act.at};
    poll_->overridden = std::move(spoke_against);
    return {};
}

}  // namespace aeolis::server::procedures
