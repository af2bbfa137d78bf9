#include "server/api/api.hpp"

#include "server/api/dictionary_reply.hpp"
#include "server/api/json.hpp"
#include "server/api/openapi.hpp"
#include "server/api/query_text.hpp"
#include "server/api/run_questions.hpp"

#include <charconv>
#include <fmt/format.h>
#include <fstream>
#include <sstream>
#include <unistd.h>

namespace aeolis::server {
namespace {

constexpr std::string_view api_prefix = "/api/v1/";

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

HttpResponse json_response(const google::protobuf::Message& message, unsigned status = 200) {
    HttpResponse response;
    response.status = status;
    response.body = to_json(message);
    return response;
}

HttpResponse wrong_method(const HttpRequest& request, std::string_view right) {
    return error_response(405, fmt::format("{} {}: only {} here", request.method, request.path, right));
}

std::uint64_t resident_octets() {
    std::ifstream statm{"/proc/self/statm"};
    std::uint64_t size_pages = 0, resident_pages = 0;
    statm >> size_pages >> resident_pages;
    return resident_pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

} // namespace

HttpResponse error_response(unsigned status, const std::string& error) {
    v1::ErrorReply reply;
    reply.set_error(error);
    return json_response(reply, status);
}

Api::Api(Parts parts) : parts_(std::move(parts)), dictionary_json_(to_json(dictionary_reply(parts_.dictionary))) {}

void Api::handle(const HttpRequest& request, const Respond& respond) {
    if (request.path.starts_with(api_prefix)) return handle_api(request, respond);
    if (request.method != "GET" && request.method != "HEAD") return respond(wrong_method(request, "GET"));
    if (request.path == "/healthz") {
        const std::string fault = parts_.pipeline.fault();
        return respond({fault.empty() ? 200U : 503U, "text/plain; charset=utf-8", "no-store", (fault.empty() ? "ok" : fault) + "\n"});
    }
    if (request.path == "/metrics") return respond(metrics());
    const bool taken = parts_.queries.ask(
        [this, path = request.path, respond](archive::Reader&) { respond(parts_.console.file(path)); });
    if (!taken) respond(error_response(503, "too many questions wait: try again"));
}

void Api::handle_api(const HttpRequest& request, const Respond& respond) {
    const auto parts = split(std::string_view{request.path}.substr(api_prefix.size()));
    const auto get_only = [&](auto&& answer) {
        if (request.method != "GET" && request.method != "HEAD") return respond(wrong_method(request, "GET"));
        const auto none = QueryText::parse(request.query, {});
        if (!none) return respond(error_response(400, none.error().message));
        answer();
    };
    const std::string first = parts.empty() ? "" : parts[0];
    if (first == "runs" && parts.size() == 1) return get_only([&] { list_runs(respond); });
    if (first == "runs" && parts.size() <= 3)
        return handle_run(request, parts[1], parts.size() == 3 ? parts[2] : "", respond);
    if (first == "scenarios" && parts.size() == 1) return get_only([&] { list_scenarios(respond); });
    if (first == "dictionary" && parts.size() == 1)
        return get_only([&] { respond({200, "application/json", "no-store", dictionary_json_}); });
    if (first == "openapi.yaml" && parts.size() == 1)
        return get_only([&] { respond({200, "application/yaml", "no-cache", std::string{openapi_text}}); });
    if (first == "rehearsals" && parts.size() == 1) return rehearsals(request, false, respond);
    if (first == "rehearsals" && parts.size() == 2 && parts[1] == "current") return rehearsals(request, true, respond);
    if (first == "stream" && parts.size() == 1)
        return respond(error_response(426, "the stream is a WebSocket: ask for an upgrade, with one of the "
                                           "subprotocols aeolis.v1.protobuf, aeolis.v1.json"));
    respond(
        error_response(404, fmt::format("{}: there is no such route; /api/v1/openapi.yaml lists them", request.path)));
}

void Api::handle_run(const HttpRequest& request, const std::string& run, const std::string& what,
                     const Respond& respond) {
    if (run != "latest" && !run_id(run))
        return respond(
            error_response(404, fmt::format("run '{}': there is none; a number or 'latest' is wanted", run)));
    if (what == "commands" && request.method == "POST") return post_command(request, run, respond);
    const auto* question = run_question(what);
    if (question == nullptr)
        return respond(error_response(
            404, fmt::format("'{}' cannot be asked of a run; these can: {}", what, run_question_names())));
    if (request.method != "GET" && request.method != "HEAD")
        return respond(wrong_method(request, what == "commands" ? "GET and POST" : "GET"));
    auto query = QueryText::parse(request.query, question->parameters);
    if (!query) return respond(error_response(400, query.error().message));
    const auto& dictionary = parts_.dictionary;
    // What the archive cannot know of the run that goes on: its pace and its clocks.
    const auto current = current_run();
    if (what.empty() && current.run() != 0 && (run == "latest" || run_id(run)->value == current.run()))
        return respond(json_response(current));
    ask(
        run, std::move(*query),
        [&dictionary, answer = question->answer](archive::Reader& reader, archive::RunId id, const QueryText& asked) {
            return answer(dictionary, reader, id, asked);
        },
        respond);
}

void Api::ask(const std::string& run, QueryText query, RunQuestion question, const Respond& respond) {
    const auto job = [run, query = std::move(query), question = std::move(question), respond](archive::Reader& reader) {
        auto id = run_id(run);
        if (!id) {
            const auto runs = reader.runs();
            if (!runs) return respond(error_response(500, runs.error().message));
            if (runs->runs().empty()) return respond(error_response(404, "run 'latest': no run has been recorded yet"));
            id = archive::RunId{static_cast<std::uint32_t>(runs->runs(0).run())};
        } else if (const auto known = reader.run(*id); !known) {
            return respond(error_response(404, known.error().message));
        }
        respond(question(reader, *id, query));
    };
    if (!parts_.queries.ask(job)) respond(error_response(503, "too many questions wait: try again"));
}

void Api::list_runs(const Respond& respond) {
    const bool taken = parts_.queries.ask(
        [respond, current = current_run()](archive::Reader& reader) {
            auto runs = reader.runs();
            if (!runs) return respond(error_response(500, runs.error().message));
            for (auto& run : *runs->mutable_runs())
                if (run.run() == current.run()) run = current;
            respond(json_response(*runs));
        });
    if (!taken) respond(error_response(503, "too many questions wait: try again"));
}

void Api::list_scenarios(const Respond& respond) {
    const bool taken =
        parts_.queries.ask([this, respond](archive::Reader&) { respond(json_response(parts_.scenarios.list())); });
    if (!taken) respond(error_response(503, "too many questions wait: try again"));
}

void Api::rehearsals(const HttpRequest& request, bool current, const Respond& respond) {
    // What cannot be done now may be asked again later; what makes no sense may not.
    const bool going_on = parts_.desk.going_on();
    const auto began = [respond, refused = going_on ? 409U : 422U](const Result<v1::RunState>& state) {
        respond(state ? json_response(*state, 201) : error_response(refused, state.error().message));
    };
    if (request.method == "GET" || request.method == "HEAD") {
        v1::RunList list;
        if (const auto state = current_run(); state.run() != 0) *list.add_runs() = state;
        if (!current) return respond(json_response(list));
        if (list.runs().empty())
            return respond(error_response(404, "no rehearsal was started since the server came up"));
        return respond(json_response(list.runs(0)));
    }
    if (!current && request.method == "POST") {
        v1::StartRehearsal start;
        if (const auto parsed = from_json(request.body, start); !parsed)
            return respond(error_response(400, parsed.error().message));
        return parts_.desk.start(start, began);
    }
    if (current && (request.method == "POST" || request.method == "PATCH")) {
        v1::RehearsalControl control;
        if (const auto parsed = from_json(request.body, control); !parsed)
            return respond(error_response(400, parsed.error().message));
        const bool starts = control.action_case() == v1::RehearsalControl::kStart;
        const auto done = parts_.desk.control(control, began);
        if (!done) return respond(error_response(going_on ? 422 : 409, done.error().message));
        if (!starts) respond(json_response(current_run(), 202));
        return;
    }
    respond(wrong_method(request, current ? "GET, POST and PATCH" : "GET and POST"));
}

void Api::post_command(const HttpRequest& request, const std::string& run, const Respond& respond) {
    v1::CommandRequest command;
    if (const auto parsed = from_json(request.body, command); !parsed)
        return respond(error_response(400, parsed.error().message));
    const auto id = run_id(run);
    if (id && command.run() != 0 && command.run() != id->value)
        return respond(error_response(400, fmt::format("run: the path says {}, the body {}", run, command.run())));
    if (id) command.set_run(id->value);
    const unsigned refused = parts_.dictionary.command(command.command()) == nullptr ? 422 : 409;
    parts_.desk.command(std::move(command), [respond, refused](const v1::CommandReply& reply) {
        respond(json_response(reply, reply.accepted() ? 202 : refused));
    });
}

v1::RunState Api::current_run() const {
    auto state = parts_.desk.current();
    if (state.run() != 0) {
        state.set_last_seq(parts_.hub.last_seq());
        state.set_archive_fault(parts_.pipeline.fault());
    }
    return state;
}

HttpResponse Api::metrics() const {
    const auto pipeline = parts_.pipeline.figures();
    const auto& hub = parts_.hub.figures;
    std::ostringstream text;
    const auto write = [&](const char* name, const char* type, const char* help, double value) {
        text << "# HELP aeolis_" << name << ' ' << help << "\n# TYPE aeolis_" << name << ' ' << type << "\naeolis_"
             << name << ' ' << fmt::format("{}", value) << '\n';
    };
    const auto count = [](auto value) { return static_cast<double>(value); };
    write("archive_deliveries_total", "counter", "deliveries taken by the pipeline", count(pipeline.deliveries));
    write("archive_deliveries_waiting", "gauge", "deliveries in the pipeline's queue", count(pipeline.waiting));
    write("archive_commits_published_total", "counter", "group commits published", count(pipeline.published_batches));
    write("archive_failed_commits_total", "counter", "commits that failed and were tried again",
          count(pipeline.failed_commits));
    write("items_published_total", "counter", "items made durable and published", count(pipeline.published_items));
    write("connections", "gauge", "open HTTP and WebSocket connections", count(parts_.connections()));
    write("stream_clients", "gauge", "WebSocket clients", count(parts_.hub.sessions()));
    write("stream_encodings_total", "counter", "batches encoded", count(hub.encodings));
    write("stream_shared_total", "counter", "batches sent in another client's encoding", count(hub.shared));
    write("stream_archive_pages_total", "counter", "pages that clients read from the archive",
          count(hub.archive_pages));
    write("stream_refusals_total", "counter", "client messages that were refused", count(hub.refusals));
    write("queries_total", "counter", "questions to the archive", count(parts_.queries.asked()));
    write("queries_waiting", "gauge", "questions that wait for a query thread", count(parts_.queries.waiting()));
    write("run", "gauge", "number of the current run", count(parts_.desk.current().run()));
    write("run_attained_pace", "gauge", "seconds of the vehicle a second", parts_.desk.current().attained_pace());
    write("resident_memory_bytes", "gauge", "resident memory of the process", count(resident_octets()));
    return {200, "text/plain; version=0.0.4; charset=utf-8", "no-store", text.str()};
}

} // namespace aeolis::server
