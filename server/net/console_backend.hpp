// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"
#include "server/api/api.hpp"
#include "server/api/hub_feed.hpp"
#include "server/archive/records.hpp"
#include "server/base/clock_watch.hpp"
#include "server/cluster/follower.hpp"
#include "server/cluster/publisher.hpp"
#include "server/cluster/request_gate.hpp"
#include "server/cluster/request_sender.hpp"
#include "server/links/downlink_follower.hpp"
#include "server/net/http_client.hpp"
#include "server/net/web_server.hpp"
#include "server/rehearsal/timeline_check.hpp"

#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace aeolis::server {

/// All of `aeolis serve`: archive, pipeline, rehearsals, queries, stream and web server.
///
/// Threads  docs/decisions/0006-threads-and-stream.md: network (run()), pipeline, three query threads, one per
///          rehearsal; a campaign has its own, and the nominal flights have one
class ConsoleBackend {
  public:
    struct Settings {
        WebServer::Settings web_server{};
        std::filesystem::path accounts{};  ///< empty: no accounts, possible on loopback only
        std::filesystem::path archive{}, scenarios{}, web{};
        std::filesystem::path dictionary{};  ///< its folder, for the instructors' plans and the rubric; empty: none
        /// The mission of the dictionary, which must outlive this. Null: our own mission.
        const telemetry::OtherMission* other = nullptr;
        ReadClocks clocks = read_clocks;
        std::uint64_t raw_octets_kept = archive::raw_octets_kept;  ///< of each link of a run, as they came
        /// Ground's own flight beside a run, with so many dispersed flights of its plan; none: no such flight.
        std::optional<std::uint64_t> plan_flights{};
        cluster::EngineAddress publish_to{};   ///< no URL: nowhere
        cluster::EngineAddress follow_by{};    ///< no URL: this server follows none
        std::string follow_archive{};          ///< identity, or its beginning; empty: the only one
        cluster::ChosenRuns follow_runs{};     ///< that are followed
        HttpClient::Settings snapshots{};      ///< of what the engine no longer has; no server: none
        std::filesystem::path follower_key{};  ///< signs what people here ask of the origin; empty: they only watch
    };
    /// Memory blocks of this size or more are mapped separately and returned to the system when freed; chosen. So the
    /// memory of each thread's longest answer does not stay with the process.
    static constexpr int mapped_octets = 256 << 10;
    /// Opens all parts. Fails with one line that names the archive or the address. The dictionary must outlive this.
    static Result<std::unique_ptr<ConsoleBackend>> open(Settings settings, const dictionary::Dictionary& dictionary);
    ~ConsoleBackend();  ///< stops a run in progress; its end is stored

    /// Starts a first rehearsal. Call before run().
    void start(RehearsalManager::Flight flight);
    /// Follows another mission's packets in a run of its own; rehearsals cannot be started then. Call before run().
    Result<void> follow(DownlinkFollower::Settings settings);
    std::uint16_t downlink_port() const { return downlink_ ? downlink_->port() : std::uint16_t{0}; }
    void run();
    void stop();  ///< from any thread
    /// Reads the certificate again, and logs the result. Call from any thread.
    void renew_certificate();
    std::uint16_t port() const { return server_->port(); }
    bool secure() const { return server_->secure(); }
    /// The administrator's password when the accounts file was just created; else empty.
    const std::string& first_password() const { return access_->first_password(); }

  private:
    ConsoleBackend(Settings settings, const dictionary::Dictionary& dictionary);
    StreamHub::Services stream_services();
    RehearsalManager::TimelineQuestions timeline_questions();
    WebServer::Handlers web_handlers();
    StreamSession::Client stream_client(const Credentials& credentials);
    void adopt_newest_run();
    void note_resets();
    void watch_clock();
    Result<void> choose_origin(archive::Archive& archive);
    Result<void> publish_and_follow();
    void take_requests();
    void take_request(cluster::RequestCheck::Taken taken, const cluster::RequestGate::Answer& answer);
    void ask_origin(const ApiRequest& call);
    void command_at_origin(const Operator& who, const v1::CommandRequest& request,
                           const std::function<void(v1::CommandReply)>& reply);
    void publish_copy(archive::RunId run, archive::Sequence first, archive::Sequence last);
    void run_state(v1::RunState state);
    void clocks(v1::Clocks clocks);
    Replication replication() const;
    void tell_standing();
    void check_audit_head();
    void keep_audit_head(const archive::AuditHead& head) const;

    Settings settings_;
    const dictionary::Dictionary& dictionary_;
    ClockWatch clock_watch_;
    TimelineCheck timeline_check_;
    ScenarioLibrary scenarios_;
    instruction::PlanLibrary plans_;
    StaticFiles console_;
    std::unique_ptr<Access> access_;
    std::unique_ptr<StreamHub> hub_;
    HubFeed hub_feed_;
    std::unique_ptr<WebServer> server_;
    std::unique_ptr<QueryThreads> queries_;
    std::unique_ptr<PipelineThread> pipeline_;
    std::unique_ptr<RehearsalManager> rehearsals_;
    PredictionService predictions_;
    std::unique_ptr<campaign::CampaignManager> campaigns_;
    std::shared_ptr<shadow::ForecastService> forecasts_;
    std::unique_ptr<DownlinkFollower> downlink_;
    std::unique_ptr<Api> api_;

    // With other machines; docs/decisions/0042.
    std::string follows_;                    ///< why no run is changed here; empty: this is an origin
    std::optional<archive::Reader> copied_;  ///< of the follower's thread
    std::atomic<std::uint32_t> followed_run_{0};
    std::atomic<bool> items_wanted_{false};
    std::unique_ptr<cluster::Publisher> publisher_;
    std::unique_ptr<cluster::Follower> follower_;
    std::string identity_;  ///< of the archive that is published
    std::unique_ptr<cluster::RequestGate> requests_;
    std::string follower_seed_;  ///< empty: no request goes to the origin
    std::unique_ptr<cluster::RequestSender> to_origin_;
};

}  // namespace aeolis::server
