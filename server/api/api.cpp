// SPDX-License-Identifier: Apache-2.0
#include "server/api/api.hpp"

#include "server/access/network.hpp"
#include "server/api/content_coding.hpp"
#include "server/api/dictionary_reply.hpp"
#include "server/api/query_text.hpp"
#include "server/api/run_questions.hpp"
#include "server/api/time_texts.hpp"
#include "server/base/json.hpp"
#include "server/base/wall_clock.hpp"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

namespace aeolis::server {
namespace {

constexpr std::string_view api_prefix = "/api/v1/";
constexpr std::size_t body_of_nobody_octets_max = 4'096;  ///< chosen: a log-in is shorter
constexpr std::size_t brief_body_octets_max =
    32'768;                                      ///< chosen: an escaped note of full length; a list of 1000 commands
constexpr std::size_t audit_detail_max = 2'000;  ///< chosen: of a request's body
constexpr std::size_t audit_outcome_max = 500;   ///< chosen: of an answer's body
constexpr std::chrono::seconds queue_retry{1};
constexpr std::chrono::seconds disk_retry{5};  ///< chosen: somebody makes room

std::vector<std::string> split(std::string_view path) {
    std::vector<std::string> parts;
    while (!path.empty()) {
        const auto slash = path.find('/');
        parts.emplace_back(path.substr(0, slash));
        path = slash == std::string_view::npos ? "" : path.substr(slash + 1);
    }
    return parts;
}

/// The parts of the path that match the pattern's braces; none when the path does not match.
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

}  // namespace

namespace {

/// 405, with the methods that the path has.
HttpResponse wrong_method(const std::string& method, const std::string& path,
                          const std::vector<std::string_view>& allowed) {
    auto response = error_response(405, fmt::format("{} {}: only {} here", method, path, fmt::join(allowed, " and ")));
    const bool get = std::ranges::find(allowed, "GET") != allowed.end();
    response.fields.emplace_back("Allow", fmt::format("{}{}", fmt::join(allowed, ", "), get ? ", HEAD" : ""));
    return response;
}

}  // namespace

std::optional<archive::RunId> run_id(std::string_view text) {
    std::uint32_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc{} || end != text.data() + text.size() || number == 0) return std::nullopt;
    return archive::RunId{number};
}

HttpResponse json_response(const google::protobuf::Message& message, unsigned status) {
    const std::unique_ptr<google::protobuf::Message> told{message.New()};
    told->CopyFrom(message);
    write_time_texts(*told);
    HttpResponse response;
    response.status = status;
    response.body = to_json(*told);
    return response;
}

HttpResponse error_response(unsigned status, const Error& error) {
    return error_response(error.internal ? 500 : status, error.message);
}

std::optional<HttpResponse> read_body(const std::string& body, google::protobuf::Message& message) {
    const auto fault = fault_of_json(body, message);
    if (!fault) return std::nullopt;
    return error_response(fault->of_value ? 422 : 400, fault->words);
}

HttpResponse busy_response() {
    return full_response(QueryThreads::busy);
}

HttpResponse full_response(const std::string& error) {
    return retry_response(503, error, queue_retry);
}

HttpResponse disk_response(const std::string& error) {
    return retry_response(503, error, disk_retry);
}

HttpResponse stopped_response(std::string_view instead) {
    return retry_response(
        503,
        fmt::format("the question was stopped after {} s: {}", QueryThreads::question_seconds_max.count(), instead),
        QueryThreads::question_seconds_max);
}

HttpResponse refusal_of(const Operator& who, Right right) {
    if (may(who, right)) return {};
    if (!who.role)
        return error_response(401, "log in first: POST /api/v1/session, or send a token (Authorization: Bearer TOKEN)");
    if (!who.accounts)
        return error_response(409, "this server has no accounts: it is started with --accounts FILE to have some");
    if (who.choose_password)
        return error_response(403,
                              fmt::format("choose a password of your own first: PATCH /api/v1/users/{}", who.user));
    return error_response(403, fmt::format("{} is {}: this needs the right to {}, which begins with {}", who.user,
                                           name_of(*who.role), name_of(right), name_of(*least_role(right))));
}

std::string client_of(const Operator& who) {
    if (!who.user.empty()) return person_of(who);
    return who.browser.empty() || who.browser == no_browser ? network_of(who.from) : who.browser;
}

namespace {

/// Contains a bug: an exception fails only this answer.
template <typename Answer>
HttpResponse answered(Answer answer) {
    try {
        return answer();
    } catch (const std::exception& bug) {
        spdlog::error("a question could not be answered: {}", bug.what());
        return error_response(500, fmt::format("this is a fault of the server: {}", bug.what()));
    }
}

}  // namespace

archive::AuditRecord audit_record(const Operator& who, std::string_view action, std::string detail,
                                  const std::string& outcome) {
    if (detail.size() > audit_detail_max)
        detail = detail.substr(0, audit_detail_max) + fmt::format(" … ({} octets)", detail.size());
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
    // The first match answers. Routes of one run come before the questions about it.
    static constexpr Route all[] = {
        {"GET", "/api/v1/session", Right::open, &Api::session},
        {"POST", "/api/v1/session", Right::open, &Api::log_in},
        {"DELETE", "/api/v1/session", Right::open, &Api::log_out},
        {"GET", "/api/v1/users", Right::administer, &Api::list_users, Query::own},
        {"POST", "/api/v1/users", Right::administer, &Api::add_user, Query::none, "user", Audited::refusals},
        {"PATCH", "/api/v1/users/{user}", Right::open, &Api::change_user},  // one's own account needs no right
        {"DELETE", "/api/v1/users/{user}", Right::administer, &Api::remove_user, Query::none, "user"},
        {"GET", "/api/v1/tokens", Right::administer, &Api::list_tokens, Query::own},
        {"POST", "/api/v1/tokens", Right::administer, &Api::add_token, Query::none, "token"},
        {"DELETE", "/api/v1/tokens/{name}", Right::administer, &Api::remove_token, Query::none, "token"},
        {"GET", "/api/v1/audit", Right::administer, &Api::audit, Query::own},
        {"GET", "/api/v1/runs", Right::watch, &Api::list_runs, Query::own},
        {"POST", "/api/v1/runs/{run}/commands", Right::command, &Api::post_command, Query::none, "command",
         Audited::refusals},
        {"POST", "/api/v1/runs/{run}/sequences", Right::command, &Api::post_sequence, Query::none, "command",
         Audited::refusals, Body::whole},
        {"POST", "/api/v1/runs/{run}/alarms", Right::command, &Api::post_alarm, Query::none, "alarm"},
        {"POST", "/api/v1/runs/{run}/notes", Right::command, &Api::post_note, Query::none, "note"},
        {"GET", "/api/v1/runs/{run}", Right::watch, &Api::run_question, Query::own},
        {"DELETE", "/api/v1/runs/{run}", Right::rehearse, &Api::remove_run, Query::none, "prune", Audited::refusals},
        {"GET", "/api/v1/runs/{run}/samples", Right::watch, &Api::export_samples, Query::own},
        {"GET", "/api/v1/runs/{run}/raw", Right::watch, &Api::export_raw, Query::own},
        {"GET", "/api/v1/runs/{run}/rows", Right::instruct, &Api::export_rows, Query::own, "rows", Audited::refusals},
        {"GET", "/api/v1/runs/{run}/prediction", Right::watch, &Api::prediction, Query::own},
        {"GET", "/api/v1/runs/{run}/forecasts", Right::watch, &Api::list_forecasts, Query::own},
        {"POST", "/api/v1/runs/{run}/forecasts", Right::command, &Api::post_forecast, Query::none, "forecast",
         Audited::all, Body::whole, false},
        {"GET", "/api/v1/runs/{run}/forecasts/{forecast}", Right::watch, &Api::get_forecast},
        {"POST", "/api/v1/runs/{run}/forecasts/{forecast}/cancel", Right::command, &Api::cancel_forecast, Query::none,
         "forecast", Audited::all, Body::brief, false},
        {"POST", "/api/v1/runs/{run}/procedures", Right::command, &Api::begin_procedure, Query::none, "procedure"},
        {"GET", "/api/v1/runs/{run}/procedures/{number}/acts", Right::watch, &Api::list_procedure_acts},
        {"POST", "/api/v1/runs/{run}/procedures/{number}/acts", Right::command, &Api::post_procedure_act, Query::none,
         "procedure"},
        {"POST", "/api/v1/runs/{run}/positions", Right::command, &Api::post_position_act, Query::none, "position"},
        {"GET", "/api/v1/runs/{run}/{question}", Right::watch, &Api::run_question, Query::own},
        {"GET", "/api/v1/layouts", Right::watch, &Api::list_layouts, Query::own},
        {"PUT", "/api/v1/layouts/{layout}", Right::watch, &Api::put_layout, Query::none, "layout"},
        {"DELETE", "/api/v1/layouts/{layout}", Right::watch, &Api::remove_layout, Query::none, "layout"},
        {"GET", "/api/v1/scenarios", Right::watch, &Api::list_scenarios, Query::own},
        {"GET", "/api/v1/plans", Right::instruct, &Api::list_plans, Query::own, "plan", Audited::refusals},
        {"GET", "/api/v1/procedures", Right::watch, &Api::list_procedures, Query::own},
        {"GET", "/api/v1/procedures/{procedure}", Right::watch, &Api::get_procedure, Query::own},
        {"GET", "/api/v1/dictionary", Right::watch, &Api::dictionary},
        {"GET", "/api/v1/openapi.yaml", Right::open, &Api::openapi},
        {"GET", "/api/v1/schema", Right::open, &Api::list_schema},
        {"GET", "/api/v1/schema/{file}", Right::open, &Api::schema},
        {"GET", "/api/v1/rehearsals", Right::watch, &Api::list_rehearsals},
        {"POST", "/api/v1/rehearsals", Right::rehearse, &Api::start_rehearsal, Query::none, "rehearsal", Audited::all,
         Body::whole},
        {"GET", "/api/v1/rehearsals/current", Right::watch, &Api::current_rehearsal},
        {"POST", "/api/v1/rehearsals/current", Right::rehearse, &Api::control_rehearsal, Query::none, "rehearsal",
         Audited::all, Body::whole},
        {"PATCH", "/api/v1/rehearsals/current", Right::rehearse, &Api::control_rehearsal, Query::none, "rehearsal",
         Audited::all, Body::whole},
        {"GET", "/api/v1/campaigns", Right::watch, &Api::list_campaigns, Query::own},
        {"POST", "/api/v1/campaigns", Right::rehearse, &Api::start_campaign, Query::none, "campaign", Audited::all,
         Body::whole},
        {"GET", "/api/v1/campaigns/{campaign}", Right::watch, &Api::campaign_report},
        {"GET", "/api/v1/campaigns/{campaign}/touchdowns", Right::watch, &Api::campaign_touchdowns, Query::own},
        {"POST", "/api/v1/campaigns/{campaign}/cancel", Right::rehearse, &Api::cancel_campaign, Query::none,
         "campaign"},
        {"GET", "/api/v1/stream", Right::watch, &Api::stream},
        {"GET", "/healthz", Right::open, &Api::health},
        {"GET", "/metrics", Right::watch, &Api::metrics},
    };
    return all;
}

namespace {

/// The standard calls; a list that breaks a rule is told in the log, and there are none.
procedures::CallList calls_of(const instruction::PlanLibrary& library) {
    auto calls = library.calls();
    if (calls) return std::move(*calls);
    spdlog::error("no standard calls: {}", calls.error().message);
    return {};
}

}  // namespace

Api::Api(Parts parts)
    : parts_(std::move(parts)), calls_(calls_of(parts_.plans)),
      dictionary_json_(to_json_by_rows(dictionary_reply(parts_.dictionary, calls_), "channels")) {}

void Api::count(const std::string& route, unsigned status) {
    const std::scoped_lock lock{counts_mutex_};
    ++responses_[{route, status}];
}

Respond Api::counted(std::string route, const Respond& respond) {
    return [this, route = std::move(route), respond](HttpResponse response) {
        count(route, response.status);
        respond(std::move(response));
    };
}

void Api::handle(HttpRequest request, const Respond& respond_with) {
    const auto give = in_accepted_coding(request, respond_with);
    const std::string_view method = request.method == "HEAD" ? "GET" : std::string_view{request.method};
    const std::string path = request.path;
    std::vector<std::string_view> others;
    for (const auto& route : routes()) {
        auto parts = parts_of(route.path, path);
        if (!parts) continue;
        if (route.method == method) {
            auto who = parts_.access.identify(request.credentials);
            const auto counts = counted(fmt::format("{} {}", route.method, route.path), give);
            return answer(route, {std::move(request), std::move(who), std::move(*parts), counts});
        }
        if (std::ranges::find(others, route.method) == others.end()) others.push_back(route.method);
    }
    const auto respond = counted("none", give);
    if (!others.empty()) return respond(wrong_method(request.method, path, others));
    if (!StaticFiles::may_have(path))
        return respond(
            error_response(404, fmt::format("{}: there is no such route; /api/v1/openapi.yaml lists them", path)));
    if (method != "GET") return respond(wrong_method(request.method, path, {"GET"}));
    auto who = parts_.access.identify(request.credentials);
    answer_on_query_thread(
        {std::move(request), std::move(who), {}, respond},
        [this, path](archive::Reader&) { return parts_.console.file(path); }, JobPriority::at_once);
}

std::size_t Api::body_octets(const Credentials& credentials, std::string_view method, std::string_view path) const {
    const auto who = parts_.access.identify(credentials);
    const auto route = std::ranges::find_if(
        routes(), [&](const Route& each) { return each.method == method && parts_of(each.path, path); });
    if (route == routes().end() || !who.role || !may(who, route->right)) return body_of_nobody_octets_max;
    return route->body == Body::whole ? HttpRequest::body_octets_max : brief_body_octets_max;
}

void Api::answer(const Route& route, ApiRequest call) {
    const bool changes = route.method != "GET";
    auto refused = refusal_of(call.who, route.right);
    if (refused.status == 200 && !changes && route.query == Query::none && route.path.starts_with(api_prefix))
        if (const auto none = QueryText::parse(call.request.query, {}); !none)
            refused = error_response(400, none.error());
    const bool of_run = route.path.starts_with("/api/v1/runs/{run}");
    if (refused.status == 200 && of_run && call.parts[0] != "latest" && !run_id(call.parts[0]))
        refused =
            error_response(404, fmt::format("run '{}': there is none; a number or 'latest' is wanted", call.parts[0]));
    if (refused.status == 200 && changes && !parts_.pipeline.audit_has_room())
        return call.respond(disk_response("nothing is done that the audit cannot take: " + parts_.pipeline.fault()));
    const bool of_origin = changes && (route.right == Right::command || route.right == Right::rehearse);
    const bool asks_origin = of_origin && parts_.to_origin && route.right == Right::command && route.for_origin;
    if (refused.status == 200 && of_origin && !asks_origin && !parts_.follows.empty())
        refused = error_response(409, parts_.follows);
    const bool refuses = refused.status != 200;
    if (of_run && call.parts[0] == "latest") name_latest(call);
    if (!refuses && asks_origin) return parts_.to_origin(call);  // which audits it
    if (!route.audit.empty() && (refuses || route.audited == Audited::all)) call.respond = audited(call, route.audit);
    if (refuses) return call.respond(std::move(refused));
    (this->*route.answer)(call);
}

bool Api::is_for_origin(std::string_view method, std::string_view path) {
    return method != "GET" && std::ranges::any_of(routes(), [&](const Route& route) {
               return route.right == Right::command && route.for_origin && route.method == method &&
                      path.starts_with('/') && parts_of(route.path, path);
           });
}

void Api::name_latest(ApiRequest& call) const {
    const auto since_start = parts_.follows.empty() ? parts_.rehearsals.current().run() : 0;
    const auto run = since_start != 0 ? since_start : parts_.hub.current_run();
    if (run == 0) return;
    call.parts[0] = std::to_string(run);
    const std::string_view latest = "latest";
    call.request.path.replace(call.request.path.find(latest), latest.size(),
                              call.parts[0]);  // the audit records it too
}

Respond Api::audited(const ApiRequest& call, std::string_view action) {
    if (!call.who.role) return call.respond;  // not logged in: anybody could fill the audit
    const bool has_password = call.request.path.starts_with("/api/v1/users");
    return [this, who = call.who, action,
            detail =
                fmt::format("{} {} {}", call.request.method, call.request.path, has_password ? "" : call.request.body),
            respond = call.respond](HttpResponse response) {
        const std::string outcome =
            response.status < 400 ? "done" : fmt::format("refused ({}): {}", response.status, response.body);
        parts_.pipeline.audit(audit_record(who, action, detail, outcome),
                              [respond, response = std::move(response)] { respond(response); });
    };
}

Respond Api::refusal_audited(const ApiRequest& call, std::string_view action) {
    return [respond = call.respond, audited = audited(call, action)](HttpResponse response) {
        (response.status == 403 ? audited : respond)(std::move(response));
    };
}

void Api::note(const Operator& who, std::string_view action, std::string detail, const std::string& outcome) {
    parts_.pipeline.audit(audit_record(who, action, std::move(detail), outcome));
}

void Api::answer_on_query_thread(const ApiRequest& call, std::function<HttpResponse(archive::Reader&)> answer,
                                 JobPriority priority) {
    const auto job = [answer = std::move(answer), respond = call.respond](archive::Reader& reader) {
        respond(answered([&] { return answer(reader); }));
    };
    if (!parts_.queries.ask(job, {client_of(call.who), {}}, priority)) call.respond(busy_response());
}

void Api::run_question(const ApiRequest& call) {
    const auto& run = call.parts[0];
    const std::string what = call.parts.size() == 2 ? call.parts[1] : "";
    const auto& respond = call.respond;
    const auto* question = server::run_question(what);
    if (question == nullptr)
        return respond(error_response(
            404, fmt::format("'{}' cannot be asked of a run; these can: {}", what, run_question_names())));
    auto query = QueryText::parse(call.request.query, question->parameters);
    if (!query) return respond(error_response(400, query.error()));
    if (!question->formats.empty())  // before the archive is queried for nothing
        if (const auto format = query->one_of("format", question->formats); !format)
            return respond(error_response(400, format.error()));
    auto asked_by = call;
    if (question->refused_for_instructors) asked_by.respond = refusal_audited(call, "plan");
    const auto& dictionary = parts_.dictionary;
    const auto& plans = parts_.plans;
    // Pace and clocks of the current run are not in the archive.
    const auto current = current_run();
    if (const auto id = run_id(run); what.empty() && id && id->value == current.run())
        return respond(json_response(current));
    ask(
        asked_by, std::move(*query),
        [&dictionary, &plans, &queries = parts_.queries, asker = Asker{client_of(call.who), call.request.disconnected},
         clock = clock(), instructor = may(call.who, Right::instruct), answer = question->answer,
         path = call.request.path,
         asked = call.request.query](archive::Reader& reader, archive::RunId id, const QueryText& asked_of) {
            const auto parts = [&queries, asker](ReadPart read) { return in_parts(queries, asker, std::move(read)); };
            auto response = answer({dictionary, plans, clock(id), instructor, parts}, reader, id, asked_of);
            add_next_link(response, path, asked);
            return response;
        },
        what.empty() ? JobPriority::soon : JobPriority::in_turn);
}

std::function<std::optional<Ert>(archive::RunId)> Api::clock() const {
    return [current = parts_.hub.current_run(), now = parts_.hub.ert_now()](archive::RunId run) {
        return run.value == current ? now : std::nullopt;
    };
}

void Api::ask(const ApiRequest& call, QueryText query, RunQuestion question, JobPriority priority) {
    const auto job = [run = call.parts[0], query = std::move(query), question = std::move(question),
                      respond = call.respond](archive::Reader& reader) {
        auto id = run_id(run);
        if (!id) {  // no run since the server started
            const auto runs = reader.runs({.limit = 1});
            if (!runs) return respond(error_response(500, runs.error()));
            if (runs->runs().empty()) return respond(error_response(404, "run 'latest': no run has been recorded yet"));
            id = archive::RunId{static_cast<std::uint32_t>(runs->runs(0).run())};
        } else if (const auto known = reader.run(*id); !known) {
            return respond(error_response(404, known.error()));
        }
        bool later = false;
        auto response = std::optional{answered([&] {
            auto given = question(reader, *id, query);
            later = !given;
            return given.value_or(HttpResponse{});
        })};
        if (later) return;
        if (reader.stopped()) response = stopped_response("ask for less, by from and to, points or limit");
        respond(std::move(*response));
    };
    if (!parts_.queries.ask(job, {client_of(call.who), call.request.disconnected}, priority))
        call.respond(busy_response());
}

void Api::answer_page(const ApiRequest& call, const ListPage::Limits& limits, AnswerPage answer, JobPriority priority) {
    auto wanted = ListRequest::of(call.request, limits);
    if (!wanted) return call.respond(error_response(400, wanted.error()));
    answer_on_query_thread(
        call,
        [answer = std::move(answer), wanted = std::move(*wanted)](archive::Reader& reader) {
            return answer(reader, wanted);
        },
        priority);
}

void Api::list_runs(const ApiRequest& call) {
    auto limits = ListPage::usual(archive::Order::newest_first);
    limits.after_max = UINT32_MAX;
    answer_page(call, limits, [current = current_run()](archive::Reader& reader, const ListRequest& wanted) {
        const auto& page = wanted.page;
        auto runs = reader.runs({static_cast<std::uint32_t>(page.after), page.limit, page.order});
        if (!runs) return error_response(500, runs.error());
        for (auto& run : *runs->mutable_runs())
            if (run.run() == current.run()) run = current;
        write_time_texts(*runs);
        return wanted.response(std::move(*runs), {"runs"});
    });
}

void Api::list_scenarios(const ApiRequest& call) {
    answer_page(call, ListPage::usual(archive::Order::oldest_first),
                [this](archive::Reader&, const ListRequest& wanted) {
                    return wanted.response_of_whole(parts_.scenarios.list(), {"scenarios"});
                });
}

void Api::list_plans(const ApiRequest& call) {
    answer_page(call, ListPage::usual(archive::Order::oldest_first),
                [this](archive::Reader&, const ListRequest& wanted) {
                    return wanted.response_of_whole(parts_.plans.list(), {"plans"});
                });
}

void Api::dictionary(const ApiRequest& call) {
    answer_on_query_thread(  // where it may be compressed: it is long
        call, [this](archive::Reader&) { return HttpResponse{200, "application/json", "no-store", dictionary_json_}; },
        JobPriority::at_once);
}

void Api::stream(const ApiRequest& call) {
    call.respond(upgrade_response("the stream is a WebSocket: ask for an upgrade, with one of the subprotocols "
                                  "aeolis.v1.protobuf, aeolis.v1.json"));
}

void Api::health(const ApiRequest& call) {
    const std::string fault = parts_.pipeline.fault();
    // File names are shown only to those with the right to watch.
    const std::string text = fault.empty()                 ? "ok"
                             : may(call.who, Right::watch) ? fault
                                                           : "the archive cannot be written";
    const auto others = parts_.replication && may(call.who, Right::watch) ? parts_.replication().line : "";
    HttpResponse response{fault.empty() ? 200U : 503U, "text/plain; charset=utf-8", "no-store",
                          text + (others.empty() ? "\n" : "\n" + others + "\n")};
    if (!fault.empty()) response.fields.emplace_back("Retry-After", std::to_string(disk_retry.count()));
    call.respond(std::move(response));
}

void Api::remove_run(const ApiRequest& call) {
    const auto run = run_id(call.parts[0]);
    if (!run) return call.respond(error_response(409, "name the run by its number: what is gone is gone"));
    if (run->value == parts_.hub.current_run())
        return call.respond(error_response(
            409, fmt::format("run {}: the consoles show it; it can be removed when another has begun", run->value)));
    const auto done = [respond = call.respond](const Result<void>& pruned) {
        respond(pruned ? HttpResponse{204, "application/json", "no-store", ""} : error_response(404, pruned.error()));
    };
    if (!parts_.pipeline.prune(*run, audit_record(call.who, "prune", "", ""), done))
        call.respond(full_response("nothing was removed, too much waits to be stored: try again"));
}

v1::RunState Api::current_run() const {
    if (!parts_.follows.empty()) return parts_.hub.state();
    auto state = parts_.rehearsals.current();
    if (state.run() != 0) {
        state.set_last_seq(parts_.hub.last_seq());
        state.set_archive_fault(parts_.pipeline.fault());
    }
    return state;
}

}  // namespace aeolis::server
