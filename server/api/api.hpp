// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"
#include "server/access/access.hpp"
#include "server/api/command_rates.hpp"
#include "server/api/http_message.hpp"
#include "server/api/list_response.hpp"
#include "server/api/procedure_library.hpp"
#include "server/api/query_threads.hpp"
#include "server/api/static_files.hpp"
#include "server/api/stream_hub.hpp"
#include "server/base/clock_watch.hpp"
#include "server/campaign/campaign_manager.hpp"
#include "server/pipeline/pipeline_thread.hpp"
#include "server/rehearsal/prediction_service.hpp"
#include "server/rehearsal/rehearsal_manager.hpp"
#include "server/scenario/scenario_library.hpp"
#include "server/shadow/forecast_service.hpp"

#include <atomic>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace aeolis::server {

class QueryText;

/// A request with its operator, the path's parts in the route's braces, and the response callback.
struct ApiRequest {
    HttpRequest request;
    Operator who;
    std::vector<std::string> parts;
    Respond respond;
};

/// How this server stands with others, for /healthz and /metrics (docs/scale.md).
struct Replication {
    struct Figure {
        const char* name;
        const char* help;
        double value = 0.0;
        bool counter = false;
    };
    std::string line;  ///< of /healthz, for those who may watch; empty: it is alone
    std::vector<Figure> figures{};
};

/// Every HTTP route (server/api/openapi.yaml describes them): turns requests into queries and answers into JSON.
///
/// Thread   handle() on the network thread; archive queries run on the query threads
/// Access   each route names the right it requires; without it: 401 or 403. Every change is written to the audit
/// Faults   an answer other than 2xx is a problem: ErrorReply with one sentence that names the fault
class Api {
  public:
    struct Parts {
        const dictionary::Dictionary& dictionary;
        const ScenarioLibrary& scenarios;
        const instruction::PlanLibrary& plans;
        QueryThreads& queries;
        RehearsalManager& rehearsals;
        PredictionService& predictions;
        campaign::CampaignManager& campaigns;
        std::shared_ptr<shadow::ForecastService> forecasts;
        StreamHub& hub;
        PipelineThread& pipeline;
        const StaticFiles& console;
        Access& access;
        bool secure;  ///< over TLS: cookies are marked Secure
        std::function<std::size_t()> connections;
        const ClockWatch& clock_watch;
        std::function<Replication()> replication{};  ///< null: this server is alone
        std::string follows{};  ///< why this server changes no run, in a sentence; empty: it is the origin of its runs
        /// Gives a request that is for the origin to it; null: it is refused with `follows`.
        std::function<void(const ApiRequest&)> to_origin{};
        ProcedureLibrary procedures{};
        std::filesystem::path archive{};  ///< its file, for what goes to other servers as it is
    };
    explicit Api(Parts parts);

    void handle(HttpRequest request, const Respond& respond_with);
    /// Counts a response for the metrics. From any thread.
    void count(const std::string& route, unsigned status);
    /// Whether people at a follower may ask this of their origin: commands, notes, actions on alarms.
    static bool is_for_origin(std::string_view method, std::string_view path);
    /// Why an operator must send no more commands now, and for how long.
    struct TooMany {
        std::string reason;
        std::chrono::seconds wait;
    };
    /// Counts commands of this operator. Returns why they must not be sent now; none: they may.
    std::optional<TooMany> count_commands(const Operator& who, std::size_t commands);
    /// The largest body accepted from this peer for this path. The body of a request that will be refused is not read,
    /// since reading takes the network thread's time.
    std::size_t body_octets(const Credentials& credentials, std::string_view method, std::string_view path) const;
    /// A question about one run. None: the answer comes later. `respond` is called on the thread that has the answer.
    using RunQuestion = std::function<std::optional<HttpResponse>(archive::Reader&, archive::RunId, const QueryText&)>;

    enum class Query { none, own };        ///< the query string: not allowed, or parsed by the handler
    enum class Body { brief, whole };      ///< whole: large enough for a scenario or a command file
    enum class Audited { all, refusals };  ///< refusals: the handler audits the rest (not dry runs)
    struct Route {
        std::string_view method;  ///< GET also answers HEAD
        std::string_view path;    ///< "{…}" matches one part
        Right right;
        void (Api::*answer)(const ApiRequest&);
        Query query = Query::none;
        std::string_view audit{};  ///< action in the audit; empty: no change, or the handler writes it
        Audited audited = Audited::all;
        Body body = Body::brief;
        /// Whether a follower hands a request with the right to command to its origin; false: it refuses it.
        bool for_origin = true;
    };
    static std::span<const Route> routes();

  private:
    void run_question(const ApiRequest& call);
    void list_runs(const ApiRequest& call);
    void remove_run(const ApiRequest& call);
    void list_scenarios(const ApiRequest& call);
    void list_plans(const ApiRequest& call);
    void dictionary(const ApiRequest& call);
    void stream(const ApiRequest& call);
    void health(const ApiRequest& call);
    // sample_export.cpp
    void export_samples(const ApiRequest& call);
    void export_raw(const ApiRequest& call);
    void export_rows(const ApiRequest& call);
    // prediction_routes.cpp
    void prediction(const ApiRequest& call);
    // schema_routes.cpp
    void openapi(const ApiRequest& call);
    void list_schema(const ApiRequest& call);
    void schema(const ApiRequest& call);
    // metrics.cpp
    void metrics(const ApiRequest& call);
    // rehearsal_routes.cpp
    void list_rehearsals(const ApiRequest& call);
    void current_rehearsal(const ApiRequest& call);
    void start_rehearsal(const ApiRequest& call);
    void control_rehearsal(const ApiRequest& call);
    // command_routes.cpp
    void post_command(const ApiRequest& call);
    void post_sequence(const ApiRequest& call);
    // annotation_routes.cpp
    void post_alarm(const ApiRequest& call);
    void post_note(const ApiRequest& call);
    using Annotated = std::variant<archive::Annotation, HttpResponse>;  ///< the latter says why not
    using Annotating = std::function<Annotated(archive::Reader&, archive::RunId, Ert now)>;
    void annotate(const ApiRequest& call, Annotating annotating);
    Annotated called(const v1::NoteRequest& wanted, archive::Reader& reader, archive::RunId id, Ert now);
    static Annotated read_back(const v1::NoteRequest& wanted, archive::Reader& reader, archive::RunId id, Ert now);
    // procedure_routes.cpp
    void list_procedures(const ApiRequest& call);
    void get_procedure(const ApiRequest& call);
    void begin_procedure(const ApiRequest& call);
    void post_procedure_act(const ApiRequest& call);
    void list_procedure_acts(const ApiRequest& call);
    /// The last says why not.
    using Acted = std::variant<archive::ProcedureActRecord, archive::PositionActRecord, HttpResponse>;
    using Acting = std::function<Acted(archive::Reader&, archive::RunId, Ert now)>;
    void act(const ApiRequest& call, Acting acting);
    void post_position_act(const ApiRequest& call);
    // layout_routes.cpp
    void list_layouts(const ApiRequest& call);
    void put_layout(const ApiRequest& call);
    void remove_layout(const ApiRequest& call);
    void change_layout(const ApiRequest& call, archive::LayoutChange change);
    // campaign_routes.cpp
    void list_campaigns(const ApiRequest& call);
    void start_campaign(const ApiRequest& call);
    void campaign_report(const ApiRequest& call);
    void campaign_touchdowns(const ApiRequest& call);
    void cancel_campaign(const ApiRequest& call);
    using CampaignQuestion =
        std::function<HttpResponse(const std::filesystem::path& file, const std::function<bool()>& stop)>;
    void ask_campaign(const ApiRequest& call, CampaignQuestion question);
    // forecast_routes.cpp
    void post_forecast(const ApiRequest& call);
    void list_forecasts(const ApiRequest& call);
    void get_forecast(const ApiRequest& call);
    void cancel_forecast(const ApiRequest& call);
    /// Answers of one forecast, or that there is none for who asks.
    void ask_forecast(const ApiRequest& call,
                      const std::function<HttpResponse(const archive::ForecastRecord&)>& answer);
    // access_routes.cpp
    void session(const ApiRequest& call);
    void log_in(const ApiRequest& call);
    void log_out(const ApiRequest& call);
    void list_users(const ApiRequest& call);
    void add_user(const ApiRequest& call);
    void change_user(const ApiRequest& call);
    void remove_user(const ApiRequest& call);
    void list_tokens(const ApiRequest& call);
    void add_token(const ApiRequest& call);
    void remove_token(const ApiRequest& call);
    void audit(const ApiRequest& call);

    void answer(const Route& route, ApiRequest call);
    /// Wraps the response callback so that the outcome is written to the audit.
    /// Audits the answer where it is 403.
    Respond refusal_audited(const ApiRequest& call, std::string_view action);
    Respond audited(const ApiRequest& call, std::string_view action);
    /// Replaces `latest` by a run number: the server's current or last run, else the newest of the archive. The same
    /// for every route.
    void name_latest(ApiRequest& call) const;
    void note(const Operator& who, std::string_view action, std::string detail, const std::string& outcome);
    /// Answers on a query thread with a page of a list that belongs to no run.
    using AnswerPage = std::function<HttpResponse(archive::Reader&, const ListRequest&)>;
    void answer_page(const ApiRequest& call, const ListPage::Limits& limits, AnswerPage answer,
                     JobPriority priority = JobPriority::soon);
    /// Answers on a query thread; 503 when too many jobs wait.
    void answer_on_query_thread(const ApiRequest& call, std::function<HttpResponse(archive::Reader&)> answer,
                                JobPriority priority = JobPriority::in_turn);
    void ask(const ApiRequest& call, QueryText query, RunQuestion question,
             JobPriority priority = JobPriority::in_turn);
    /// A function that gives the time on Earth in the current run; none for other runs.
    std::function<std::optional<Ert>(archive::RunId)> clock() const;
    v1::RunState current_run() const;  ///< including what only the stream knows; run 0: no run since the server started

    /// Counts the response, by route and status, for the metrics.
    Respond counted(std::string route, const Respond& respond);

    Parts parts_;
    procedures::CallList calls_;  ///< as they were when the server began
    std::string dictionary_json_;
    CommandRates command_rates_;
    const std::shared_ptr<std::atomic<int>> rows_under_way_ = std::make_shared<std::atomic<int>>(0);
    std::mutex counts_mutex_;
    /// By route and status. Refused log-ins count from 0, or an alert's increase() would not see the first ones.
    std::map<std::pair<std::string, unsigned>, std::uint64_t> responses_{{{"POST /api/v1/session", 401}, 0},
                                                                         {{"POST /api/v1/session", 429}, 0}};
};

/// The response when too many jobs wait for the query threads.
HttpResponse busy_response();
/// An error response with `status`; with 500 when the fault is the server's.
HttpResponse error_response(unsigned status, const Error& error);
/// 503: nothing was done, and the request may be sent again after a time: chosen by what is waited for. A request that
/// changes something and was taken all the same is answered without one (post_note).
HttpResponse full_response(const std::string& error);  ///< a queue, empty again within a second
HttpResponse disk_response(const std::string& error);  ///< a disk that refuses
HttpResponse json_response(const google::protobuf::Message& message, unsigned status = 200);
/// Makes a problem of a refused command, or command file: its reply, with the members of a problem beside its own. The
/// reply's reason is the problem's sentence.
template <typename Reply>
Reply as_problem(Reply reply, unsigned status) {
    reply.set_type(std::string{about_blank});
    reply.set_title(reason_phrase(status));
    reply.set_status(status);
    reply.set_detail(reply.reason());
    reply.set_error(reply.reason());
    return reply;
}
/// The response with that problem.
template <typename Reply>
HttpResponse refusal_response(Reply reply, unsigned status) {
    auto response = error_response(status, reply.reason());
    response.body = json_response(as_problem(std::move(reply), status)).body;
    return response;
}
/// The reply to a command that does not reach the run.
v1::CommandReply unsent(const v1::CommandRequest& command, const std::string& reason);
/// Reads a request's body. Returns the response when it cannot: 400 when it is no such message, 422 when a value in it
/// makes no sense.
std::optional<HttpResponse> read_body(const std::string& body, google::protobuf::Message& message);
/// The same, signed: with accounts, nobody can write in another's name, and a token writes in its owner's.
template <typename Request>
std::optional<HttpResponse> read_signed(const ApiRequest& call, Request& wanted) {
    auto unreadable = read_body(call.request.body, wanted);
    if (!unreadable && call.who.accounts) wanted.set_by(person_of(call.who));
    return unreadable;
}

/// The client that a request counts for: an account, without accounts a browser, else the network it comes from.
std::string client_of(const Operator& who);

/// The response to a question that was stopped because it took too long; `instead` says what to ask.
HttpResponse stopped_response(std::string_view instead);
/// The run number from a path's {run}; none when it is not a number.
std::optional<archive::RunId> run_id(std::string_view text);

/// The refusal when the operator lacks the right; empty when the operator has it.
HttpResponse refusal_of(const Operator& who, Right right);
/// Whether the operator may send this command, by its significance and the operator's list. An act on a queued command
/// of the run of `rehearsals` needs the right to send that command.
Result<void> may_send(const Operator& who, const dictionary::Dictionary& dictionary, const RehearsalManager& rehearsals,
                      const v1::CommandRequest& request);

/// The check of may_send(), made again later: the operator may have lost the right meanwhile.
RehearsalManager::AuthorityCheck may_still_send(Access& access, const Credentials& credentials,
                                                const dictionary::Dictionary& dictionary,
                                                const RehearsalManager& rehearsals);

/// With accounts, gives the request the name of its sender, whatever name it carries.
void name_asker(const Operator& who, v1::CommandRequest& request);

/// Whether the operator may start this rehearsal: every command in the script of an inline scenario must be one that
/// the operator may send.
Result<void> may_start(const Operator& who, const dictionary::Dictionary& dictionary, const v1::StartRehearsal& start);
/// Whether who may rehearse may control a rehearsal so: faults, notes and plans are an instructor's.
Result<void> may_control(const Operator& who, const dictionary::Dictionary& dictionary,
                         const v1::RehearsalControl& control);

/// Signs the control message. With accounts, nobody can write in another's name.
void sign(const Operator& who, v1::RehearsalControl& control);

/// An audit entry with the present time.
archive::AuditRecord audit_record(const Operator& who, std::string_view action, std::string detail,
                                  const std::string& outcome);

}  // namespace aeolis::server
