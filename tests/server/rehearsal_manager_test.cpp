// SPDX-License-Identifier: Apache-2.0
#include "server/rehearsal/rehearsal_manager.hpp"

#include "tests/server/running_server.hpp"
#include "tests/server/small_mission.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <condition_variable>
#include <deque>
#include <mutex>

namespace server_rehearsal_manager_test {

using namespace aeolis;
using namespace aeolis::server;

namespace {

/// The network thread: what the others post waits until the test looks.
struct Posted {
    std::mutex mutex;
    std::condition_variable changed;
    std::deque<std::function<void()>> actions;

    void post(std::function<void()> action) {
        const std::scoped_lock lock{mutex};
        actions.push_back(std::move(action));
        changed.notify_one();
    }
    /// Does what is posted until `done`; false: it is not within a minute.
    bool until(const std::function<bool()>& done) {
        const auto end = std::chrono::steady_clock::now() + std::chrono::seconds{60};
        while (!done()) {
            std::unique_lock lock{mutex};
            if (!changed.wait_until(lock, end, [&] { return !actions.empty(); })) return false;
            const auto action = std::move(actions.front());
            actions.pop_front();
            lock.unlock();
            action();
        }
        return true;
    }
};

v1::CommandRequest request_of(const char* command) {
    v1::CommandRequest request;
    request.set_command(command);
    request.set_armed(true);
    request.set_confirmation(command);
    return request;
}

Result<void> always(const v1::CommandRequest&) {
    return {};
}

/// A run of the nominal scenario under way, whose changes of the timeline are analysed when the test says so.
class SlowAnalyses {
  public:
    SlowAnalyses() {
        bool begun = false;
        rehearsals.start({test::shipped_scenario("nominal"), 1, 1.0}, [&](const Result<v1::RunState>& state) {
            CHECK(state);
            begun = true;
        });
        REQUIRE(network.until([&] { return begun; }));
    }

    RehearsalManager::Reply answer(const std::string& whose) {
        return [this, whose](const v1::CommandReply& reply) {
            answers.push_back(fmt::format("{}: {}", whose, reply.accepted() ? "taken" : reply.reason()));
        };
    }
    /// Ends the analysis under way, and waits until this many answers were given.
    void refute(std::size_t answers_by_then) {
        std::exchange(analysed, {})(Error{"it breaks a constraint"});
        REQUIRE(network.until([&] { return answers.size() >= answers_by_then; }));
    }

    test::TemporaryFolder folder;
    Posted network;
    const ScenarioLibrary scenarios{test::shipped_scenarios};
    const instruction::PlanLibrary plans{{}, tests::shipped_dictionary()};
    PipelineThread pipeline{std::move(archive::Archive::open(folder / "a.db")).value(), tests::shipped_dictionary(),
                            PipelineThread::Faults::hold, [](const auto&) {}};
    std::function<void(Result<std::string>)> analysed;  ///< the answer of the analysis, which takes its time
    RehearsalManager rehearsals{scenarios,
                                plans,
                                tests::shipped_dictionary(),
                                pipeline,
                                [this](auto action) { network.post(std::move(action)); },
                                [](const v1::StartRehearsal&, const auto& done) { done(Error{"none was cut off"}); },
                                questions(),
                                {[](const auto&) {}, [](const auto&) {}}};
    std::vector<std::string> answers;

  private:
    RehearsalManager::TimelineQuestions questions() {
        RehearsalManager::TimelineQuestions all;
        all.check = [this](archive::RunId, const auto& requests, bool, auto done) {
            if (std::ranges::none_of(requests, changes_timeline)) return done(std::string{});
            CHECK_FALSE(analysed);  // one at a time
            analysed = std::move(done);
        };
        all.reanalyse = [](archive::RunId, const auto& done) { done(TimelineCheck::Reanalysis{}); };
        return all;
    }
};

}  // namespace

TEST_CASE(
    "an order that waited for a change of the timeline goes only if its sender still may, and those after it go on",
    "[access][timeline]") {
    spdlog::set_level(spdlog::level::err);
    SlowAnalyses run;
    bool has_rights = true;
    const auto may = [&](const v1::CommandRequest&) {
        return has_rights ? Result<void>{} : Result<void>{Error{"not any more"}};
    };
    run.rehearsals.command(request_of("EDL_SET_TIMEPOINT_OFFSET"), {always}, run.answer("change"));
    REQUIRE(run.analysed);
    run.rehearsals.command(request_of("NO_OP"), {may}, run.answer("loses rights"));
    run.rehearsals.command(request_of("NO_OP"), {always}, run.answer("keeps them"));
    CHECK(run.rehearsals.commands_deferred() == 2);
    CHECK(run.answers.empty());
    has_rights = false;
    run.refute(3);
    CHECK(run.answers == std::vector<std::string>{"change: it breaks a constraint", "loses rights: not any more",
                                                  "keeps them: taken"});
    CHECK(run.rehearsals.commands_deferred() == 0);
}

TEST_CASE("behind another's change of the timeline waits only what changes it too: do edl is taken at once",
          "[access][timeline][rehearsal][R63]") {
    spdlog::set_level(spdlog::level::err);
    SlowAnalyses run;
    const RehearsalManager::Sender greedy{always, "a", true}, other{always, "b", true}, third{always, "c"};
    for (int i = 0; i < 20; ++i)
        run.rehearsals.command(request_of("EDL_SET_ANCHOR_OFFSET"), greedy, run.answer("a's change"));
    REQUIRE(run.analysed);
    CHECK(run.rehearsals.commands_deferred() == 19);

    auto parameters = request_of("EDL_SET_PARAMETERS");
    parameters.set_from_solution(true);
    run.rehearsals.command(parameters, other, run.answer("b's parameters"));
    run.rehearsals.command(request_of("EDL_DO_EDL"), other, run.answer("b's do edl"));
    run.rehearsals.command(request_of("NO_OP"), third, run.answer("c's no-op"));
    REQUIRE(run.network.until([&] { return run.answers.size() == 3; }));
    CHECK(run.answers == std::vector<std::string>{"b's parameters: taken", "b's do edl: taken", "c's no-op: taken"});
    CHECK(run.analysed);  // the first change still is
    CHECK(run.rehearsals.commands_deferred() == 19);
}

TEST_CASE("a sender's orders keep their order behind its own change, and the changes of several go in turns",
          "[access][timeline][rehearsal][R63]") {
    spdlog::set_level(spdlog::level::err);
    SlowAnalyses run;
    const RehearsalManager::Sender greedy{always, "a", true}, other{always, "b", true};
    for (int i = 0; i < 3; ++i)
        run.rehearsals.command(request_of("EDL_SET_ANCHOR_OFFSET"), greedy, run.answer("a's change"));
    run.rehearsals.command(request_of("NO_OP"), greedy, run.answer("a's no-op"));
    run.rehearsals.command(request_of("EDL_SET_ANCHOR_OFFSET"), other, run.answer("b's change"));
    run.rehearsals.command(request_of("NO_OP"), other, run.answer("b's no-op"));
    CHECK(run.rehearsals.commands_deferred() == 5);

    const std::string refuted = ": it breaks a constraint";
    run.refute(1);
    CHECK(run.answers == std::vector{"a's change" + refuted});
    run.refute(3);
    CHECK(run.answers == std::vector<std::string>{"a's change" + refuted, "b's change" + refuted, "b's no-op: taken"});
    run.refute(4);
    run.refute(6);
    CHECK(run.answers[3] == "a's change" + refuted);
    CHECK(run.answers[4] == "a's change" + refuted);
    CHECK(run.answers[5] == "a's no-op: taken");
    CHECK(run.rehearsals.commands_deferred() == 0);
}

}  // namespace server_rehearsal_manager_test
