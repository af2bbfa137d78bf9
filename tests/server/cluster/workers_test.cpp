// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/case_collector.hpp"
#include "server/cluster/case_messages.hpp"
#include "server/cluster/case_worker.hpp"
#include "tests/server/cluster/followed.hpp"
#include "tests/server/cluster/nats_server.hpp"
#include "tests/support/catch.hpp"

#include <cmath>
#include <fmt/format.h>
#include <memory>
#include <thread>

namespace server_cluster_workers_test {

using namespace aeolis;
using namespace aeolis::server;
using namespace std::chrono_literals;
using campaign::CampaignStore;
using campaign::CaseResult;
using campaign::Progress;
using cluster::Engine;
using tests::connected, tests::NatsServer;

namespace {

const campaign::Identity identity{"made_up", "name: \"made_up\"\nseed_of: 1\n", 1, "4711", "0123456789abcdef"};
const cluster::CollectorTimes soon{20ms, 1s, 2s};

/// A case that is nothing but a function of its number: each third lands, each third is struck, each third is lost.
CaseResult made_up(std::uint64_t number) {
    const auto x = static_cast<double>(number);
    CaseResult result;
    result.number = number;
    result.outcome = number % 3 == 0 ? "touchdown" : number % 3 == 1 ? "impact" : "lost";
    result.reason = fmt::format("made up {}", number);
    result.limits_exceeded = number % 5;
    result.end_cycle = 1000 + number;
    if (number % 3 == 0) {
        result.touchdown = simulation::TouchdownReport{std::sin(x), 1.0 / x, 1e3 * std::cos(x), -4.6, 137.4, 0.1 * x};
        result.east_m = std::exp(std::sin(x));
        result.north_m = -x / 7.0;
    }
    if (number % 2 == 0) result.parachute = simulation::ParachuteReport{1.7 + std::sin(x), 500.0 / x};
    if (number % 3 == 1) result.separation = {12.5, x / 3.0, number % 2 == 0 ? "backshell" : "heatshield"};
    result.peak_deceleration_mps2 = 110.0 + std::tan(x);
    result.propellant_kg = 40.0 - std::sqrt(x);
    result.margins = {{"sufr", 2.0 + std::sin(x)}, {"backshell", 0.5}};
    result.events = {{"entry_interface", 0.0, 131052.0, 5845.2}, {"touchdown", 420.0 + std::sin(x), 7.4, 0.7}};
    return result;
}

cluster::EngineAddress at(std::string url) {
    cluster::EngineAddress address;
    address.url = std::move(url);
    return address;
}

/// A worker in a thread, until it is ended.
class WorkerThread {
  public:
    WorkerThread(const NatsServer& server, std::string name, cluster::FlyCase fly, campaign::Identity own = identity)
        : engine_(connected(server, name)), own_(std::move(own)), settings_{std::move(name), 2, 20ms, 1s},
          thread_([this, fly = std::move(fly)] {
              const auto begin = [&](const v1::CampaignOrder&) -> Result<cluster::FlyCase> { return fly; };
              last_ = cluster::work(engine_, own_, begin, settings_, stop_, [this](const auto& now) {
                  const std::scoped_lock lock{mutex_};
                  last_ = now;
              });
          }) {}
    ~WorkerThread() { stop_ = true; }

    cluster::WorkerProgress progress() {
        const std::scoped_lock lock{mutex_};
        return last_;
    }

  private:
    Engine engine_;
    campaign::Identity own_;
    cluster::WorkerSettings settings_;
    std::atomic<bool> stop_{false};
    std::mutex mutex_;
    cluster::WorkerProgress last_;
    std::jthread thread_;
};

cluster::FlyCase made_up_in(std::chrono::milliseconds time) {
    return [time](std::uint64_t number) -> std::optional<CaseResult> {
        std::this_thread::sleep_for(time);
        return made_up(number);
    };
}

Progress collected(const NatsServer& server, const std::filesystem::path& file, std::uint64_t cases,
                   const std::function<void(const Progress&)>& tell = {}, const std::atomic<bool>& stop = false) {
    auto store = CampaignStore::open(file, identity);
    REQUIRE(store);
    REQUIRE(store->want(cases));
    auto engine = connected(server);
    auto progress = cluster::collect(*store, identity, cases, engine, stop, tell, soon);
    REQUIRE(progress);
    return std::move(*progress);
}

/// All that a file holds of its cases, but for the order in which they came.
std::string contents(const std::filesystem::path& file) {
    auto database = archive::sqlite::Database::open(file.string(), archive::sqlite::Mode::read_write_create);
    REQUIRE(database);
    std::string all;
    for (const char* sql :
         {"SELECT number||outcome||reason||end_cycle||quote(vertical_mps)||quote(horizontal_mps)||quote(miss_m)"
          "||quote(latitude_deg)||quote(longitude_deg)||quote(east_m)||quote(north_m)||quote(peak_deceleration_mps2)"
          "||quote(parachute_mach)||quote(parachute_pressure_Pa)||quote(propellant_kg)||quote(heatshield_least_m)"
          "||quote(backshell_least_m)||quote(struck_by)||quote(tilt_deg)||limits_exceeded FROM cases ORDER BY number",
          "SELECT case_number||' '||place||name||quote(e_s)||quote(altitude_m)||quote(speed_mps) FROM events",
          "SELECT case_number||' '||place||timepoint||quote(margin_s) FROM margins",
          "SELECT 'arrivals '||count(*)||' of '||count(DISTINCT case_number) FROM arrivals"}) {
        auto rows = database->prepare(sql);
        REQUIRE(rows);
        for (auto row = rows->step(); row && *row; row = rows->step()) all += std::string{rows->text(0)} + "\n";
    }
    return all;
}

/// The same cases, flown by one process.
std::string alone(const std::filesystem::path& file, std::uint64_t cases) {
    auto store = CampaignStore::open(file, identity);
    REQUIRE(store);
    for (std::uint64_t number = 1; number <= cases; ++number) {
        const std::vector<CaseResult> one{made_up(number)};
        REQUIRE(store->add(one));
    }
    return contents(file);
}

}  // namespace

TEST_CASE("what three workers fly is what one process flies, bit for bit, each case once", "[cluster][campaign][R61]") {
    if (!NatsServer::present()) return;
    test::TemporaryFolder folder;
    const NatsServer server;
    const WorkerThread first{server, "first", made_up_in(1ms)}, second{server, "second", made_up_in(1ms)},
        third{server, "third", made_up_in(1ms)};
    const auto progress = collected(server, folder / "workers.db", 300);
    CHECK(progress.done == 300);
    CHECK(progress.flown == 300);
    CHECK_FALSE(progress.workers.empty());
    CHECK(progress.refused_answers == 0);
    CHECK(contents(folder / "workers.db") == alone(folder / "alone.db", 300));
}

TEST_CASE("an engine that is killed, with its queue or without, loses no case and doubles none",
          "[cluster][campaign][R61]") {
    if (!NatsServer::present()) return;
    const bool forgets = GENERATE(false, true);
    test::TemporaryFolder folder;
    NatsServer server;
    const WorkerThread first{server, "first", made_up_in(5ms)}, second{server, "second", made_up_in(5ms)};
    bool killed = false;
    const auto progress = collected(server, folder / "workers.db", 200, [&](const Progress& now) {
        if (now.flown < 60 || std::exchange(killed, true)) return;
        server.kill();
        if (forgets) server.forget();
        server.start();
    });
    CHECK(killed);
    CHECK(progress.done == 200);
    CHECK(contents(folder / "workers.db") == alone(folder / "alone.db", 200));
}

TEST_CASE("a campaign that is stopped goes on where it was, and meanwhile its queue is empty",
          "[cluster][campaign][R61]") {
    if (!NatsServer::present()) return;
    test::TemporaryFolder folder;
    const NatsServer server;
    WorkerThread worker{server, "worker", made_up_in(2ms)};
    std::atomic<bool> stop{false};
    const auto before =
        collected(server, folder / "workers.db", 400, [&](const Progress& now) { stop = now.flown > 50; }, stop);
    CHECK(before.done < 400);
    auto engine = connected(server);
    CHECK(engine.subjects(cluster::campaign_stream, "aeolis.campaigns.>")->empty());
    CHECK(engine.subjects(cluster::case_stream, "aeolis.cases.>")->empty());
    const auto after = collected(server, folder / "workers.db", 400);
    CHECK(after.done == 400);
    CHECK(after.flown == 400 - before.done);
    CHECK(contents(folder / "workers.db") == alone(folder / "alone.db", 400));
}

TEST_CASE("a case that no worker answers is set aside after three tries, and the others are stored",
          "[cluster][campaign][R61]") {
    if (!NatsServer::present()) return;
    test::TemporaryFolder folder;
    const NatsServer server;
    std::atomic<int> tries{0};
    const WorkerThread worker{server, "worker", [&](std::uint64_t number) -> std::optional<CaseResult> {
                                  if (number != 7) return made_up(number);
                                  ++tries;
                                  return std::nullopt;  // given back, as by a worker that ends
                              }};
    const auto progress = collected(server, folder / "workers.db", 20);
    CHECK(tries == 3);
    CHECK(progress.done == 19);
    REQUIRE(progress.set_aside.size() == 1);
    CHECK(progress.set_aside[0].number == 7);
    CHECK_THAT(progress.set_aside[0].reason, Catch::Contains("given 3 times"));
}

TEST_CASE("a case that workers give back because they end is not set aside, however many do",
          "[cluster][campaign][R61]") {
    if (!NatsServer::present()) return;
    test::TemporaryFolder folder;
    const NatsServer server;
    std::unique_ptr<WorkerThread> worker;
    int ended = 0;
    std::atomic<bool> holds{false}, let_go{false};
    const auto hold = [&](std::uint64_t number) -> std::optional<CaseResult> {
        if (number != 7) return made_up(number);
        holds = true;
        while (!let_go) std::this_thread::sleep_for(1ms);
        return std::nullopt;  // abandoned, as a landing is when its worker ends
    };
    worker = std::make_unique<WorkerThread>(server, "first", hold);
    const auto progress = collected(server, folder / "workers.db", 10, [&](const Progress&) {
        if (!holds || ended == 5) return;
        holds = false;
        std::thread ends{[&] { worker.reset(); }};
        std::this_thread::sleep_for(20ms);  // it has been told to end
        let_go = true;
        ends.join();
        let_go = false;
        worker = ++ended < 5 ? std::make_unique<WorkerThread>(server, "next", hold)
                             : std::make_unique<WorkerThread>(server, "last", made_up_in(1ms));
    });
    CHECK(ended == 5);
    CHECK(progress.set_aside.empty());
    CHECK(progress.done == 10);
    CHECK(contents(folder / "workers.db") == alone(folder / "alone.db", 10));
}

TEST_CASE("a worker that says nothing loses its case to another", "[cluster][campaign][R61]") {
    if (!NatsServer::present()) return;
    test::TemporaryFolder folder;
    const NatsServer server;
    std::atomic<bool> held{false}, over{false};
    // Takes one case and holds it until the campaign is over.
    auto engine = connected(server);
    std::thread silent{[&] {
        const cluster::CampaignSubjects* subjects = nullptr;
        std::unique_ptr<cluster::CampaignSubjects> found;
        while (!over && subjects == nullptr) {
            const auto orders = engine.subjects(cluster::campaign_stream, "aeolis.campaigns.>");
            for (const auto& subject : orders ? *orders : std::vector<std::string>{}) {
                const auto kind = cluster::kind_of(identity);
                found = std::make_unique<cluster::CampaignSubjects>(kind, cluster::campaign_of(subject, kind));
                subjects = found.get();
            }
            std::this_thread::sleep_for(10ms);
        }
        if (subjects == nullptr) return;
        auto consumer = engine.consumer(cluster::case_stream, subjects->case_consumer, subjects->cases);
        if (!consumer) return;
        std::vector<cluster::Given> given;
        while (!over && given.empty())
            if (auto next = consumer->next(1, 200ms)) given = std::move(*next);
        held = !given.empty();
        while (!over) std::this_thread::sleep_for(10ms);
    }};
    std::unique_ptr<WorkerThread> worker;
    const auto progress = collected(server, folder / "workers.db", 10, [&](const Progress&) {
        if (held && !worker) worker = std::make_unique<WorkerThread>(server, "worker", made_up_in(1ms));
    });
    over = true;
    silent.join();
    CHECK(held);
    CHECK(progress.done == 10);
    CHECK(contents(folder / "workers.db") == alone(folder / "alone.db", 10));
}

TEST_CASE("answers that are none of the campaign's are refused, counted and never stored", "[cluster][campaign][R61]") {
    if (!NatsServer::present()) return;
    test::TemporaryFolder folder;
    const NatsServer server;
    const auto queue = CampaignStore::open(folder / "workers.db", identity)->queue();
    REQUIRE(queue);
    std::vector<std::string> forged{"", "octets that are no message \xff\xfe"};
    v1::CaseAnswer answer;
    answer.set_campaign(*queue);
    answer.set_number(3);
    forged.push_back(answer.SerializeAsString());  // neither flown nor set aside
    *answer.mutable_flown() = cluster::message_of(made_up(3));
    answer.mutable_flown()->set_outcome("victory");
    forged.push_back(answer.SerializeAsString());
    *answer.mutable_flown() = cluster::message_of(made_up(3));
    answer.mutable_flown()->set_struck_by("moon");
    forged.push_back(answer.SerializeAsString());
    *answer.mutable_flown() = cluster::message_of(made_up(3));
    answer.set_number(11);  // beyond the campaign
    forged.push_back(answer.SerializeAsString());
    answer.set_number(0);
    forged.push_back(answer.SerializeAsString());
    answer.set_number(3);
    answer.set_campaign("another");
    forged.push_back(answer.SerializeAsString());
    {
        auto engine = connected(server);
        REQUIRE(engine.make_stream(cluster::answer_stream, "aeolis.answers.>", cluster::Retention::until_taken));
        REQUIRE(engine.publish(cluster::CampaignSubjects{cluster::kind_of(identity), *queue}.answers, forged));
    }
    const WorkerThread worker{server, "worker", made_up_in(1ms)};
    const auto progress = collected(server, folder / "workers.db", 10);
    CHECK(progress.refused_answers == forged.size());
    CHECK(progress.done == 10);
    CHECK(contents(folder / "workers.db") == alone(folder / "alone.db", 10));
}

TEST_CASE("a worker of another program or dictionary flies nothing and says what is needed",
          "[cluster][campaign][R61]") {
    if (!NatsServer::present()) return;
    test::TemporaryFolder folder;
    const NatsServer server;
    auto other_program = identity, other_dictionary = identity;
    other_program.program = "fedcba9876543210";
    other_dictionary.dictionary = "4712";
    WorkerThread first{server, "first", made_up_in(1ms), other_program},
        second{server, "second", made_up_in(1ms), other_dictionary};
    std::unique_ptr<WorkerThread> right;
    const auto progress = collected(server, folder / "workers.db", 10, [&](const Progress& now) {
        if (right || first.progress().left_out.empty() || second.progress().left_out.empty()) return;
        CHECK(now.flown == 0);
        CHECK_THAT(first.progress().left_out[0],
                   Catch::Contains("program 0123456789abcdef is needed, this is fedcba9876543210"));
        CHECK_THAT(second.progress().left_out[0], Catch::Contains("dictionary 4711 is needed, this is 4712"));
        right = std::make_unique<WorkerThread>(server, "right", made_up_in(1ms));
    });
    CHECK(progress.done == 10);
    REQUIRE(progress.workers.size() == 1);
    CHECK(progress.workers[0].name == "right");
}

TEST_CASE("an engine that is away, has no JetStream or is none is named in one line", "[cluster][R61]") {
    const auto none = Engine::connect(at("nats://someone:secret@127.0.0.1:1"), "test");
    REQUIRE_FALSE(none);
    CHECK_THAT(none.error().message, Catch::StartsWith("nats://127.0.0.1:1: "));
    CHECK_THAT(none.error().message, !Catch::Contains("secret") && !Catch::Contains("\n"));
    for (const std::string url : {"nats://someone:sec,ret@one:1", "nats://someone:sec://ret@one:1", "sec,ret@one:1",
                                  "nats://a:secret@two:1,nats://b:secret@one:1", "nats://one:1"}) {
        CHECK_THAT(cluster::shown(at(url)), !Catch::Contains("sec") && !Catch::Contains("ret"));
        CHECK_THAT(cluster::shown(at(url)), Catch::EndsWith("one:1"));
    }
    const auto nonsense = Engine::connect(at("nats://127.0.0.1:port"), "test");
    REQUIRE_FALSE(nonsense);
    CHECK(nonsense.error().message == "nats://127.0.0.1:port: invalid port 'port'");
    if (!NatsServer::present()) return;
    const NatsServer plain{NatsServer::JetStream::absent};
    auto engine = connected(plain);
    const auto made = engine.make_stream(cluster::case_stream, "aeolis.cases.>", cluster::Retention::until_taken);
    REQUIRE_FALSE(made);
    CHECK(made.error().message ==
          plain.url() +
              ": stream AEOLIS_CASES: nobody there takes it: no such stream, or no JetStream (start it with -js)");
}

TEST_CASE("each field of a case survives its message, to the last bit", "[cluster][campaign][R61]") {
    test::TemporaryFolder folder;
    {
        auto store = CampaignStore::open(folder / "told.db", identity);
        REQUIRE(store);
        for (std::uint64_t number = 1; number <= 30; ++number) {
            v1::CaseAnswer answer;
            answer.set_number(number);
            *answer.mutable_flown() = cluster::message_of(made_up(number));
            const auto again = cluster::result_of(answer);
            REQUIRE(again);
            REQUIRE(store->add(std::vector<CaseResult>{*again}));
        }
    }
    CHECK(contents(folder / "told.db") == alone(folder / "alone.db", 30));
}

TEST_CASE("an answer that comes after its case was set aside is stored", "[cluster][campaign][R61]") {
    if (!NatsServer::present()) return;
    test::TemporaryFolder folder;
    const NatsServer server;
    std::atomic<bool> late{false};
    std::atomic<int> tries{0};
    const auto queue = CampaignStore::open(folder / "workers.db", identity)->queue();
    REQUIRE(queue);
    const WorkerThread worker{server, "worker", [&](std::uint64_t number) -> std::optional<CaseResult> {
                                  if (number == 7 && ++tries <= 3) return std::nullopt;
                                  while (number == 8 && !late) std::this_thread::sleep_for(10ms);
                                  return made_up(number);
                              }};
    auto engine = connected(server);
    const auto progress = collected(server, folder / "workers.db", 10, [&](const Progress& now) {
        if (now.set_aside.empty() || late) return;
        v1::CaseAnswer answer;
        answer.set_campaign(*queue);
        answer.set_number(7);
        *answer.mutable_flown() = cluster::message_of(made_up(7));
        REQUIRE(engine.publish(cluster::CampaignSubjects{cluster::kind_of(identity), *queue}.answers,
                               answer.SerializeAsString()));
        late = true;  // now case 8 may end the campaign, behind it
    });
    CHECK(progress.set_aside.empty());
    CHECK(progress.done == 10);
    CHECK(contents(folder / "workers.db") == alone(folder / "alone.db", 10));
}

}  // namespace server_cluster_workers_test
