// SPDX-License-Identifier: Apache-2.0
#include "server/api/api.hpp"
#include "server/base/json.hpp"

#include "commands/authorise.hpp"
#include "server/rehearsal/client_ids.hpp"
#include "server/rehearsal/command_messages.hpp"

#include <algorithm>
#include <fmt/format.h>

// The routes of commands, and the check of who may send which command: used here, by the stream (console_backend.cpp)
// and for the script of a scenario.
namespace aeolis::server {
namespace {

constexpr int sequence_max = 100;  // chosen: commands in one command file

Result<void> may_send_named(const Operator& who, const dictionary::Dictionary& dictionary, const std::string& name,
                            bool dry_run) {
    const auto* command = dictionary.command(name);
    if (command == nullptr) return {};
    if (!who.commands.empty() && std::ranges::find(who.commands, command->name) == who.commands.end())
        return Error{
            fmt::format("{} may not send {}: it is not among the commands of this account", who.user, command->name)};
    if (!commands::is_hazardous(*command) || dry_run || may(who, Right::hazardous)) return {};
    return Error{fmt::format("{} is hazardous: it needs a {}, and {} is {}", command->name,
                             name_of(*least_role(Right::hazardous)), who.user, name_of(*who.role))};
}

/// The right to act on a number that no command has yet: by then it may be any command's, even a hazardous one's.
Result<void> may_act_on_any(const Operator& who, const std::string& action) {
    if (!who.commands.empty())
        return Error{
            fmt::format("{} may not {}: this account has a list of commands, and acts on no others", who.user, action)};
    if (!may(who, Right::hazardous))
        return Error{fmt::format("{} may not {}: it needs a {}, and {} is {}", who.user, action,
                                 name_of(*least_role(Right::hazardous)), who.user, name_of(*who.role))};
    return {};
}

/// The right to release or stop a waiting command equals the right to send it: stopping one that must be in time is as
/// grave.
Result<void> may_act(const Operator& who, const dictionary::Dictionary& dictionary, const RehearsalManager& rehearsals,
                     const v1::CommandRequest& request) {
    if (!who.accounts) return {};
    const std::string& action = request.action();
    const auto name = rehearsals.name_of_command(request.number());
    const auto allowed = name ? may_send_named(who, dictionary, *name, false) : may_act_on_any(who, action);
    if (!allowed && name)
        return Error{fmt::format("{} command {}: {}", action, request.number(), allowed.error().message)};
    if (!allowed) return allowed;
    if (action == "approve" && who.session.empty())
        return Error{"approve: a second person does it, and " + who.user + " is none"};
    return {};
}

/// Sets the run from the path and the operator's identity. Fails when the body names another run.
Result<void> complete(const ApiRequest& call, v1::CommandRequest& command) {
    const auto& run = call.parts[0];
    const auto id = run_id(run);
    if (id && command.run() != 0 && command.run() != id->value)
        return Error{fmt::format("run: the path says {}, the body {}", run, command.run())};
    if (id) command.set_run(id->value);
    name_asker(call.who, command);
    return {};
}

/// @param malformed  what makes no sense in the file, so that nothing was sent; empty: nothing
HttpResponse response_to_file(std::vector<v1::CommandReply> replies, const std::string& malformed) {
    v1::SequenceReply reply;
    reply.set_accepted(malformed.empty());
    reply.set_reason(malformed);
    for (auto& each : replies) {
        if (!each.reason().empty() && (reply.reason().empty() || (!each.accepted() && reply.accepted())))
            reply.set_reason(fmt::format("commands[{}]: {}", reply.commands_size(), each.reason()));
        if (!each.accepted()) reply.set_accepted(false);
        *reply.add_commands() = std::move(each);
    }
    if (reply.accepted()) return json_response(reply, 202);
    return refusal_response(std::move(reply), malformed.empty() ? 409 : 422);
}

}  // namespace

v1::CommandReply unsent(const v1::CommandRequest& command, const std::string& reason) {
    v1::CommandReply reply;
    reply.set_request(command.request());
    reply.set_dry_run(command.dry_run());
    reply.set_reason(reason);
    return reply;
}

void name_asker(const Operator& who, v1::CommandRequest& request) {
    if (who.accounts) request.set_controller(person_of(who));
}

Result<void> may_send(const Operator& who, const dictionary::Dictionary& dictionary, const RehearsalManager& rehearsals,
                      const v1::CommandRequest& request) {
    if (!request.action().empty()) return may_act(who, dictionary, rehearsals, request);
    return may_send_named(who, dictionary, request.command(), request.dry_run());
}

RehearsalManager::AuthorityCheck may_still_send(Access& access, const Credentials& credentials,
                                                const dictionary::Dictionary& dictionary,
                                                const RehearsalManager& rehearsals) {
    return [&access, credentials, &dictionary, &rehearsals](const v1::CommandRequest& request) -> Result<void> {
        const auto who = access.identify(credentials);
        if (!may(who, Right::command))
            return Error{"the right to send it was lost while it waited for a change of the timeline"};
        return may_send(who, dictionary, rehearsals, request);
    };
}

Result<void> may_start(const Operator& who, const dictionary::Dictionary& dictionary, const v1::StartRehearsal& start) {
    const auto& script = start.inline_scenario().commands();
    for (int i = 0; i < script.size(); ++i) {
        if (const auto allowed = may_send_named(who, dictionary, script[i].command(), false); !allowed)
            return Error{fmt::format("inline_scenario.commands[{}]: {}", i, allowed.error().message)};
    }
    const bool planned = !start.plan().empty() || !start.inline_plan().empty();
    if (planned && !may(who, Right::instruct)) return Error{"plan: this needs the right to instruct"};
    return {};
}

Result<void> may_control(const Operator& who, const dictionary::Dictionary& dictionary,
                         const v1::RehearsalControl& control) {
    const bool instructs = control.has_inject() || control.has_note() || control.has_plan();
    if (instructs && !may(who, Right::instruct))
        return Error{"inject, note and plan are an instructor's: this needs the right to instruct"};
    return may_start(who, dictionary, control.start());
}

std::optional<Api::TooMany> Api::count_commands(const Operator& who, std::size_t commands) {
    const auto wait = command_rates_.take(client_of(who), commands, CommandRates::Clock::now());
    if (!wait) return std::nullopt;
    return TooMany{fmt::format("more than {} commands a second: none of these is sent; try again in {} s",
                               CommandRates::each_second, wait->count()),
                   *wait};
}

void Api::post_command(const ApiRequest& call) {
    // Counted unread: a body that says nothing takes time, too.
    if (const auto many = count_commands(call.who, 1))
        return audited(call, "command")(retry_response(429, many->reason, many->wait));
    v1::CommandRequest command;
    if (const auto fault = fault_of_json(call.request.body, command))
        return call.respond(fault->of_value ? refusal_response(unsent(command, fault->words), 422)
                                            : error_response(400, fault->words));
    const auto respond = command.dry_run() ? call.respond : audited(call, "command");
    if (const auto right = complete(call, command); !right) return respond(error_response(400, right.error()));
    if (const auto allowed = may_send(call.who, parts_.dictionary, parts_.rehearsals, command); !allowed)
        return respond(error_response(403, allowed.error()));
    if (const auto formed = check_form(command, parts_.dictionary); !formed)
        return respond(refusal_response(unsent(command, formed.error().message), 422));
    const auto still = may_still_send(parts_.access, call.request.credentials, parts_.dictionary, parts_.rehearsals);
    parts_.rehearsals.command(std::move(command), {still, call.who.browser, may(call.who, Right::hazardous)},
                              [respond](v1::CommandReply reply) {
                                  respond(reply.accepted() ? json_response(reply, 202)
                                                           : refusal_response(std::move(reply), 409));
                              });
}

void Api::post_sequence(const ApiRequest& call) {
    if (const auto many = count_commands(call.who, 1))
        return audited(call, "command")(retry_response(429, many->reason, many->wait));
    v1::CommandSequence sequence;
    if (const auto fault = fault_of_json(call.request.body, sequence)) {
        v1::SequenceReply reply;
        reply.set_reason(fault->words);
        return call.respond(fault->of_value ? refusal_response(reply, 422) : error_response(400, fault->words));
    }
    const auto respond = sequence.dry_run() ? call.respond : audited(call, "command");
    if (sequence.commands().empty() || sequence.commands_size() > sequence_max)
        return respond(error_response(
            400, fmt::format("commands: 1 to {} are wanted, here are {}", sequence_max, sequence.commands_size())));
    if (const auto many = count_commands(call.who, static_cast<std::size_t>(sequence.commands_size() - 1)))
        return respond(retry_response(429, many->reason, many->wait));
    std::string malformed;
    for (int i = 0; i < sequence.commands_size(); ++i) {
        auto& command = *sequence.mutable_commands(i);
        const auto at = [i](const std::string& error) { return fmt::format("commands[{}]: {}", i, error); };
        if (command.dry_run() || !command.action().empty())
            return respond(error_response(400, at("dry_run and action are not for a command of a sequence")));
        if (const auto right = complete(call, command); !right)
            return respond(error_response(400, at(right.error().message)));
        command.set_dry_run(sequence.dry_run());
        if (const auto allowed = may_send(call.who, parts_.dictionary, parts_.rehearsals, command); !allowed)
            return respond(error_response(403, at(allowed.error().message)));
        if (const auto formed = check_form(command, parts_.dictionary); !formed && malformed.empty())
            malformed = at(formed.error().message);
    }
    std::vector<v1::CommandRequest> file{sequence.commands().begin(), sequence.commands().end()};
    if (const auto ids = check_client_ids(file); !ids && malformed.empty()) malformed = ids.error().message;
    const auto still = may_still_send(parts_.access, call.request.credentials, parts_.dictionary, parts_.rehearsals);
    // A malformed file is checked all the same: its sender is told what is said of each of its commands.
    parts_.rehearsals.sequence(std::move(file), sequence.dry_run() || !malformed.empty(),
                               {still, call.who.browser, may(call.who, Right::hazardous)},
                               [respond, malformed](std::vector<v1::CommandReply> replies) {
                                   respond(response_to_file(std::move(replies), malformed));
                               });
}

}  // namespace aeolis::server
