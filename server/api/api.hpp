// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"
#include "server/access/access.hpp"
#include "server/api/http_message.hpp"
#include "server/api/query_threads.hpp"
#include "server/api/static_files.hpp"
#include "server/api/stream_hub.hpp"
#include "server/campaign/campaign_desk.hpp"
#include "server/pipeline/pipeline_thread.hpp"
#include "server/rehearsal/rehearsal_desk.hpp"
#include "server/scenario/scenario_library.hpp"

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>

namespace aeolis::server {

class QueryText;

/// A request with who asks, what stood in the braces of its route's path, and where its answer goes.
struct ApiRequest {
    HttpRequest request;
    Operator who;
    std::vector<std::string> parts;
    Respond respond;
};

/// Every HTTP route (server/api/openapi.yaml describes them): requests to questions, answers to JSON.
///
/// Thread   handle() on the network thread; questions to the archive run on the query threads
/// Access   a route says which right it needs; without it, 401 or 403. What changes something is written into the audit
/// Faults   an answer other than 2xx carries ErrorReply: one sentence that names what is wrong
class Api {
  public:
    struct Parts {
        const dictionary::Dictionary& dictionary;
        const ScenarioLibrary& scenarios;
        QueryThreads& queries;
        RehearsalDesk& desk;
        campaign::CampaignDesk& campaigns;
        StreamHub& hub;
        PipelineThread& pipeline;
        const StaticFiles& console;
        Access& access;
        bool secure;  ///< over TLS: cookies say so
        std::function<std::size_t()> connections;
    };
    explicit Api(Parts parts);

    void handle(HttpRequest request, const Respond& respond);
    /// How long a body this one may send: what is refused anyhow need not be read, and what is read takes the network
    /// thread's time.
    std::size_t body_octets(const Credentials& credentials, std::string_view method, std::string_view path) const;
    /// None: it will be given later. `respond` is called on whatever thread has the answer.
    using RunQuestion = std::function<std::optional<HttpResponse>(archive::Reader&, archive::RunId, const QueryText&)>;

    enum class Query { none, own };        ///< behind '?': nothing; or what its answer reads
    enum class Body { brief, whole };      ///< whole: a scenario, a command file
    enum class Audited { all, refusals };  ///< refusals: the rest its answer notes, a dry run is no action
    struct Route {
        std::string_view method;  ///< GET answers HEAD, too
        std::string_view path;    ///< "{…}" takes one part
        Right right;
        void (Api::*answer)(const ApiRequest&);
        Query query = Query::none;
        std::string_view audit{};  ///< the action's word; empty: it changes nothing, or its answer writes it
        Audited audited = Audited::all;
        Body body = Body::brief;
    };
    static std::span<const Route> routes();

  private:
    void run_question(const ApiRequest& asked);
    void list_runs(const ApiRequest& asked);
    void list_scenarios(const ApiRequest& asked);
    void dictionary(const ApiRequest& asked);
    void openapi(const ApiRequest& asked);
    void stream(const ApiRequest& asked);
    void health(const ApiRequest& asked);
    // sample_export.cpp
    void export_samples(const ApiRequest& asked);
    // metrics.cpp
    void metrics(const ApiRequest& asked);
    // rehearsal_routes.cpp
    void list_rehearsals(const ApiRequest& asked);
    void current_rehearsal(const ApiRequest& asked);
    void start_rehearsal(const ApiRequest& asked);
    void control_rehearsal(const ApiRequest& asked);
    // command_routes.cpp
    void post_command(const ApiRequest& asked);
    void post_sequence(const ApiRequest& asked);
    // annotation_routes.cpp
    void post_alarm(const ApiRequest& asked);
    void post_note(const ApiRequest& asked);
    using Annotated = std::variant<archive::Annotation, HttpResponse>;  ///< the latter says why not
    using Annotating = std::function<Annotated(archive::Reader&, archive::RunId, Ert now)>;
    void annotate(const ApiRequest& asked, Annotating annotating);
    // campaign_routes.cpp
    void list_campaigns(const ApiRequest& asked);
    void start_campaign(const ApiRequest& asked);
    void campaign_report(const ApiRequest& asked);
    void campaign_touchdowns(const ApiRequest& asked);
    void cancel_campaign(const ApiRequest& asked);
    using CampaignQuestion =
        std::function<HttpResponse(const std::filesystem::path& file, const std::function<bool()>& stop)>;
    void ask_campaign(const ApiRequest& asked, CampaignQuestion question);
    // access_routes.cpp
    void session(const ApiRequest& asked);
    void log_in(const ApiRequest& asked);
    void log_out(const ApiRequest& asked);
    void list_users(const ApiRequest& asked);
    void add_user(const ApiRequest& asked);
    void change_user(const ApiRequest& asked);
    void remove_user(const ApiRequest& asked);
    void list_tokens(const ApiRequest& asked);
    void add_token(const ApiRequest& asked);
    void remove_token(const ApiRequest& asked);
    void audit(const ApiRequest& asked);

    void answer(const Route& route, ApiRequest asked);
    /// Answers, and notes what became of it.
    Respond audited(const ApiRequest& asked, std::string_view action);
    /// `latest` is the run that goes on, or went on last, in this server; else the newest of the archive: for every
    /// route the same.
    void name_latest(ApiRequest& asked) const;
    void note(const Operator& who, std::string_view action, std::string detail, const std::string& outcome);
    /// Answered on a query thread; 503 when too much waits.
    void aside(const Respond& respond, std::function<HttpResponse(archive::Reader&)> answer,
               JobPriority priority = JobPriority::in_turn);
    void ask(const ApiRequest& asked, QueryText query, RunQuestion question,
             JobPriority priority = JobPriority::in_turn);
    /// The time on Earth in a run that goes on; none in others.
    std::function<std::optional<Ert>(archive::RunId)> clock() const;
    v1::RunState current_run() const;  ///< with what only the stream knows; run 0: none since the server started

    Parts parts_;
    std::string dictionary_json_;
};

HttpResponse error_response(unsigned status, const std::string& error);
/// `status`, unless the fault is ours: then 500.
HttpResponse error_response(unsigned status, const Error& error);
HttpResponse json_response(const google::protobuf::Message& message, unsigned status = 200);

/// To a question that was asked too long, with what to ask `instead`.
HttpResponse stopped_response(std::string_view instead);
/// Of a path's {run}; none: it is no number.
std::optional<archive::RunId> run_id(std::string_view text);

/// Why this one may not; empty: nothing is against it.
HttpResponse refusal_of(const Operator& who, Right right);
/// Whether they may send this command, by its significance and their own list; of one that waits in the run of `desk`:
/// whether they may do something about it, which needs the right to send it.
Result<void> may_send(const Operator& who, const dictionary::Dictionary& dictionary, const RehearsalDesk& desk,
                      const v1::CommandRequest& request);

/// The same, asked again later of who may have lost what they had.
RehearsalDesk::AuthorityCheck may_still_send(Access& access, const Credentials& credentials,
                                             const dictionary::Dictionary& dictionary, const RehearsalDesk& desk);

/// With accounts, the request is its sender's, whatever name it carries.
void name_asker(const Operator& who, v1::CommandRequest& request);

/// Whether the operator may start this: of an inline scenario each command of its script must be one that they may
/// send.
Result<void> may_start(const Operator& who, const dictionary::Dictionary& dictionary, const v1::StartRehearsal& start);

/// With accounts nobody writes in another's name.
void sign(const Operator& who, v1::RehearsalControl& control);

/// An entry of the audit, now.
archive::AuditRecord audit_record(const Operator& who, std::string_view action, std::string detail,
                                  const std::string& outcome);

}  // namespace aeolis::server
