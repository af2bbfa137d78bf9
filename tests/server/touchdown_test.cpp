// SPDX-License-Identifier: Apache-2.0
#include "server/api/touchdown.hpp"

#include "server/pipeline/pipeline.hpp"
#include "server/rehearsal/rehearsal.hpp"
#include "tests/server/running_server.hpp"
#include "tests/server/small_mission.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <algorithm>
#include <cmath>

namespace server_touchdown_test {

using namespace aeolis;
using namespace aeolis::test;
using Step = v1::TouchdownStep;
using Report = v1::TouchdownReport;

namespace {

constexpr double down_s = 1430.0, entry_s = 1000.0;

}  // namespace

TEST_CASE("a place says what it rests on; its uncertainty is not known, and none is made up", "[touchdown]") {
    CHECK(server::place_rests_on(0.0) ==
          "the entry solution from ground, carried on by the IMU; radar corrects height and velocity, not the place. "
          "Its uncertainty is not known: no channel and no solution holds it");
    CHECK(server::place_rests_on({}) == server::place_rests_on(0.0));
    CHECK(server::place_rests_on(1.25).ends_with("; for a silence of the IMU velocity may have been off by 1.25 m/s"));
}

TEST_CASE("a place over ground is east and north of the target, and in the ellipse or not by its axes", "[touchdown]") {
    constexpr double radius_m = 3'390'000.0;
    const auto at = [&](double x, double y, double z) {
        return server::place_over_ground({x, y, z}, 0.0, 90.0, radius_m);
    };
    CHECK(at(0.0, radius_m, 0.0).east_m() == Approx(0.0).margin(1e-6));
    CHECK(at(-1000.0, radius_m, 0.0).east_m() == Approx(1000.0).margin(0.1));  // east of 90° is towards 180°
    CHECK(at(0.0, radius_m, 2000.0).north_m() == Approx(2000.0).margin(0.5));
    CHECK(at(0.0, 2.0 * radius_m, 4000.0).north_m() == Approx(2000.0).margin(0.5));  // height does not count
    v1::TargetEllipse ellipse;
    ellipse.set_major_m(20'000.0);
    ellipse.set_minor_m(7'000.0);
    ellipse.set_azimuth_deg(90.0);
    const auto inside = [&](double east_m, double north_m) {
        v1::TouchdownPlace place;
        place.set_east_m(east_m);
        place.set_north_m(north_m);
        return server::is_inside(place, ellipse);
    };
    CHECK(inside(9'999.0, 0.0));
    CHECK_FALSE(inside(10'001.0, 0.0));
    CHECK(inside(0.0, -3'499.0));
    CHECK_FALSE(inside(0.0, 3'501.0));
    ellipse.set_azimuth_deg(0.0);
    CHECK(inside(0.0, 9'999.0));
    CHECK_FALSE(inside(9'999.0, 0.0));
}

TEST_CASE("the names by which a touchdown is told are words of the shipped dictionary", "[touchdown]") {
    const auto& shipped = tests::shipped_dictionary();
    std::vector<std::string_view> channels{telemetry::touchdown_flag, telemetry::touchdown_live,
                                           telemetry::rover_rate_channel, telemetry::rover_force_channel};
    channels.insert(channels.end(), server::position_channels.begin(), server::position_channels.end());
    for (const auto& each : server::touchdown_channels) channels.push_back(each.channel);
    for (const auto name : channels) {
        INFO(name);
        CHECK(shipped.channel(name) != nullptr);
    }
    const auto has = [](const auto& all, std::string_view name) {
        return std::ranges::any_of(all, [&](const auto& each) { return each.name == name; });
    };
    CHECK(has(shipped.events, telemetry::touchdown_event));
    CHECK(has(shipped.timeline, telemetry::touchdown_timepoint));
    for (const auto name : server::target_arguments) CHECK(has(shipped.command("EDL_SET_PARAMETERS")->arguments, name));
}

TEST_CASE("the touchdown of a past is what was received by then, and its figures are those just before it",
          "[touchdown][archive]") {
    const TemporaryFolder folder;
    auto dictionary = small_dictionary();
    dictionary.timeline[2].name = "touchdown";
    dictionary.channels[speed.value].name = "descent_rate_mps";
    for (auto& field : dictionary.packets[0].fields)
        if (field.channel == speed) field.name = "descent_rate_mps";
    dictionary.model = tests::packet_model_of(dictionary);
    auto archive = archive::Archive::open(folder / "a.db");
    REQUIRE(archive);
    pipeline::Pipeline pipeline{*archive, dictionary};
    archive::RunStart start;
    start.entry = Sclk{entry_s};
    REQUIRE(pipeline.begin(start));
    const auto accept = [&](auto&& what) { REQUIRE(pipeline.accept(std::forward<decltype(what)>(what)).ok()); };
    accept(live(navigation_packet(0, down_s - 1.0, 10.0F, 0.75F)));
    accept(live(navigation_packet(1, down_s + 1.0, 10.0F, 0.5F)));
    accept(live(fired_packet(0, down_s, 2)));
    accept(live(status_packet(0, down_s + 0.5, 9)));
    REQUIRE(pipeline.commit().ok());
    auto reader = archive::Reader::open(folder / "a.db", dictionary);
    REQUIRE(reader);
    const auto at = [&](std::optional<Sclk> sclk) {
        auto report = server::touchdown(*reader, archive::RunId{1}, dictionary, sclk, {}, true);
        REQUIRE(report);
        return std::move(*report);
    };
    CHECK(at(Sclk{down_s - 0.5}).verdict() == Report::untold);
    const auto report = at({});
    CHECK(report.verdict() == Report::reported);
    CHECK(report.sclk() == down_s);
    CHECK(report.steps(0).words() == "E+7:10.0: timepoint touchdown by UHF");
    REQUIRE(report.figures_size() == 3);
    CHECK(report.figures(0).name() == "down");
    CHECK(report.figures(0).value() == 0.75);
    CHECK(report.figures(0).before_s() == 1.0);
    CHECK_FALSE(report.figures(1).has_value());
    CHECK_FALSE(report.has_place());
    CHECK(report.place_unknown() == "no target in the ground's solution");
}

namespace {

/// What a landing of `scenario` brought to ground says of its touchdown, without and with the recording.
struct Landed {
    explicit Landed(const simulation::Scenario& scenario) {
        const TemporaryFolder folder;
        const auto& dictionary = tests::shipped_dictionary();
        auto archive = std::move(archive::Archive::open(folder / "a.db")).value();
        pipeline::Pipeline pipeline{archive, dictionary};
        server::Rehearsal rehearsal{scenario, 1, 0, dictionary};
        REQUIRE(pipeline.begin(rehearsal.run_start(0.0)).ok());
        bool taken = true;
        while (!rehearsal.finished()) {
            taken = taken && pipeline.accept(rehearsal.step()).ok();
            for (auto& stage : rehearsal.take_stages()) taken = taken && pipeline.accept(std::move(stage)).ok();
            taken = taken && pipeline.commit_if_full().ok();
        }
        REQUIRE((taken && pipeline.finish({}).ok()));
        auto reader = archive::Reader::open(folder / "a.db", dictionary);
        for (const bool recorded : {false, true}) {
            auto report = server::touchdown(*reader, archive::RunId{1}, dictionary, {}, {}, recorded);
            REQUIRE(report);
            (recorded ? with_recording : live) = std::move(*report);
        }
    }
    Report live, with_recording;
};

}  // namespace

TEST_CASE("a nominal landing is confirmed, live and with its recording", "[touchdown][simulation]") {
    const Landed landed{test::shipped_scenario("nominal_auto")};
    for (const auto* report : {&landed.live, &landed.with_recording}) {
        INFO(report->steps(1).words() << "; " << report->steps(2).words());
        CHECK(report->verdict() == Report::confirmed);
        CHECK(report->steps(1).sclk() - report->sclk() < telemetry::still_s + 2.0);
    }
}

TEST_CASE("a landing whose rover's IMU is silent, or says that its data fail, stays reported and says why",
          "[touchdown][simulation]") {
    for (const auto kind : {simulation::DeviceFault::Kind::silent, simulation::DeviceFault::Kind::dropout}) {
        auto scenario = test::shipped_scenario("nominal_auto");
        scenario.device_faults = {{flight::Device::rover_imu, flight::Unit::a, kind, -300.0, 1000.0}};
        const Landed landed{scenario};
        CHECK(landed.live.verdict() == Report::reported);
        CHECK(landed.with_recording.verdict() == Report::reported);
        CHECK(landed.live.steps(1).state() == Step::unknown);
        CHECK(
            landed.live.steps(1).words().starts_with("not known: rover_imu_rate_rps has told nothing since touchdown"));
        CHECK(landed.live.steps(2).state() == Step::done);
    }
}

TEST_CASE("a flag of the archive that falls after the touchdown contradicts it, when it was received and is defined",
          "[touchdown][archive][R53]") {
    const TemporaryFolder folder;
    auto dictionary = small_dictionary();
    dictionary.timeline[2].name = "touchdown";
    dictionary.channels[altitude.value].name = telemetry::touchdown_flag;
    for (auto& field : dictionary.packets[0].fields)
        if (field.channel == altitude) field.name = telemetry::touchdown_flag;
    dictionary.model = tests::packet_model_of(dictionary);
    auto archive = archive::Archive::open(folder / "a.db");
    REQUIRE(archive);
    pipeline::Pipeline pipeline{*archive, dictionary};
    archive::RunStart start;
    start.entry = Sclk{entry_s};
    REQUIRE(pipeline.begin(start));
    const auto accept = [&](auto&& what) { REQUIRE(pipeline.accept(std::forward<decltype(what)>(what)).ok()); };
    accept(live(fired_packet(0, down_s, 2)));
    accept(live(navigation_packet(0, down_s + 1.0, 1.0F, 0.5F)));
    accept(live(navigation_packet(1, down_s + 10.0, 1.0F, 0.5F)));
    accept(live(navigation_packet(2, down_s + 20.0, {}, 0.5F)));  // undefined says nothing
    accept(recorded(navigation_packet(3, down_s + 30.0, 0.0F, 0.5F)));
    accept(live(navigation_packet(4, down_s + 40.0, 0.0F, 0.5F)));
    REQUIRE(pipeline.commit().ok());
    auto reader = archive::Reader::open(folder / "a.db", dictionary);
    REQUIRE(reader);
    const auto told_at = [&](double sclk_s, bool with_recording) {
        auto report = server::touchdown(*reader, archive::RunId{1}, dictionary, Sclk{sclk_s}, {}, with_recording);
        REQUIRE(report);
        return std::move(*report);
    };
    CHECK(told_at(down_s + 25.0, true).verdict() == Report::reported);
    CHECK(told_at(down_s + 25.0, true).steps(0).words() ==
          "E+7:10.0: timepoint touchdown by UHF, touchdown_declared is 1");
    CHECK(told_at(down_s + 35.0, false).verdict() == Report::reported);
    const auto by_recording = told_at(down_s + 35.0, true);
    CHECK(by_recording.verdict() == Report::contradicted);
    CHECK(by_recording.steps(0).words() ==
          "timepoint touchdown by UHF at E+7:10.0, but touchdown_declared is 0 at E+7:40.0");
    // Beyond what was received holds what was received last.
    for (const double beyond_s : {down_s + 45.0, down_s + 1.0e6}) {
        CHECK(told_at(beyond_s, false).verdict() == Report::contradicted);
        CHECK(told_at(beyond_s, false).steps(0).words() ==
              "timepoint touchdown by UHF at E+7:10.0, but touchdown_declared is 0 at E+7:50.0");
    }
}

}  // namespace server_touchdown_test
