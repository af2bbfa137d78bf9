// SPDX-License-Identifier: Apache-2.0
#include "flight/edl/gnc_health.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/outbox.hpp"

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

}  // namespace flight_gnc_health_test
