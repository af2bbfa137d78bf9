// SPDX-License-Identifier: Apache-2.0
#include "server/net/console_backend.hpp"

#include "server/access/this_user.hpp"
#include "server/api/channel_names.hpp"
#include "server/archive/upkeep.hpp"
#include "server/base/json.hpp"
#include "server/base/log_line.hpp"
#include "server/base/wall_clock.hpp"
#include "server/rehearsal/again_of.hpp"
#include "server/rehearsal/command_messages.hpp"
#include "server/shadow/shadow.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <google/protobuf/stubs/logging.h>
#include <malloc.h>
#include <spdlog/spdlog.h>

namespace aeolis::server {
namespace {

constexpr unsigned stream_check_ms = 1'000;  // chosen: longest time that a client follows after its session ended

/// Why a client of the stream gets nothing done, with the status by which its route would say so.
struct Refusal {
    unsigned status;
    std::string reason;
};

/// The identity of the user who started the program.
Operator command_line_operator() {
    Operator who;
    who.user = this_user();
    who.from = command_line;
    return who;
}

/// Requires accounts and TLS for an address that other machines can reach.
Result<void> check_reach(const ConsoleBackend::Settings& settings) {
    const auto& web = settings.web_server;
    if (WebServer::is_loopback(web.address)) return {};
    if (settings.accounts.empty() || web.certificate.empty())
        return Error{fmt::format(
            "--listen {}: other machines reach this address: give --accounts, --tls-certificate and --tls-key; "
            "without accounts the server listens on loopback only",
            web.address)};
    if (web.names.empty())
        return Error{fmt::format("--listen {}: give --host, the name by which browsers call this server", web.address)};
    return {};
}

}  // namespace

ConsoleBackend::ConsoleBackend(Settings settings, const dictionary::Dictionary& dictionary)
    : settings_(std::move(settings)), dictionary_(dictionary), clock_watch_(settings_.clocks),
      timeline_check_(dictionary), scenarios_(settings_.scenarios), plans_(settings_.dictionary, dictionary),
      console_(settings_.web), predictions_(dictionary) {}

Result<std::unique_ptr<ConsoleBackend>> ConsoleBackend::open(Settings settings,
                                                             const dictionary::Dictionary& dictionary) {
    // An invalid message is refused to its client; Protobuf would also print a line for each.
    google::protobuf::SetLogHandler(nullptr);
    ::mallopt(M_MMAP_THRESHOLD, mapped_octets);
    std::unique_ptr<ConsoleBackend> backend{new ConsoleBackend{std::move(settings), dictionary}};
    const auto& chosen = backend->settings_;
    auto* const self = backend.get();

    if (auto safe = check_reach(chosen); !safe) return safe.error();
    // The address first: a second server must fail before it touches the archive.
    backend->hub_ = std::make_unique<StreamHub>(dictionary.id, self->stream_services());
    auto server = WebServer::open(chosen.web_server, self->web_handlers());
    if (!server) return server.error();
    backend->server_ = std::move(*server);
    backend->server_->every(stream_check_ms, [self] {
        self->hub_->check_clients();
        self->note_resets();
        self->watch_clock();
    });
    const auto post = [self](std::function<void()> action) { self->server_->post(std::move(action)); };

    std::error_code ignored;
    if (chosen.archive.has_parent_path()) std::filesystem::create_directories(chosen.archive.parent_path(), ignored);
    auto archive = archive::Archive::open(chosen.archive);
    if (!archive) return archive.error();
    if (const auto wide = archive::open_to_others(chosen.archive)) spdlog::warn("{}", *wide);
    if (auto chosen_origin = self->choose_origin(*archive); !chosen_origin) return chosen_origin.error();
    for (const auto run : archive->interrupted())
        spdlog::warn("run {} was cut off: it can be continued in the console, or by POST /api/v1/rehearsals "
                     "{{\"continue_run\":{}}}",
                     run.value, run.value);
    auto queries = QueryThreads::open(chosen.archive, dictionary, chosen.other);
    if (!queries) return queries.error();
    backend->queries_ = std::move(*queries);
    backend->pipeline_ = std::make_unique<PipelineThread>(
        std::move(*archive), dictionary, PipelineThread::Faults::hold,
        [self, post](std::shared_ptr<const pipeline::PublishedBatch> batch) {
            post([self, batch = self->hub_feed_.departs(std::move(batch))]() mutable {
                self->hub_feed_.arrived(*batch);
                self->hub_->published(std::move(batch));
            });
        },
        chosen.other);
    backend->pipeline_->keep_raw(chosen.raw_octets_kept);
    backend->pipeline_->want_items(false);
    backend->pipeline_->on_fault(
        [self, post](const std::string& fault) { post([self, fault] { self->hub_->archive_fault(fault); }); });
    backend->pipeline_->on_audited([self](const archive::AuditHead& head) { self->keep_audit_head(head); });
    backend->rehearsals_ = std::make_unique<RehearsalManager>(
        backend->scenarios_, backend->plans_, dictionary, *backend->pipeline_, post,
        [self](const v1::StartRehearsal& request, const auto& done) {
            const bool taken =
                self->queries_->ask([request, done](archive::Reader& reader) { done(again_of(request, reader)); });
            if (!taken) done(Error{QueryThreads::busy});
        },
        self->timeline_questions(),
        RehearsalManager::Callbacks{
            [self](v1::RunState state) { self->run_state(std::move(state)); },
            [self](v1::Clocks clocks) { self->clocks(std::move(clocks)); },
            chosen.plan_flights ? shadow::make_shadows(dictionary, {.cases = *chosen.plan_flights, .idle = true})
                                : MakeCompanion{}});
    // The last step that can fail: the first password is shown once, and only by a server that starts.
    auto access = Access::open({.file = chosen.accounts, .secure = backend->server_->secure()});
    if (!access) return access.error();
    backend->access_ = std::move(*access);
    backend->campaigns_ =
        std::make_unique<campaign::CampaignManager>(chosen.archive.parent_path(), backend->scenarios_, dictionary);
    backend->forecasts_ = std::make_shared<shadow::ForecastService>(
        dictionary, chosen.archive,
        [pipeline = backend->pipeline_.get()](const archive::ForecastRecord& forecast,
                                              const std::function<void(bool)>& done) {
            return pipeline->keep_forecast(forecast, [done](const Result<std::uint64_t>& kept) {
                if (!kept) spdlog::error("a forecast could not be stored: {}", kept.error().message);
                done(kept.ok());
            });
        });
    backend->api_ = std::make_unique<Api>(Api::Parts{
        dictionary,
        backend->scenarios_,
        backend->plans_,
        *backend->queries_,
        *backend->rehearsals_,
        backend->predictions_,
        *backend->campaigns_,
        backend->forecasts_,
        *backend->hub_,
        *backend->pipeline_,
        backend->console_,
        *backend->access_,
        backend->server_->secure(),
        [self] { return self->server_->connections(); },
        backend->clock_watch_,
        chosen.publish_to.url.empty() && chosen.follow_by.url.empty() ? std::function<Replication()>{}
                                                                      : [self] { return self->replication(); },
        backend->follows_,
        backend->follower_seed_.empty() ? std::function<void(const ApiRequest&)>{}
                                        : [self](const ApiRequest& call) { self->ask_origin(call); },
        ProcedureLibrary{chosen.dictionary.empty() ? chosen.dictionary : chosen.dictionary / "procedures"},
        chosen.archive});
    backend->check_audit_head();
    backend->adopt_newest_run();
    backend->note_resets();
    if (auto begun = backend->publish_and_follow(); !begun) return begun.error();
    return backend;
}

/// On the network thread: for the browsers here, and for followers.
void ConsoleBackend::run_state(v1::RunState state) {
    if (publisher_) publisher_->run_state(state);
    hub_->run_state(std::move(state));
}
void ConsoleBackend::clocks(v1::Clocks clocks) {
    if (publisher_) publisher_->clocks(clocks);
    hub_->clocks(std::move(clocks));
}

WebServer::Handlers ConsoleBackend::web_handlers() {
    WebServer::Handlers handlers;
    handlers.request = [this](HttpRequest request, const Respond& respond) {
        api_->handle(std::move(request), respond);
    };
    handlers.refused = [this](const char* route, unsigned status) { api_->count(route, status); };
    handlers.person = [this](const Credentials& credentials) -> std::optional<std::string> {
        const auto who = access_->identify(credentials);
        if (!who.role) return std::nullopt;
        return who.accounts ? person_of(who) : std::string{};
    };
    handlers.body_octets = [this](const Credentials& credentials, std::string_view method, std::string_view path) {
        return api_->body_octets(credentials, method, path);
    };
    handlers.admit_stream = [this](const Credentials& credentials) {
        return refusal_of(access_->identify(credentials), Right::watch);
    };
    handlers.open_stream = [this](const Credentials& credentials, StreamFormat format, std::function<void()> wake) {
        return std::make_shared<StreamSession>(*hub_, format, std::move(wake), stream_client(credentials));
    };
    return handlers;
}

/// The actions of a stream client, with the checks and audit of the corresponding routes.
StreamSession::Client ConsoleBackend::stream_client(const Credentials& credentials) {
    StreamSession::Client client;
    client.refusal = [this, credentials] {
        return may(access_->identify(credentials), Right::watch) ? "" : "the log-in has ended: log in again";
    };
    const auto full = [this] { return !pipeline_->audit_has_room(); };
    const auto refusal_of_right = [this, full](const Operator& who, Right right) -> std::optional<Refusal> {
        if (!follows_.empty()) return Refusal{409, follows_};
        if (!who.role) return Refusal{401, "the log-in has ended: log in again"};
        if (!may(who, right))
            return Refusal{
                403, fmt::format("{} is {}: this needs the right to {}", who.user, name_of(*who.role), name_of(right))};
        if (full()) return Refusal{503, "nothing is done that the audit cannot take: " + pipeline_->fault()};
        return std::nullopt;
    };
    const auto refusal_of_command =
        [this, refusal_of_right](const Operator& who, const v1::CommandRequest& request) -> std::optional<Refusal> {
        if (auto refused = refusal_of_right(who, Right::command)) return refused;
        if (const auto many = api_->count_commands(who, 1)) return Refusal{429, many->reason};
        if (const auto sendable = may_send(who, dictionary_, *rehearsals_, request); !sendable)
            return Refusal{403, sendable.error().message};
        if (const auto formed = check_form(request, dictionary_); !formed) return Refusal{422, formed.error().message};
        return std::nullopt;
    };
    client.command = [this, credentials, refusal_of_command, full](v1::CommandRequest request,
                                                                   const std::function<void(v1::CommandReply)>& reply) {
        const auto who = access_->identify(credentials);
        if (to_origin_ && may(who, Right::command)) return command_at_origin(who, request, reply);
        name_asker(who, request);
        const auto noted = [this, who, detail = to_json(request), dry_run = request.dry_run(), full,
                            reply](const v1::CommandReply& answer, unsigned status_if_refused) {
            // A dry run is not audited: a console repeats it every second.
            if (!dry_run && !full())
                pipeline_->audit(
                    audit_record(who, "command", detail, answer.accepted() ? "done" : "refused: " + answer.reason()));
            reply(answer.accepted() ? answer : as_problem(answer, status_if_refused));
        };
        if (const auto refused = refusal_of_command(who, request))
            return noted(unsent(request, refused->reason), refused->status);
        rehearsals_->command(
            std::move(request),
            {may_still_send(*access_, credentials, dictionary_, *rehearsals_), who.browser, may(who, Right::hazardous)},
            [noted](const v1::CommandReply& answer) { noted(answer, 409); });
    };
    client.control = [this, credentials, refusal_of_right](v1::RehearsalControl control,
                                                           const std::function<void(Result<void>)>& done) {
        const auto who = access_->identify(credentials);
        sign(who, control);
        const auto noted = [this, who, detail = to_json(control), done](const Result<void>& result) {
            pipeline_->audit(
                audit_record(who, "rehearsal", detail, result ? "done" : "refused: " + result.error().message));
            done(result);
        };
        if (const auto refused = refusal_of_right(who, Right::rehearse)) return noted(Error{refused->reason});
        if (const auto right = may_control(who, dictionary_, control); !right) return noted(right);
        const bool starts = control.action_case() == v1::RehearsalControl::kStart;
        const auto now = rehearsals_->control(control, [noted](const Result<v1::RunState>& began) {
            noted(began ? Result<void>{} : Result<void>{began.error()});
        });
        if (!now || !starts) noted(now);
    };
    return client;
}

ConsoleBackend::~ConsoleBackend() {
    // The end of the current run must be stored, which could wait forever for a failing disk.
    if (pipeline_) pipeline_->closing();
    // An explicit order: each of these may call those below until it is destroyed.
    if (queries_) queries_->end();  // waiting jobs may still add notes through api and pipeline; new ones are refused
    requests_.reset();
    to_origin_.reset();
    api_.reset();
    follower_.reset();
    publisher_.reset();
    forecasts_.reset();
    campaigns_.reset();  // abandons cases in flight
    downlink_.reset();
    rehearsals_.reset();
    queries_.reset();
    pipeline_.reset();
    server_.reset();
    hub_.reset();
}

/// The timeline checks on the query threads: a second of work each, limited as a query; consoles repeat dry runs each
/// second.
RehearsalManager::TimelineQuestions ConsoleBackend::timeline_questions() {
    RehearsalManager::TimelineQuestions questions;
    questions.check = [this](archive::RunId run, const std::vector<v1::CommandRequest>& requests, bool only_check,
                             const auto& done) {
        if (std::ranges::none_of(requests, changes_timeline)) return done(std::string{});
        const bool taken = queries_->ask(
            [this, run, requests, only_check, done](archive::Reader& reader) {
                const auto before =
                    // 0: no run yet
                    run.value == 0 ? Result<v1::CommandList>{v1::CommandList{}} : reader.timeline_commands(run);
                done(before ? timeline_check_.check(*before, requests, only_check, queries_->stop_of_question({}))
                            : Result<std::string>{before.error()});
            },
            {}, JobPriority::soon);
        if (!taken) done(Error{.message = QueryThreads::busy, .internal = true});
    };
    questions.reanalyse = [this](archive::RunId run, const auto& done) {
        using Reanalysis = TimelineCheck::Reanalysis;
        const bool taken = queries_->ask(
            [this, run, done](archive::Reader& reader) {
                const auto before = reader.timeline_commands(run);
                done(before ? Result<Reanalysis>{timeline_check_.reanalyse(*before, queries_->stop_of_question({}))}
                            : Result<Reanalysis>{before.error()});
            },
            {}, JobPriority::soon);
        if (!taken) done(Error{.message = QueryThreads::busy, .internal = true});
    };
    return questions;
}

StreamHub::Services ConsoleBackend::stream_services() {
    StreamHub::Services services;
    services.rate_by = settings_.other != nullptr ? RateBy::reception : RateBy::vehicle;
    services.read_items = [this](archive::RunId run, archive::Sequence after, std::size_t limit,
                                 archive::Reader::ItemKinds kinds, const auto& done) {
        const bool taken = queries_->ask(
            [this, run, after, limit, kinds, done](archive::Reader& reader) {
                auto page = reader.items(run, after, limit, kinds);
                server_->post([done, page = std::move(page)]() mutable { done(std::move(page)); });
            },
            {}, JobPriority::soon);
        if (!taken) server_->post([done] { done(Error{.message = QueryThreads::busy, .internal = true}); });
    };
    services.read_run = [this](std::uint64_t run, const auto& done) {
        const bool taken = queries_->ask(
            [this, run, done](archive::Reader& reader) {
                auto state = reader.run(archive::RunId{static_cast<std::uint32_t>(run)});
                server_->post([done, state = std::move(state)]() mutable { done(std::move(state)); });
            },
            {}, JobPriority::soon);
        if (!taken) server_->post([done] { done(Error{.message = QueryThreads::busy, .internal = true}); });
    };
    services.want_items = [this](bool wanted) {
        items_wanted_ = wanted;
        if (pipeline_) pipeline_->want_items(wanted);
    };
    services.channel_id = [this, ids = channel_ids(dictionary_)](const std::string& name) -> Result<std::uint32_t> {
        if (const auto id = ids.find(name); id != ids.end()) return id->second;
        return channel_named(dictionary_, "channel_names", name).error();
    };
    std::unordered_set<std::uint32_t> known;
    for (const auto& channel : dictionary_.channels) known.insert(channel.id.value);
    services.has_channel = [known = std::move(known)](std::uint32_t id) { return known.contains(id); };
    return services;
}

/// Until a rehearsal starts, a client's "current run" is the last one flown.
void ConsoleBackend::adopt_newest_run() {
    auto reader = archive::Reader::open(settings_.archive, dictionary_, settings_.other);
    if (!reader) return;
    auto runs = reader->runs({.limit = 1});
    if (runs && !runs->runs().empty()) hub_->run_state(runs->runs(0));
}

/// Adds password resets to the audit. Whoever can write the accounts file can become an administrator without a server;
/// the next server records it.
void ConsoleBackend::note_resets() {
    for (const auto& reset : access_->take_resets()) {
        Operator who;
        who.user = reset.by();
        who.from = command_line;
        const auto done = reset.change().empty() ? fmt::format("aeolis accounts reset: a new password for '{}', {}",
                                                               reset.user(), reset.at())
                                                 : fmt::format("{}, {}", reset.change(), reset.at());
        pipeline_->audit(audit_record(who, "user", done, "done"));
    }
}

namespace {

/// Where the head of the audit is kept: beside the accounts. Without accounts the audit names nobody, and its head is
/// in the log only.
std::filesystem::path audit_head_file(const ConsoleBackend::Settings& settings) {
    return archive::head_file(settings.archive, settings.accounts.parent_path());
}

}  // namespace

/// Compares the audit with the head that the last server kept. What is missing is in the log and the audit from now on.
void ConsoleBackend::check_audit_head() {
    if (settings_.accounts.empty()) return;
    const auto fault = [this]() -> Result<std::optional<std::string>> {
        const auto known = archive::read_head(audit_head_file(settings_));
        if (!known) return known.error();
        if (!*known) return std::optional<std::string>{};
        auto database = archive::sqlite::Database::open(settings_.archive.string(), archive::sqlite::Mode::read_only);
        if (!database) return database.error();
        return archive::head_fault(*database, **known);
    }();
    if (fault && !*fault) return;
    const auto told = fault ? **fault : fault.error().message;
    spdlog::error("{}", told);
    Operator who;
    who.from = "server";
    pipeline_->audit(audit_record(who, "audit", told, "found"));
}

/// On the pipeline's thread.
void ConsoleBackend::keep_audit_head(const archive::AuditHead& head) const {
    log_always(fmt::format("audit head {}", archive::text_of(head)));
    if (settings_.accounts.empty()) return;
    if (const auto kept = archive::write_head(audit_head_file(settings_), head); !kept)
        spdlog::error("the head of the audit is not kept: {}", kept.error().message);
}

/// Tells a jump of the system's clock: in the log, the audit, whose times are the clock's, and the shift log of a run
/// in progress.
void ConsoleBackend::watch_clock() {
    const auto jump = clock_watch_.look();
    if (!jump) return;
    const auto told = text_of(*jump);
    spdlog::warn("{}", told);
    Operator who;
    who.from = "server";
    pipeline_->audit(audit_record(who, "clock", told, "found"));

    archive::NoteRecord note;
    archive::RunId run;
    if (downlink_) {
        run = downlink_->run();
        note.ert = downlink_->now();
    } else {
        const auto now = hub_->ert_now();
        run = archive::RunId{static_cast<std::uint32_t>(rehearsals_->current().run())};
        if (!rehearsals_->going_on() || run.value != hub_->current_run() || !now) return;
        note.ert = *now;
    }
    note.text = fmt::format("{}. Earth received times of this run do not follow it.", told);
    note.by = "server";
    note.written = wall_clock_text();
    const auto added = [run](const Result<PipelineThread::Annotated>& stored) {
        if (!stored) spdlog::error("run {}: the jump is not in its shift log: {}", run.value, stored.error().message);
    };
    if (!pipeline_->annotate(run, std::move(note), added)) added(Error{"too much waits to be stored"});
}

void ConsoleBackend::start(RehearsalManager::Flight flight) {
    const auto detail =
        fmt::format("serve --scenario {} --seed {} --pace {}", flight.scenario.name, flight.seed, flight.pace);
    rehearsals_->start(std::move(flight), [this, detail](const Result<v1::RunState>& began) {
        pipeline_->audit(audit_record(command_line_operator(), "rehearsal", detail,
                                      began ? "done" : "refused: " + began.error().message));
        if (!began) spdlog::error("the rehearsal could not be started: {}", began.error().message);
    });
}

Result<void> ConsoleBackend::follow(DownlinkFollower::Settings settings) {
    AEOLIS_CHECK(settings_.other != nullptr);
    rehearsals_->close("this server follows the downlink of another mission: rehearsals need one of their own");
    campaigns_->close("this server follows the downlink of another mission: campaigns need one of their own");
    const auto detail = fmt::format("serve --downlink {} --xtce {}", settings.address.text(), settings.xtce);
    settings.clocks = settings_.clocks;
    auto follower = DownlinkFollower::start(
        std::move(settings), *pipeline_,
        [this](v1::RunState state) {
            server_->post([this, state = std::move(state)]() mutable { run_state(std::move(state)); });
        },
        [this](v1::Clocks clocks) {
            server_->post([this, clocks = std::move(clocks)]() mutable { this->clocks(std::move(clocks)); });
        });
    pipeline_->audit(audit_record(command_line_operator(), "downlink", detail,
                                  follower ? "done" : "refused: " + follower.error().message));
    if (!follower) return follower.error();
    downlink_ = std::move(*follower);
    return {};
}

void ConsoleBackend::run() {
    server_->run();
}
void ConsoleBackend::renew_certificate() {
    if (!server_->secure()) return;
    server_->post([this] {
        if (const auto renewed = server_->renew_certificate(); !renewed)
            spdlog::error("{}; the certificate of before stays", renewed.error().message);
        else
            spdlog::info("new connections get the certificate as it stands now");
    });
}
void ConsoleBackend::stop() {
    server_->stop();
}

}  // namespace aeolis::server
