// SPDX-License-Identifier: Apache-2.0
// The server as an origin of others, and as a follower of one: docs/scale.md.
#include "server/net/console_backend.hpp"

#include "server/archive/shared_archive.hpp"
#include "server/base/json.hpp"

#include <algorithm>
#include <cstdlib>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

namespace aeolis::server {
namespace {

constexpr unsigned standing_ms = 1'000;  // chosen: as often as lags are told

cluster::SnapshotSource snapshots_from(const HttpClient::Settings& server) {
    if (server.server.empty()) return {};
    return {server.server,
            [client = HttpClient{server}](const std::string& path, const auto& take,
                                          const auto& stop) -> Result<cluster::SnapshotSource::Answer> {
                auto answer = client.get(path, take, stop);
                if (!answer) return answer.error();
                return cluster::SnapshotSource::Answer{answer->status, std::move(answer->body),
                                                       std::move(answer->lost)};
            }};
}

}  // namespace

/// Whether this archive follows another, from now on. Its writer is open, and is opened anew where runs that went on
/// elsewhere are now cut off.
Result<void> ConsoleBackend::choose_origin(archive::Archive& archive) {
    auto shared = archive::SharedArchive::open(settings_.archive);
    if (!shared) return shared.error();
    if (!settings_.publish_to.url.empty()) {  // drawn before the writer's thread would wait for it
        auto identity = shared->identity();
        if (!identity) return identity.error();
        identity_ = std::move(*identity);
    }
    if (!settings_.follow_by.url.empty()) {
        if (!settings_.snapshots.server.empty())
            if (auto usable = HttpClient{settings_.snapshots}.check(); !usable) return usable;
        const auto begun =
            cluster::begin_following(*shared, settings_.follow_by, settings_.follow_archive, dictionary_.id);
        if (!begun) return Error{"--follow: " + begun.error().message};
    }
    const auto origin = shared->followed();
    if (!origin || origin->empty()) return origin ? Result<void>{} : origin.error();
    if (!settings_.follow_by.url.empty()) {
        if (!settings_.follower_key.empty()) {
            auto seed = cluster::read_seed(settings_.follower_key);
            if (!seed) return Error{"--follower-key " + seed.error().message};
            if (settings_.accounts.empty())
                return Error{"--follower-key: the origin is asked in the name of accounts: give --accounts"};
            follower_seed_ = std::move(*seed);
        }
        follows_ = fmt::format("this server follows another (archive {:.8}): {} there", *origin,
                               follower_seed_.empty() ? "runs are begun, commanded and annotated" : "runs are begun");
        return {};
    }
    spdlog::warn("{} followed the archive {} until now: from here on it is its own", settings_.archive.string(),
                 *origin);
    if (auto done = shared->stop_following(); !done) return done;
    shared = Error{"closed"};
    {
        const auto closed = std::move(archive);
    }
    auto again = archive::Archive::open(settings_.archive);
    if (!again) return again.error();
    archive = std::move(*again);
    return {};
}

Result<void> ConsoleBackend::publish_and_follow() {
    if (!follows_.empty()) {
        rehearsals_->close(follows_);
        campaigns_->close(follows_);
        cluster::Follower::Parts parts;
        parts.taken = [this](archive::RunId run, archive::Sequence first, archive::Sequence last) {
            publish_copy(run, first, last);
        };
        parts.run_state = [this](v1::RunState state) {
            followed_run_ = static_cast<std::uint32_t>(state.run());
            server_->post([this, state = std::move(state)]() mutable { hub_->run_state(std::move(state)); });
        };
        parts.clocks = [this](v1::Clocks clocks) {
            server_->post([this, clocks = std::move(clocks)]() mutable { hub_->clocks(std::move(clocks)); });
        };
        followed_run_ = static_cast<std::uint32_t>(hub_->current_run());
        cluster::Follower::Settings settings;
        settings.engine = settings_.follow_by;
        settings.archive = settings_.archive;
        settings.dictionary = dictionary_.id;
        settings.runs = settings_.follow_runs;
        settings.snapshots = snapshots_from(settings_.snapshots);
        auto started = cluster::Follower::start(std::move(settings), std::move(parts));
        if (!started) return started.error();
        follower_ = std::move(*started);
        if (!follower_seed_.empty()) {
            cluster::RequestSender::Settings asked;
            asked.engine = settings_.follow_by;
            asked.origin = follower_->status().origin;
            asked.seed = follower_seed_;
            asked.heard = [this] {
                const auto now = follower_->status();
                return cluster::RequestSender::Origin{now.publisher, now.heard};
            };
            to_origin_ = std::make_unique<cluster::RequestSender>(std::move(asked));
        }
    } else if (!settings_.publish_to.url.empty()) {
        cluster::Publisher::Settings settings;
        settings.engine = settings_.publish_to;
        settings.archive = settings_.archive;
        settings.dictionary = dictionary_.id;
        publisher_ = std::make_unique<cluster::Publisher>(std::move(settings));
        publisher_->run_state(hub_->state());
        if (access_->accounts()) take_requests();
    }
    if (publisher_ || follower_) server_->every(standing_ms, [this] { tell_standing(); });
    return {};
}

/// People at followers, as people here: their requests are those of the HTTP routes.
void ConsoleBackend::take_requests() {
    cluster::RequestGate::Settings settings;
    settings.engine = settings_.publish_to;
    settings.rules = {
        identity_, [this](const std::string& key) { return access_->follower(key); },
        [this](const std::string& publisher, std::uint64_t count) { return publisher_->age_of(publisher, count); }};
    requests_ = std::make_unique<cluster::RequestGate>(
        std::move(settings), [this](cluster::RequestCheck::Taken taken, const cluster::RequestGate::Answer& answer) {
            server_->post(
                [this, taken = std::move(taken), answer]() mutable { take_request(std::move(taken), answer); });
        });
}

/// On the network thread.
void ConsoleBackend::take_request(cluster::RequestCheck::Taken taken, const cluster::RequestGate::Answer& answer) {
    auto& asked = taken.request;
    HttpRequest request;
    request.method = asked.method();
    request.path = asked.path();
    request.body = std::move(*asked.mutable_body());
    request.credentials.from = asked.from();
    request.credentials.vouched = Vouched{
        taken.key,      asked.user(), asked.owner(), asked.role(), {asked.commands().begin(), asked.commands().end()},
        asked.session()};
    const Respond respond = [answer](const HttpResponse& response) {
        v1::RequestAnswer given;
        given.set_status(response.status);
        given.set_content_type(response.content_type);
        given.set_body(response.body);
        const auto wait = response.field("Retry-After");
        if (!wait.empty()) given.set_retry_after_s(static_cast<std::uint32_t>(std::strtoul(wait.c_str(), nullptr, 10)));
        answer(std::move(given));
    };
    const auto who = access_->identify(request.credentials);
    if (!who.role)
        return respond(
            error_response(403, fmt::format("follower {}: '{}' has no account here, or no command that it may "
                                            "send both here and there",
                                            taken.follower, asked.owner().empty() ? asked.user() : asked.owner())));
    if (!Api::is_for_origin(request.method, request.path))
        return respond(
            error_response(403, fmt::format("{} {}: not for people at a follower", request.method, request.path)));
    if (request.body.size() > api_->body_octets(request.credentials, request.method, request.path))
        return respond(error_response(413, "the body is too long"));
    api_->handle(std::move(request), respond);
}

namespace {

v1::FollowerRequest request_of(const Operator& who, std::string method, std::string path, std::string body) {
    v1::FollowerRequest request;
    request.set_method(std::move(method));
    request.set_path(std::move(path));
    request.set_body(std::move(body));
    request.set_user(who.user);
    request.set_owner(who.owner);
    request.set_role(std::string{name_of(*who.role)});
    for (const auto& command : who.commands) request.add_commands(command);
    request.set_session(who.session);
    request.set_from(who.from);
    return request;
}

}  // namespace

void ConsoleBackend::ask_origin(const ApiRequest& call) {
    to_origin_->ask(request_of(call.who, call.request.method, call.request.path, call.request.body),
                    [respond = call.respond](v1::RequestAnswer answer) {
                        HttpResponse response = error_response(answer.status(), answer.body());
                        if (!answer.content_type().empty()) {
                            response.content_type = answer.content_type();
                            response.body = std::move(*answer.mutable_body());
                        }
                        if (answer.retry_after_s() > 0)
                            response.fields.emplace_back("Retry-After", std::to_string(answer.retry_after_s()));
                        respond(std::move(response));
                    });
}

/// As POST /runs/N/commands there.
void ConsoleBackend::command_at_origin(const Operator& who, const v1::CommandRequest& request,
                                       const std::function<void(v1::CommandReply)>& reply) {
    const auto run = request.run() != 0 ? request.run() : hub_->current_run();
    to_origin_->ask(request_of(who, "POST", fmt::format("/api/v1/runs/{}/commands", run), to_json(request)),
                    [this, number = request.request(), reply](const v1::RequestAnswer& answer) {
                        v1::CommandReply told;
                        if (answer.content_type().empty() || !from_json(answer.body(), told)) {
                            told.Clear();
                            told.set_reason(answer.body());
                        }
                        // A problem with nothing of a CommandReply:
                        if (told.reason().empty() && told.has_detail()) told.set_reason(told.detail());
                        told.set_request(number);
                        server_->post([reply, told = std::move(told)] { reply(told); });
                    });
}

/// Gives items of a followed run on to the browsers. On the follower's thread.
void ConsoleBackend::publish_copy(archive::RunId run, archive::Sequence first, archive::Sequence last) {
    auto batch = std::make_shared<pipeline::PublishedBatch>();
    batch->run = run;
    batch->first_seq = first;
    batch->last_seq = last;
    batch->built = false;  // then sessions read it from the archive
    const std::size_t count = last - first + 1;
    if (items_wanted_ && run.value == followed_run_ && count <= archive::items_page_max) {
        if (!copied_ || copied_->outdated()) {
            auto reader = archive::Reader::open(settings_.archive, dictionary_, settings_.other);
            if (reader) copied_.emplace(std::move(*reader));
        }
        auto page = copied_ ? copied_->items(run, first - 1, count) : Result<archive::ItemPage>{archive::ItemPage{}};
        batch->built = page && page->items.size() == count;
        if (batch->built) batch->items = std::move(page->items);
    }
    server_->post([this, batch = hub_feed_.departs(std::move(batch))] {
        hub_feed_.arrived(*batch);
        hub_->published(batch);
    });
}

/// Once a second, for the consoles.
void ConsoleBackend::tell_standing() {
    constexpr double told_after_s = 2.0;  // chosen: an engine that answers is faster
    StreamHub::Standing standing;
    if (follower_) {
        const auto now = follower_->status();
        standing.follows = cluster::text_of(now);
        standing.origin_lost = now.lost;
    }
    if (publisher_) {
        const auto now = publisher_->status();
        if (!now.fault.empty() || now.waiting_s > told_after_s) standing.unpublished = cluster::text_of(now);
    }
    hub_->standing(std::move(standing));
}

Replication ConsoleBackend::replication() const {
    Replication told;
    if (publisher_) {
        const auto now = publisher_->status();
        told.line = cluster::text_of(now);
        told.figures = {
            {"publishing_waiting_items", "items that are committed and not acknowledged by the engine",
             static_cast<double>(now.waiting_items)},
            {"publishing_waiting_seconds", "time since none waited", now.waiting_s},
            {"publishing_fault", "1 while nothing is published; /healthz says why", now.fault.empty() ? 0.0 : 1.0},
            {"publishing_left_out", "runs that are not published", static_cast<double>(now.left_out.size())},
            {"published_steps_total", "steps that the engine has acknowledged", static_cast<double>(now.steps), true},
            {"published_items_total", "items in them", static_cast<double>(now.items), true},
            {"published_octets_total", "octets of them", static_cast<double>(now.octets), true}};
        if (requests_) {
            const auto counts = requests_->counts();
            told.figures.push_back({"follower_requests_total", "requests of people at followers that were genuine",
                                    static_cast<double>(counts.taken), true});
            told.figures.push_back({"follower_requests_refused_total",
                                    "requests that were forged, repeated, too old, or of a key that is not known",
                                    static_cast<double>(counts.refused), true});
        }
    }
    if (follower_) {
        const auto now = follower_->status();
        told.line = cluster::text_of(now);
        told.figures = {
            {"following_behind_items", "items of the origin that are not here", static_cast<double>(now.behind_items)},
            {"following_behind_seconds", "time since none was missing", now.behind_s},
            {"following_silent_seconds", "time since the origin was heard", now.silent_s},
            {"following_lost", "1 while the origin is silent", now.lost ? 1.0 : 0.0},
            {"following_fetch_fault", "1 while what the engine no longer has cannot be fetched; /healthz says why",
             now.fetch_fault.empty() ? 0.0 : 1.0},
            {"following_left_out", "runs that are not taken further", static_cast<double>(now.left_out.size())},
            {"followed_steps_total", "steps that were taken", static_cast<double>(now.steps), true},
            {"followed_fetched_steps_total", "of them, those that came from another server's API",
             static_cast<double>(now.fetched_steps), true},
            {"followed_items_total", "items in them", static_cast<double>(now.items), true},
            {"followed_refused_total", "messages that were refused", static_cast<double>(now.refused), true}};
    }
    return told;
}

}  // namespace aeolis::server
