// SPDX-License-Identifier: Apache-2.0
#include "server/rehearsal/rehearsal_runner.hpp"

#include "server/archive/kept_request.hpp"
#include "server/archive/reader.hpp"
#include "server/rehearsal/again_of.hpp"
#include "server/rehearsal/rehearsal.hpp"
#include "server/scenario/scenario_text.hpp"
#include "server/shadow/shadow.hpp"
#include "tests/server/running_server.hpp"
#include "tests/server/small_mission.hpp"
#include "tests/support/acknowledged.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <atomic>
#include <chrono>
#include <mutex>
#include <random>
#include <thread>
#include <unistd.h>

namespace server_rehearsal_runner_test {

using namespace aeolis;
using namespace aeolis::server;

TEST_CASE("tones come from a waveform up to the pace that sustains it, unless the scenario has chosen",
          "[tones][R31]") {
    simulation::Radio open;
    CHECK(RehearsalRunner::from_samples(open, 1.0));
    CHECK(RehearsalRunner::from_samples(open, RehearsalRunner::signal_pace_max));
    CHECK_FALSE(RehearsalRunner::from_samples(open, RehearsalRunner::signal_pace_max + 1.0));
    CHECK_FALSE(RehearsalRunner::from_samples(open, 0.0));  // as fast as it goes
    simulation::Radio insists, refuses;
    insists.tones_from_samples = true;
    refuses.tones_from_samples = false;
    CHECK(RehearsalRunner::from_samples(insists, 0.0));
    CHECK_FALSE(RehearsalRunner::from_samples(refuses, 1.0));
}

TEST_CASE("no shipped scenario that is flown live has chosen for itself", "[tones][R31]") {
    for (const char* name : {"nominal", "nominal_auto", "nominal_light_time", "pre_edl"}) {
        INFO(name);
        CHECK_FALSE(test::shipped_scenario(name).radio.tones_from_samples.has_value());
    }
}

TEST_CASE(
    "a change of pace in mid-run loses, doubles and changes no tone, and the run goes on saying where they come from",
    "[tones][R31]") {
    spdlog::set_level(spdlog::level::err);
    auto scenario = test::shipped_scenario("nominal_auto");
    scenario.start_before_entry_s = 900.0;
    scenario.commands[0].send_before_entry_s = 895.0;
    scenario.commands[1].send_before_entry_s = 885.0;
    const dictionary::Dictionary& dictionary = tests::shipped_dictionary();

    test::TemporaryFolder folder;
    const auto file = folder / "a.db";
    std::atomic<double> e_s{-900.0};
    std::atomic<bool> begun{false};
    archive::RunId run;
    std::string tone_model;
    {
        PipelineThread pipeline{std::move(archive::Archive::open(file)).value(), dictionary,
                                PipelineThread::Faults::give_up, [](const auto&) {}};
        RehearsalRunner::Callbacks callbacks;
        callbacks.on_begun = [&](Result<v1::RunState> state) {
            run = {static_cast<std::uint32_t>(state->run())};
            tone_model = state->tone_model();
            begun = true;
        };
        callbacks.on_state = [](const auto&) {};
        callbacks.on_clocks = [&](const v1::Clocks& clocks) { e_s = clocks.e_s(); };
        RehearsalRunner runner{scenario, 1, RehearsalRunner::signal_pace_max, dictionary, pipeline, callbacks};
        const auto fly_until = [&](double until_e_s) {
            while (e_s < until_e_s) std::this_thread::sleep_for(std::chrono::milliseconds{1});
        };
        fly_until(-735.0);  // within the first tones
        CHECK(runner.order(PaceRun{0.0}));
        fly_until(-500.0);
        CHECK(runner.order(StopRun{}));
        while (!runner.over()) std::this_thread::sleep_for(std::chrono::milliseconds{1});
    }
    REQUIRE(begun);
    CHECK(tone_model == "signal");

    scenario.radio.tones_from_samples = true;
    Rehearsal undisturbed{scenario, 1, 0, dictionary};
    std::vector<telemetry::ReceivedTone> expected;
    while (undisturbed.landing().sclk() < scenario.entry_sclk - 500.0)
        for (const auto& tone : undisturbed.step().tones) expected.push_back(tone);

    auto reader = archive::Reader::open(file, dictionary);
    REQUIRE(reader);
    const auto heard = reader->tones(run, {});
    REQUIRE(heard);
    CHECK(expected.size() > 5);
    REQUIRE(static_cast<std::size_t>(heard->tones_size()) >= expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
        INFO(i);
        const v1::Tone& tone = heard->tones(static_cast<int>(i)).tone();
        CHECK(tone.model() == "signal");
        CHECK(tone.ert_start_us() == expected[i].start.microseconds);
        CHECK(tone.has_tone() == expected[i].tone.has_value());
        if (expected[i].tone) CHECK(tone.tone() == expected[i].tone->value);
        CHECK(tone.likelihood() == expected[i].likelihood);
        CHECK(tone.spectrum().size() == 128);
    }
}

namespace {

/// A clock other than that of the sheet.
dictionary::Dictionary with_clock_rate(double rate) {
    auto dictionary = tests::shipped_dictionary();
    dictionary.clock.front().correlation.rate = rate;
    dictionary.clock.front().correlation.version = 4;
    return dictionary;
}

constexpr const char* flying = "part of a test: a flight that is killed";

/// Flies with a command now and then until this process is killed; every published sequence number is acknowledged.
[[noreturn]] void fly_until_killed(const std::filesystem::path& file, const dictionary::Dictionary& dictionary) {
    auto archive = archive::Archive::open(file);
    if (!archive) ::_exit(1);
    const test::Acknowledging acknowledges{file};
    PipelineThread pipeline{std::move(*archive), dictionary, PipelineThread::Faults::give_up,
                            [&](const auto& batch) { acknowledges(batch->last_seq); }};
    std::atomic<bool> begun{false};
    RehearsalRunner::Callbacks callbacks;
    callbacks.on_begun = [&](const auto&) { begun = true; };
    callbacks.on_state = [](const auto&) {};
    callbacks.on_clocks = [](const auto&) {};
    RehearsalRunner runner{test::short_landing(), 7, 0.0, dictionary, pipeline, callbacks};
    InterveneRun fault, note;
    auto& device_fault = *fault.intervention.mutable_fault()->mutable_device_fault();
    device_fault.set_device(v1::DEVICE_IMU);
    device_fault.set_unit(v1::REDUNDANT_UNIT_A);
    device_fault.set_kind(v1::DEVICE_FAULT_KIND_DROPOUT);
    device_fault.set_duration_s(2.0);  // that loses samples: the recording tells of it
    note.intervention.mutable_note()->set_text("do they see it?");
    while (!begun) std::this_thread::sleep_for(std::chrono::milliseconds{1});
    for (bool first = true;; first = false) {
        v1::CommandRequest request;
        request.set_command("NO_OP");
        if (!runner.order(SendCommands{{request}, false, [](const auto&) {}})) ::_exit(1);
        if (first && !(runner.order(fault) && runner.order(note))) ::_exit(1);
        std::this_thread::sleep_for(std::chrono::milliseconds{40});
    }
}

/// The same run without any crash: every item up to `last`, with the requests at their cycles.
std::vector<std::string> items_flown(const archive::FlownRun& cut, archive::Sequence last,
                                     const std::filesystem::path& file) {
    const dictionary::Dictionary& dictionary = tests::shipped_dictionary();
    {
        PipelineThread pipeline{std::move(archive::Archive::open(file)).value(), dictionary,
                                PipelineThread::Faults::give_up, [](const auto&) {}};
        Rehearsal rehearsal{test::short_landing(), 7, 0, dictionary};
        REQUIRE(pipeline.begin(rehearsal.run_start(0.0)));
        archive::Sequence stored = 0;
        for (auto request = cut.requests.begin(); stored < last;) {
            Delivery delivery;
            for (; request != cut.requests.end() && request->cycle == rehearsal.cycles(); ++request) {
                const auto again = archive::kept_request(request->request);
                if (again.has_intervention()) {
                    const auto& done = again.intervention();
                    if (done.has_fault()) REQUIRE(rehearsal.inject(done.fault()).ok());
                    continue;
                }
                REQUIRE(rehearsal.submit(again.command()).accepted());
                for (auto& stage : rehearsal.take_stages()) delivery.entries.emplace_back(std::move(stage));
            }
            delivery.add(std::move(rehearsal.step()));
            delivery.pass(rehearsal.cycles(), rehearsal.landing().ert_now());
            for (auto& stage : rehearsal.take_stages()) delivery.entries.emplace_back(std::move(stage));
            REQUIRE(pipeline.deliver(std::move(delivery)));
            if (rehearsal.cycles() % 640 != 0) continue;
            REQUIRE(pipeline.caught_up());
            stored = pipeline.figures().published_items;
        }
        pipeline.abandon();
    }
    auto reader = archive::Reader::open(file, dictionary);
    REQUIRE(reader);
    std::vector<std::string> items;
    while (items.size() < last) {
        const auto page = reader->items(archive::RunId{1}, items.size(), archive::items_page_max);
        REQUIRE(page);
        for (const auto& item : page->items) items.push_back(item.SerializeAsString());
    }
    items.resize(last);
    return items;
}

/// @param rate  of the clock, where it is not the sheet's
archive::Sequence kill_after(archive::Sequence published, const std::filesystem::path& file,
                             const std::string& rate = {}) {
    auto flight =
        test::ChildProcess::part(flying, {{"AEOLIS_TEST_ARCHIVE", file.string()}, {"AEOLIS_TEST_CLOCK_RATE", rate}});
    return test::killed_after(flight, published, file);
}

enum class Ended : std::uint8_t { killed, left };

/// Flies in this process, with a command on the way, and leaves the run as a server does that ends.
archive::Sequence leave_after(archive::Sequence published, const std::filesystem::path& file) {
    const dictionary::Dictionary& dictionary = tests::shipped_dictionary();
    PipelineThread pipeline{std::move(archive::Archive::open(file)).value(), dictionary,
                            PipelineThread::Faults::give_up, [](const auto&) {}};
    RehearsalRunner::Callbacks callbacks;
    std::atomic<bool> begun{false};
    callbacks.on_begun = [&](const auto&) { begun = true; };
    callbacks.on_state = [](const auto&) {};
    callbacks.on_clocks = [](const auto&) {};
    {
        RehearsalRunner runner{test::short_landing(), 7, 0.0, dictionary, pipeline, callbacks};
        while (!begun) std::this_thread::sleep_for(std::chrono::milliseconds{1});
        v1::CommandRequest request;
        request.set_command("NO_OP");
        request.set_client_id("of-the-first-server");
        REQUIRE(runner.order(SendCommands{{request}, false, [](const auto&) {}}));
        while (pipeline.figures().published_items < published)
            std::this_thread::sleep_for(std::chrono::milliseconds{1});
    }
    return pipeline.figures().published_items;
}

/// Ends a flight once `published` items are out, continues the run for `further` items, and holds every item against a
/// run that nothing happened to.
void end_and_continue(archive::Sequence published, archive::Sequence further, Ended ended) {
    spdlog::set_level(spdlog::level::err);
    INFO((ended == Ended::left ? "left" : "killed") << " after item " << published);
    test::TemporaryFolder folder;
    const auto file = folder / "killed.db";
    const dictionary::Dictionary& dictionary = tests::shipped_dictionary();
    const archive::Sequence acknowledged =
        ended == Ended::left ? leave_after(published, file) : kill_after(published, file);
    REQUIRE(acknowledged >= published);
    std::optional<archive::FlownRun> cut;
    std::string failure;
    {
        auto archive = archive::Archive::open(file);
        REQUIRE(archive);
        REQUIRE(archive->interrupted() == std::vector<archive::RunId>{archive::RunId{1}});
        auto found = archive::Reader::open(file, dictionary)->cut_off(archive::RunId{1});
        REQUIRE(found);
        cut = *found;
        CHECK(cut->last_seq >= acknowledged);
        const auto count_of = [&](bool (v1::Intervention::*is_one)() const) {
            return std::ranges::count_if(cut->requests, [&](const auto& taken) {
                return (archive::kept_request(taken.request).intervention().*is_one)();
            });
        };
        if (published > 1 && ended == Ended::killed)
            CHECK((count_of(&v1::Intervention::has_fault) == 1 && count_of(&v1::Intervention::has_note) == 1));
        auto scenario = scenario_from_text(cut->scenario_text, "its row");
        REQUIRE(scenario);
        PipelineThread pipeline{std::move(*archive), dictionary, PipelineThread::Faults::give_up, [](const auto&) {}};
        std::atomic<bool> begun{false};
        RehearsalRunner::Callbacks callbacks;
        callbacks.on_begun = [&](Result<v1::RunState> state) {
            if (!state) failure = state.error().message;
            begun = true;
        };
        callbacks.on_state = [](const auto&) {};
        callbacks.on_clocks = [](const auto&) {};
        RehearsalRunner runner{*scenario, {.run = *cut}, 0.0, dictionary, pipeline, callbacks};
        while (!runner.over() && pipeline.figures().published_items < further)
            std::this_thread::sleep_for(std::chrono::milliseconds{1});
        if (ended == Ended::left) {
            v1::CommandRequest request;
            request.set_command("NO_OP");
            request.set_client_id("of-the-first-server");
            CHECK(runner.unknown({request}).empty());
        }
        CHECK(runner.order(StopRun{}));
    }
    REQUIRE(failure.empty());
    auto reader = archive::Reader::open(file, dictionary);
    const archive::Sequence last = cut->last_seq + further;
    const auto undisturbed = items_flown(*cut, last, folder / "undisturbed.db");
    std::size_t seen = 0;
    while (seen < last) {
        const auto page = reader->items(archive::RunId{1}, seen, archive::items_page_max);
        REQUIRE(page);
        REQUIRE_FALSE(page->items.empty());
        for (const auto& item : page->items)
            if (seen < last) REQUIRE(item.SerializeAsString() == undisturbed[seen++]);
    }
}

/// An archive whose run was begun with a clock of this rate and ended by kill -9, and what there is of the run as it is
/// read today.
std::pair<archive::Archive, archive::FlownRun> cut_off_in(const std::filesystem::path& file,
                                                          const std::string& rate = {}) {
    kill_after(2'000, file, rate);
    auto archive = archive::Archive::open(file);
    REQUIRE(archive);
    auto cut = archive::Reader::open(file, tests::shipped_dictionary())->cut_off(archive::RunId{1});
    REQUIRE(cut);
    return {std::move(*archive), std::move(*cut)};
}

}  // namespace

TEST_CASE("part of a test: a flight that is killed", "[.part]") {
    const auto file = test::variable("AEOLIS_TEST_ARCHIVE"), rate = test::variable("AEOLIS_TEST_CLOCK_RATE");
    REQUIRE_FALSE(file.empty());
    fly_until_killed(file, rate.empty() ? tests::shipped_dictionary() : with_clock_rate(std::stod(rate)));
}

TEST_CASE("a run that kill -9 ended goes on in the same run as if nothing had been, commands, faults and all",
          "[rehearsal][archive][R41][R43]") {
    for (const archive::Sequence published :
         {1U, 9'000U, 60'000U})  // at the start, in flight, while the recording comes down
        end_and_continue(published, 3'000, Ended::killed);
}

TEST_CASE("a run that the server left when it ended goes on in the same run as if nothing had been",
          "[rehearsal][archive][R41]") {
    end_and_continue(9'000, 3'000, Ended::left);
}

TEST_CASE("who hears of a run's end may begin another: the runner is over by then", "[rehearsal][threads]") {
    const test::TemporaryFolder folder;
    const dictionary::Dictionary& dictionary = tests::shipped_dictionary();
    PipelineThread pipeline{std::move(archive::Archive::open(folder / "a.db")).value(), dictionary,
                            PipelineThread::Faults::give_up, [](const auto&) {}};
    std::atomic<RehearsalRunner*> told_of{nullptr};
    std::atomic<int> ends{0}, over_by_then{0};
    RehearsalRunner::Callbacks callbacks;
    callbacks.on_begun = [](const auto&) {};
    callbacks.on_clocks = [](const auto&) {};
    callbacks.on_state = [&](const v1::RunState& state) {
        if (state.state() != v1::RunState::finished) return;
        while (told_of == nullptr) std::this_thread::sleep_for(std::chrono::milliseconds{1});
        over_by_then += told_of.load()->over() ? 1 : 0;
        ++ends;
    };
    RehearsalRunner runner{test::short_landing(), 7, 0.0, dictionary, pipeline, callbacks};
    told_of = &runner;
    CHECK(runner.order(StopRun{}));
    while (ends == 0) std::this_thread::sleep_for(std::chrono::milliseconds{1});
    CHECK(ends == 1);
    CHECK(over_by_then == 1);
}

TEST_CASE(
    "a jump of time flies to its end as fast as it can and holds there; nobody commands meanwhile, and it is kept",
    "[rehearsal][threads][R59]") {
    const test::TemporaryFolder folder;
    const dictionary::Dictionary& dictionary = tests::shipped_dictionary();
    archive::RunId run;
    std::string digest;
    const auto scenario = test::short_landing();
    {
        PipelineThread pipeline{std::move(archive::Archive::open(folder / "a.db")).value(), dictionary,
                                PipelineThread::Faults::give_up, [](const auto&) {}};
        std::mutex mutex;
        v1::RunState told;
        RehearsalRunner::Callbacks callbacks;
        callbacks.on_begun = [&](Result<v1::RunState> state) {
            run = {static_cast<std::uint32_t>(state->run())};
            const std::scoped_lock lock{mutex};
            told = *state;
        };
        callbacks.on_clocks = [](const auto&) {};
        callbacks.on_state = [&](const v1::RunState& state) {
            const std::scoped_lock lock{mutex};
            told = state;
        };
        RehearsalRunner runner{scenario, 7, 1.0, dictionary, pipeline, callbacks};
        const auto wait_until = [&](const auto& is_so) {
            for (;; std::this_thread::sleep_for(std::chrono::milliseconds{1})) {
                const std::scoped_lock lock{mutex};
                if (is_so(told)) return told;
            }
        };
        const double begin_e_s = -scenario.start_before_entry_s;
        wait_until([&](const auto& state) { return state.clocks().e_s() > begin_e_s; });
        REQUIRE(runner.order(JumpRun{begin_e_s + 20.0}).ok());
        const auto jumping = wait_until([](const auto& state) { return state.has_jumps_to_e_s(); });
        CHECK(jumping.jumps_to_e_s() == begin_e_s + 20.0);
        const auto held = wait_until([](const auto& state) { return state.state() == v1::RunState::paused; });
        CHECK_FALSE(held.has_jumps_to_e_s());
        CHECK(held.pace() == 1.0);
        CHECK(held.clocks().e_s() == Approx(begin_e_s + 20.0).margin(2.0 / 64.0));
        CHECK(runner.order(JumpRun{begin_e_s + 5.0}).error().message.starts_with("jump: E−"));

        // Pausing ends one where it is. Commands are refused from when it is ordered.
        REQUIRE(runner.order(JumpRun{begin_e_s + 20000.0}).ok());
        std::string refused;
        SendCommands order;
        order.requests.emplace_back().set_command("NO_OP");
        order.replies = [&](std::vector<v1::CommandReply> replies) { refused = replies.front().reason(); };
        CHECK(runner.order(std::move(order)).ok());
        CHECK_THAT(refused, Catch::StartsWith("the rehearsal jumps to E+"));
        wait_until([](const auto& state) { return state.has_jumps_to_e_s(); });
        REQUIRE(runner.order(PauseRun{true}).ok());
        wait_until(
            [](const auto& state) { return state.state() == v1::RunState::paused && !state.has_jumps_to_e_s(); });
        REQUIRE(runner.order(PaceRun{0.0}).ok());
        REQUIRE(runner.order(PauseRun{false}).ok());
        digest = wait_until([](const auto& state) { return state.state() == v1::RunState::finished; }).digest();
    }
    auto reader = archive::Reader::open(folder / "a.db", dictionary);
    REQUIRE(reader.ok());
    const auto jumps = reader->jumps(run);
    REQUIRE(jumps.ok());
    REQUIRE(jumps->size() == 2);
    CHECK(jumps->at(0).from_e_s() >= -scenario.start_before_entry_s);
    CHECK(jumps->at(0).from_e_s() < -scenario.start_before_entry_s + 20.0);
    CHECK(jumps->at(0).to_e_s() == Approx(-scenario.start_before_entry_s + 20.0).margin(2.0 / 64.0));
    CHECK(jumps->at(1).from_e_s() == jumps->at(0).to_e_s());
    CHECK_FALSE(jumps->at(1).begins());
    // Nothing of the flight is another by it.
    Rehearsal undisturbed{scenario, 7, 0, dictionary};
    while (!undisturbed.finished()) undisturbed.step();
    CHECK(undisturbed.digest() == digest);
}

TEST_CASE("a run that is cut off within a jump is continued where it was, and holds there",
          "[rehearsal][threads][R59]") {
    const test::TemporaryFolder folder;
    const dictionary::Dictionary& dictionary = tests::shipped_dictionary();
    const auto file = folder / "a.db";
    const auto scenario = test::short_landing();
    archive::RunId run;
    const auto fly = [&](const auto& make, const auto& meanwhile) {
        PipelineThread pipeline{std::move(archive::Archive::open(file)).value(), dictionary,
                                PipelineThread::Faults::give_up, [](const auto&) {}};
        std::mutex mutex;
        std::optional<v1::RunState> told;
        RehearsalRunner::Callbacks callbacks;
        const auto take = [&](const v1::RunState& state) {
            const std::scoped_lock lock{mutex};
            told = state;
        };
        callbacks.on_begun = [&](Result<v1::RunState> state) {
            REQUIRE(state.ok());
            run = {static_cast<std::uint32_t>(state->run())};
            take(*state);
        };
        callbacks.on_clocks = [&](const v1::Clocks& clocks) {
            const std::scoped_lock lock{mutex};
            if (told) *told->mutable_clocks() = clocks;
        };
        callbacks.on_state = take;
        const auto runner = make(pipeline, callbacks);
        meanwhile(*runner, [&](const auto& is_so) {
            for (;; std::this_thread::sleep_for(std::chrono::milliseconds{1})) {
                const std::scoped_lock lock{mutex};
                if (told && is_so(*told)) return *told;
            }
        });
    };
    fly(
        [&](PipelineThread& pipeline, RehearsalRunner::Callbacks callbacks) {
            return std::make_unique<RehearsalRunner>(scenario, 7, 1.0, dictionary, pipeline, callbacks);
        },
        [&](RehearsalRunner& runner, const auto& wait_until) {
            wait_until([](const auto&) { return true; });
            REQUIRE(runner.order(JumpRun{-10.0}).ok());
            wait_until([](const auto& state) { return state.clocks().e_s() > -880.0; });
        });                                      // it is left, as when the server ends
    REQUIRE(archive::Archive::open(file).ok());  // as a server that comes up: what was cut off is marked so
    auto reader = archive::Reader::open(file, dictionary);
    REQUIRE(reader.ok());
    REQUIRE(reader->jumps(run)->size() == 1);
    CHECK(reader->jumps(run)->front().begins());
    v1::StartRehearsal request;
    request.set_continue_run(run.value);
    auto again = again_of(request, *reader);
    REQUIRE(again.ok());
    fly(
        [&](PipelineThread& pipeline, RehearsalRunner::Callbacks callbacks) {
            return std::make_unique<RehearsalRunner>(scenario, std::move(*again), 1.0, dictionary, pipeline, callbacks);
        },
        [&](RehearsalRunner& runner, const auto& wait_until) {
            const auto held = wait_until([](const auto& state) { return state.state() == v1::RunState::paused; });
            CHECK_FALSE(held.has_jumps_to_e_s());
            CHECK(held.clocks().e_s() > -881.0);
            CHECK(held.clocks().e_s() < -10.0);
            CHECK(runner.order(StopRun{}).ok());
            wait_until([](const auto& state) { return state.state() == v1::RunState::finished; });
        });
    const auto jumps = reader->jumps(run);
    REQUIRE(jumps->size() == 1);
    CHECK_FALSE(jumps->front().begins());
    CHECK(jumps->front().to_e_s() > -881.0);
}

TEST_CASE("a kept request comes back from its text, and another text is none", "[rehearsal][archive]") {
    v1::KeptRequest kept;
    kept.mutable_verdict()->set_command(3);
    kept.mutable_verdict()->set_analysis("all bounds hold, \"detumble\" too");
    CHECK(archive::kept_request(archive::kept_text(kept)).SerializeAsString() == kept.SerializeAsString());
    CHECK(archive::kept_request("command { command: \"NO_OP\" } browser: \"b1\"").browser() == "b1");
    CHECK(archive::kept_request("command: \"NO_OP\"").kept_case() == v1::KeptRequest::KEPT_NOT_SET);
}

TEST_CASE("fifty runs that kill -9 ended at random go on as if nothing had been", "[.long][rehearsal][archive]") {
    std::mt19937_64 random{1};
    for (int i = 0; i < 50; ++i) end_and_continue(1 + random() % 60'000, 5'000, Ended::killed);
}

TEST_CASE("a run that was left goes on with the flight that ground keeps beside it, and with the flights of its plan",
          "[rehearsal][shadow][archive][R57][release]") {
    spdlog::set_level(spdlog::level::err);
    test::TemporaryFolder folder;
    const auto file = folder / "left.db";
    const dictionary::Dictionary& dictionary = tests::shipped_dictionary();
    auto scenario = test::shipped_scenario("nominal_auto");
    scenario.start_before_entry_s = 900.0;
    scenario.commands[0].send_before_entry_s = 895.0;
    scenario.commands[1].send_before_entry_s = 885.0;
    scenario.ground_flight = true;
    const auto fly = [&](std::optional<archive::FlownRun> cut, double until_e_s) {
        auto archive = archive::Archive::open(file);
        REQUIRE(archive);
        std::string failure;
        std::atomic<double> e_s{-1.0e9};
        PipelineThread pipeline{std::move(*archive), dictionary, PipelineThread::Faults::give_up, [](const auto&) {}};
        RehearsalRunner::Callbacks callbacks;
        callbacks.on_begun = [&](const Result<v1::RunState>& state) {
            if (!state) failure = state.error().message;
        };
        callbacks.on_state = [](const auto&) {};
        callbacks.on_clocks = [&](const v1::Clocks& clocks) { e_s = clocks.e_s(); };
        callbacks.companion = shadow::make_shadows(dictionary, {.cases = 2});
        const double pace = cut ? 0.0 : 200.0;
        RehearsalRunner runner = cut ? RehearsalRunner{scenario, {.run = *cut}, pace, dictionary, pipeline, callbacks}
                                     : RehearsalRunner{scenario, 1, pace, dictionary, pipeline, callbacks};
        while (!runner.over() && e_s < until_e_s) std::this_thread::sleep_for(std::chrono::milliseconds{1});
        static_cast<void>(runner.order(LeaveRun{}));
        while (!runner.over()) std::this_thread::sleep_for(std::chrono::milliseconds{1});
        return failure;
    };
    const auto cut_off = [&] {
        REQUIRE(archive::Archive::open(file));  // finds that the run was cut off
        auto reader = archive::Reader::open(file, dictionary);
        REQUIRE(reader);
        auto cut = reader->cut_off(archive::RunId{1});
        INFO((cut ? "" : cut.error().message));
        REQUIRE(cut);
        return *cut;
    };
    CHECK(fly({}, 60.0).empty());
    const auto first = cut_off();
    const auto plans = [](const archive::FlownRun& run) {
        return std::ranges::count_if(
            run.requests, [](const auto& request) { return archive::kept_request(request.request).has_ensemble(); });
    };
    CHECK(plans(first) == 1);
    CHECK(fly(first, 120.0).empty());  // each item of before is compared
    const auto second = cut_off();
    CHECK(plans(second) == 1);
    auto reader = archive::Reader::open(file, dictionary);
    const auto series = reader->series(archive::RunId{1}, {{"STA-0007", "STA-0023"}, {}, {}});
    REQUIRE(series);
    CHECK(series->channels(0).sclk_size() > 700);
    CHECK(series->channels(1).value(series->channels(1).value_size() - 1) == 2.0);
    const auto altitude = dictionary.channel("altitude_m")->id, stand = dictionary.channel("timepoint_index")->id;
    const auto expected = reader->expected_values(archive::RunId{1}, {altitude, stand}, {});
    REQUIRE(expected);
    CHECK((*expected)[0].sclk_s.size() > 600);  // each second from E−540 s on
    CHECK((*expected)[1].sclk_s.size() > 5);
    CHECK((*expected)[1].sclk_s.size() < 100);  // where it changes
    CHECK((*expected)[0].sclk_s.back() > scenario.entry_sclk.seconds + 118.0);
    // Within a range in which it does not change it has the range's ends.
    const auto& whole = (*expected)[1];
    std::size_t held = 0;
    while (held + 1 < whole.sclk_s.size() && whole.sclk_s[held + 1] - whole.sclk_s[held] < 5.0) ++held;
    REQUIRE(held + 1 < whole.sclk_s.size());
    const double from_s = whole.sclk_s[held] + 1.0, to_s = whole.sclk_s[held] + 3.0;
    const auto within = reader->expected_values(archive::RunId{1}, {stand}, {from_s, to_s});
    REQUIRE(within);
    CHECK((*within)[0].sclk_s == std::vector<double>{from_s, to_s});
    CHECK((*within)[0].value == std::vector<double>{whole.value[held], whole.value[held]});
    const auto timepoints = reader->timepoints(archive::RunId{1}, {});
    REQUIRE(timepoints);
    const auto mortar =
        std::ranges::find(timepoints->timepoints(), "parachute_deploy", [](const auto& row) { return row.name(); });
    CHECK(std::abs(mortar->flights_e_s() - 256.0) < 30.0);  // of two flights
    CHECK(mortar->flights() == 2);
    CHECK_FALSE(mortar->has_flights_from_e_s());
}

TEST_CASE("a run that does not come out the same is not continued, and what it has stays as it is",
          "[rehearsal][archive][R43]") {
    test::TemporaryFolder folder;
    const auto file = folder / "killed.db";
    const dictionary::Dictionary& dictionary = tests::shipped_dictionary();
    spdlog::set_level(spdlog::level::err);
    auto [archive, cut] = cut_off_in(file);
    cut.seed = 8;
    std::string failure;
    {
        PipelineThread pipeline{std::move(archive), dictionary, PipelineThread::Faults::give_up, [](const auto&) {}};
        RehearsalRunner::Callbacks callbacks;
        callbacks.on_begun = [&](Result<v1::RunState> state) { failure = state ? "continued" : state.error().message; };
        RehearsalRunner runner{test::short_landing(), {.run = cut}, 0.0, dictionary, pipeline, callbacks};
        while (!runner.over()) std::this_thread::sleep_for(std::chrono::milliseconds{1});
    }
    CHECK_THAT(failure, Catch::Contains("run 1 cannot be continued: run 1: flown again, item"));
    auto reader = archive::Reader::open(file, dictionary);
    CHECK(reader->run(archive::RunId{1})->state() == v1::RunState::interrupted);
    CHECK(reader->last_seq(archive::RunId{1}).value() == cut.last_seq);
}

TEST_CASE("what is written down while a cut-off run is being continued keeps its number, and no item has another's",
          "[rehearsal][archive][R43]") {
    test::TemporaryFolder folder;
    const auto file = folder / "killed.db";
    const dictionary::Dictionary& dictionary = tests::shipped_dictionary();
    spdlog::set_level(spdlog::level::err);
    const archive::RunId run{1};
    auto [archive, cut] = cut_off_in(file);
    archive::NoteRecord note;
    note.text = "between reading and going on";
    REQUIRE(archive.annotate(run, note));
    {
        PipelineThread pipeline{std::move(archive), dictionary, PipelineThread::Faults::give_up, [](const auto&) {}};
        RehearsalRunner::Callbacks callbacks;
        archive::Sequence told = 0;
        callbacks.on_begun = [&](Result<v1::RunState> state) { told = state ? state->last_seq() : 0; };
        callbacks.on_state = [](const auto&) {};
        callbacks.on_clocks = [](const auto&) {};
        RehearsalRunner runner{test::short_landing(), {.run = cut}, 0.0, dictionary, pipeline, callbacks};
        while (!runner.over() && pipeline.figures().published_items < 500)
            std::this_thread::sleep_for(std::chrono::milliseconds{1});
        CHECK(runner.order(StopRun{}));
        while (!runner.over()) std::this_thread::sleep_for(std::chrono::milliseconds{1});
        CHECK(told == cut.last_seq + 1);  // who follows it resumes from there
    }
    auto reader = archive::Reader::open(file, dictionary);
    archive::Sequence seen = 0;
    int notes = 0;
    for (auto page = reader->items(run, seen, archive::items_page_max); page && !page->items.empty();
         page = reader->items(run, seen, archive::items_page_max))
        for (const auto& item : page->items) {
            REQUIRE(item.seq() == ++seen);
            notes += item.has_note() ? 1 : 0;
            if (item.has_note()) CHECK(item.seq() == cut.last_seq + 1);
        }
    CHECK(notes == 1);
    CHECK(seen > cut.last_seq + 500);
}

TEST_CASE("a run that goes on keeps the clock with which it was begun, whatever the sheet says by now",
          "[rehearsal][archive][time][R43]") {
    test::TemporaryFolder folder;
    const auto file = folder / "killed.db";
    spdlog::set_level(spdlog::level::err);
    const dictionary::Dictionary& today = tests::shipped_dictionary();
    auto [archive, cut] = cut_off_in(file, "1.00002");  // some 18 ms over the flight to entry
    CHECK(cut.clock.rate == 1.00002);
    std::atomic<bool> begun{false};
    std::string failure;
    v1::RunState state;
    {
        PipelineThread pipeline{std::move(archive), today, PipelineThread::Faults::give_up, [](const auto&) {}};
        RehearsalRunner::Callbacks callbacks;
        callbacks.on_begun = [&](Result<v1::RunState> told) {
            if (told)
                state = *told;
            else
                failure = told.error().message;
            begun = true;
        };
        callbacks.on_state = [](const auto&) {};
        callbacks.on_clocks = [](const auto&) {};
        RehearsalRunner runner{test::short_landing(), {.run = cut}, 0.0, today, pipeline, callbacks};
        while (!begun) std::this_thread::sleep_for(std::chrono::milliseconds{1});
        CHECK(runner.order(StopRun{}));
        while (!runner.over()) std::this_thread::sleep_for(std::chrono::milliseconds{1});
    }
    CHECK(failure.empty());
    CHECK(state.clock().version() == 4);
    CHECK(state.clock().rate() == 1.0 + 2.0e-5);
}

}  // namespace server_rehearsal_runner_test
