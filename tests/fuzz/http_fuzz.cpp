// SPDX-License-Identifier: Apache-2.0
// Octets as a peer may send them for an HTTP request, through the parser with the server's limits, to every route: no
// file outside the console's folder is given out, nothing takes long, and what is refused is refused in words.
#include "server/api/api.hpp"
#include "server/base/json.hpp"
#include "server/net/web_server.hpp"
#include "tests/fuzz/recorded_run.hpp"

#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http.hpp>
#include <boost/url/parse.hpp>
#include <fstream>
#include <spdlog/spdlog.h>

namespace {

using namespace aeolis;
using namespace aeolis::server;
namespace http = boost::beast::http;

constexpr const char* secret = "not for the console";

/// All of `aeolis serve` but sockets and threads of its own. Nothing can be started: what a start checks is
/// request_fuzz's.
struct Server {
    Server() {
        std::filesystem::create_directories(recorded.folder / "web/assets");
        std::ofstream{recorded.folder / "web/index.html"} << "the console";
        std::ofstream{recorded.folder / "web/assets/a.js"} << "1";
        std::ofstream{recorded.folder / "secret.txt"} << secret;
        std::filesystem::create_symlink(recorded.folder / "secret.txt", recorded.folder / "web/link.txt");
        rehearsals.close("nothing can be started here");
        campaigns.close("nothing can be started here");
    }
    static StreamHub::Services no_services() {
        StreamHub::Services services;
        services.want_items = [](bool) {};
        return services;
    }

    test::RecordedRun recorded;
    ScenarioLibrary scenarios{AEOLIS_SOURCE_DIR "/simulation/scenarios"};
    instruction::PlanLibrary plans{{}, recorded.dictionary};
    StaticFiles console{recorded.folder / "web"};
    std::unique_ptr<QueryThreads> queries = std::move(QueryThreads::open(recorded.file(), recorded.dictionary)).value();
    PipelineThread pipeline{std::move(archive::Archive::open(recorded.file())).value(),
                            recorded.dictionary,
                            PipelineThread::Faults::hold,
                            {}};
    StreamHub hub{recorded.dictionary.id, no_services()};
    RehearsalManager rehearsals{scenarios,
                                plans,
                                recorded.dictionary,
                                pipeline,
                                [](const auto& action) { action(); },
                                [](const v1::StartRehearsal&, const auto& done) { done(Error{"was not cut off"}); },
                                {[](archive::RunId, const auto&, bool, const auto& done) { done(std::string{}); },
                                 [](archive::RunId, const auto& done) { done(TimelineCheck::Reanalysis{}); }},
                                {[](const auto&) {}, [](const auto&) {}}};
    campaign::CampaignManager campaigns{recorded.folder / "campaigns", scenarios, recorded.dictionary};
    std::shared_ptr<shadow::ForecastService> forecasts = std::make_shared<shadow::ForecastService>(
        recorded.dictionary, recorded.file(), [](const auto&, const auto&) { return false; });
    PredictionService predictions{recorded.dictionary};
    std::unique_ptr<Access> access = std::move(Access::open({})).value();
    ClockWatch clock_watch;
    Api api{{recorded.dictionary, scenarios, plans, *queries, rehearsals, predictions, campaigns, forecasts, hub,
             pipeline, console, *access, false, [] { return std::size_t{1}; }, clock_watch}};
};

HttpResponse ask(Server& server, const HttpRequest& request) {
    std::promise<HttpResponse> answered;
    server.api.handle(request, [&](HttpResponse response) { answered.set_value(std::move(response)); });
    auto response = answered.get_future().get();
    for (bool more = response.next_part != nullptr; more;) {
        std::promise<BodyPart> told;
        response.next_part([&](BodyPart part) { told.set_value(std::move(part)); });
        const auto part = told.get_future().get();
        more = part && *part;
        if (more) response.body += **part;
    }
    return response;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    // OpenSSL cleans up behind itself at exit: first used here, that comes after the server has written its last entry
    // of the audit.
    static const std::string openssl_first = archive::audit_hash({}, {});
    static Server server;
    spdlog::set_level(spdlog::level::off);
    http::request_parser<http::string_body> parser;
    parser.eager(true);
    parser.body_limit(HttpRequest::body_octets_max);
    parser.header_limit(WebServer::header_octets_max);
    boost::system::error_code error;
    parser.put(boost::asio::buffer(data, size), error);
    if (!error && parser.is_header_done() && !parser.is_done()) parser.put_eof(error);
    if (error || !parser.is_done()) return 0;
    auto request = parser.release();
    const auto target = boost::urls::parse_origin_form({request.target().data(), request.target().size()});
    if (!target) return 0;
    const HttpRequest asked{std::string{request.method_string()}, target->path(), std::string{target->encoded_query()},
                            request.body()};
    const auto answer = ask(server, asked);
    if (answer.status < 200 || answer.status > 599 || answer.status == 500 || answer.content_type.empty()) std::abort();
    if (answer.body.find(secret) != std::string::npos) std::abort();
    if (answer.status >= 400 && asked.path.starts_with("/api/")) {  // a problem, of whatever it is
        if (answer.content_type != "application/problem+json") std::abort();
        v1::ErrorReply problem;
        v1::CommandReply command;
        v1::SequenceReply file;
        const auto said = from_json(answer.body, problem)   ? problem.detail()
                          : from_json(answer.body, command) ? command.detail()
                          : from_json(answer.body, file)    ? file.detail()
                                                            : std::string{};
        if (said.empty()) std::abort();
    }
    return 0;
}
