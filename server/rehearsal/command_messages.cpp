// SPDX-License-Identifier: Apache-2.0
#include "server/rehearsal/command_messages.hpp"

#include "commands/request_form.hpp"
#include "server/rehearsal/client_ids.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <utility>

namespace aeolis::server {

Result<commands::Request> request_of(const v1::CommandRequest& message, const archive::RunClocks& clocks,
                                     const std::string& browser, bool director) {
    commands::Request request;
    request.request = message.request();
    request.client_id = message.client_id();
    request.command = message.command();
    for (const auto& argument : message.arguments()) request.arguments.push_back({argument.name(), argument.value()});
    request.from_solution = message.from_solution();
    request.armed = message.armed();
    request.confirmation = message.confirmation();
    request.service = message.service();
    request.dry_run = message.dry_run();
    if (const auto& at = message.release_at(); !at.empty()) {
        const auto leaves = archive::departure_of(at, clocks, "release_at");
        if (!leaves) return leaves.error();
        request.release_at = *leaves;
    }
    request.hold = message.hold();
    request.priority = message.priority();
    request.action = message.action();
    request.number = message.number();
    request.controller = message.controller();
    request.browser = browser;
    request.director = director;
    return request;
}

Result<void> check_form(const v1::CommandRequest& message, const dictionary::Dictionary& dictionary) {
    if (const auto id = check_client_ids({&message, 1}); !id) return id;
    const auto& at = message.release_at();
    if (!at.empty())
        if (const auto instant = archive::check_instant(at, "release_at"); !instant) return instant;
    auto untimed = message;
    untimed.clear_release_at();
    const auto request = request_of(untimed, {});
    if (!request) return request.error();
    return commands::check_form(*request, dictionary);
}

commands::TimelineVerdict verdict_of(const v1::TimelineVerdict& message) {
    return {message.command(), message.undone(), message.refuted(), message.analysis()};
}

v1::TimelineVerdict message_of(const commands::TimelineVerdict& verdict) {
    v1::TimelineVerdict message;
    message.set_command(verdict.command);
    message.set_undone(verdict.undone);
    message.set_refuted(verdict.refuted);
    message.set_analysis(verdict.analysis);
    return message;
}

v1::CommandReply message_of(const commands::Reply& reply) {
    v1::CommandReply message;
    message.set_request(reply.request);
    message.set_command(reply.command);
    message.set_accepted(reply.accepted);
    message.set_dry_run(reply.dry_run);
    message.set_reason(reply.reason);
    message.set_octets(fmt::format("{:02x}", fmt::join(reply.octets, "")));
    message.set_arguments(reply.arguments);
    for (const auto& condition : reply.preconditions) {
        auto& told = *message.add_preconditions();
        told.set_text(condition.text);
        told.set_state(commands::name_of(condition.verdict));
    }
    message.set_service(reply.service);
    message.set_needs_approval(reply.needs_approval);
    if (reply.leaves) message.set_leaves_us(reply.leaves->microseconds);
    if (reply.arrives) message.set_arrives_us(reply.arrives->microseconds);
    if (reply.effect_seen) message.set_effect_seen_us(reply.effect_seen->microseconds);
    message.set_station(reply.station);
    if (reply.station_until) message.set_station_until_us(reply.station_until->microseconds);
    if (reply.deadline) {
        message.set_latest_useful_us(reply.deadline->latest.microseconds);
        message.set_useful_before(reply.deadline->timepoint);
    }
    for (const auto& timepoint : reply.too_late_for) message.add_too_late_for(timepoint);
    return message;
}

archive::StageRecord record_of(commands::StageReport stage) {
    archive::StageRecord record;
    record.command = stage.command;
    record.name = std::move(stage.name);
    record.stage = stage.stage;
    record.status = stage.status;
    record.evidence = std::move(stage.evidence);
    record.ert = stage.at;
    record.arguments = std::move(stage.arguments);
    record.count = stage.count;
    record.octets = std::move(stage.octets);
    record.held = stage.held;
    record.needs_approval = stage.needs_approval;
    record.asked_by = std::move(stage.asked_by);
    record.client_id = std::move(stage.client_id);
    return record;
}

}  // namespace aeolis::server
