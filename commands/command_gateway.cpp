// SPDX-License-Identifier: Apache-2.0
#include "commands/command_gateway.hpp"

#include "commands/authorise.hpp"
#include "commands/preconditions.hpp"
#include "commands/read_back.hpp"
#include "commands/request_form.hpp"
#include "commands/shares.hpp"
#include "commands/timeline_change.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace aeolis::commands {
namespace {

constexpr const char* of_script =
    "asked for by the scenario's script, ";  // by this the console tells the script's commands from people's
constexpr const char* parameters_received =
    "parameters_received";  // the vehicle has some; whether they are right, ground must decide

constexpr std::string_view begin_command = "EDL_DO_EDL";  // before its first timepoint stands its acceptance. R16

/// Whether the change means that the command has no effect. A failed verification does not undo it.
bool undoes(const StageChange& change) {
    return change.status == Status::failed && change.stage != Stage::verified;
}

/// A controller's name as typed, without surrounding blanks and in small letters.
std::string same_person(std::string_view name) {
    const auto first = name.find_first_not_of(' ');
    if (first == std::string_view::npos) return {};
    std::string same{name.substr(first, name.find_last_not_of(' ') - first + 1)};
    std::ranges::transform(same, same.begin(),
                           [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    return same;
}

Precedence precedence_of(const Request& request, const dictionary::Command& command) {
    if (is_hazardous(command)) return Precedence::hazardous;
    return request.director ? Precedence::director : Precedence::ordinary;
}

}  // namespace

CommandGateway::CommandGateway(const dictionary::Dictionary& dictionary, double light_time_s,
                               std::vector<NamedValue> solution, std::vector<std::string> second_person,
                               TrackingSchedule stations, std::optional<Scet> entry,
                               std::optional<ClockCorrelation> clock, double downlink_bps)
    : dictionary_(dictionary), light_time_s_(light_time_s), clcw_(clcw_places(dictionary)), pace_(downlink_bps),
      link_(light_time_s), solutions_(std::move(solution)), second_person_(std::move(second_person)),
      stations_(std::move(stations)), deadlines_(dictionary, entry, light_time_s), judge_(dictionary), clock_(clock),
      heard_(dictionary.channels.size()) {}

std::vector<CommandGateway::FieldPlace> CommandGateway::clcw_places(const dictionary::Dictionary& dictionary) {
    std::vector<FieldPlace> places;
    for (std::size_t packet = 0; packet < dictionary.packets.size(); ++packet)
        for (const std::string_view name : {"clcw", "clcw_b"})
            if (const auto field = dictionary::field_index(dictionary.packets[packet], name))
                places.push_back({packet, *field});
    return places;
}

Result<void> CommandGateway::takes(std::size_t more, const std::string& asker) const {
    const auto own = static_cast<std::size_t>(std::ranges::count_if(
        underway_, [&](const Underway& each) { return asker_of(each.browser, each.controller) == asker; }));
    const std::size_t taken = underway_.size() + more - 1;
    if (may_take(own + more - 1, taken, commands_max)) return {};
    if (taken >= commands_max)
        return Error{fmt::format("{} commands are under way: no more until one of them is done", underway_.size())};
    return Error{fmt::format("{} of the {} commands under way are yours: the places left are for others", own,
                             underway_.size())};
}

Result<CommandGateway::Prepared> CommandGateway::prepare(const Request& request, Ert now) const {
    const auto named = command_named(dictionary_, request.command);
    if (!named) return named.error();
    const auto* command = *named;
    if (auto room = takes(1, asker_of(request.browser, request.controller)); !room) return room.error();

    std::vector<NamedValue> arguments = request.arguments;
    if (request.from_solution) arguments = fill_from_solution(*command, arguments, solutions_.latest());
    auto packet = encode(*command, arguments, count_);
    if (!packet) return packet.error();
    const auto wanted = service_named(request.service);
    if (!wanted) return wanted.error();
    if (request.release_at && *request.release_at < now)
        return Error{fmt::format("release_at: {} is past, it is {}", day_of_year_text(*request.release_at),
                                 day_of_year_text(now))};
    const auto held = decode(*command, *packet);  // as encoded, with defaults
    return Prepared{command, *packet,           arguments_text(held ? *held : arguments), preconditions(*command, now),
                    *wanted, request.release_at};
}

std::vector<PreconditionReply> CommandGateway::preconditions(const dictionary::Command& command, Ert now) const {
    auto replies = check(dictionary_, command, latest(now));
    const auto* received = dictionary_.channel(parameters_received);
    const bool wants_them = received != nullptr && std::ranges::any_of(command.preconditions, [&](const auto& each) {
                                return each.channel == received->id;
                            });
    if (!wants_them) return replies;
    using Verdict = PreconditionReply::Verdict;
    for (const auto& [name, sent] : read_backs_) {
        if (sent.empty()) continue;
        const ReadBack& told = sent.back();
        auto& reply = replies.emplace_back();
        // The first set's reception is confirmed by flight's own channel. A later set is confirmed only by its
        // read-back, which is waited for while it can still arrive.
        const auto [holds, words] =
            told.held == Status::ok        ? std::pair{Verdict::holds, "read back"}
            : told.held == Status::failed  ? std::pair{Verdict::fails, "the vehicle reports other values"}
            : told.held == Status::unknown ? std::pair{Verdict::unknown, "not read back in its time"}
            : told.renewed                 ? std::pair{Verdict::fails, "sent anew and not read back yet, wait for it"}
                                           : std::pair{Verdict::unknown, "not read back yet"};
        reply.verdict = holds;
        reply.text = fmt::format("{} held as sent (command {}): {}", name, told.number, words);
    }
    return replies;
}

Reply CommandGateway::submit(const Request& request, Ert now, std::vector<StageReport>& stages, Asker asker) {
    if (!request.action.empty()) return act(request, now, stages);
    Reply reply;
    reply.request = request.request;
    reply.dry_run = request.dry_run;
    const auto refuse = [&](std::string reason) {
        reply.reason = std::move(reason);
        return reply;
    };
    auto prepared = prepare(request, now);
    if (!prepared) return refuse(prepared.error().message);
    tell(*prepared, now, reply);
    const Ert leaves = prepared->release_at.value_or(now);
    const bool settled = prepared->release_at || !request.hold;  // otherwise its time of leaving is unknown
    if (settled ? !stations_.sees(leaves) : stations_.over(now)) return refuse(stations_.refusal(leaves));
    if (settled) tell_station(leaves, reply);
    // A waiting command's preconditions are checked when it leaves: one that fails now may hold then.
    const bool waits = request.hold || prepared->release_at;
    const auto authorised = authorise(*prepared->command, {request.armed, request.confirmation},
                                      waits ? std::span<const PreconditionReply>{} : prepared->preconditions);
    if (!authorised) return refuse(authorised.error().message);
    if (auto unlike = unlike_solutions(*prepared->command, prepared->packet); !unlike.empty())
        return refuse(std::move(unlike));
    if (!waits)
        if (auto unsafe = unsafe_on_timeline(*prepared->command, prepared->packet, leaves); !unsafe.empty())
            return refuse(std::move(unsafe));
    const auto approval = needs_approval(request);
    if (!approval) return refuse(approval.error().message);
    reply.needs_approval = *approval;
    if (request.dry_run)
        reply.accepted = true;
    else
        queue(*prepared, request, asker, now, reply, stages);
    return reply;
}

Result<bool> CommandGateway::needs_approval(const Request& request) const {
    if (const auto controller = check_controller(request.controller); !controller) return controller.error();
    if (std::ranges::find(second_person_, request.command) == second_person_.end()) return false;
    if (same_person(request.controller).empty())
        return Error{request.command +
                     " needs a second person: say who you are (controller), then another controller approves it"};
    return true;
}

void CommandGateway::queue(const Prepared& prepared, const Request& request, Asker asker, Ert now, Reply& reply,
                           std::vector<StageReport>& stages) {
    // An unknown condition is no reason to refuse: flight holds the same conditions and decides with its own data.
    std::string not_known;
    for (const auto& condition : prepared.preconditions)
        if (condition.verdict == PreconditionReply::Verdict::unknown)
            not_known += (not_known.empty() ? "; left to flight: " : ", ") + condition.text;
    const auto* report = read_back_packet(dictionary_, *prepared.command);
    auto& underway = underway_.emplace_back(
        Underway{++commands_, prepared.packet, prepared.arguments, request.controller, request.browser,
                 request.client_id, "", request.priority, precedence_of(request, *prepared.command), prepared.wanted,
                 report, CommandLifecycle{*prepared.command, count_, light_time_s_, report != nullptr}});
    count_ = static_cast<std::uint16_t>((count_ + 1) % count_modulus);

    changes_.clear();
    auto& lifecycle = underway.lifecycle;
    lifecycle.ground_stage(
        Stage::queued, Status::ok,
        fmt::format("{}accepted as command {}", asker == Asker::script ? of_script : "", underway.number), now,
        changes_);
    lifecycle.ground_stage(Stage::authorised, Status::ok,
                           (is_hazardous(*prepared.command) ? "armed and confirmed by name" : "no arming needed") +
                               (request.controller.empty() ? "" : ", by " + request.controller) + not_known,
                           now, changes_);
    append(underway, changes_, stages);
    reply.accepted = true;
    reply.command = underway.number;
    const CommandQueue::Entry entry{
        underway.number, request.priority,     prepared.release_at,
        request.hold,    reply.needs_approval, changes_offsets(prepared.command->name),
        false,           underway.precedence,  asker_of(request.browser, request.controller)};
    queue_.add(entry);
    if (request.hold || prepared.release_at || reply.needs_approval || queue_.leaves_after(entry))
        tell_wait(underway, now, stages);
    release_due(now, stages);
    if (!waits_for_turn(underway, now)) return;
    tell_turn(underway, now, stages);
    reply.leaves.reset();  // not settled
    reply.arrives.reset();
    reply.effect_seen.reset();
    reply.deadline.reset();
    reply.too_late_for.clear();
}

void CommandGateway::tell_turn(Underway& underway, Ert now, std::vector<StageReport>& stages) {
    changes_.clear();
    underway.lifecycle.await_release(
        fmt::format("waits for its turn: {} commands wait, and leave as the downlink has room for their answers",
                    queue_.waiting().size()),
        now, changes_);
    append(underway, changes_, stages);
}

std::vector<Reply> CommandGateway::look(std::span<const Request> file, Ert now) {
    std::vector<Reply> replies;
    std::vector<StageReport> none;
    const auto kept = read_backs_;
    const TimelineJudge kept_judge = judge_;
    std::size_t more = 0;  // each needs room
    for (Request request : file) {
        request.dry_run = true;
        auto& reply = replies.emplace_back(submit(request, now, none));
        if (!reply.accepted || !request.action.empty()) continue;
        if (const auto room = takes(++more, asker_of(request.browser, request.controller)); !room) {
            reply.accepted = false;
            reply.reason = room.error().message;
            continue;
        }
        const bool leaves = !request.hold && !request.release_at && !reply.needs_approval;
        if (leaves)
            if (const auto change = timeline_change(*dictionary_.command(request.command), reply.octets))
                judge_.make(*change);
        if (!leaves || read_back_packet(dictionary_, *dictionary_.command(request.command)) == nullptr) continue;
        auto& sent = read_backs_[request.command];  // for later commands of the file
        sent.push_back({commands_ + more, Status::pending, !sent.empty()});
    }
    read_backs_ = kept;
    judge_ = kept_judge;
    return replies;
}

void CommandGateway::note_refused(const Request& request, const std::string& reason, Ert now,
                                  std::vector<StageReport>& stages) {
    const auto* command = dictionary_.command(request.command);
    if (command == nullptr) return;  // a script with an unknown command is not started
    auto prepared = prepare(request, now);
    Underway refused{++commands_, {}, "", "", "",      "",
                     "",          0,  {}, {}, nullptr, CommandLifecycle{*command, count_, light_time_s_, false}};
    if (prepared) {
        refused.packet = std::move(prepared->packet);
        refused.arguments = std::move(prepared->arguments);
    }
    changes_.clear();
    refused.lifecycle.ground_stage(Stage::queued, Status::failed, of_script + ("refused: " + reason), now, changes_);
    append(refused, changes_, stages);
}

const CommandQueue::Entry* CommandGateway::waiting(std::uint64_t number) const {
    const auto& all = queue_.waiting();
    const auto entry = std::ranges::find(all, number, &CommandQueue::Entry::number);
    return entry == all.end() ? nullptr : &*entry;
}

std::string CommandGateway::failing_now(const Underway& underway, Ert now) const {
    const auto& command = underway.lifecycle.command();
    std::string failing = unsafe_on_timeline(command, underway.packet, now, underway.number);
    for (const auto& condition : preconditions(command, now))
        if (condition.verdict == PreconditionReply::Verdict::fails)
            failing += (failing.empty() ? "" : "; ") + condition.text;
    return failing;
}

std::string CommandGateway::does_not_wait(std::uint64_t number, Ert now) const {
    return fmt::format("command {} does not wait: it has left, was cancelled, could not leave, or there is none{}",
                       number, stations_.over(now) ? "; " + stations_.refusal(now) : "");
}

std::optional<timeline::Change> CommandGateway::timeline_change(const dictionary::Command& command,
                                                                std::span<const std::uint8_t> packet) const {
    const auto arguments = decode(command, packet);
    if (!arguments) return std::nullopt;
    const auto change = offset_change(dictionary_, command.name, *arguments);
    return change ? std::optional{change->what} : std::nullopt;
}

std::string CommandGateway::unlike_solutions(const dictionary::Command& command,
                                             std::span<const std::uint8_t> packet) const {
    const auto arguments = decode(command, packet);
    return arguments ? solutions_.judge(*arguments) : std::string{};
}

std::string CommandGateway::unsafe_on_timeline(const dictionary::Command& command, std::span<const std::uint8_t> packet,
                                               Ert leaves, std::uint64_t number) const {
    const auto change = timeline_change(command, packet);
    if (!change && command.name != begin_command) return {};
    TimelineJudge judge = judge_;
    for (const auto& each : underway_) {
        const auto status = [&](Stage stage) { return each.lifecycle.status(stage); };
        const bool on_its_way = each.number != number && status(Stage::released) == Status::ok &&
                                status(Stage::executed) != Status::ok && status(Stage::executed) != Status::failed;
        if (const auto before = on_its_way ? timeline_change(each.lifecycle.command(), each.packet) : std::nullopt)
            judge.make(*before);
    }
    const auto known = std::ranges::find(solutions_.latest(), "entry_sclk", &NamedValue::name);
    const auto entry = known == solutions_.latest().end() ? std::nullopt : std::optional{Sclk{known->value}};
    const Scet there{leaves.microseconds + static_cast<std::int64_t>(light_time_s_ * 1.0e6)};
    const auto arrives = clock_ ? std::optional{clock_->sclk_of(there)} : std::nullopt;
    if (!change) {
        const auto late_s = judge.begins_late_s(entry, arrives);
        return late_s ? fmt::format("it would come {:.1f} s too late: timepoints would be overdue", *late_s) : "";
    }
    const auto unsafe = judge.judge(*change, entry, arrives);
    return unsafe ? "the change is not safe on the timeline as it stands: " + judge.text(*unsafe) : "";
}

std::string CommandGateway::perform(const Request& asked, const Underway* command, Ert now) {
    const std::string& action = asked.action;
    const auto number = asked.number;
    const auto waits = [&](bool done) { return done ? std::string{} : does_not_wait(number, now); };
    if (action == "hold") return waits(queue_.hold(number));
    const auto* entry = waiting(number);
    if (entry != nullptr && (action == "release" || action == "approve") && stations_.over(now))
        return fmt::format("command {} can no longer leave: {}", number, stations_.refusal(now));
    if (action == "release" && entry != nullptr && entry->held) {
        const Ert leaves = std::max(entry->release_at.value_or(now), now);
        if (!stations_.sees(leaves)) return fmt::format("command {} stays held: {}", number, stations_.refusal(leaves));
    }
    if (action == "release") return waits(queue_.release(number));
    if (action == "cancel") return waits(queue_.cancel(number));
    if (command == nullptr || (entry == nullptr && stations_.over(now))) return waits(false);
    if (entry == nullptr || !entry->needs_approval) return fmt::format("command {} waits for no approval", number);
    if (const auto refusal = not_another_person(asked, *command); !refusal.empty()) return refusal;
    return waits(queue_.approve(number));
}

std::string CommandGateway::not_another_person(const Request& asked, const Underway& command) {
    const std::string person = same_person(asked.controller);
    if (person.empty()) return "controller: say who approves it";
    if (person == same_person(command.controller))
        return fmt::format("command {} was asked for by {}: another controller must approve it", command.number,
                           command.controller);
    // Names are only typed when there are no accounts.
    if (asked.browser.empty() || asked.browser != command.browser) return {};
    return fmt::format("command {} was asked for, as {}, from where it would now be approved: a second person approves "
                       "it in a browser of their own",
                       command.number, command.controller);
}

Reply CommandGateway::act(const Request& request, Ert now, std::vector<StageReport>& stages) {
    Reply reply;
    reply.request = request.request;
    reply.dry_run = request.dry_run;
    const std::string& action = request.action;
    auto* command = underway(request.number);
    const auto formed = check_action(request);
    const std::string refusal = formed ? perform(request, command, now) : formed.error().message;
    const std::string by = request.controller.empty() ? "a controller" : request.controller;
    if (!refusal.empty()) {
        reply.reason = refusal;
    } else {
        AEOLIS_CHECK(command != nullptr);  // a waiting command is under way
        reply.accepted = true;
        reply.command = command->number;
        changes_.clear();
        if (action == "cancel")
            command->lifecycle.ground_stage(Stage::released, Status::failed, "cancelled by " + by, now, changes_);
        else if (action == "approve")
            command->lifecycle.approved(fmt::format("approved by {}, as the second person", request.controller), now,
                                        changes_);
        go_on(*command, now, stages);
        tell_leaving(*command, now, reply);
    }
    return reply;
}

void CommandGateway::go_on(Underway& underway, Ert now, std::vector<StageReport>& stages) {
    append(underway, changes_, stages);
    // A due command while no station sees the vehicle is reported below, with the pass that it waits for.
    if (stations_.sees(now) || !queue_.due(underway.number, now)) tell_wait(underway, now, stages);
    release_due(now, stages);
    if (waits_for_turn(underway, now)) tell_turn(underway, now, stages);
}

Result<void> CommandGateway::judge(const TimelineVerdict& verdict, Ert now, std::vector<StageReport>& stages) {
    const auto number = verdict.command;
    if (verdict.undone != undone_.size())
        return Error{fmt::format("command {} was analysed on a timeline that now is another", number)};
    if (!(verdict.refuted ? queue_.cancel(number) : queue_.judged(number))) return Error{does_not_wait(number, now)};
    auto* command = underway(number);
    AEOLIS_CHECK(command != nullptr);  // a waiting command is under way
    changes_.clear();
    if (verdict.refuted)
        command->lifecycle.ground_stage(Stage::released, Status::failed,
                                        "what it was analysed with has changed: " + verdict.analysis, now, changes_);
    else
        command->timeline = verdict.analysis;
    go_on(*command, now, stages);
    return {};
}

CommandGateway::Underway* CommandGateway::underway(std::optional<std::uint64_t> number) {
    const auto found = std::ranges::find_if(underway_, [&](const Underway& each) { return each.number == number; });
    return found == underway_.end() ? nullptr : &*found;
}

void CommandGateway::append(const Underway& underway, const std::vector<StageChange>& changes,
                            std::vector<StageReport>& stages) {
    const auto* waits = waiting(underway.number);
    bool undone = false;
    for (const auto& change : changes) {
        note_read_back(underway, change);
        if (change.stage == Stage::executed && change.status == Status::ok)
            if (const auto arguments = decode(underway.lifecycle.command(), underway.packet)) {
                deadlines_.executed(underway.lifecycle.command(), *arguments);
                if (const auto made = offset_change(dictionary_, underway.lifecycle.command().name, *arguments))
                    judge_.make(made->what);
            }
        undone = undone || undoes(change);
        auto& stage = stages.emplace_back();
        stage.command = underway.number;
        stage.name = underway.lifecycle.command().name;
        static_cast<StageChange&>(stage) = change;
        stage.count = underway.lifecycle.count();
        if (change.stage == Stage::queued) {
            stage.arguments = underway.arguments;
            stage.octets = underway.packet;
            stage.client_id = underway.client_id;
        }
        if (change.stage == Stage::released && change.status == Status::pending && waits != nullptr) {
            stage.held = waits->held;
            stage.needs_approval = waits->needs_approval;
            if (waits->needs_approval) stage.asked_by = underway.controller;
        }
    }
    if (undone && changes_offsets(underway.lifecycle.command().name) && undone_.insert(underway.number).second)
        doubt_after(underway.number, changes.back().at, stages);
}

}  // namespace aeolis::commands
