#include "server/api/api.hpp"

#include "server/api/annotations.hpp"
#include "server/api/dictionary_reply.hpp"
#include "server/api/json.hpp"
#include "server/api/openapi.hpp"
#include "server/api/query_text.hpp"
#include "server/api/run_questions.hpp"
#include "server/archive/items.hpp"
#include "server/rehearsal/wall_clock.hpp"

#include "commands/authorise.hpp"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

namespace aeolis::server {
namespace {

constexpr std::string_view api_prefix = "/api/v1/";
constexpr std::size_t audit_detail_max = 2'000; ///< ours: of a request's body
constexpr int sequence_max = 100;              ///< ours: commands in one command file
constexpr std::size_t audit_outcome_max = 500;  ///< ours: of an answer's

std::vector<std::string> split(std::string_view path) {
    std::vector<std::string> parts;
    while (!path.empty()) {
        const auto slash = path.find('/');
        parts.emplace_back(path.substr(0, slash));
        path = slash == std::string_view::npos ? "" : path.substr(slash + 1);
    }
    return parts;
}

std::optional<archive::RunId> run_id(std::string_view text) {
    std::uint32_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc{} || end != text.data() + text.size() || number == 0) return std::nullopt;
    return archive::RunId{number};
}

/// What stands in the braces of the pattern; none: the path is another one.
std::optional<std::vector<std::string>> parts_of(std::string_view pattern, std::string_view path) {
    const auto wanted = split(pattern.substr(1)), given = split(path.substr(1));
    if (wanted.size() != given.size() || path.ends_with('/') != pattern.ends_with('/')) return std::nullopt;
    std::vector<std::string> parts;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        if (wanted[i].starts_with('{'))
            parts.push_back(given[i]);
        else if (wanted[i] != given[i])
            return std::nullopt;
    }
    return parts;
}

} // namespace

HttpResponse json_response(const google::protobuf::Message& message, unsigned status) {
    HttpResponse response;
    response.status = status;
    response.body = to_json(message);
    return response;
}

HttpResponse error_response(unsigned status, const std::string& error) {
    v1::ErrorReply reply;
    reply.set_error(error);
    return json_response(reply, status);
}

HttpResponse refusal_of(const Operator& who, Right right) {
    if (may(who, right)) return {};
    if (!who.role)
        return error_response(401, "log in first: POST /api/v1/session, or send a token (Authorization: Bearer TOKEN)");
    if (!who.accounts) return error_response(409, "this server has no accounts: it is started with --accounts FILE to have some");
    if (who.choose_password)
        return error_response(403, fmt::format("choose a password of your own first: PATCH /api/v1/users/{}", who.user));
    return error_response(403, fmt::format("{} is {}: this needs the right to {}, which begins with {}", who.user, name_of(*who.role),
                                           name_of(right), name_of(*least_role(right))));
}

namespace {

/// A bug in one answer costs that answer only.
template <typename Answer>
HttpResponse answered(Answer answer) {
    try {
        return answer();
    } catch (const std::exception& bug) {
        spdlog::error("a question could not be answered: {}", bug.what());
        return error_response(500, fmt::format("this is a fault of the server: {}", bug.what()));
    }
}

/// What waits may be any command, a hazardous one too: only who may send that lets it go.
Result<void> may_act(const Operator& who, const std::string& action) {
    if (!who.accounts) return {};
    if (!who.commands.empty()) return Error{fmt::format("{} may not {}: this account has a list of commands, and acts on no others", who.user, action)};
    if ((action == "release" || action == "approve") && !may(who, Right::hazardous))
        return Error{fmt::format("{} may not {}: it needs a {}, and {} is {}", who.user, action, name_of(*least_role(Right::hazardous)), who.user,
                                 name_of(*who.role))};
    if (action == "approve" && who.session.empty()) return Error{"approve: a second person does it, and " + who.user + " is none"};
    return {};
}

} // namespace

Result<void> may_send(const Operator& who, const dictionary::Dictionary& dictionary, const v1::CommandRequest& request) {
    if (!request.action().empty()) return may_act(who, request.action());
    const auto* command = dictionary.command(request.command());
    if (command == nullptr) return {};
    if (!who.commands.empty() && std::ranges::find(who.commands, command->name) == who.commands.end())
        return Error{fmt::format("{} may not send {}: it is not among the commands of this account", who.user, command->name)};
    if (!commands::is_hazardous(*command) || request.dry_run() || may(who, Right::hazardous)) return {};
    return Error{fmt::format("{} is hazardous: it needs a {}, and {} is {}", command->name, name_of(*least_role(Right::hazardous)),
                             who.user, name_of(*who.role))};
}

Result<void> may_start(const Operator& who, const dictionary::Dictionary& dictionary, const v1::StartRehearsal& start) {
    const auto& script = start.inline_scenario().commands();
    for (int i = 0; i < script.size(); ++i) {
        v1::CommandRequest scripted;
        scripted.set_command(script[i].command());
        if (const auto allowed = may_send(who, dictionary, scripted); !allowed)
            return Error{fmt::format("inline_scenario.commands[{}]: {}", i, allowed.error().message)};
    }
    return {};
}

archive::AuditRecord audit_record(const Operator& who, std::string_view action, std::string detail, const std::string& outcome) {
    if (detail.size() > audit_detail_max) detail = detail.substr(0, audit_detail_max) + fmt::format(" … ({} octets)", detail.size());
    archive::AuditRecord record;
    record.at = wall_clock_text();
    record.who = who.user;
    record.from = who.from;
    record.action = action;
    record.detail = std::move(detail);
    record.outcome = outcome.substr(0, audit_outcome_max);
    return record;
}

std::span<const Api::Route> Api::routes() {
    // The first that fits answers. What stands for one run comes before the questions to it.
    static constexpr Route all[] = {
        {"GET", "/api/v1/session", Right::open, &Api::session, ""},
        {"POST", "/api/v1/session", Right::open, &Api::log_in, ""},
        {"DELETE", "/api/v1/session", Right::open, &Api::log_out, ""},
        {"GET", "/api/v1/users", Right::administer, &Api::list_users, ""},
        {"POST", "/api/v1/users", Right::administer, &Api::add_user, "user", true},
        {"PATCH", "/api/v1/users/{user}", Right::open, &Api::change_user, ""}, // one's own needs no right
        {"DELETE", "/api/v1/users/{user}", Right::administer, &Api::remove_user, "user"},
        {"GET", "/api/v1/tokens", Right::administer, &Api::list_tokens, ""},
        {"POST", "/api/v1/tokens", Right::administer, &Api::add_token, "token"},
        {"DELETE", "/api/v1/tokens/{name}", Right::administer, &Api::remove_token, "token"},
        {"GET", "/api/v1/audit", Right::administer, &Api::audit, "", false, true},
        {"GET", "/api/v1/runs", Right::watch, &Api::list_runs, ""},
        {"POST", "/api/v1/runs/{run}/commands", Right::command, &Api::post_command, "command", true},
        {"POST", "/api/v1/runs/{run}/sequences", Right::command, &Api::post_sequence, "command", true},
        {"POST", "/api/v1/runs/{run}/alarms", Right::command, &Api::post_alarm, "alarm"},
        {"POST", "/api/v1/runs/{run}/notes", Right::command, &Api::post_note, "note"},
        {"GET", "/api/v1/runs/{run}", Right::watch, &Api::run_question, "", false, true},
        {"GET", "/api/v1/runs/{run}/samples", Right::watch, &Api::export_samples, "", false, true},
        {"GET", "/api/v1/runs/{run}/{question}", Right::watch, &Api::run_question, "", false, true},
        {"GET", "/api/v1/scenarios", Right::watch, &Api::list_scenarios, ""},
        {"GET", "/api/v1/dictionary", Right::watch, &Api::dictionary, ""},
        {"GET", "/api/v1/openapi.yaml", Right::open, &Api::openapi, ""},
        {"GET", "/api/v1/rehearsals", Right::watch, &Api::list_rehearsals, ""},
        {"POST", "/api/v1/rehearsals", Right::rehearse, &Api::start_rehearsal, "rehearsal"},
        {"GET", "/api/v1/rehearsals/current", Right::watch, &Api::current_rehearsal, ""},
        {"POST", "/api/v1/rehearsals/current", Right::rehearse, &Api::control_rehearsal, "rehearsal"},
        {"PATCH", "/api/v1/rehearsals/current", Right::rehearse, &Api::control_rehearsal, "rehearsal"},
        {"GET", "/api/v1/campaigns", Right::watch, &Api::list_campaigns, ""},
        {"POST", "/api/v1/campaigns", Right::rehearse, &Api::start_campaign, "campaign"},
        {"GET", "/api/v1/campaigns/{campaign}", Right::watch, &Api::campaign_report, ""},
        {"GET", "/api/v1/campaigns/{campaign}/touchdowns", Right::watch, &Api::campaign_touchdowns, "", false, true},
        {"POST", "/api/v1/campaigns/{campaign}/cancel", Right::rehearse, &Api::cancel_campaign, "campaign"},
        {"GET", "/api/v1/stream", Right::watch, &Api::stream, ""},
        {"GET", "/healthz", Right::open, &Api::health, ""},
        {"GET", "/metrics", Right::watch, &Api::metrics, ""},
    };
    return all;
}

Api::Api(Parts parts) : parts_(std::move(parts)), dictionary_json_(to_json(dictionary_reply(parts_.dictionary))) {}

void Api::handle(HttpRequest request, const Respond& respond) {
    const std::string_view method = request.method == "HEAD" ? "GET" : std::string_view{request.method};
    const std::string path = request.path;
    std::string others;
    for (const auto& route : routes()) {
        auto parts = parts_of(route.path, path);
        if (!parts) continue;
        if (route.method == method) {
            auto who = parts_.access.identify(request.credentials);
            return answer(route, {std::move(request), std::move(who), std::move(*parts), respond});
        }
        if (others.find(route.method) == std::string::npos) others += (others.empty() ? "" : " and ") + std::string{route.method};
    }
    if (!others.empty()) return respond(error_response(405, fmt::format("{} {}: only {} here", request.method, path, others)));
    if (path.starts_with(api_prefix))
        return respond(error_response(404, fmt::format("{}: there is no such route; /api/v1/openapi.yaml lists them", path)));
    if (method != "GET") return respond(error_response(405, fmt::format("{} {}: only GET here", request.method, path)));
    aside(respond, [this, path](archive::Reader&) { return parts_.console.file(path); });
}

void Api::answer(const Route& route, Asked asked) {
    const bool changes = route.method != "GET";
    auto refused = refusal_of(asked.who, route.right);
    if (refused.status == 200 && !changes && !route.parameters && route.path.starts_with(api_prefix))
        if (const auto none = QueryText::parse(asked.request.query, {}); !none) refused = error_response(400, none.error().message);
    const bool of_run = route.path.starts_with("/api/v1/runs/{run}");
    if (refused.status == 200 && of_run && asked.parts[0] != "latest" && !run_id(asked.parts[0]))
        refused = error_response(404, fmt::format("run '{}': there is none; a number or 'latest' is wanted", asked.parts[0]));
    if (refused.status == 200 && changes && !parts_.pipeline.audit_has_room())
        return asked.respond(error_response(503, "nothing is done that the audit cannot take: " + parts_.pipeline.fault()));
    const bool refuses = refused.status != 200;
    if (!route.audit.empty() && (refuses || !route.only_refusals)) asked.respond = noted(asked, route.audit);
    if (refuses) return asked.respond(std::move(refused));
    (this->*route.answer)(asked);
}

Respond Api::noted(const Asked& asked, std::string_view action) {
    if (!asked.who.role) return asked.respond; // nobody: else anyone could fill the audit
    const bool has_password = asked.request.path.starts_with("/api/v1/users");
    return [this, who = asked.who, action,
            detail = fmt::format("{} {} {}", asked.request.method, asked.request.path, has_password ? "" : asked.request.body), respond = asked.respond](HttpResponse response) {
        note(who, action, detail, response.status < 400 ? "done" : fmt::format("refused ({}): {}", response.status, response.body));
        respond(std::move(response));
    };
}

void Api::note(const Operator& who, std::string_view action, std::string detail, const std::string& outcome) {
    parts_.pipeline.audit(audit_record(who, action, std::move(detail), outcome));
}

void Api::aside(const Respond& respond, std::function<HttpResponse(archive::Reader&)> answer) {
    const bool taken = parts_.queries.ask([answer = std::move(answer), respond](archive::Reader& reader) {
        respond(answered([&] { return answer(reader); }));
    });
    if (!taken) respond(error_response(503, "too many questions wait: try again"));
}

void Api::run_question(const Asked& asked) {
    const auto& run = asked.parts[0];
    const std::string what = asked.parts.size() == 2 ? asked.parts[1] : "";
    const auto& respond = asked.respond;
    const auto* question = server::run_question(what);
    if (question == nullptr)
        return respond(error_response(404, fmt::format("'{}' cannot be asked of a run; these can: {}", what, run_question_names())));
    auto query = QueryText::parse(asked.request.query, question->parameters);
    if (!query) return respond(error_response(400, query.error().message));
    const auto& dictionary = parts_.dictionary;
    // What the archive cannot know of the run that goes on: its pace and its clocks.
    const auto current = current_run();
    if (what.empty() && current.run() != 0 && (run == "latest" || run_id(run)->value == current.run()))
        return respond(json_response(current));
    ask(asked, std::move(*query),
        [&dictionary, clock = clock(), answer = question->answer](archive::Reader& reader, archive::RunId id, const QueryText& asked_of) {
            return answer({dictionary, clock(id)}, reader, id, asked_of);
        });
}

std::function<std::optional<Ert>(archive::RunId)> Api::clock() const {
    return [current = parts_.hub.current_run(), now = ert_from_day_of_year(parts_.hub.latest_clocks().ert())](archive::RunId run) {
        return run.value == current ? now : std::nullopt;
    };
}

void Api::ask(const Asked& asked, QueryText query, RunQuestion question) {
    const auto job = [run = asked.parts[0], query = std::move(query), question = std::move(question), respond = asked.respond](archive::Reader& reader) {
        auto id = run_id(run);
        if (!id) {
            const auto runs = reader.runs();
            if (!runs) return respond(error_response(500, runs.error().message));
            if (runs->runs().empty()) return respond(error_response(404, "run 'latest': no run has been recorded yet"));
            id = archive::RunId{static_cast<std::uint32_t>(runs->runs(0).run())};
        } else if (const auto known = reader.run(*id); !known) {
            return respond(error_response(404, known.error().message));
        }
        bool later = false;
        auto response = std::optional{answered([&] {
            auto given = question(reader, *id, query);
            later = !given;
            return given.value_or(HttpResponse{});
        })};
        if (later) return;
        if (reader.stopped())
            response = error_response(503, fmt::format("the question was stopped after {} s: ask for less, by from and to, points or limit",
                                                       QueryThreads::question_seconds_max.count()));
        respond(std::move(*response));
    };
    if (!parts_.queries.ask(job, asked.request.gone)) asked.respond(error_response(503, "too many questions wait: try again"));
}

void Api::list_runs(const Asked& asked) {
    aside(asked.respond, [current = current_run()](archive::Reader& reader) {
        auto runs = reader.runs();
        if (!runs) return error_response(500, runs.error().message);
        for (auto& run : *runs->mutable_runs())
            if (run.run() == current.run()) run = current;
        return json_response(*runs);
    });
}

void Api::list_scenarios(const Asked& asked) {
    aside(asked.respond, [this](archive::Reader&) { return json_response(parts_.scenarios.list()); });
}

void Api::dictionary(const Asked& asked) {
    asked.respond({200, "application/json", "no-store", dictionary_json_});
}

void Api::openapi(const Asked& asked) {
    asked.respond({200, "application/yaml", "no-cache", std::string{openapi_text}});
}

void Api::stream(const Asked& asked) {
    asked.respond(error_response(426, "the stream is a WebSocket: ask for an upgrade, with one of the "
                                      "subprotocols aeolis.v1.protobuf, aeolis.v1.json"));
}

void Api::health(const Asked& asked) {
    const std::string fault = parts_.pipeline.fault();
    // Whoever may not watch is not told the names of files.
    const std::string text = fault.empty() ? "ok" : may(asked.who, Right::watch) ? fault : "the archive cannot be written";
    asked.respond({fault.empty() ? 200U : 503U, "text/plain; charset=utf-8", "no-store", text + "\n"});
}

void Api::list_rehearsals(const Asked& asked) {
    v1::RunList list;
    if (const auto state = current_run(); state.run() != 0) *list.add_runs() = state;
    asked.respond(json_response(list));
}

void Api::current_rehearsal(const Asked& asked) {
    const auto state = current_run();
    asked.respond(state.run() == 0 ? error_response(404, "no rehearsal was started since the server came up") : json_response(state));
}

namespace {

// What cannot be done now may be asked again later; what makes no sense may not.
RehearsalDesk::Began tell_begun(const Respond& respond, bool going_on) {
    return [respond, refused = going_on ? 409U : 422U](const Result<v1::RunState>& state) {
        respond(state ? json_response(*state, 201) : error_response(refused, state.error().message));
    };
}

} // namespace

void Api::start_rehearsal(const Asked& asked) {
    v1::StartRehearsal start;
    if (const auto parsed = from_json(asked.request.body, start); !parsed)
        return asked.respond(error_response(400, parsed.error().message));
    if (const auto allowed = may_start(asked.who, parts_.dictionary, start); !allowed)
        return asked.respond(error_response(403, allowed.error().message));
    parts_.desk.start(start, tell_begun(asked.respond, parts_.desk.going_on()));
}

void Api::control_rehearsal(const Asked& asked) {
    v1::RehearsalControl control;
    if (const auto parsed = from_json(asked.request.body, control); !parsed)
        return asked.respond(error_response(400, parsed.error().message));
    if (const auto allowed = may_start(asked.who, parts_.dictionary, control.start()); !allowed)
        return asked.respond(error_response(403, allowed.error().message));
    const bool going_on = parts_.desk.going_on();
    const bool starts = control.action_case() == v1::RehearsalControl::kStart;
    const auto done = parts_.desk.control(control, tell_begun(asked.respond, going_on));
    if (!done) return asked.respond(error_response(going_on ? 422 : 409, done.error().message));
    if (!starts) asked.respond(json_response(current_run(), 202));
}

namespace {

/// What the path says of the run goes into the request, and who asks: both may not be said otherwise.
Result<void> complete(const Asked& asked, v1::CommandRequest& command) {
    const auto& run = asked.parts[0];
    const auto id = run_id(run);
    if (id && command.run() != 0 && command.run() != id->value) return Error{fmt::format("run: the path says {}, the body {}", run, command.run())};
    if (id) command.set_run(id->value);
    if (asked.who.accounts) command.set_controller(asked.who.user);
    return {};
}

} // namespace

void Api::post_command(const Asked& asked) {
    v1::CommandRequest command;
    if (const auto parsed = from_json(asked.request.body, command); !parsed)
        return asked.respond(error_response(400, parsed.error().message));
    const auto respond = command.dry_run() ? asked.respond : noted(asked, "command");
    if (const auto right = complete(asked, command); !right) return respond(error_response(400, right.error().message));
    if (const auto allowed = may_send(asked.who, parts_.dictionary, command); !allowed)
        return respond(error_response(403, allowed.error().message));
    const unsigned refused = parts_.dictionary.command(command.command()) == nullptr ? 422 : 409;
    parts_.desk.command(std::move(command), [respond, refused](const v1::CommandReply& reply) {
        respond(json_response(reply, reply.accepted() ? 202 : refused));
    });
}

void Api::post_sequence(const Asked& asked) {
    v1::CommandSequence sequence;
    if (const auto parsed = from_json(asked.request.body, sequence); !parsed)
        return asked.respond(error_response(400, parsed.error().message));
    const auto respond = sequence.dry_run() ? asked.respond : noted(asked, "command");
    if (sequence.commands().empty() || sequence.commands_size() > sequence_max)
        return respond(error_response(400, fmt::format("commands: 1 to {} are wanted, here are {}", sequence_max, sequence.commands_size())));
    for (int i = 0; i < sequence.commands_size(); ++i) {
        auto& command = *sequence.mutable_commands(i);
        const auto at = [i](const std::string& error) { return fmt::format("commands[{}]: {}", i, error); };
        if (command.dry_run() || !command.action().empty())
            return respond(error_response(400, at("dry_run and action are not for a command of a sequence")));
        if (const auto right = complete(asked, command); !right) return respond(error_response(400, at(right.error().message)));
        if (const auto allowed = may_send(asked.who, parts_.dictionary, command); !allowed)
            return respond(error_response(403, at(allowed.error().message)));
    }
    parts_.desk.sequence({sequence.commands().begin(), sequence.commands().end()}, sequence.dry_run(), [respond](std::vector<v1::CommandReply> replies) {
        v1::SequenceReply reply;
        reply.set_accepted(true);
        for (auto& each : replies) {
            if (!each.accepted() && reply.accepted()) {
                reply.set_accepted(false);
                reply.set_reason(fmt::format("commands[{}]: {}", reply.commands_size(), each.reason()));
            }
            *reply.add_commands() = std::move(each);
        }
        respond(json_response(reply, reply.accepted() ? 202 : 409));
    });
}

namespace {

/// Answers with the item that something became, once it is durable.
std::function<void(Result<archive::Annotation>)> added(const Respond& respond) {
    return [respond](const Result<archive::Annotation>& annotation) {
        respond(annotation ? json_response(archive::to_item(*annotation), 201) : error_response(503, annotation.error().message));
    };
}

} // namespace

void Api::post_note(const Asked& asked) {
    const auto& respond = asked.respond;
    v1::NoteRequest wanted;
    if (const auto parsed = from_json(asked.request.body, wanted); !parsed) return respond(error_response(400, parsed.error().message));
    if (asked.who.accounts) wanted.set_by(asked.who.user);
    const auto question = [this, wanted, clock = clock(), respond](archive::Reader& reader, archive::RunId id,
                                                                   const QueryText&) -> std::optional<HttpResponse> {
        const auto newest = reader.newest_ert(id);
        if (!newest) return error_response(500, newest.error().message);
        auto note = note_of(wanted, wanted.by(), clock(id).value_or(*newest));
        if (!note) return error_response(422, note.error().message);
        if (parts_.pipeline.annotate(id, std::move(*note), added(respond))) return {};
        return error_response(503, "too much waits to be stored: try again");
    };
    ask(asked, {}, question);
}

void Api::post_alarm(const Asked& asked) {
    const auto& respond = asked.respond;
    v1::AlarmRequest wanted;
    if (const auto parsed = from_json(asked.request.body, wanted); !parsed) return respond(error_response(400, parsed.error().message));
    if (asked.who.accounts) wanted.set_by(asked.who.user);
    const auto question = [this, wanted, clock = clock(), respond](archive::Reader& reader, archive::RunId id,
                                                                   const QueryText&) -> std::optional<HttpResponse> {
        const auto newest = reader.newest_ert(id);
        if (!newest) return error_response(500, newest.error().message);
        auto action = alarm_action_of(wanted, parts_.dictionary, wanted.by(), clock(id).value_or(*newest));
        if (!action) return error_response(422, action.error().message);
        const auto act = telemetry::alarm_act(action->action);
        if (auto may = reader.may(id, action->alarm, *act, action->at); !may) return error_response(409, may.error().message);
        if (parts_.pipeline.annotate(id, std::move(*action), added(respond))) return {};
        return error_response(503, "too much waits to be stored: try again");
    };
    ask(asked, {}, question);
}

v1::RunState Api::current_run() const {
    auto state = parts_.desk.current();
    if (state.run() != 0) {
        state.set_last_seq(parts_.hub.last_seq());
        state.set_archive_fault(parts_.pipeline.fault());
    }
    return state;
}

} // namespace aeolis::server
