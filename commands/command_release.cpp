// SPDX-License-Identifier: Apache-2.0
// How commands leave: from the queue, through the uplink, while a station sees the vehicle. Also what the vehicle's
// reports say of their frames.
#include "commands/command_gateway.hpp"

#include "commands/shares.hpp"
#include "commands/timeline_change.hpp"
#include "common/bytes.hpp"
#include "common/tc_frame.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace aeolis::commands {

void CommandGateway::release_due(Ert now, std::vector<StageReport>& stages) {
    for (const std::uint64_t number : std::exchange(doubted_, {}))
        if (auto* command = underway(number)) tell_wait(*command, now, stages);
    if (!stations_.sees(now)) return await_pass(now, stages);
    begin_pass(now, stages);
    while (link_.waiting() < at_uplink_max) {
        const bool room = pace_.has_room(now) && link_.waiting() < radiated_a_cycle_max;
        const auto number = queue_.take_next(now, room ? Precedence::ordinary : Precedence::hazardous);
        if (!number) break;
        auto* command = underway(*number);
        if (command == nullptr) continue;
        const std::string failing = failing_now(*command, now);
        const auto service = command->wanted.value_or(link_.suitable(now));
        const auto taken = failing.empty() ? link_.send(*number, command->packet, service)
                                           : Result<void>{Error{"it must not be sent now: " + failing}};
        changes_.clear();
        if (taken && command->precedence != Precedence::hazardous) pace_.count();
        if (taken)
            command->lifecycle.ground_stage(
                Stage::released, Status::ok,
                fmt::format("to the uplink, {}; ahead of it: {}", name_of(service), link_.waiting() - 1), now,
                changes_);
        else
            command->lifecycle.ground_stage(Stage::released, Status::failed, taken.error().message, now, changes_);
        append(*command, changes_, stages);
    }
    waits_for_room_ = queue_.any_due(now);
    radiate(now, stages);
}

void CommandGateway::await_pass(Ert now, std::vector<StageReport>& stages) {
    unseen_ = true;
    waits_for_room_ = false;
    const auto not_radiated = link_.take_back();
    if (const auto* next = stations_.next_after(now)) {
        for (const std::uint64_t number : queue_.postpone_due(now, next->begin))
            if (auto* command = underway(number)) tell_wait(*command, now, stages);
        for (const std::uint64_t number : not_radiated)
            wait_again(number, next->begin, "when the pass ended", now, stages);
        return;
    }
    const auto fail = [&](std::uint64_t number, Stage stage) {
        auto* command = underway(number);
        if (command == nullptr) return;
        changes_.clear();
        command->lifecycle.ground_stage(stage, Status::failed, stations_.refusal(now), now, changes_);
        append(*command, changes_, stages);
    };
    for (const std::uint64_t number : not_radiated) fail(number, Stage::radiated);
    for (const std::uint64_t number : queue_.take_all()) fail(number, Stage::released);
}

void CommandGateway::wait_again(std::uint64_t number, std::optional<Ert> until, const std::string& why, Ert now,
                                std::vector<StageReport>& stages) {
    auto* command = underway(number);
    if (command == nullptr) return;
    const CommandQueue::Entry entry{number,
                                    command->priority,
                                    until,
                                    false,
                                    false,
                                    changes_offsets(command->lifecycle.command().name),
                                    false,
                                    command->precedence,
                                    asker_of(command->browser, command->controller)};
    queue_.add(entry);
    std::vector<StageChange> changes;
    command->lifecycle.taken_back(
        "taken back from the uplink, which had not radiated it " + why + "; " + leaving_text(entry), now, changes);
    append(*command, changes, stages);
}

void CommandGateway::doubt_after(std::uint64_t undone, Ert now, std::vector<StageReport>& stages) {
    const auto after = [&](const Underway& each) {
        return each.number > undone && changes_offsets(each.lifecycle.command().name);
    };
    const auto reached = [](const Underway& each, Stage stage) { return each.lifecycle.status(stage) == Status::ok; };
    const auto at_uplink = [&](const Underway& each) {
        return reached(each, Stage::released) && each.lifecycle.status(Stage::radiated) == Status::pending;
    };
    if (std::ranges::any_of(underway_, [&](const Underway& each) { return after(each) && at_uplink(each); }))
        for (const std::uint64_t number :
             link_.take_back())  // all of them: those not in doubt are released again at once
            wait_again(number, {}, fmt::format("when command {} came to nothing", undone), now, stages);
    for (const std::uint64_t number : queue_.doubt_after(undone)) doubted_.push_back(number);
    for (Underway& each : underway_) {
        if (!after(each) || !reached(each, Stage::radiated) || each.lifecycle.finished()) continue;
        std::vector<StageChange> changes;
        each.lifecycle.radiated_in_doubt(
            fmt::format("has left Earth, and its timeline was analysed with command {}, which came to nothing", undone),
            now, changes);
        append(each, changes, stages);
    }
}

void CommandGateway::begin_pass(Ert now, std::vector<StageReport>& stages) {
    if (!std::exchange(unseen_, false)) return;
    bool any = false;
    for (const std::uint64_t number : link_.unacknowledged()) {
        auto* command = underway(number);
        const std::string failing = command == nullptr ? "" : failing_now(*command, now);
        if (failing.empty()) continue;
        any = true;
        changes_.clear();
        command->lifecycle.radiated_in_doubt(
            "not acknowledged, and not radiated again: it must not be sent now: " + failing, now, changes_);
        append(*command, changes_, stages);
    }
    if (!any) return;
    // Frames are sent again in sequence: none can be left out.
    link_.give_up();
    note_frames(now, stages);
}

void CommandGateway::tell_wait(Underway& underway, Ert now, std::vector<StageReport>& stages) {
    const auto* entry = waiting(underway.number);
    if (entry == nullptr) return;
    const std::string when = leaving_text(*entry);
    changes_.clear();
    const std::string looked_at =
        entry->doubted
            ? "does not leave before its timeline is looked at again, for what it was analysed with has changed; "
        : underway.timeline.empty()
            ? ""
            : "its timeline was looked at again, for what it was analysed with has changed: " + underway.timeline +
                  "; ";
    const std::string approval =
        entry->needs_approval ? "waits for the approval of another controller than " + underway.controller + "; " : "";
    underway.lifecycle.await_release(
        looked_at + approval + (entry->held ? "held until a controller releases it; " + when : when), now, changes_);
    append(underway, changes_, stages);
}

std::string CommandGateway::leaving_text(const CommandQueue::Entry& entry) const {
    std::string when = entry.release_at ? "leaves at " + day_of_year_text(*entry.release_at) : "then leaves at once";
    const auto* pass = entry.release_at ? stations_.pass_at(*entry.release_at) : nullptr;
    if (pass != nullptr) when += " by " + pass->station;
    if (const auto other = queue_.leaves_after(entry))
        when += fmt::format(", after command {}, with which its timeline was analysed", *other);
    if (entry.priority > 0) when += fmt::format(", priority {}", entry.priority);
    return when;
}

void CommandGateway::radiate(Ert now, std::vector<StageReport>& stages) {
    const bool seen = stations_.sees(now);
    if (seen) begin_pass(now, stages);
    const auto* pass = stations_.pass_at(now);
    if (std::exchange(radiated_at_, now) != now) radiated_then_ = 0;
    while (seen && radiated_then_ < radiated_a_cycle_max) {
        auto unit = link_.next(now);
        if (!unit) break;
        ++radiated_then_;
        if (auto* command = underway(unit->tag)) {
            const std::string frame =
                fmt::format("{} octets left {}, packet {} in frame {}, {}; at the vehicle {:.1f} s later",
                            unit->cltu.size(), pass == nullptr ? "the station" : pass->station,
                            command->lifecycle.count(), unit->sequence, name_of(unit->service), light_time_s_);
            changes_.clear();
            if (unit->transmission == 1)
                command->lifecycle.ground_stage(Stage::radiated, Status::ok, frame, now, changes_);
            else
                command->lifecycle.radiated_again(fmt::format("transmission {}: {}", unit->transmission, frame), now,
                                                  changes_);
            append(*command, changes_, stages);
        }
        uplinks_.push_back(std::move(unit->cltu));
    }
    note_frames(now, stages);
}

void CommandGateway::note_frames(Ert now, std::vector<StageReport>& stages) {
    using Fate = Fop::Fate;
    for (const auto& frame : link_.take_reports()) {
        auto* command = underway(frame.tag);
        if (command == nullptr || frame.fate == Fate::radiated) continue;
        changes_.clear();
        if (frame.fate == Fate::acknowledged)
            command->lifecycle.frame_taken(fmt::format("the vehicle reports its frame as taken (CLCW: {} comes next)",
                                                       link_.last_heard()->expected),
                                           now, changes_);
        else
            command->lifecycle.frame_not_acknowledged(
                fmt::format("radiated {} x, and no report of the vehicle has its frame: taken or not",
                            frame.transmissions),
                now, changes_);
        append(*command, changes_, stages);
    }
}

void CommandGateway::hear_clcw(std::uint32_t word, Ert ert, std::vector<StageReport>& stages) {
    std::array<std::uint8_t, clcw_octets> octets{};
    BitWriter{octets}.put(word, 32);
    const auto clcw = read_clcw(octets);
    if (!clcw) return;
    link_.hear(*clcw, ert);
    radiate(ert, stages);
}

void CommandGateway::pass(Ert now, std::vector<StageReport>& stages) {
    for (auto& underway : underway_) {
        changes_.clear();
        underway.lifecycle.pass(now, changes_);
        append(underway, changes_, stages);
    }
    if (stations_.sees(now)) link_.pass(now);  // otherwise unacknowledged frames are sent again in the next pass
    release_due(now, stages);
    forget_finished();
}

}  // namespace aeolis::commands
