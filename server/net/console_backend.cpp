#include "server/net/console_backend.hpp"

#include <spdlog/spdlog.h>

namespace aeolis::server {

ConsoleBackend::ConsoleBackend(Settings settings, const dictionary::Dictionary& dictionary)
    : settings_(std::move(settings)), dictionary_(dictionary), scenarios_(settings_.scenarios),
      console_(settings_.web) {}

Result<std::unique_ptr<ConsoleBackend>> ConsoleBackend::open(Settings settings,
                                                             const dictionary::Dictionary& dictionary) {
    std::unique_ptr<ConsoleBackend> backend{new ConsoleBackend{std::move(settings), dictionary}};
    const auto& chosen = backend->settings_;
    auto* const self = backend.get();

    // The address first: a second server must not touch the archive before it fails.
    backend->hub_ = std::make_unique<StreamHub>(dictionary.id, self->stream_services());
    WebServer::Handlers handlers;
    handlers.request = [self](const HttpRequest& request, const Respond& respond) {
        self->api_->handle(request, respond);
    };
    handlers.open_stream = [self](StreamFormat format, std::function<void()> wake) {
        return std::make_shared<StreamSession>(*self->hub_, format, std::move(wake));
    };
    auto server = WebServer::open(chosen.address, chosen.port, std::move(handlers));
    if (!server) return server.error();
    backend->server_ = std::move(*server);
    const auto post = [self](std::function<void()> action) { self->server_->post(std::move(action)); };

    std::error_code ignored;
    if (chosen.archive.has_parent_path()) std::filesystem::create_directories(chosen.archive.parent_path(), ignored);
    auto archive = archive::Archive::open(chosen.archive);
    if (!archive) return archive.error();
    for (const auto run : archive->interrupted())
        spdlog::warn("run {} was cut off: it can be continued in the console, or by POST /api/v1/rehearsals {{\"continue_run\":{}}}",
                     run.value, run.value);
    auto queries = QueryThreads::open(chosen.archive, dictionary, chosen.other);
    if (!queries) return queries.error();
    backend->queries_ = std::move(*queries);
    backend->pipeline_ = std::make_unique<PipelineThread>(
        std::move(*archive), dictionary, PipelineThread::Faults::hold,
        [self, post](std::shared_ptr<const pipeline::PublishedBatch> batch) {
            post([self, batch = std::move(batch)]() mutable { self->hub_->published(std::move(batch)); });
        },
        chosen.other);
    backend->pipeline_->want_items(false);
    backend->desk_ = std::make_unique<RehearsalDesk>(
        backend->scenarios_, dictionary, *backend->pipeline_, post,
        [self](archive::RunId run, const auto& done) {
            const bool taken = self->queries_->ask([run, done](archive::Reader& reader) { done(reader.cut_off(run)); });
            if (!taken) done(Error{"too many questions wait: try again"});
        },
        RehearsalDesk::Callbacks{[self](v1::RunState state) { self->hub_->run_state(std::move(state)); },
                                 [self](v1::Clocks clocks) { self->hub_->clocks(std::move(clocks)); }});
    backend->api_ = std::make_unique<Api>(
        Api::Parts{dictionary, backend->scenarios_, *backend->queries_, *backend->desk_, *backend->hub_,
                   *backend->pipeline_, backend->console_, [self] { return self->server_->connections(); }});
    backend->adopt_newest_run();
    return backend;
}

ConsoleBackend::~ConsoleBackend() {
    // Said and not left to the members' order: until it is gone, each may call what comes after it here.
    queries_.reset(); // what still waits may add a note, through api and pipeline
    api_.reset();
    downlink_.reset();
    desk_.reset();
    pipeline_.reset();
    server_.reset();
    hub_.reset();
}

StreamHub::Services ConsoleBackend::stream_services() {
    StreamHub::Services services;
    services.read_items = [this](archive::RunId run, archive::Sequence after, std::size_t limit,
                                 archive::Reader::ItemKinds kinds, const auto& done) {
        const bool taken = queries_->ask([this, run, after, limit, kinds, done](archive::Reader& reader) {
            auto page = reader.items(run, after, limit, kinds);
            server_->post([done, page = std::move(page)]() mutable { done(std::move(page)); });
        });
        if (!taken) server_->post([done] { done(Error{"too many questions wait: try again"}); });
    };
    services.read_run = [this](std::uint64_t run, const auto& done) {
        const bool taken = queries_->ask([this, run, done](archive::Reader& reader) {
            auto state = reader.run(archive::RunId{static_cast<std::uint32_t>(run)});
            server_->post([done, state = std::move(state)]() mutable { done(std::move(state)); });
        });
        if (!taken) server_->post([done] { done(Error{"too many questions wait: try again"}); });
    };
    services.command = [this](v1::CommandRequest request, auto reply) {
        desk_->command(std::move(request), std::move(reply));
    };
    services.control = [this](const v1::RehearsalControl& control, const auto& done) {
        const auto now = desk_->control(control, [done](const Result<v1::RunState>& began) {
            if (!began) done(began.error());
        });
        if (!now) done(now);
    };
    services.want_items = [this](bool wanted) {
        if (pipeline_) pipeline_->want_items(wanted);
    };
    return services;
}

/// Until a rehearsal starts, "the run" of a client is the last one that was flown.
void ConsoleBackend::adopt_newest_run() {
    auto reader = archive::Reader::open(settings_.archive, dictionary_, settings_.other);
    if (!reader) return;
    auto runs = reader->runs();
    if (runs && !runs->runs().empty()) hub_->run_state(runs->runs(0));
}

void ConsoleBackend::start(simulation::Scenario scenario, std::uint64_t seed, double pace) {
    desk_->start(std::move(scenario), seed, pace, [](const Result<v1::RunState>& began) {
        if (!began) spdlog::error("the rehearsal could not be started: {}", began.error().message);
    });
}

Result<void> ConsoleBackend::follow(DownlinkFollower::Settings settings) {
    AEOLIS_CHECK(settings_.other != nullptr);
    desk_->close("this server follows the downlink of another mission: rehearsals need one of their own");
    auto follower = DownlinkFollower::start(std::move(settings), *pipeline_, [this](v1::RunState state) {
        server_->post([this, state = std::move(state)]() mutable { hub_->run_state(std::move(state)); });
    });
    if (!follower) return follower.error();
    downlink_ = std::move(*follower);
    return {};
}

void ConsoleBackend::run() {
    server_->run();
}
void ConsoleBackend::stop() {
    server_->stop();
}

} // namespace aeolis::server
