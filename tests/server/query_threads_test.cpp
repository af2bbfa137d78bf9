// SPDX-License-Identifier: Apache-2.0
#include "server/api/query_threads.hpp"

#include "server/pipeline/pipeline.hpp"
#include "tests/server/small_mission.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/slept_time.hpp"

#include <fmt/format.h>
#include <future>

namespace server_query_threads_test {

using namespace aeolis;
using namespace aeolis::test;
using server::QueryThreads;

namespace {

/// A run with enough packets that a question over all of them is noticed.
struct Recorded {
    TemporaryFolder folder;
    dictionary::Dictionary dictionary = small_dictionary();
    std::filesystem::path file = folder / "a.db";
    archive::Archive archive = std::move(archive::Archive::open(file)).value();
    std::unique_ptr<QueryThreads> threads;

    explicit Recorded(std::chrono::milliseconds question_max = QueryThreads::question_seconds_max) {
        pipeline::Pipeline pipeline(archive, dictionary);
        REQUIRE(pipeline.begin({}).ok());
        for (std::uint16_t i = 0; i < 3000; ++i)
            REQUIRE(pipeline.accept(live(navigation_packet(i, 1000.0 + i, 9000.0F, 3.0F))).ok());
        REQUIRE(pipeline.commit().ok());
        threads = std::move(QueryThreads::open(file, dictionary, nullptr, question_max)).value();
    }
    /// What a question over all packets comes to.
    std::string ask(const std::function<bool()>& gone) const {
        std::promise<std::string> answered;
        REQUIRE(threads->ask(
            [&](archive::Reader& reader) {
                const auto proof = reader.proof(archive::RunId{1});
                answered.set_value(proof ? "answered" : reader.stopped() ? "stopped" : proof.error().message);
            },
            {.disconnected = gone}));
        return answered.get_future().get();
    }
};

}  // namespace

TEST_CASE("a question whose asker has left is stopped, and the next question is answered", "[http][bounds]") {
    const Recorded recorded;
    std::atomic<bool> left{false};
    const auto gone = [&] { return left.load(); };
    CHECK(recorded.ask(nullptr) == "answered");
    CHECK(recorded.ask(gone) == "answered");
    left = true;
    CHECK(recorded.ask(gone) == "stopped");
    CHECK(recorded.ask(gone) == "stopped");
    for (std::size_t i = 0; i < 2 * QueryThreads::threads; ++i)  // the next question is not stopped by that
        CHECK(recorded.ask(nullptr) == "answered");
}

TEST_CASE("a question that takes longer than questions may is stopped", "[http][bounds]") {
    const Recorded recorded{std::chrono::milliseconds{0}};
    CHECK(recorded.ask(nullptr) == "stopped");
    CHECK(recorded.ask(nullptr) == "stopped");
}

TEST_CASE("what is short does not wait behind questions, however many", "[http][bounds]") {
    const Recorded recorded;
    auto& threads = *recorded.threads;
    std::promise<void> answered;
    const auto waits = answered.get_future().share();
    const auto question = [waits](archive::Reader&) { waits.wait(); };
    for (std::size_t i = 0; i < QueryThreads::question_threads; ++i) REQUIRE(threads.ask(question));
    while (threads.waiting() > 0)  // all are busy
        std::this_thread::yield();
    const auto room = QueryThreads::waiting_max[static_cast<std::size_t>(server::JobPriority::in_turn)];
    for (std::size_t i = 0; i < room; ++i) REQUIRE(threads.ask(question));
    CHECK_FALSE(threads.ask(question));
    for (const auto priority : {server::JobPriority::soon, server::JobPriority::at_once}) {
        std::promise<std::size_t> told;
        REQUIRE(threads.ask(
            [&](archive::Reader& reader) { told.set_value(reader.items(archive::RunId{1}, 0, 10)->items.size()); }, {},
            priority));
        auto items = told.get_future();
        REQUIRE(items.wait_for(std::chrono::seconds{10}) == std::future_status::ready);
        CHECK(items.get() == 10);
    }
    answered.set_value();
}

TEST_CASE("clients are served in turn, each in its own order, and no client takes all the places", "[http][bounds]") {
    server::TurnQueue<int> queue{5, 3};
    for (int i = 1; i <= 3; ++i) CHECK(queue.push("greedy", i));
    CHECK_FALSE(queue.push("greedy", 4));
    CHECK(queue.push("other", 10));
    CHECK(queue.push("third", 20));
    CHECK_FALSE(queue.push("fourth", 30));  // no place is left to anybody
    const auto anybody = [](const std::string&) { return true; };
    std::vector<int> served;
    while (const auto job = queue.pop(anybody)) served.push_back(*job);
    CHECK(served == std::vector{1, 10, 20, 2, 3});
    CHECK(queue.size() == 0);
    CHECK(queue.push("greedy", 1));
    CHECK(queue.push("other", 2));
    CHECK(queue.pop([](const std::string& client) { return client == "other"; }) == 2);
    CHECK_FALSE(queue.has([](const std::string& client) { return client == "other"; }));
}

TEST_CASE("a question of one client is answered while another's slow ones go on and wait", "[http][bounds]") {
    std::atomic<bool> enough{false};
    const Recorded recorded;
    auto& threads = *recorded.threads;
    const auto slow = [&](archive::Reader& reader) {
        while (!enough && !reader.stopped()) (void)reader.proof(archive::RunId{1}).ok();
    };
    for (std::size_t i = 0; i < 60; ++i) REQUIRE(threads.ask(slow, {.client = "greedy"}));
    // A second one, so that more questions are under way than run at a time.
    for (int i = 0; i < 5; ++i) REQUIRE(threads.ask(slow, {.client = "slow"}));
    for (int i = 0; i < 5; ++i) {
        std::promise<bool> told;
        auto answered = told.get_future();
        REQUIRE(threads.ask([&](archive::Reader& reader) { told.set_value(reader.proof(archive::RunId{1}).ok()); },
                            {.client = i == 0 ? "careful" : "slow but one"}));
        REQUIRE(answered.wait_for(std::chrono::seconds{60}) == std::future_status::ready);
        CHECK(answered.get());
    }
    CHECK(threads.waiting() > 50);
    enough = true;
}

TEST_CASE("a client's question is answered while many others' slow ones go on, each of them with one of its own",
          "[http][bounds][R63]") {
    std::atomic<bool> enough{false};
    const Recorded recorded;
    auto& threads = *recorded.threads;
    const auto slow = [&](archive::Reader& reader) {
        while (!enough && !reader.stopped()) (void)reader.proof(archive::RunId{1}).ok();
    };
    // The first two have two under way each: nobody else asked then. One thread is left for who comes last.
    constexpr auto greedy = QueryThreads::question_threads - QueryThreads::crowd_min;
    for (std::size_t client = 0; client < greedy; ++client)
        for (int i = 0; i < 10; ++i) REQUIRE(threads.ask(slow, {.client = fmt::format("greedy {}", client)}));
    for (int i = 0; i < 5; ++i) {
        std::promise<bool> told;
        auto answered = told.get_future();
        REQUIRE(threads.ask([&](archive::Reader& reader) { told.set_value(reader.proof(archive::RunId{1}).ok()); },
                            {.client = "careful"}));
        REQUIRE(answered.wait_for(std::chrono::seconds{60}) == std::future_status::ready);
        CHECK(answered.get());
    }
    CHECK(threads.waiting() >= 10 * greedy - QueryThreads::question_threads);
    enough = true;
}

TEST_CASE("questions that wait or go on when the server ends are stopped, and what is short is done",
          "[http][bounds]") {
    Recorded recorded;
    auto& threads = *recorded.threads;
    const auto question = [](archive::Reader& reader) {
        for (int i = 0; i < 3000 && !reader.stopped(); ++i) (void)reader.proof(archive::RunId{1}).ok();
    };
    for (int i = 0; i < 20; ++i) REQUIRE(threads.ask(question));
    std::atomic<int> noted{0};
    for (int i = 0; i < 20; ++i)
        REQUIRE(threads.ask([&](archive::Reader& reader) { noted += reader.runs() ? 1 : 0; }, {},
                            server::JobPriority::at_once));
    const tests::SleptTime time;
    recorded.threads.reset();
    CHECK(time.passed() < std::chrono::seconds{5});
    CHECK(noted == 20);
}

}  // namespace server_query_threads_test
