// SPDX-License-Identifier: Apache-2.0
#include "flight/edl/gnc_health.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/outbox.hpp"

#include <cmath>

namespace flight_gnc_health_test {

using namespace aeolis;
using namespace aeolis::flight;
constexpr aeolis::flight::Parameters parameters;

namespace {

bool asked_for(const test::OutboxRecorder& recorder, ToneId tone) {
    for (const ToneRequest& request : recorder.sent<ToneRequest>())
        if (request.tone == tone) return true;
    return false;
}

}  // namespace

TEST_CASE("a silence of the IMU is told once when it is one, and its end with what is believed", "[edl][R27]") {
    test::OutboxRecorder recorder;
    GncHealth health;
    gnc::Output gnc;
    for (int tick = 1; tick < 4; ++tick) {
        gnc.dead_reckoned_s = tick * seconds_per_tick;
        health.watch(parameters, gnc, recorder.out);
    }
    CHECK(recorder.events<evr::IMU_SILENT>() == 0);  // three ticks may be garbled messages
    for (int tick = 4; tick < 10; ++tick) {
        gnc.dead_reckoned_s = tick * seconds_per_tick;
        health.watch(parameters, gnc, recorder.out);
    }
    CHECK(recorder.events<evr::IMU_SILENT>() == 1);
    CHECK(asked_for(recorder, tone::imu_silent));
    CHECK(recorder.events<evr::IMU_HEARD_AGAIN>() == 0);
    gnc.dead_reckoned_s = 0.0;
    health.watch(parameters, gnc, recorder.out);
    health.watch(parameters, gnc, recorder.out);
    CHECK(recorder.events<evr::IMU_HEARD_AGAIN>() == 1);
}

TEST_CASE("attitude that is lost is told, and propellant that is low, each once", "[edl][R27]") {
    test::OutboxRecorder recorder;
    GncHealth health;
    gnc::Output gnc;
    gnc.attitude_uncertainty_deg = parameters.attitude_lost_deg - 0.1;
    health.watch(parameters, gnc, recorder.out);
    CHECK(recorder.events<evr::ATTITUDE_LOST>() == 0);
    gnc.attitude_uncertainty_deg = parameters.attitude_lost_deg;
    gnc.propellant_low = true;
    health.watch(parameters, gnc, recorder.out);
    health.watch(parameters, gnc, recorder.out);
    CHECK(recorder.events<evr::ATTITUDE_LOST>() == 1);
    CHECK(recorder.events<evr::PROPELLANT_LOW>() == 1);
    CHECK(asked_for(recorder, tone::attitude_lost));
    CHECK(asked_for(recorder, tone::propellant_low));
}

TEST_CASE("thrusters that are not felt are told once, after some judgements in a row, explained, and again when felt",
          "[edl][R27][R38]") {
    test::OutboxRecorder recorder;
    GncHealth health;
    gnc::Output gnc;
    const auto judged = [&](double felt) {
        recorder.begin(ModuleId::edl, Sclk{1000.0});
        gnc.thrusters_judged = true;
        gnc.thrusters_felt = felt;
        health.watch(parameters, gnc, recorder.out);
        return recorder.events<evr::THRUSTERS_NOT_FELT>();
    };
    const double least = parameters.thrusters_felt_min;
    CHECK(judged(least) == 0);
    for (int i = 1; i < static_cast<int>(parameters.thrusters_unfelt_windows); ++i) CHECK(judged(0.99 * least) == 0);
    CHECK(judged(1.0) == 0);  // the row is broken
    for (int i = 1; i < static_cast<int>(parameters.thrusters_unfelt_windows); ++i) CHECK(judged(0.0) == 0);
    CHECK(judged(0.0) == 1);
    CHECK(asked_for(recorder, tone::thrusters_not_felt));
    const auto told = recorder.explanations();
    REQUIRE(told.size() == 1);
    CHECK(told[0].decision == Decision::device_lost);
    CHECK(told[0].subject == static_cast<std::uint16_t>(Device::thrusters));
    REQUIRE(told[0].conditions.size() == 2);
    CHECK(told[0].conditions[0].quantity == Quantity::thrusters_felt);
    CHECK(told[0].conditions[1].quantity == Quantity::judgements_in_a_row);
    CHECK(told[0].conditions[1].bound == std::floor(parameters.thrusters_unfelt_windows));
    for (const gnc::Condition& condition : told[0].conditions) CHECK(condition.holds);
    CHECK(judged(0.0) == 0);
    gnc.thrusters_felt.reset();
    health.watch(parameters, gnc, recorder.out);
    CHECK(recorder.events<evr::THRUSTERS_FELT_AGAIN>() == 0);
    judged(0.9);
    CHECK(recorder.events<evr::THRUSTERS_FELT_AGAIN>() == 1);
    judged(0.9);
    CHECK(recorder.events<evr::THRUSTERS_FELT_AGAIN>() == 0);
}

TEST_CASE("judgements of thrusters before and after a pause are not in a row, and what nobody judges any more is said",
          "[edl][R27]") {
    test::OutboxRecorder recorder;
    GncHealth health;
    gnc::Output gnc;
    gnc.mode = gnc::Mode::range_control;
    const auto watch = [&](bool judged, std::optional<double> felt) {
        recorder.begin(ModuleId::edl, Sclk{1000.0});
        gnc.thrusters_judged = judged;
        gnc.thrusters_felt = felt;
        health.watch(parameters, gnc, recorder.out);
    };
    const int in_a_row = static_cast<int>(parameters.thrusters_unfelt_windows);
    const auto unfelt = [&](int times) {
        for (int i = 0; i < times; ++i) watch(true, 0.0);
        return recorder.events<evr::THRUSTERS_NOT_FELT>();
    };
    CHECK(unfelt(in_a_row - 1) == 0);
    watch(false, {});
    CHECK(unfelt(in_a_row - 1) == 0);
    CHECK(unfelt(1) == 1);
    watch(false, {});  // a pause: they may be felt again
    CHECK(recorder.events<evr::THRUSTERS_NOT_JUDGED>() == 0);
    gnc.mode = gnc::Mode::free_fall;
    watch(false, {});
    CHECK(recorder.events<evr::THRUSTERS_NOT_JUDGED>() == 1);
    watch(false, {});
    CHECK(recorder.events<evr::THRUSTERS_NOT_JUDGED>() == 0);
}

TEST_CASE("engine controllers that are silent are told once, explained, and again when they are heard",
          "[edl][R27][R38]") {
    test::OutboxRecorder recorder;
    GncHealth health;
    gnc::Output gnc;
    const auto silent = [&](double for_s) {
        recorder.begin(ModuleId::edl, Sclk{1000.0});
        gnc.engines_silent_s = for_s;
        gnc.engines_heard = for_s == 0.0;
        health.watch(parameters, gnc, recorder.out);
        return recorder.events<evr::ENGINES_SILENT>();
    };
    CHECK(silent(parameters.engines_silent_told_s - seconds_per_tick) == 0);
    CHECK(silent(parameters.engines_silent_told_s) == 1);
    CHECK(asked_for(recorder, tone::engines_silent));
    const auto told = recorder.explanations();
    REQUIRE(told.size() == 1);
    CHECK(told[0].decision == Decision::device_lost);
    CHECK(told[0].subject == static_cast<std::uint16_t>(Device::descent_engines));
    REQUIRE(told[0].conditions.size() == 1);
    CHECK(told[0].conditions[0].quantity == Quantity::engines_silent_s);
    CHECK(silent(2.0) == 0);
    silent(0.0);
    CHECK(recorder.events<evr::ENGINES_HEARD_AGAIN>() == 1);
    silent(0.0);
    CHECK(recorder.events<evr::ENGINES_HEARD_AGAIN>() == 0);
}

}  // namespace flight_gnc_health_test
