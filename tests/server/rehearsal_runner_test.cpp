#include "server/rehearsal/rehearsal_runner.hpp"

#include "server/archive/reader.hpp"
#include "server/rehearsal/rehearsal.hpp"
#include "tests/server/running_server.hpp"
#include "tests/server/small_mission.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <atomic>
#include <chrono>
#include <thread>

using namespace aeolis;
using namespace aeolis::server;

TEST_CASE("tones come from a waveform up to the pace that sustains it, unless the scenario has chosen", "[tones][R31]") {
    simulation::Radio open;
    CHECK(RehearsalRunner::from_samples(open, 1.0));
    CHECK(RehearsalRunner::from_samples(open, RehearsalRunner::signal_pace_max));
    CHECK_FALSE(RehearsalRunner::from_samples(open, RehearsalRunner::signal_pace_max + 1.0));
    CHECK_FALSE(RehearsalRunner::from_samples(open, 0.0)); // as fast as it goes
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

TEST_CASE("a change of pace in mid-run loses, doubles and changes no tone, and the run goes on saying where they come from",
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
        PipelineThread pipeline{std::move(archive::Archive::open(file)).value(), dictionary, PipelineThread::Faults::give_up,
                                [](const auto&) {}};
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
            while (e_s < until_e_s)
                std::this_thread::sleep_for(std::chrono::milliseconds{1});
        };
        fly_until(-870.0);
        runner.set_pace(0.0);
        fly_until(-700.0);
        runner.stop();
        while (!runner.over())
            std::this_thread::sleep_for(std::chrono::milliseconds{1});
    }
    REQUIRE(begun);
    CHECK(tone_model == "signal");

    scenario.radio.tones_from_samples = true;
    Rehearsal undisturbed{scenario, 1, 0, dictionary};
    std::vector<simulation::ReceivedTone> expected;
    while (undisturbed.landing().sclk() < scenario.entry_sclk - 700.0)
        for (const auto& tone : undisturbed.step().tones)
            expected.push_back(tone);

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
        CHECK(tone.ert_start() == day_of_year_text(expected[i].start));
        CHECK(tone.has_tone() == expected[i].tone.has_value());
        if (expected[i].tone) CHECK(tone.tone() == expected[i].tone->value);
        CHECK(tone.likelihood() == expected[i].likelihood);
        CHECK(tone.spectrum().size() == 128);
    }
}
