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
    return request;
}

}  // namespace

TEST_CASE(
    "an order that waited for a change of the timeline goes only if its sender still may, and those after it go on",
    "[access][timeline]") {
    spdlog::set_level(spdlog::level::err);
    test::TemporaryFolder folder;
    Posted network;
    const ScenarioLibrary scenarios{test::shipped_scenarios};
    const instruction::PlanLibrary plans{{}, tests::shipped_dictionary()};
    PipelineThread pipeline{std::move(archive::Archive::open(folder / "a.db")).value(), tests::shipped_dictionary(),
                            PipelineThread::Faults::hold, [](const auto&) {}};
    std::function<void(Result<std::string>)> analysed;  // the answer of the analysis, which takes its time
    RehearsalManager::TimelineQuestions questions;
    questions.check = [&](archive::RunId, const auto& requests, bool, auto done) {
        if (std::ranges::none_of(requests, changes_timeline)) return done(std::string{});
        analysed = std::move(done);
    };
    questions.reanalyse = [](archive::RunId, const auto& done) { done(TimelineCheck::Reanalysis{}); };
    RehearsalManager rehearsals{scenarios,
                                plans,
                                tests::shipped_dictionary(),
                                pipeline,
                                [&](auto action) { network.post(std::move(action)); },
                                [](const v1::StartRehearsal&, const auto& done) { done(Error{"none was cut off"}); },
                                questions,
                                {[](const auto&) {}, [](const auto&) {}}};
    bool begun = false;
    rehearsals.start({test::shipped_scenario("nominal"), 1, 1.0}, [&](const Result<v1::RunState>& state) {
        CHECK(state);
        begun = true;
    });
    REQUIRE(network.until([&] { return begun; }));

    std::vector<std::string> answers;
    const auto answer = [&](const char* whose) {
        return [&answers, whose](const v1::CommandReply& reply) {
            answers.push_back(fmt::format("{}: {}", whose, reply.accepted() ? "taken" : reply.reason()));
        };
    };
    bool has_rights = true;
    const auto may = [&](const v1::CommandRequest&) {
        return has_rights ? Result<void>{} : Result<void>{Error{"not any more"}};
    };
    const auto always = [](const v1::CommandRequest&) { return Result<void>{}; };
    rehearsals.command(request_of("EDL_SET_TIMEPOINT_OFFSET"), {always}, answer("change"));
    REQUIRE(analysed);
    rehearsals.command(request_of("NO_OP"), {may}, answer("loses rights"));
    rehearsals.command(request_of("NO_OP"), {always}, answer("keeps them"));
    CHECK(rehearsals.commands_deferred() == 2);
    CHECK(answers.empty());
    has_rights = false;
    analysed(Error{"it breaks a constraint"});
    REQUIRE(network.until([&] { return answers.size() == 3; }));
    CHECK(answers == std::vector<std::string>{"change: it breaks a constraint", "loses rights: not any more",
                                              "keeps them: taken"});
    CHECK(rehearsals.commands_deferred() == 0);
}

}  // namespace server_rehearsal_manager_test
