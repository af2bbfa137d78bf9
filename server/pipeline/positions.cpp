// SPDX-License-Identifier: Apache-2.0
#include "server/pipeline/positions.hpp"

#include <fmt/format.h>

namespace aeolis::pipeline {
namespace {

using namespace server::procedures;

void write(v1::PositionAnswer& out, Position position, const PositionBoard::Answer& answer) {
    out.set_position(std::string(name_of(position)));
    out.set_by(answer.person);
    out.set_answered(true);
    out.set_go(answer.go);
    out.set_reason(answer.reason);
    out.set_at_us(answer.at.microseconds);
}

void write(v1::PositionPoll& out, const PositionBoard& board) {
    const PositionBoard::Poll& poll = *board.poll();
    out.set_subject(poll.subject);
    out.set_by(poll.person);
    out.set_at_us(poll.at.microseconds);
    for (const Position position : positions) {
        if (position == Position::flight_director) continue;
        if (const auto& answer = poll.answers[static_cast<std::size_t>(position)]) {
            write(*out.add_answers(), position, *answer);
        } else if (const auto& seat = board.seat(position); !seat.person.empty()) {
            auto& silent = *out.add_answers();
            silent.set_position(std::string(name_of(position)));
            silent.set_by(seat.person);
        }
    }
    if (poll.decision) write(*out.mutable_decision(), Position::flight_director, *poll.decision);
    out.set_against(board.against());
    out.set_overridden(poll.overridden);
}

}  // namespace

v1::PositionBoard board_of(const PositionBoard& board) {
    v1::PositionBoard out;
    for (const Position position : positions) {
        const auto& seat = board.seat(position);
        auto& shown = *out.add_seats();
        shown.set_position(std::string(name_of(position)));
        shown.set_by(seat.person);
        if (!seat.person.empty()) shown.set_since_us(seat.since.microseconds);
        shown.set_offered_to(seat.offered_to);
        for (const auto kind : board.acts(position)) shown.add_acts(static_cast<v1::PositionAct::Kind>(kind));
    }
    if (board.poll()) write(*out.mutable_poll(), board);
    out.set_closed(board.closed());
    out.set_directed(board.directed());
    return out;
}

void Positions::begin() {
    const std::scoped_lock lock{mutex_};
    board_.emplace();
    acts_ = 0;
}

void Positions::end() {
    const std::scoped_lock lock{mutex_};
    board_.reset();
}

Result<void> Positions::take(const archive::PositionActRecord& record) {
    const auto kind = position_act_named(archive::name_of(record.kind));
    const auto position = position_named(record.position);
    if (!kind || !position)
        return Error{
            fmt::format("'{}' of '{}' is no act on a position", archive::name_of(record.kind), record.position)};
    auto taken =
        board_->on(PositionAct{*kind, *position, record.by, record.to, record.subject, record.reason, record.ert});
    if (taken) ++acts_;
    return taken;
}

Result<void> Positions::repeat(std::span<const archive::PositionActRecord> acts) {
    const std::scoped_lock lock{mutex_};
    if (!board_) return Error{"no run goes on"};
    for (const auto& act : acts)
        if (auto taken = take(act); !taken)
            return Error{fmt::format("the act on a position that is item {} is refused now: {}", act.seq,
                                     taken.error().message)};
    return {};
}

Result<archive::PositionActRecord> Positions::act(archive::PositionActRecord act) {
    const std::scoped_lock lock{mutex_};
    if (!board_) return Error{"no run goes on"};
    // Whoever fills the log must not take the go from the flight director.
    if (acts_ >= acts_max && act.position != name_of(Position::flight_director))
        return Error{
            fmt::format("{} acts on positions were taken in this run, which is as many as there may be", acts_max)};
    if (auto taken = take(act); !taken) return taken.error();
    const auto octets = board_of(*board_).SerializeAsString();
    act.board.assign(octets.begin(), octets.end());
    return act;
}

Result<void> Positions::may_act(std::string_view position, std::string_view person) const {
    const auto known = position_named(position);
    const std::scoped_lock lock{mutex_};
    return board_ && known ? board_->may_act(*known, person) : Result<void>{};
}

Result<void> Positions::may_send(std::string_view person) const {
    const std::scoped_lock lock{mutex_};
    return board_ ? board_->may_send(person) : Result<void>{};
}

Result<void> Positions::may_approve(std::string_view person) const {
    const std::scoped_lock lock{mutex_};
    return board_ ? board_->may_approve(person) : Result<void>{};
}

Result<void> Positions::may_stop(std::string_view person) const {
    const std::scoped_lock lock{mutex_};
    return board_ ? board_->may_stop(person) : Result<void>{};
}

}  // namespace aeolis::pipeline
