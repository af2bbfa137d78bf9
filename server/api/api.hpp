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
struct Asked {
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

    enum class Query { none, own };      ///< behind '?': nothing; or what its answer reads
    enum class Body { brief, whole };    ///< whole: a scenario, a command file
    enum class Noted { all, refusals };  ///< refusals: the rest its answer notes, a dry run is no action
    struct Route {
        std::string_view method;  ///< GET answers HEAD, too
        std::string_view path;    ///< "{…}" takes one part
        Right right;
        void (Api::*answer)(const Asked&);
        Query query = Query::none;
        std::string_view audit{};  ///< the action's word; empty: it changes nothing, or its answer writes it
        Noted noted = Noted::all;
        Body body = Body::brief;
    };
    static std::span<const Route> routes();

  private:
    void run_question(const Asked& asked);
    void list_runs(const Asked& asked);
    void list_scenarios(const Asked& asked);
    void dictionary(const Asked& asked);
    void openapi(const Asked& asked);
    void stream(const Asked& asked);
    void health(const Asked& asked);
    // sample_export.cpp
    void export_samples(const Asked& asked);
    // metrics.cpp
    void metrics(const Asked& asked);
    // rehearsal_routes.cpp
    void list_rehearsals(const Asked& asked);
    void current_rehearsal(const Asked& asked);
    void start_rehearsal(const Asked& asked);
    void control_rehearsal(const Asked& asked);
    // command_routes.cpp
    void post_command(const Asked& asked);
    void post_sequence(const Asked& asked);
    // annotation_routes.cpp
    void post_alarm(const Asked& asked);
    void post_note(const Asked& asked);
    using Annotated = std::variant<archive::Annotation, HttpResponse>;  ///< the latter says why not
    using Annotating = std::function<Annotated(archive::Reader&, archive::RunId, Ert now)>;
    void annotate(const Asked& asked, Annotating annotating);
    // campaign_routes.cpp
    void list_campaigns(const Asked& asked);
    void start_campaign(const Asked& asked);
    void campaign_report(const Asked& asked);
    void campaign_touchdowns(const Asked& asked);
    void cancel_campaign(const Asked& asked);
    using CampaignQuestion =
        std::function<HttpResponse(const std::filesystem::path& file, const std::function<bool()>& stop)>;
    void ask_campaign(const Asked& asked, CampaignQuestion question);
    // access_routes.cpp
    void session(const Asked& asked);
    void log_in(const Asked& asked);
    void log_out(const Asked& asked);
    void list_users(const Asked& asked);
    void add_user(const Asked& asked);
    void change_user(const Asked& asked);
    void remove_user(const Asked& asked);
    void list_tokens(const Asked& asked);
    void add_token(const Asked& asked);
    void remove_token(const Asked& asked);
    void audit(const Asked& asked);

    void answer(const Route& route, Asked asked);
    /// Answers, and notes what became of it.
    Respond noted(const Asked& asked, std::string_view action);
    /// `latest` is the run that goes on, or went on last, in this server; else the newest of the archive: for every
    /// route the same.
    void name_latest(Asked& asked) const;
    void note(const Operator& who, std::string_view action, std::string detail, const std::string& outcome);
    /// Answered on a query thread; 503 when too much waits.
    void aside(const Respond& respond, std::function<HttpResponse(archive::Reader&)> answer,
               Haste haste = Haste::in_turn);
    void ask(const Asked& asked, QueryText query, RunQuestion question, Haste haste = Haste::in_turn);
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

/// Writes into the request what only the server knows of who asks.
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
