#pragma once

#include "dictionaries/dictionary.hpp"
#include "server/api/query_threads.hpp"
#include "server/api/static_files.hpp"
#include "server/net/http_message.hpp"
#include "server/net/stream_hub.hpp"
#include "server/rehearsal/pipeline_thread.hpp"
#include "server/rehearsal/rehearsal_desk.hpp"
#include "server/scenario/scenario_library.hpp"

#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace aeolis::server {

class QueryText;

/// Every HTTP route (server/api/openapi.yaml describes them): requests to questions, answers to JSON.
///
/// Thread   handle() on the network thread; questions to the archive run on the query threads
/// Faults   an answer other than 2xx carries ErrorReply: one sentence that names what is wrong
class Api {
  public:
    struct Parts {
        const dictionary::Dictionary& dictionary;
        const ScenarioLibrary& scenarios;
        QueryThreads& queries;
        RehearsalDesk& desk;
        StreamHub& hub;
        PipelineThread& pipeline;
        const StaticFiles& console;
        std::function<std::size_t()> connections;
    };
    explicit Api(Parts parts);

    void handle(const HttpRequest& request, const Respond& respond);
    /// None: it will be given later. `respond` is called on whatever thread has the answer.
    using RunQuestion = std::function<std::optional<HttpResponse>(archive::Reader&, archive::RunId, const QueryText&)>;

  private:
    void handle_api(const HttpRequest& request, const Respond& respond);
    void handle_run(const HttpRequest& request, const std::string& run, const std::string& what,
                    const Respond& respond);
    void list_runs(const Respond& respond);
    void list_scenarios(const Respond& respond);
    void rehearsals(const HttpRequest& request, bool current, const Respond& respond);
    void post_command(const HttpRequest& request, const std::string& run, const Respond& respond);
    /// @param by  who asks, where that is known; else the request says so itself
    void post_alarm(const HttpRequest& request, const std::string& run, const std::optional<std::string>& by, const Respond& respond);
    void post_note(const HttpRequest& request, const std::string& run, const std::optional<std::string>& by, const Respond& respond);
    void ask(const HttpRequest& request, const std::string& run, QueryText query, RunQuestion question, const Respond& respond);
    /// The time on Earth in a run that goes on; none in others.
    std::function<std::optional<Ert>(archive::RunId)> clock() const;
    v1::RunState current_run() const; ///< with what only the stream knows; run 0: none since the server started
    HttpResponse metrics() const;

    Parts parts_;
    std::string dictionary_json_;
};

HttpResponse error_response(unsigned status, const std::string& error);

} // namespace aeolis::server
