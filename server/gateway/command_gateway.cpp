#include "server/gateway/command_gateway.hpp"

#include "commands/authorise.hpp"
#include "commands/preconditions.hpp"
#include "commands/read_back.hpp"
#include "common/bytes.hpp"
#include "common/tc_frame.hpp"
#include "telemetry/text.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace aeolis::server {
namespace {

std::string hex_text(std::span<const std::uint8_t> octets) {
    std::string text;
    text.reserve(octets.size() * 2);
    for (const auto octet : octets)
        fmt::format_to(std::back_inserter(text), "{:02x}", octet);
    return text;
}

std::optional<double> argument_value(const dictionary::Packet& packet, const telemetry::Decoded& decoded,
                                     std::string_view name) {
    const auto index = telemetry::field_index(packet, name);
    return index ? decoded.value[*index] : std::nullopt;
}

/// None: as the link chooses.
Result<std::optional<commands::Fop::Service>> service_named(const std::string& name) {
    using Service = commands::Fop::Service;
    if (name.empty()) return std::optional<Service>{};
    if (name == "AD") return std::optional{Service::sequence_controlled};
    if (name == "BD") return std::optional{Service::expedited};
    return Error{fmt::format("unknown service '{}': AD, BD, or none for what suits", name)};
}

constexpr std::size_t controller_name_max = 64; // ours

/// Of a person, as it was typed: without blanks around it, in small letters.
std::string same_person(std::string_view name) {
    const auto first = name.find_first_not_of(' ');
    if (first == std::string_view::npos) return {};
    std::string same{name.substr(first, name.find_last_not_of(' ') - first + 1)};
    std::ranges::transform(same, same.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    return same;
}

} // namespace

std::vector<commands::NamedValue> solution_arguments(const simulation::NavigationSolution& solution) {
    return {
        {"solution_id", static_cast<double>(solution.solution_id)},
        {"epoch_sclk", solution.epoch.seconds},
        {"position_x_m", solution.p_MoB_M_m[0]},
        {"position_y_m", solution.p_MoB_M_m[1]},
        {"position_z_m", solution.p_MoB_M_m[2]},
        {"velocity_x_mps", solution.v_MB_M_mps[0]},
        {"velocity_y_mps", solution.v_MB_M_mps[1]},
        {"velocity_z_mps", solution.v_MB_M_mps[2]},
        {"entry_sclk", solution.entry.seconds},
        {"target_latitude_deg", solution.target.latitude_deg},
        {"target_longitude_deg", solution.target.longitude_deg},
        {"target_radius_m", solution.target.radius_m},
        {"parachute_speed_mps", solution.parachute_speed_mps},
        {"heatshield_speed_mps", solution.heatshield_speed_mps},
        {"backshell_altitude_m", solution.backshell_altitude_m},
    };
}

CommandGateway::CommandGateway(const dictionary::Dictionary& dictionary, double light_time_s,
                               std::vector<commands::NamedValue> solution, std::vector<std::string> second_person,
                               commands::TrackingSchedule stations)
    : dictionary_(dictionary), decommutator_(dictionary), light_time_s_(light_time_s), clcw_(clcw_place(dictionary)),
      link_(light_time_s), solution_(std::move(solution)), second_person_(std::move(second_person)),
      stations_(std::move(stations)), heard_(dictionary.channels.size()) {}

std::optional<CommandGateway::FieldPlace> CommandGateway::clcw_place(const dictionary::Dictionary& dictionary) {
    for (std::size_t packet = 0; packet < dictionary.packets.size(); ++packet)
        if (const auto field = telemetry::field_index(dictionary.packets[packet], "clcw")) return FieldPlace{packet, *field};
    return std::nullopt;
}

Result<CommandGateway::Prepared> CommandGateway::prepare(const v1::CommandRequest& request, Ert now) const {
    const auto* command = dictionary_.command(request.command());
    if (command == nullptr)
        return Error{fmt::format("unknown command '{}': the dictionary of {} has none of this name", request.command(),
                                 dictionary_.mission)};
    if (commands_ >= commands_max) return Error{fmt::format("this run has had its {} commands", commands_max)};

    std::vector<commands::NamedValue> arguments;
    for (const auto& argument : request.arguments())
        arguments.push_back({argument.name(), argument.value()});
    if (request.from_solution()) arguments = commands::fill_from_solution(*command, arguments, solution_);
    auto packet = commands::encode(*command, arguments, count_);
    if (!packet) return packet.error();
    const auto wanted = service_named(request.service());
    if (!wanted) return wanted.error();
    std::optional<Ert> release_at;
    if (!request.release_at().empty()) {
        release_at = ert_from_day_of_year(request.release_at());
        if (!release_at)
            return Error{fmt::format("release_at: '{}' is no time as {}", request.release_at(), day_of_year_text(now))};
        if (*release_at < now)
            return Error{fmt::format("release_at: {} is past, it is {}", request.release_at(), day_of_year_text(now))};
    }
    const auto held = commands::decode(*command, *packet); // as encoded: defaults are in it
    return Prepared{command, *packet, commands::arguments_text(held ? *held : arguments),
                    commands::check(dictionary_, *command, latest(now)), *wanted, release_at};
}

void CommandGateway::tell(const Prepared& prepared, Ert now, v1::CommandReply& reply) const {
    reply.set_octets(hex_text(prepared.packet));
    reply.set_arguments(prepared.arguments);
    for (const auto& condition : prepared.preconditions) {
        auto& told = *reply.add_preconditions();
        told.set_text(condition.text);
        told.set_state(commands::name_of(condition.state));
    }
    reply.set_service(prepared.wanted.value_or(link_.suitable(now)) == commands::Fop::Service::expedited ? "BD" : "AD");
    const auto light_time_us = static_cast<std::int64_t>(light_time_s_ * 1.0e6);
    const Ert leaves = prepared.release_at.value_or(now);
    reply.set_arrives(day_of_year_text(Scet{leaves.microseconds + light_time_us}));
    reply.set_effect_seen(day_of_year_text(Ert{leaves.microseconds + 2 * light_time_us}));
}

void CommandGateway::tell_station(Ert leaves, v1::CommandReply& reply) const {
    const auto* pass = stations_.pass_at(leaves);
    if (pass == nullptr) return;
    reply.set_station(pass->station);
    reply.set_station_until(day_of_year_text(pass->end));
}

v1::CommandReply CommandGateway::submit(const v1::CommandRequest& request, Ert now,
                                        std::vector<archive::StageRecord>& stages) {
    if (!request.action().empty()) return act(request, now, stages);
    v1::CommandReply reply;
    reply.set_request(request.request());
    reply.set_dry_run(request.dry_run());
    const auto refuse = [&](std::string reason) {
        reply.set_reason(std::move(reason));
        return reply;
    };
    auto prepared = prepare(request, now);
    if (!prepared) return refuse(prepared.error().message);
    tell(*prepared, now, reply);
    if (prepared->release_at || !request.hold()) { // else nobody can say yet when it leaves
        const Ert leaves = prepared->release_at.value_or(now);
        if (!stations_.sees(leaves)) return refuse(stations_.refusal(leaves));
        tell_station(leaves, reply);
    }
    // What waits is looked at when it leaves: a condition that fails now may hold then.
    const bool waits = request.hold() || prepared->release_at;
    const auto authorised = commands::authorise(*prepared->command, {request.armed(), request.confirmation()},
                                                waits ? std::span<const commands::PreconditionState>{} : prepared->preconditions);
    if (!authorised) return refuse(authorised.error().message);
    const auto approval = needs_approval(request);
    if (!approval) return refuse(approval.error().message);
    reply.set_needs_approval(*approval);
    if (request.dry_run())
        reply.set_accepted(true);
    else
        queue(*prepared, request, now, reply, stages);
    return reply;
}

Result<bool> CommandGateway::needs_approval(const v1::CommandRequest& request) const {
    if (request.controller().size() > controller_name_max)
        return Error{fmt::format("controller: a name of at most {} octets is wanted", controller_name_max)};
    if (std::ranges::find(second_person_, request.command()) == second_person_.end()) return false;
    if (same_person(request.controller()).empty())
        return Error{request.command() + " needs a second person: say who you are (controller), then another controller approves it"};
    return true;
}

void CommandGateway::queue(const Prepared& prepared, const v1::CommandRequest& request, Ert now,
                           v1::CommandReply& reply, std::vector<archive::StageRecord>& stages) {
    using commands::Stage;
    using commands::Status;
    // What ground does not know is no reason to refuse: flight holds the same conditions and decides by what it knows.
    std::string not_known;
    for (const auto& condition : prepared.preconditions)
        if (condition.state == commands::PreconditionState::State::unknown)
            not_known += (not_known.empty() ? "; left to flight: " : ", ") + condition.text;
    const auto* report = commands::read_back_packet(dictionary_, *prepared.command);
    auto& underway = underway_.emplace_back(
        Underway{++commands_, prepared.packet, prepared.arguments, request.controller(), prepared.wanted, report,
                 commands::CommandLifecycle{*prepared.command, count_, light_time_s_, report != nullptr}});
    count_ = static_cast<std::uint16_t>((count_ + 1) % commands::count_modulus);

    changes_.clear();
    auto& lifecycle = underway.lifecycle;
    lifecycle.ground_stage(Stage::queued, Status::ok, fmt::format("accepted as command {}", underway.number), now,
                           changes_);
    lifecycle.ground_stage(
        Stage::authorised, Status::ok,
        (commands::is_hazardous(*prepared.command) ? "armed and confirmed by name" : "no arming needed") +
            (request.controller().empty() ? "" : ", by " + request.controller()) + not_known,
        now, changes_);
    append(underway, changes_, stages);
    reply.set_accepted(true);
    reply.set_command(underway.number);
    queue_.add({underway.number, request.priority(), prepared.release_at, request.hold(), reply.needs_approval()});
    if (request.hold() || prepared.release_at || reply.needs_approval()) tell_wait(underway, now, stages);
    release_due(now, stages);
}

const commands::CommandQueue::Entry* CommandGateway::waiting(std::uint64_t number) const {
    const auto& all = queue_.waiting();
    const auto entry = std::ranges::find(all, number, &commands::CommandQueue::Entry::number);
    return entry == all.end() ? nullptr : &*entry;
}

void CommandGateway::tell_wait(Underway& underway, Ert now, std::vector<archive::StageRecord>& stages) {
    const auto* entry = waiting(underway.number);
    if (entry == nullptr) return;
    std::string when = entry->release_at ? "leaves at " + day_of_year_text(*entry->release_at) : "then leaves at once";
    const auto* pass = entry->release_at ? stations_.pass_at(*entry->release_at) : nullptr;
    if (pass != nullptr) when += " by " + pass->station;
    if (entry->priority > 0) when += fmt::format(", priority {}", entry->priority);
    changes_.clear();
    const std::string approval = entry->needs_approval ? "waits for the approval of another controller than " + underway.controller + "; " : "";
    underway.lifecycle.await_release(approval + (entry->held ? "held until a controller releases it; " + when : when), now, changes_);
    append(underway, changes_, stages);
}

std::string CommandGateway::perform(const v1::CommandRequest& asked, const Underway* command, Ert now) {
    const std::string& action = asked.action();
    const auto number = asked.number();
    const auto waits = [&](bool done) {
        return done ? std::string{} : fmt::format("command {} does not wait: it has left, was cancelled, or there is none", number);
    };
    if (action == "hold") return waits(queue_.hold(number));
    const auto* entry = waiting(number);
    if (action == "release" && entry != nullptr && entry->held) {
        const Ert leaves = std::max(entry->release_at.value_or(now), now);
        if (!stations_.sees(leaves)) return fmt::format("command {} stays held: {}", number, stations_.refusal(leaves));
    }
    if (action == "release") return waits(queue_.release(number));
    if (action == "cancel") return waits(queue_.cancel(number));
    if (action != "approve") return fmt::format("unknown action '{}': release, hold, cancel or approve", action);
    if (command == nullptr) return waits(false);
    const std::string person = same_person(asked.controller());
    if (person.empty() || asked.controller().size() > controller_name_max) return "controller: say who approves it";
    if (person == same_person(command->controller))
        return fmt::format("command {} was asked for by {}: another controller must approve it", number, command->controller);
    return queue_.approve(number) ? std::string{} : fmt::format("command {} waits for no approval", number);
}

v1::CommandReply CommandGateway::act(const v1::CommandRequest& request, Ert now,
                                     std::vector<archive::StageRecord>& stages) {
    v1::CommandReply reply;
    reply.set_request(request.request());
    reply.set_dry_run(request.dry_run());
    const std::string& action = request.action();
    auto* command = underway(request.number());
    const std::string refusal = request.dry_run() ? "dry_run: what is done about a waiting command cannot be tried out" : perform(request, command, now);
    const std::string by = request.controller().empty() ? "a controller" : request.controller();
    if (!refusal.empty()) {
        reply.set_reason(refusal);
    } else {
        AEOLIS_CHECK(command != nullptr); // what waits is under way
        reply.set_accepted(true);
        reply.set_command(command->number);
        if (const auto* entry = waiting(command->number); entry != nullptr && !entry->held)
            tell_station(std::max(entry->release_at.value_or(now), now), reply);
        if (action == "cancel") {
            changes_.clear();
            command->lifecycle.ground_stage(commands::Stage::released, commands::Status::failed, "cancelled by " + by, now,
                                            changes_);
            append(*command, changes_, stages);
        } else if (action == "approve") {
            changes_.clear();
            command->lifecycle.approved(fmt::format("approved by {}, as the second person", request.controller()), now, changes_);
            append(*command, changes_, stages);
            tell_wait(*command, now, stages);
        } else {
            tell_wait(*command, now, stages);
        }
        release_due(now, stages);
    }
    return reply;
}

void CommandGateway::release_due(Ert now, std::vector<archive::StageRecord>& stages) {
    using commands::Stage;
    using commands::Status;
    if (!stations_.sees(now)) return await_pass(now, stages);
    for (const std::uint64_t number : queue_.take_due(now)) {
        auto* command = underway(number);
        if (command == nullptr) continue;
        std::string failing;
        for (const auto& condition : commands::check(dictionary_, command->lifecycle.command(), latest(now)))
            if (condition.state == commands::PreconditionState::State::fails)
                failing += (failing.empty() ? "" : "; ") + condition.text;
        const auto service = command->wanted.value_or(link_.suitable(now));
        const auto taken = failing.empty() ? link_.send(number, command->packet, service)
                                           : Result<void>{Error{"it must not be sent now: " + failing}};
        changes_.clear();
        if (taken)
            command->lifecycle.ground_stage(
                Stage::released, Status::ok,
                fmt::format("to the uplink, {}; ahead of it: {}", name_of(service), link_.waiting() - 1), now, changes_);
        else
            command->lifecycle.ground_stage(Stage::released, Status::failed, taken.error().message, now, changes_);
        append(*command, changes_, stages);
    }
    radiate(now, stages);
}

void CommandGateway::await_pass(Ert now, std::vector<archive::StageRecord>& stages) {
    if (const auto* next = stations_.next_after(now)) {
        for (const std::uint64_t number : queue_.postpone_due(now, next->begin))
            if (auto* command = underway(number)) tell_wait(*command, now, stages);
        return;
    }
    for (const std::uint64_t number : queue_.take_due(now)) {
        auto* command = underway(number);
        if (command == nullptr) continue;
        changes_.clear();
        command->lifecycle.ground_stage(commands::Stage::released, commands::Status::failed, stations_.refusal(now), now, changes_);
        append(*command, changes_, stages);
    }
}

CommandGateway::Underway* CommandGateway::underway(std::optional<std::uint64_t> number) {
    const auto found = std::ranges::find_if(underway_, [&](const Underway& each) { return each.number == number; });
    return found == underway_.end() ? nullptr : &*found;
}

void CommandGateway::radiate(Ert now, std::vector<archive::StageRecord>& stages) {
    const auto* pass = stations_.pass_at(now);
    while (auto unit = stations_.sees(now) ? link_.next(now) : std::nullopt) {
        if (auto* command = underway(unit->tag)) {
            const std::string frame =
                fmt::format("{} octets left {}, packet {} in frame {}, {}; at the vehicle {:.1f} s later",
                            unit->cltu.size(), pass == nullptr ? "the station" : pass->station, command->lifecycle.count(), unit->sequence, name_of(unit->service), light_time_s_);
            changes_.clear();
            if (unit->transmission == 1)
                command->lifecycle.ground_stage(commands::Stage::radiated, commands::Status::ok, frame, now, changes_);
            else
                command->lifecycle.radiated_again(fmt::format("transmission {}: {}", unit->transmission, frame), now, changes_);
            append(*command, changes_, stages);
        }
        uplinks_.push_back(std::move(unit->cltu));
    }
    note_frames(now, stages);
}

void CommandGateway::note_frames(Ert now, std::vector<archive::StageRecord>& stages) {
    using Fate = commands::Fop::Fate;
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
                fmt::format("radiated {} x, and no report of the vehicle has its frame: taken or not", frame.transmissions), now,
                changes_);
        append(*command, changes_, stages);
    }
}

void CommandGateway::receive(std::span<const std::uint8_t> packet, bool live, Ert ert,
                             std::vector<archive::StageRecord>& stages) {
    // What comes later tells the past: it decides no precondition, but an answer that was lost live still counts.
    if (!live && underway_.empty()) return;
    if (decommutator_.decode(packet, decoded_)) return;
    const auto& container = dictionary_.packets[decoded_.packet];
    if (live) note_channels(container, ert);
    if (live && clcw_ && decoded_.packet == clcw_->packet && decoded_.value[clcw_->field]) hear_clcw(ert, stages);
    if (underway_.empty()) return;
    if (container.event) note_answer(ert, stages);
    note_report(container, packet, ert, stages);
    std::erase_if(underway_, [](const Underway& underway) { return underway.lifecycle.finished(); });
}

void CommandGateway::pass(Ert now, std::vector<archive::StageRecord>& stages) {
    for (auto& underway : underway_) {
        changes_.clear();
        underway.lifecycle.pass(now, changes_);
        append(underway, changes_, stages);
    }
    if (stations_.sees(now)) link_.pass(now); // else what is not acknowledged is sent again when the next pass begins
    release_due(now, stages);
}

void CommandGateway::hear_clcw(Ert ert, std::vector<archive::StageRecord>& stages) {
    std::array<std::uint8_t, clcw_octets> octets{};
    BitWriter{octets}.put(static_cast<std::uint32_t>(*decoded_.value[clcw_->field]), 32);
    const auto clcw = read_clcw(octets);
    if (!clcw) return;
    link_.hear(*clcw, ert);
    radiate(ert, stages);
}

std::vector<commands::LatestValue> CommandGateway::latest(Ert now) const {
    std::vector<commands::LatestValue> values(heard_.size());
    for (std::size_t i = 0; i < heard_.size(); ++i)
        if (heard_[i].at)
            values[i] = {heard_[i].value, static_cast<double>(now.microseconds - heard_[i].at->microseconds) * 1e-6};
    return values;
}

void CommandGateway::note_channels(const dictionary::Packet& packet, Ert ert) {
    for (std::size_t i = 0; i < packet.fields.size(); ++i)
        if (const auto& channel = packet.fields[i].channel) heard_[channel->value] = {decoded_.value[i], ert};
}

void CommandGateway::note_answer(Ert ert, std::vector<archive::StageRecord>& stages) {
    const auto* event = telemetry::event_of(dictionary_, decoded_);
    const auto& packet = dictionary_.packets[decoded_.packet];
    const auto opcode = argument_value(packet, decoded_, "opcode");
    const auto count = argument_value(packet, decoded_, "count");
    if (event == nullptr || !opcode || !count) return;
    const commands::Answer answer{event->id,
                                  event->name,
                                  telemetry::event_text(dictionary_, *event, decoded_),
                                  Opcode{static_cast<std::uint16_t>(*opcode)},
                                  static_cast<std::uint16_t>(*count),
                                  decoded_.header.time,
                                  ert};
    for (auto& underway : underway_) {
        if (underway.lifecycle.command().opcode != answer.opcode || underway.lifecycle.count() != answer.count)
            continue;
        changes_.clear();
        underway.lifecycle.on(answer, changes_);
        append(underway, changes_, stages);
    }
}

void CommandGateway::note_report(const dictionary::Packet& packet, std::span<const std::uint8_t> octets, Ert ert,
                                 std::vector<archive::StageRecord>& stages) {
    for (auto& underway : underway_) {
        if (underway.report != &packet) continue;
        changes_.clear();
        underway.lifecycle.on(commands::compare(underway.lifecycle.command(), underway.packet, packet, octets), ert,
                              changes_);
        append(underway, changes_, stages);
    }
}

void CommandGateway::append(const Underway& underway, const std::vector<commands::StageChange>& changes,
                            std::vector<archive::StageRecord>& stages) const {
    const auto* waits = waiting(underway.number);
    for (const auto& change : changes) {
        auto& stage = stages.emplace_back();
        stage.command = underway.number;
        stage.name = underway.lifecycle.command().name;
        stage.stage = commands::name_of(change.stage);
        stage.status = commands::name_of(change.status);
        stage.evidence = change.evidence;
        stage.at = change.at;
        stage.count = underway.lifecycle.count();
        if (change.stage == commands::Stage::queued) {
            stage.arguments = underway.arguments;
            stage.octets = underway.packet;
        }
        if (change.stage == commands::Stage::released && change.status == commands::Status::pending && waits != nullptr) {
            stage.held = waits->held;
            stage.needs_approval = waits->needs_approval;
            if (waits->needs_approval) stage.asked_by = underway.controller;
        }
    }
}

} // namespace aeolis::server
