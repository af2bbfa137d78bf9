// SPDX-License-Identifier: Apache-2.0
// The ground under its design load.
//
// Each second 2000 packets of 1.5 kB are kept as they came, decoded, stored, and sent to a thousand clients that follow
// 30 channels at 20 Hz and every event; one client is stalled. First all follow the same channels, then each has some
// of its own. The first, a middle and the last client are watched, and the stalled one when it reads again. Then the
// same once more, while a client asks 60 slow questions at a time, one sends 1000 commands a second, which are checked
// and refused as there is no vehicle, and one replays the run before; and once while programs ask for every list of the
// API at once: of the run itself, of one with 4096 commands, and of what people made.

#include "bench/greedy_clients.hpp"
#include "bench/list_readers.hpp"
#include "bench/loopback_clients.hpp"
#include "bench/must.hpp"
#include "common/bytes.hpp"
#include "server/api/api.hpp"
#include "server/archive/reader.hpp"
#include "server/net/console_backend.hpp"
#include "server/net/web_server.hpp"
#include "server/pipeline/pipeline_thread.hpp"
#include "tests/server/run_writer.hpp"
#include "tests/support/packet_model_of.hpp"
#include "tests/support/temporary_folder.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <malloc.h>
#include <optional>
#include <spdlog/spdlog.h>
#include <string>
#include <string_view>
#include <sys/socket.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <utility>
#include <vector>

using namespace aeolis;
using namespace aeolis::bench;
using Clock = std::chrono::steady_clock;

namespace {

constexpr std::size_t clients = 1000, watched = 4, watched_channels = 30;  // one of those watched is stalled
constexpr std::size_t packet_kinds = 32, packets_per_s = 2000, channels_a_packet = 368;  // 1.5 kB
constexpr std::size_t events_per_s = 10, tones_per_s = 1, stages_per_s = 2;
constexpr int stalled_receive_octets = 4096;  // otherwise the kernel would read for it
// From so little room the sender learns that there is some only by its next probe, which may be seconds later
// (ss -tino: "timer:(persist"). Who reads on has an ordinary buffer.
constexpr int reading_receive_octets = 1 << 18;
constexpr double seconds = 10.0, seconds_with_lists_max = 60.0;
constexpr double sample_rate_hz = 20.0;
constexpr double lists_from_s = 2.0;  // after the load began
constexpr std::size_t people = 12;    // who ask for lists, each by several programs
constexpr std::uint64_t commands_of_old_run = 4096, rounds_a_batch = 512;
constexpr std::size_t evidence_octets = 400;  // as long as evidence gets; each is two octets of JSON
constexpr Apid event_apid{0x7F};

double now_s() {
    return std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
}

/// Packets of floats, each a channel, and an event with its time of making: two numbers of 32 bits.
dictionary::Dictionary load() {
    dictionary::Dictionary d;
    d.mission = "LOAD";
    d.id = 1;
    dictionary::Type real;
    real.kind = dictionary::ValueKind::real;
    real.encoding = dictionary::Encoding::ieee754;
    real.bits = 32;
    for (std::size_t kind = 0; kind < packet_kinds; ++kind) {
        dictionary::Packet packet;
        packet.name = "Load" + std::to_string(kind);
        packet.apid = Apid{static_cast<std::uint16_t>(kind + 1)};
        packet.octets = static_cast<unsigned>(tm_overhead_octets + 4 * channels_a_packet);
        for (std::size_t i = 0; i < channels_a_packet; ++i) {
            const ChannelId id{static_cast<std::uint16_t>(d.channels.size())};
            const auto name = "load_" + std::to_string(id.value);
            d.channels.push_back({id, name, name, "", real});
            packet.fields.push_back(
                {name, real, id, static_cast<unsigned>((tm_data_offset_octets + 4 * i) * 8), std::nullopt});
        }
        d.packets.push_back(packet);
    }
    dictionary::Type whole;
    whole.bits = 32;
    dictionary::Packet event;
    event.name = "LOAD_EVENT";
    event.apid = event_apid;
    event.event = EvrId{1};
    event.octets = tm_overhead_octets + 2 + 8;
    const unsigned data = tm_data_offset_octets * 8;
    dictionary::Type id = whole;
    id.bits = 16;
    event.fields = {{"event_id", id, {}, data, {}},
                    {"seconds", whole, {}, data + 16, {}},
                    {"nanoseconds", whole, {}, data + 48, {}}};
    d.packets.push_back(event);
    d.events = {
        {EvrId{1}, "LOAD_EVENT", dictionary::EventLevel::activity_hi, "at {seconds}.{nanoseconds}", packet_kinds}};
    d.model = tests::packet_model_of(d);
    return d;
}

std::uint64_t resident_octets() {
    std::ifstream statm{"/proc/self/statm"};
    std::uint64_t size = 0, resident = 0;
    statm >> size >> resident;
    return resident * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

/// A client that reads every item, as a console does. One thread.
class Watcher {
  public:
    /// @param stalled  it sends signs of life, and reads nothing until read_on()
    Watcher(const char* who, std::uint16_t port, const std::string& subscription, bool stalled = false)
        : name(who), reads_(!stalled), socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
        if (stalled)
            must(::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &stalled_receive_octets, sizeof stalled_receive_octets) ==
                     0,
                 "SO_RCVBUF");
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_port = htons(port);
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        must(::connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0, "connect");
        write("GET /api/v1/stream HTTP/1.1\r\nHost: 127.0.0.1\r\nUpgrade: websocket\r\nConnection: "
              "Upgrade\r\nSec-WebSocket-Version: 13\r\n"
              "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\nSec-WebSocket-Protocol: aeolis.v1.protobuf\r\n\r\n");
        while (!kept_.ends_with("\r\n\r\n")) kept_ += read(1);
        must(kept_.starts_with("HTTP/1.1 101 "), "the upgrade to a stream");
        kept_.clear();
        must(subscription.size() < 126, "a short subscription");
        write(std::string{"\x82"} + static_cast<char>(0x80U | subscription.size()) + std::string(4, '\0') +
              subscription);
        thread_ = std::thread{[this] { follow(); }};
    }
    ~Watcher() {
        reads_ = true;
        ::shutdown(socket_, SHUT_RDWR);
        thread_.join();
        ::close(socket_);
    }

    void read_on() {
        must(::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &reading_receive_octets, sizeof reading_receive_octets) == 0,
             "SO_RCVBUF");
        reads_ = true;
    }

    const char* name;  ///< in the report
    std::atomic<std::uint64_t> events{0}, tones{0}, stages{0}, through{0};
    std::atomic<std::uint64_t> thinned{0};  ///< samples marked as preceded by omitted ones
    std::atomic<bool> broken{false};        ///< a batch did not continue the one before
    std::vector<double> event_ms, sample_ms;

  private:
    void write(const std::string& octets) {
        must(::send(socket_, octets.data(), octets.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(octets.size()),
             "send");
    }
    std::string read(std::size_t octets) {
        std::string got(octets, '\0');
        if (octets > 0 && ::recv(socket_, got.data(), octets, MSG_WAITALL) != static_cast<ssize_t>(octets))
            over_ = true;
        return got;
    }
    void follow() {
        while (!reads_) {
            say_that_it_lives();
            std::this_thread::sleep_for(std::chrono::milliseconds{100});
        }
        while (!over_) {
            const auto head = read(2);
            std::uint64_t octets = static_cast<std::uint8_t>(head[1]);
            const std::size_t more = octets == 126 ? 2 : octets == 127 ? 8 : 0;
            if (more > 0) octets = 0;
            for (const char each : read(more)) octets = octets << 8U | static_cast<std::uint8_t>(each);
            const auto payload = read(octets);
            v1::ServerMessage message;
            if (over_ || (head[0] & 0xF) != 2 || !message.ParseFromString(payload)) continue;
            if (message.has_refusal()) std::printf("  %s was told: %s\n", name, message.refusal().reason().c_str());
            if (!message.has_batch()) continue;
            take(message.batch());
            say_that_it_lives();
        }
    }
    void say_that_it_lives() {
        if (now_s() - alive_s_ < 5.0) return;
        alive_s_ = now_s();
        write(std::string{unsolicited_pong});
    }
    void take(const v1::Batch& batch) {
        const double now = now_s();
        if (batch.after_seq() != through) broken = true;
        through = batch.complete_through();
        double newest = 0.0;
        for (const auto& item : batch.items()) {
            if (item.has_samples()) newest = std::max(newest, item.samples().sclk());
            if (item.has_samples() && item.samples().thinned()) ++thinned;
            if (item.has_tone()) ++tones;
            if (item.has_command_stage()) ++stages;
            if (!item.has_event()) continue;
            ++events;
            event_ms.push_back(1e3 * (now - item.event().sclk()));
        }
        if (newest > 0.0) sample_ms.push_back(1e3 * (now - newest));
    }

    std::atomic<bool> reads_;
    int socket_;
    bool over_ = false;
    double alive_s_ = now_s();
    std::string kept_;
    std::thread thread_;
};

double quantile(std::vector<double>& values, double q) {
    if (values.empty()) return 1e9;
    const auto at = static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + at, values.end());
    return values[static_cast<std::size_t>(at)];
}

bool met = true;
void goal(const std::string& what, double figure, double most, const char* unit) {
    std::printf("  %-60s %9.2f %s, goal %.0f", what.c_str(), figure, unit, most);
    if (most > 0.0) std::printf(": ratio %.2f", figure / most);
    std::printf("\n");
    met = met && figure <= most;
}

/// A client's subscription to 30 channels: all of the first kind of packet, or ten of each of three kinds, different
/// for each client.
enum class Channels { same, own };
/// What else is asked of the server under the load.
enum class Beside { nothing, greedy_clients, every_list };
std::string subscription_of(std::size_t client, Channels channels) {
    v1::ClientMessage message;
    auto& subscribe = *message.mutable_subscribe();
    for (std::size_t i = 0; i < watched_channels; ++i) {
        const std::size_t kind = channels == Channels::same ? 0 : (client + 11 * (i / 10)) % packet_kinds;
        const std::size_t within = channels == Channels::same ? i : (client * 7 + i % 10) % channels_a_packet;
        subscribe.add_channels(static_cast<std::uint32_t>(kind * channels_a_packet + within));
    }
    subscribe.set_max_rate_hz(sample_rate_hz);
    subscribe.set_without_units(true);
    return message.SerializeAsString();
}

/// Of the run before, at its pace.
std::string replay_of_old_run() {
    v1::ClientMessage message;
    message.mutable_subscribe()->set_run(1);
    message.mutable_subscribe()->set_all_channels(true);
    message.mutable_subscribe()->set_pace(1.0);
    return message.SerializeAsString();
}

/// Every list of the API at its longest page, as JSON, which takes the most memory.
std::vector<std::string> list_targets() {
    std::vector<std::string> lists{"runs", "users", "tokens", "audit", "layouts", "scenarios", "campaigns"};
    for (const std::string run : {"runs/1/", "runs/2/"})
        for (const auto* list : {"events", "tones", "explanations", "alarms", "notes", "commands", "packets",
                                 "interventions", "timepoints"})
            lists.push_back(run + list);
    std::vector<std::string> targets;
    for (const auto& list : lists) {
        targets.push_back("/api/v1/" + list);
        if (list.ends_with("timepoints")) continue;  // it has one page
        const bool brief = list.ends_with("commands") || list.ends_with("packets") || list == "audit";
        targets.back() += brief ? "?limit=1000" : "?limit=10000";
    }
    for (const auto* run : {"1", "2"}) targets.push_back(std::string{"/api/v1/runs/"} + run + "/items?limit=1000");
    return targets;
}

/// The API over the threads of the load, and who asks: people with a token each.
struct ApiServer {
    ApiServer(const std::filesystem::path& folder, const dictionary::Dictionary& dictionary,
              server::QueryThreads& queries, server::PipelineThread& pipeline, server::StreamHub& hub)
        : plans({}, dictionary), console(folder / "web"),
          rehearsals(
              scenarios, plans, dictionary, pipeline, [](const auto& action) { action(); },
              [](const v1::StartRehearsal&, const auto& done) { done(Error{"was not cut off"}); },
              {[](archive::RunId, const auto&, bool, const auto& done) { done(std::string{}); },
               [](archive::RunId, const auto& done) { done(server::TimelineCheck::Reanalysis{}); }},
              {[](const auto&) {}, [](const auto&) {}}),
          campaigns(folder, scenarios, dictionary),
          forecasts(std::make_shared<server::shadow::ForecastService>(dictionary, folder / "none.db",
                                                                      [](const auto&, const auto&) { return false; })),
          predictions(dictionary), access(std::move(server::Access::open({.file = folder / "accounts.json"})).value()),
          api({dictionary, scenarios, plans, queries, rehearsals, predictions, campaigns, forecasts, hub, pipeline,
               console, *access, false, [] { return std::size_t{0}; }, clock_watch}) {
        for (std::size_t i = 0; i < people; ++i) {
            v1::NewUser user;
            user.set_user("person" + std::to_string(i));
            user.set_role("administrator");
            user.set_password("given by another");
            must(access->add_user(user).ok(), "add_user");
            v1::NewToken token;
            token.set_name("of-" + user.user());
            token.set_role(user.role());
            token.set_owner(user.user());
            auto made = access->add_token(token);
            must(made.ok(), "add_token");
            tokens.push_back(made->token());
        }
    }

    server::ScenarioLibrary scenarios{AEOLIS_SOURCE_DIR "/simulation/scenarios"};
    server::instruction::PlanLibrary plans;
    server::StaticFiles console;
    server::RehearsalManager rehearsals;
    server::campaign::CampaignManager campaigns;
    std::shared_ptr<server::shadow::ForecastService> forecasts;
    server::PredictionService predictions;
    std::unique_ptr<server::Access> access;
    server::ClockWatch clock_watch;
    server::Api api;
    std::vector<std::string> tokens;
};

/// Writes a run with many commands in a process of its own, so that its memory is not charged to the server.
void write_old_run(const std::filesystem::path& file, const dictionary::Dictionary& dictionary) {
    const pid_t writer = ::fork();
    must(writer >= 0, "fork");
    if (writer == 0) {
        {
            auto archive = std::move(archive::Archive::open(file)).value();
            const auto run = archive.begin_run({}, dictionary);
            must(run.ok(), "begin_run");
            test::RunWriter rows{archive, *run, std::string(evidence_octets, '"')};
            while (rows.rounds() < commands_of_old_run) rows.add(rounds_a_batch);
            rows.finish();
        }
        ::_exit(0);
    }
    int status = 0;
    must(::waitpid(writer, &status, 0) == writer && WIFEXITED(status) && WEXITSTATUS(status) == 0, "the old run");
}

/// Runs threads and connections as in `aeolis serve`, with packets made here in place of a landing's.
void under_load(Channels channels, Beside beside) {
    const bool with_lists = beside == Beside::every_list, with_greedy = beside == Beside::greedy_clients;
    const bool with_api = beside != Beside::nothing;
    std::array<LoopbackClients, 2> others;  // clients that join between the first and the middle one, and after it
    std::optional<ListReaders> readers;
    if (with_lists) readers.emplace(list_targets());
    std::optional<GreedyClients> greedy;
    if (with_greedy) greedy.emplace();
    spdlog::set_level(spdlog::level::err);
    ::mallopt(M_MMAP_THRESHOLD, server::ConsoleBackend::mapped_octets);  // as `aeolis serve`
    const test::TemporaryFolder folder;
    const auto file = folder / "load.db";
    const auto dictionary = load();
    if (with_api) write_old_run(file, dictionary);
    auto archive = std::move(archive::Archive::open(file)).value();
    auto queries = std::move(server::QueryThreads::open(file, dictionary)).value();
    std::unique_ptr<server::WebServer> web;
    server::StreamHub::Services services;
    services.want_items = [](bool) {};
    services.read_items = [&](archive::RunId run, archive::Sequence after, std::size_t limit,
                              archive::Reader::ItemKinds kinds, const auto& done) {
        const bool taken = queries->ask(
            [&web, run, after, limit, kinds, done](archive::Reader& reader) {
                auto page = reader.items(run, after, limit, kinds);
                web->post([done, page = std::move(page)]() mutable { done(std::move(page)); });
            },
            {}, server::JobPriority::soon);
        if (!taken) web->post([done] { done(Error{server::QueryThreads::busy}); });
    };
    services.read_run = [&](std::uint64_t run, const auto& done) {
        const bool taken = queries->ask(
            [&web, run, done](archive::Reader& reader) {
                auto of_archive = reader.run(archive::RunId{static_cast<std::uint32_t>(run)});
                web->post([done, of_archive = std::move(of_archive)]() mutable { done(std::move(of_archive)); });
            },
            {}, server::JobPriority::soon);
        if (!taken) web->post([done] { done(Error{server::QueryThreads::busy}); });
    };
    server::StreamHub hub{dictionary.id, services};
    std::optional<ApiServer> api;
    server::WebServer::Handlers handlers;
    handlers.request = [&](server::HttpRequest request, const server::Respond& respond) {
        api->api.handle(std::move(request), respond);
    };
    handlers.admit_stream = [](const server::Credentials&) { return server::HttpResponse{}; };
    handlers.open_stream = [&](const server::Credentials&, server::StreamFormat format, std::function<void()> wake) {
        return std::make_shared<server::StreamSession>(hub, format, std::move(wake), server::StreamSession::follower());
    };
    web = std::move(server::WebServer::open({}, handlers)).value();
    server::PipelineThread pipeline{
        std::move(archive), dictionary, server::PipelineThread::Faults::give_up, [&](auto batch) {
            web->post([&hub, batch = std::move(batch)]() mutable { hub.published(std::move(batch)); });
        }};
    if (with_api) api.emplace(folder.path(), dictionary, *queries, pipeline, hub);
    std::thread network{[&] { web->run(); }};
    const auto run = pipeline.begin({});
    must(run.ok(), "begin");
    v1::RunState state;
    state.set_run(run->value);
    state.set_attained_pace(1.0);
    web->post([&hub, state] { hub.run_state(state); });

    std::uint64_t sent_packets = 0, sent_events = 0, sent_tones = 0, sent_stages = 0;
    std::uint64_t resident = 0, raw_octets = 0;
    double behind_s = 0.0;
    {
        std::size_t joined = 0;
        const auto next = [&] { return subscription_of(joined++, channels); };
        const auto half = [&] {
            // The server takes a thousand streams; the client that replays is one of them.
            std::vector<std::string> subscriptions((clients - watched - (greedy ? 1 : 0)) / 2);
            std::ranges::generate(subscriptions, next);
            return LoopbackClients::Settings{subscriptions.size(), 0, true, subscriptions};
        };
        Watcher first{"the first to join", web->port(), next()},
            stalled{"the one that was stalled", web->port(), next(), true};
        others[0].connect(web->port(), half());
        Watcher middle{"one in the middle", web->port(), next()};
        others[1].connect(web->port(), half());
        Watcher last{"the last to join", web->port(), next()};
        const std::array all{&first, &middle, &last, &stalled};
        std::this_thread::sleep_for(std::chrono::milliseconds{500});
        for (auto& each : others) each.reset_counts();
        std::vector<std::uint8_t> octets(tm_overhead_octets + 4 * channels_a_packet), event(tm_overhead_octets + 10);
        BitWriter bits{std::span<std::uint8_t>(octets).subspan(tm_data_offset_octets)};
        for (std::size_t i = 0; i < channels_a_packet; ++i)
            bits.put_float(static_cast<float>(std::sin(static_cast<double>(i))));
        const std::string path = "/api/v1/runs/" + std::to_string(run->value);
        if (greedy) greedy->begin(web->port(), {path + "/proof", api->tokens[0], path + "/commands", api->tokens[1]});
        std::optional<Watcher> replaying;
        if (greedy) replaying.emplace("the one that replays", web->port(), replay_of_old_run());
        const double begin = now_s();
        bool lists_begun = false;
        double lists_s = 0.0;
        while (now_s() - begin < seconds || (readers && lists_s == 0.0 && now_s() - begin < seconds_with_lists_max)) {
            server::Delivery delivery;
            const double now = now_s();
            if (readers && !lists_begun && now - begin > lists_from_s) {
                readers->begin(web->port(), api->tokens);
                lists_begun = true;
            }
            if (lists_begun && lists_s == 0.0 && readers->over()) lists_s = now - begin - lists_from_s;
            for (; static_cast<double>(sent_packets) < (now - begin) * packets_per_s; ++sent_packets) {
                const auto kind = static_cast<std::uint16_t>(sent_packets % packet_kinds);
                octets[tm_data_offset_octets + 3] = static_cast<std::uint8_t>(sent_packets >> 5U);
                seal_tm_packet(octets, Apid{static_cast<std::uint16_t>(kind + 1)},
                               static_cast<std::uint16_t>(sent_packets / packet_kinds & 0x3FFFU), Sclk{now},
                               dictionary.id);
                delivery.entries.emplace_back(
                    telemetry::ReceivedOctets{telemetry::uhf_live_link, Ert{std::llround(now * 1e6)}, octets});
                delivery.entries.emplace_back(telemetry::ReceivedPacket{telemetry::uhf_live_link, Ert{0}, octets});
                raw_octets += octets.size();
            }
            for (; static_cast<double>(sent_events) < (now - begin) * events_per_s; ++sent_events) {
                BitWriter told{std::span<std::uint8_t>(event).subspan(tm_data_offset_octets)};
                told.put(1, 16);
                seal_tm_packet(event, event_apid, static_cast<std::uint16_t>(sent_events), Sclk{now}, dictionary.id);
                delivery.entries.emplace_back(telemetry::ReceivedPacket{telemetry::uhf_live_link, Ert{0}, event});
            }
            for (; static_cast<double>(sent_tones) < (now - begin) * tones_per_s; ++sent_tones)
                delivery.entries.emplace_back(telemetry::ReceivedTone{});
            for (; static_cast<double>(sent_stages) < (now - begin) * stages_per_s; ++sent_stages) {
                archive::StageRecord stage;
                stage.command = sent_stages + 1;
                stage.name = "LOAD";
                stage.stage = commands::Stage::radiated;
                stage.status = commands::Status::ok;
                delivery.entries.emplace_back(std::move(stage));
            }
            must(pipeline.deliver(std::move(delivery)), "deliver");
            behind_s = std::max(behind_s, now_s() - now);
            resident = std::max(resident, resident_octets());
            std::this_thread::sleep_for(std::chrono::milliseconds{5});
        }
        const double stopped = now_s(), lasted_s = stopped - begin;
        stalled.read_on();
        must(pipeline.finish({archive::Outcome::stopped, "", "", ""}).ok(), "finish");
        state.set_state(v1::RunState::finished);
        web->post([&hub, state] { hub.run_state(state); });  // as a run reports its end
        const std::uint64_t last_seq = 2 * (sent_packets + sent_events) + sent_tones + sent_stages;
        const auto has_all = [&](const Watcher* each) { return each->through == last_seq; };
        while (!std::ranges::all_of(all, has_all) && now_s() - stopped < 10.0)
            std::this_thread::sleep_for(std::chrono::milliseconds{10});
        const double caught_up_s = now_s() - stopped;
        std::printf("%.0f packets/s of %zu octets, %zu channels each, for %.0f s; %zu clients on %zu channels %s at "
                    "%.0f Hz, one of them stalled\n",
                    static_cast<double>(sent_packets) / lasted_s, octets.size(), channels_a_packet, lasted_s, clients,
                    watched_channels, channels == Channels::same ? "that are the same" : "of their own",
                    sample_rate_hz);
        if (readers)
            std::printf(
                "  %zu programs of %zu people asked for %zu lists each, at once: %.0f MB in %.1f s, the longest wait "
                "%.1f s\n",
                ListReaders::readers, people, list_targets().size(), static_cast<double>(readers->octets()) * 1e-6,
                lists_s, 1e-3 * readers->longest_ms());
        if (greedy)
            std::printf(
                "  beside them %llu answers to slow questions and %llu refusals, %llu commands of which %llu got 429, "
                "%llu stages replayed\n",
                static_cast<unsigned long long>(greedy->answers()), static_cast<unsigned long long>(greedy->refused()),
                static_cast<unsigned long long>(greedy->commands()), static_cast<unsigned long long>(greedy->limited()),
                static_cast<unsigned long long>(replaying->stages.load()));
        if (greedy)
            goal("clients beside them that got nothing", greedy->answers() > 0 && replaying->stages > 0 ? 0.0 : 1.0,
                 0.0, "");
        std::printf("  to the clients %.1f MB/s; delivery waited for the archive %.0f ms at most\n",
                    static_cast<double>(others[0].octets() + others[1].octets()) / lasted_s * 1e-6, 1e3 * behind_s);
        for (Watcher* each : all) {
            const std::string who = std::string{", "} + each->name;
            const auto lost = [](std::uint64_t sent, std::uint64_t seen) {
                return static_cast<double>(sent) - static_cast<double>(seen);
            };
            goal("events that are lost or doubled" + who, std::abs(lost(sent_events, each->events)), 0.0, "");
            goal("tones and command stages that are" + who,
                 std::abs(lost(sent_tones, each->tones)) + std::abs(lost(sent_stages, each->stages)), 0.0, "");
            goal("sequence numbers without an answer" + who, lost(last_seq, each->through), 0.0, "");
            goal("batches that do not join the one before" + who, each->broken ? 1.0 : 0.0, 0.0, "");
            if (each == &stalled) continue;  // its delay is its own choice
            const double event_ms = quantile(each->event_ms, 0.99), sample_ms = quantile(each->sample_ms, 0.99);
            if (with_lists) {  // the goals are for the load alone
                std::printf("  p99%s: event %.0f ms, newest sample %.0f ms\n", who.c_str(), event_ms, sample_ms);
                continue;
            }
            goal("event, from receipt to the client, p99" + who, event_ms, 40.0, "ms");
            goal("newest sample's age when a batch arrives, p99" + who, sample_ms, 65.0, "ms");
        }
        goal("samples' gaps that the stalled one is not told of", stalled.thinned > 0 ? 0.0 : 1.0, 0.0, "");
        std::printf("  the stalled one had caught up after %.2f s\n", caught_up_s);
        if (readers) {
            goal("lists that are missing", lists_s > 0.0 ? 0.0 : 1.0, 0.0, "");
            goal("lists that were refused", static_cast<double>(readers->refused()), 0.0, "");
        }
        goal("connections that ended", static_cast<double>(others[0].lost_connections() + others[1].lost_connections()),
             0.0, "");
        goal("resident memory", static_cast<double>(resident) * 1e-6, 300.0, "MB");
    }
    for (auto& each : others) each.close();
    auto reader = archive::Reader::open(file, dictionary);
    must(reader.ok(), "Reader::open");
    archive::EventQuery events;
    events.limit = 10'000;
    goal("items that are not in the archive",
         static_cast<double>(2 * (sent_packets + sent_events) + sent_tones + sent_stages) -
             static_cast<double>(reader->last_seq(*run).value()),
         0.0, "");
    const auto raw_links = reader->raw_links(*run).value();
    const double raw_kept = raw_links.empty() ? 0.0 : static_cast<double>(raw_links.front().octets);
    std::printf("  %.1f MB kept as they came\n", raw_kept * 1e-6);
    goal("octets that are not in the archive as they came", static_cast<double>(raw_octets) - raw_kept, 0.0, "");
    greedy.reset();
    web->stop();
    network.join();
    queries.reset();
    api.reset();
}

}  // namespace

/// `load_bench [same|own|greedy|lists]...`: those loads alone; none named: all.
int main(int count, char** arguments) {
    struct Load {
        std::string_view name;
        Channels channels;
        Beside beside;
    };
    constexpr std::array loads{
        Load{"same", Channels::same, Beside::nothing}, Load{"own", Channels::own, Beside::nothing},
        Load{"greedy", Channels::own, Beside::greedy_clients}, Load{"lists", Channels::own, Beside::every_list}};
    const std::vector<std::string_view> wanted{arguments + 1, arguments + count};
    for (const auto& name : wanted)
        must(std::ranges::find(loads, name, &Load::name) != loads.end(), "a load: same, own, greedy or lists");
    for (const auto& [name, channels, beside] : loads) {
        if (!wanted.empty() && std::ranges::find(wanted, name) == wanted.end()) continue;
        // each in its own process, with its own heap
        const pid_t child = ::fork();
        must(child >= 0, "fork");
        if (child == 0) {
            under_load(channels, beside);
            std::fflush(stdout);
            ::_exit(met ? 0 : 1);
        }
        int status = 0;
        must(::waitpid(child, &status, 0) == child && WIFEXITED(status), "the load");
        met = met && WEXITSTATUS(status) == 0;
    }
    return met ? 0 : 1;
}
