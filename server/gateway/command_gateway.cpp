#include "server/gateway/command_gateway.hpp"

#include "commands/authorise.hpp"
#include "commands/preconditions.hpp"
#include "commands/read_back.hpp"
#include "telemetry/text.hpp"

#include <algorithm>
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
                               std::vector<commands::NamedValue> solution)
    : dictionary_(dictionary), decommutator_(dictionary), light_time_s_(light_time_s), solution_(std::move(solution)),
      heard_(dictionary.channels.size()) {}

CommandGateway::Submitted CommandGateway::submit(const v1::CommandRequest& request, Ert now,
                                                 std::vector<archive::StageRecord>& stages) {
    Submitted submitted;
    submitted.reply.set_request(request.request());
    const auto refuse = [&](std::string reason) {
        submitted.reply.set_reason(std::move(reason));
        return submitted;
    };

    const auto* command = dictionary_.command(request.command());
    if (command == nullptr)
        return refuse(fmt::format("unknown command '{}': the dictionary of {} has none of this name", request.command(),
                                  dictionary_.mission));
    if (commands_ >= commands_max) return refuse(fmt::format("this run has had its {} commands", commands_max));

    std::vector<commands::NamedValue> arguments;
    for (const auto& argument : request.arguments())
        arguments.push_back({argument.name(), argument.value()});
    if (request.from_solution()) arguments = commands::fill_from_solution(*command, arguments, solution_);
    auto packet = commands::encode(*command, arguments, count_);
    if (!packet) return refuse(packet.error().message);

    // What ground does not know is no reason to refuse: flight holds the same conditions and decides by what it knows.
    auto preconditions = commands::check(dictionary_, *command, latest(now));
    std::string not_known;
    for (const auto& condition : preconditions)
        if (condition.state == commands::PreconditionState::State::unknown)
            not_known += (not_known.empty() ? "; left to flight: " : ", ") + condition.text;
    std::erase_if(preconditions, [](const commands::PreconditionState& condition) {
        return condition.state == commands::PreconditionState::State::unknown;
    });
    const auto authorised = commands::authorise(*command, {request.armed(), request.confirmation()}, preconditions);
    if (!authorised) return refuse(authorised.error().message);

    const auto* report = commands::read_back_packet(dictionary_, *command);
    const auto held = commands::decode(*command, *packet); // as encoded: defaults are in it
    auto& underway = underway_.emplace_back(
        Underway{++commands_, *packet, commands::arguments_text(held ? *held : arguments), report,
                 commands::CommandLifecycle{*command, count_, light_time_s_, report != nullptr}});
    count_ = static_cast<std::uint16_t>((count_ + 1) % commands::count_modulus);

    using commands::Stage;
    using commands::Status;
    changes_.clear();
    auto& lifecycle = underway.lifecycle;
    lifecycle.ground_stage(Stage::queued, Status::ok, fmt::format("accepted as command {}", underway.number), now,
                           changes_);
    lifecycle.ground_stage(Stage::authorised, Status::ok,
                           (commands::is_hazardous(*command) ? "armed and confirmed by name" : "no arming needed") +
                               not_known,
                           now, changes_);
    lifecycle.ground_stage(Stage::released, Status::ok, "nothing is ahead in the uplink queue", now, changes_);
    lifecycle.ground_stage(Stage::radiated, Status::ok,
                           fmt::format("{} octets left the station, count {}; at the vehicle {:.1f} s later",
                                       underway.packet.size(), lifecycle.count(), light_time_s_),
                           now, changes_);
    append(underway, changes_, stages);

    submitted.reply.set_accepted(true);
    submitted.reply.set_command(underway.number);
    submitted.reply.set_octets(hex_text(underway.packet));
    submitted.packet = underway.packet;
    return submitted;
}

void CommandGateway::receive(std::span<const std::uint8_t> packet, bool realtime, Ert ert,
                             std::vector<archive::StageRecord>& stages) {
    // The recording tells the past: it decides no precondition, but an answer that was lost live still counts.
    if (!realtime && underway_.empty()) return;
    if (decommutator_.decode(packet, decoded_)) return;
    const auto& container = dictionary_.packets[decoded_.packet];
    if (realtime) note_channels(container, ert);
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
                            std::vector<archive::StageRecord>& stages) {
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
    }
}

} // namespace aeolis::server
