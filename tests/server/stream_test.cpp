// SPDX-License-Identifier: Apache-2.0
#include "server/base/json.hpp"
#include "tests/server/running_server.hpp"
#include "tests/server/web_client.hpp"

#include <chrono>
#include <fmt/format.h>
#include <map>
#include <optional>

namespace server_stream_test {

using namespace aeolis;
using namespace aeolis::test;

namespace {

/// One client that follows everything and checks the chain of its batches.
struct Follower {
    Follower(std::uint16_t port, bool as_json, std::uint64_t after = 0)
        : json(as_json), client(port, as_json ? "aeolis.v1.json" : "aeolis.v1.protobuf"), complete_through(after) {
        REQUIRE(client.open());
        v1::ClientMessage message;
        message.mutable_subscribe()->set_after_seq(after);
        message.mutable_subscribe()->set_all_channels(true);
        send(message);
    }
    void send(const v1::ClientMessage& message) {
        client.send(json ? server::to_json(message) : message.SerializeAsString(), !json);
    }
    bool read() {
        const auto payload = client.receive();
        if (!payload) return false;
        last.Clear();
        if (json) {
            const auto parsed = server::from_json(*payload, last);
            REQUIRE(parsed);
        } else {
            REQUIRE(last.ParseFromString(*payload));
        }
        if (last.has_batch()) {
            CHECK(last.batch().after_seq() == complete_through);
            complete_through = last.batch().complete_through();
            history = history || last.batch().history();
            for (const auto& item : last.batch().items()) {
                seen.push_back(item.seq());
                ++kinds[item.item_case()];
                if (item.has_tone() && item.tone().has_tone()) ++decoded_tones;
            }
        }
        return true;
    }
    void read_through(std::uint64_t seq) {
        while (complete_through < seq) REQUIRE(read());
    }

    bool json;
    StreamClient client;
    std::uint64_t complete_through;
    bool history = false;
    v1::ServerMessage last;
    std::vector<std::uint64_t> seen;
    std::map<v1::Item::ItemCase, std::size_t> kinds;
    std::size_t decoded_tones = 0;
};

void send_no_op(Follower& follower, std::uint64_t request) {
    v1::ClientMessage message;
    message.mutable_command()->set_command("NO_OP");
    message.mutable_command()->set_request(request);
    follower.send(message);
    do REQUIRE(follower.read());
    while (!follower.last.has_command_reply());
    CHECK(follower.last.command_reply().accepted());
    CHECK(follower.last.command_reply().request() == request);
}

std::vector<std::uint64_t> all_from(std::uint64_t first, std::uint64_t last) {
    std::vector<std::uint64_t> numbers;
    for (auto i = first; i <= last; ++i) numbers.push_back(i);
    return numbers;
}

}  // namespace

TEST_CASE("exactly one offered subprotocol is echoed, or the upgrade is refused", "[stream][R42]") {
    RunningServer server;
    CHECK(StreamClient{server.port(), "aeolis.v1.json"}.subprotocol() == "aeolis.v1.json");
    CHECK(StreamClient{server.port(), "aeolis.v1.protobuf"}.subprotocol() == "aeolis.v1.protobuf");
    CHECK(StreamClient{server.port(), "chat, aeolis.v1.json, aeolis.v1.protobuf"}.subprotocol() == "aeolis.v1.json");
    for (const char* none : {"", "chat", "aeolis.v2.json"}) {
        StreamClient refused{server.port(), none};
        CHECK_FALSE(refused.open());
        CHECK(refused.status() == 400);
    }
}

TEST_CASE("a client that comes back with after_seq has no gap and no double", "[stream][R42][R43]") {
    RunningServer server{shipped_scenario("nominal"), 100.0};
    std::uint64_t through = 0;
    std::vector<std::uint64_t> seen;
    {
        Follower first{server.port(), true};
        while (first.last.run_state().run() == 0 && first.last.welcome().run_state().run() == 0) REQUIRE(first.read());
        send_no_op(first, 1);
        first.read_through(10);
        through = first.complete_through;
        seen = first.seen;
    }
    Follower second{server.port(), false, through};
    send_no_op(second, 2);
    second.read_through(through + 8);
    seen.insert(seen.end(), second.seen.begin(), second.seen.end());
    CHECK(seen == all_from(1, second.complete_through));

    server.restart();  // the run is over now, and all of it is in the archive
    Follower third{server.port(), false};
    third.read_through(second.complete_through);
    CHECK(third.history);
    CHECK(third.seen == all_from(1, third.complete_through));
}

TEST_CASE("what a rate left out is counted, and comes by HTTP, where all items of a run are",
          "[stream][http][R42][R62]") {
    RunningServer server{shipped_scenario("nominal_auto"), 0.0};
    Follower all{server.port(), false};
    std::map<std::uint64_t, std::string> by_stream;
    const auto read = [&] {
        REQUIRE(all.read());
        for (const auto& item : all.last.batch().items()) {
            by_stream[item.seq()] = item.SerializeAsString();
            CHECK_FALSE(item.samples().thinned());
        }
        CHECK(all.last.batch().left_out() == 0);
    };
    while (all.complete_through < 20'000) read();

    StreamClient slow{server.port(), "aeolis.v1.protobuf"};
    v1::ClientMessage message;
    message.mutable_subscribe()->set_all_channels(true);
    message.mutable_subscribe()->set_max_rate_hz(1.0);
    slow.send(message.SerializeAsString(), true);
    std::uint64_t seen = 0, left_out = 0, through = 0;
    while (through < 20'000) {
        const auto payload = slow.receive();
        REQUIRE(payload);
        v1::ServerMessage got;
        REQUIRE(got.ParseFromString(*payload));
        if (!got.has_batch()) continue;
        through = got.batch().complete_through();
        left_out += got.batch().left_out();
        seen += static_cast<std::uint64_t>(got.batch().items_size());
    }
    CHECK(left_out > 0);

    std::uint64_t after = 0, items = 0;
    while (after < through) {
        const auto page =
            web_request(server.port(), "GET", fmt::format("/api/v1/runs/latest/items?format=protobuf&after={}", after));
        REQUIRE(page.status == 200);
        v1::Batch batch;
        REQUIRE(batch.ParseFromString(page.body));
        CHECK(batch.after_seq() == after);
        REQUIRE(batch.complete_through() > after);
        for (const auto& item : batch.items()) {
            if (item.seq() > through) continue;
            ++items;
            if (item.seq() <= all.complete_through && by_stream.contains(item.seq()))
                CHECK(item.SerializeAsString() == by_stream[item.seq()]);
        }
        after = batch.complete_through();
    }
    CHECK(items == seen + left_out);
    // The newest first: each item once, down to the first, whatever the size of a page.
    std::uint64_t before = 2'000, expected = before - 1;
    for (unsigned limit = 1; expected > 0; limit = std::min(3 * limit, 1000U)) {
        const auto page = web_request(
            server.port(), "GET",
            fmt::format("/api/v1/runs/latest/items?format=protobuf&order=newest&after={}&limit={}", before, limit));
        REQUIRE(page.status == 200);
        v1::Batch batch;
        REQUIRE(batch.ParseFromString(page.body));
        CHECK(batch.complete_through() == before - 1);
        REQUIRE(batch.items_size() > 0);
        for (const auto& item : batch.items()) {
            REQUIRE(item.seq() == expected--);
            if (by_stream.contains(item.seq())) CHECK(item.SerializeAsString() == by_stream[item.seq()]);
        }
        CHECK(batch.after_seq() == expected);
        CHECK(page.next_after == std::to_string(expected == 0 ? 0 : expected + 1));
        before = expected + 1;
    }
    const auto newest = web_request(server.port(), "GET", "/api/v1/runs/latest/items?order=newest&limit=3");
    CHECK_THAT(newest.body, Catch::Contains("\"after_seq\":"));
    CHECK(std::ranges::any_of(newest.fields, [](const auto& field) {
        return field.first == "Link" && field.second.find("order=newest&limit=3&after=") != std::string::npos;
    }));
    CHECK(web_request(server.port(), "GET", "/api/v1/runs/latest/items?limit=1001").status == 400);
    CHECK_THAT(web_request(server.port(), "GET", "/api/v1/runs/latest/items?names=nonsense").body,
               Catch::Contains("names: there is no channel 'nonsense'"));
    CHECK_THAT(web_request(server.port(), "GET", "/api/v1/runs/latest/items?names=altitude_m&limit=200").body,
               Catch::StartsWith(R"({"run":"1","complete_through":"200")"));
}

TEST_CASE("a message that does not parse is refused and the stream goes on", "[stream]") {
    RunningServer server;
    for (const bool json : {true, false}) {
        Follower client{server.port(), json};
        client.client.send("{\"subscribe\": {\"after\": 1}}", !json);
        client.client.send(json ? "no JSON" : "\xFF\xFF\xFF", !json);
        int refusals = 0;
        while (refusals < 2) {
            REQUIRE(client.read());
            if (client.last.has_refusal()) ++refusals;
        }
        v1::ClientMessage command;
        command.mutable_command()->set_command("NO_OP");
        client.send(command);
        do REQUIRE(client.read());
        while (!client.last.has_command_reply());
        CHECK_THAT(client.last.command_reply().reason(), Catch::Contains("no run goes on"));
    }
}

TEST_CASE("a command over the stream is refused as over HTTP: by the same words and the same status", "[stream][R62]") {
    RunningServer server{shipped_scenario("nominal"), 1.0};
    Follower client{server.port(), true};
    for (int i = 0; i < 3000 && web_request(server.port(), "GET", "/api/v1/runs/1").status != 200; ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds{20});
    for (const char* body :
         {R"({"command":"NOPE","request":"7"})", R"({"command":"NO_OP","service":"XX","dry_run":true})",
          R"({"command":"NO_OP","release_at":"tomorrow"})", R"({"command":"NO_OP","client_id":"a b"})",
          R"({"command":"NO_OP","arguments":[{"name":"much","value":1}]})", R"({"action":"launch","number":"1"})",
          R"({"action":"cancel","number":"1","dry_run":true})", R"({"action":"cancel","number":"99"})",
          R"({"command":"EDL_DO_EDL"})"}) {
        INFO(body);
        const auto answer = web_request(server.port(), "POST", "/api/v1/runs/1/commands", body);
        v1::CommandReply by_http;
        REQUIRE(server::from_json(answer.body, by_http));
        v1::ClientMessage message;
        REQUIRE(server::from_json(body, *message.mutable_command()));
        client.send(message);
        do REQUIRE(client.read());
        while (!client.last.has_command_reply());
        const auto& by_stream = client.last.command_reply();
        CHECK_FALSE(by_stream.accepted());
        CHECK(by_stream.request() == by_http.request());
        CHECK(by_stream.dry_run() == by_http.dry_run());
        CHECK(by_stream.reason() == by_http.reason());
        CHECK(by_stream.status() == answer.status);
        CHECK(by_stream.title() == by_http.title());
        CHECK(by_stream.detail() == by_http.detail());
    }
}

TEST_CASE("an over-long message closes its own connection with 'too big'", "[stream]") {
    RunningServer server;
    StreamClient client{server.port(), "aeolis.v1.json"};
    REQUIRE(client.open());
    client.send(std::string(server::WebServer::message_octets_max + 1, ' '), false);
    CHECK_FALSE(client.receive());
    CHECK(client.close_code() == 1009);
    CHECK(client.close_words() == "a message has at most 65536 octets");
    CHECK(web_request(server.port(), "GET", "/healthz").status == 200);
}

TEST_CASE("a rehearsal is started, paused, paced and stopped over the stream", "[stream][R45]") {
    RunningServer server;
    Follower client{server.port(), true};
    const auto read_until = [&](auto condition) {
        do REQUIRE(client.read());
        while (!condition(client.last));
    };
    v1::ClientMessage message;
    auto& start = *message.mutable_control()->mutable_start();
    start.set_scenario("nominal");
    start.set_seed(5);
    start.set_pace(10.0);
    client.send(message);
    read_until([](const auto& said) { return said.welcome().run_state().run() == 1; });
    CHECK(client.last.welcome().run_state().seed() == 5);
    client.complete_through = 0;
    message.mutable_control()->set_pause(true);
    client.send(message);
    read_until([](const auto& said) { return said.run_state().state() == v1::RunState::paused; });
    message.mutable_control()->set_pause(false);
    client.send(message);
    read_until([](const auto& said) { return said.run_state().state() == v1::RunState::running; });
    message.mutable_control()->set_pace(200.0);
    client.send(message);
    read_until([](const auto& said) { return said.run_state().pace() == 200.0; });
    message.mutable_control()->set_stop(true);
    client.send(message);
    read_until([](const auto& said) { return said.run_state().state() == v1::RunState::finished; });
    CHECK(client.last.run_state().outcome() == v1::Landing::stopped);
    CHECK(client.last.run_state().digest().size() == 64);
}

TEST_CASE("UHF packets and decoded tones are streamed while the vehicle flies, and are in the archive",
          "[stream][R41][R42][R43]") {
    auto scenario = shipped_scenario("nominal_auto");
    scenario.start_before_entry_s = 900.0;  // just before the first timepoint; tones begin at 750
    scenario.commands[0].send_before_entry_s = 895.0;
    scenario.commands[1].send_before_entry_s = 885.0;
    RunningServer server{scenario, 300.0};
    Follower client{server.port(), false};
    while (client.kinds[v1::Item::kSamples] < 500 || client.decoded_tones < 5 || client.kinds[v1::Item::kTimepoint] < 5)
        REQUIRE(client.read());
    CHECK(client.kinds[v1::Item::kUnit] > 500);
    CHECK(client.kinds[v1::Item::kEvent] > 0);
    CHECK(client.kinds[v1::Item::kCommandStage] >= 16);  // both of the script, eight stages each
    CHECK(client.kinds[v1::Item::kLink] > 0);
    CHECK(client.seen == all_from(1, client.complete_through));  // all of it live: nothing is thinned or left out

    auto reader = archive::Reader::open(server.archive(), tests::shipped_dictionary());
    REQUIRE(reader);
    const auto durable = reader->last_seq(archive::RunId{1});
    REQUIRE(durable);
    CHECK(*durable >= client.complete_through);  // published means durable
    const auto metrics = web_request(server.port(), "GET", "/metrics").body;
    CHECK_THAT(metrics, Catch::Contains("aeolis_link_packets_total{link=\"uhf_live\"} ") &&
                            Catch::Contains("aeolis_link_packets_total{link=\"tones\"} "));
    CHECK_THAT(metrics,
               Catch::Contains("aeolis_stream_clients_behind ") && !Catch::Contains("aeolis_stream_octets_total 0\n"));
}

TEST_CASE("a run that is over comes again over the socket at a pace, and not while it goes on", "[stream][R42][R45]") {
    auto scenario = shipped_scenario("nominal_auto");
    scenario.start_before_entry_s = 900.0;
    scenario.commands[0].send_before_entry_s = 895.0;
    scenario.commands[1].send_before_entry_s = 885.0;
    RunningServer server{scenario, 100.0};
    Follower client{server.port(), false};
    for (int tones = 0; tones < 6;) {
        REQUIRE(client.read());
        for (const auto& item : client.last.batch().items()) tones += item.has_tone() ? 1 : 0;
    }
    v1::ClientMessage replay;
    replay.mutable_subscribe()->set_run(1);
    replay.mutable_subscribe()->set_pace(1.0);
    client.send(replay);
    do REQUIRE(client.read());
    while (!client.last.has_refusal());
    CHECK_THAT(client.last.refusal().reason(), Catch::Contains("run 1 goes on"));
    v1::ClientMessage stop;
    stop.mutable_control()->set_stop(true);
    client.send(stop);
    while (client.last.run_state().state() != v1::RunState::finished) REQUIRE(client.read());
    const auto last_seq = client.last.run_state().last_seq();
    REQUIRE(last_seq > 0);

    struct Arrival {
        std::chrono::steady_clock::time_point at;
        std::uint64_t through = 0;
        std::optional<Ert> ert;  ///< of the newest tone
    };
    const auto replayed = [&](double pace, std::uint64_t after) {
        replay.mutable_subscribe()->set_pace(pace);
        replay.mutable_subscribe()->set_after_seq(after);
        client.send(replay);
        do REQUIRE(client.read());
        while (!client.last.has_welcome());
        CHECK(client.last.welcome().run_state().state() == v1::RunState::finished);
        CHECK(client.last.welcome().last_seq() == last_seq);
        client.complete_through = after;
        client.seen.clear();
        std::vector<Arrival> arrivals;
        while (client.complete_through < last_seq) {
            REQUIRE(client.read());
            auto& arrival =
                arrivals.emplace_back(Arrival{std::chrono::steady_clock::now(), client.complete_through, {}});
            for (const auto& item : client.last.batch().items())
                if (item.has_tone()) arrival.ert = Ert{item.ert_us()};
        }
        return arrivals;
    };
    replayed(10'000.0, 0);
    const auto all = client.seen;
    CHECK(all.back() + 1 >= last_seq);  // the last may be samples, which nobody asked for
    constexpr double pace = 100.0;
    const auto arrivals = replayed(pace, 0);
    CHECK(client.seen == all);
    std::optional<Arrival> first;
    std::size_t held = 0;
    for (const auto& arrival : arrivals) {
        if (!arrival.ert) continue;
        if (!first) first = arrival;
        const double wanted_s = static_cast<double>(arrival.ert->microseconds - first->ert->microseconds) * 1e-6 / pace;
        const double took_s = std::chrono::duration<double>(arrival.at - first->at).count();
        CHECK(took_s > wanted_s - 0.2);  // the first may itself have come late, and batches are 50 ms apart
        if (took_s < wanted_s + 0.5) ++held;
    }
    REQUIRE(first);
    CHECK(arrivals.size() > 3);
    CHECK(held > 3);
    replayed(10'000.0, last_seq / 2);  // a jump, and another pace
    CHECK((client.seen.front() > last_seq / 2 && client.seen.front() <= last_seq / 2 + 2));
}

}  // namespace server_stream_test
