#include "flight/edl/decisions.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/outbox.hpp"

using namespace aeolis;
using namespace aeolis::flight;

TEST_CASE("what GNC starts and the timeline waits for has an anchor", "[edl][R17]") {
    CHECK(anchor_of(gnc::Trigger::parachute) == anchor::parachute);
    CHECK(anchor_of(gnc::Trigger::touchdown) == anchor::touchdown);
    CHECK_FALSE(anchor_of(gnc::Trigger::radar_lock).has_value());
}

TEST_CASE("each decision of GNC is an event and an explanation with its conditions", "[edl][R38]") {
    for (std::size_t i = 0; i < gnc::trigger_count; ++i) {
        test::OutboxRecorder recorder;
        gnc::Output output;
        output.conditions.push_back({1, 404.6, 405.0, gnc::Condition::Comparison::le, true});
        announce(static_cast<gnc::Trigger>(i), output, recorder.out);
        CHECK(recorder.packets<evr::PARACHUTE_DEPLOY>() == 1);
        explain(static_cast<gnc::Trigger>(i), output, recorder.out);
        CHECK(recorder.packets<packet::Explanation>() == 1);
    }
}

TEST_CASE("the peak of deceleration is told once, after it has passed, with the state at the peak", "[edl]") {
    PeakDeceleration peak;
    gnc::Output output;
    output.mode = gnc::Mode::range_control;
    int told = 0;
    for (const double mps2 : {5.0, 40.0, 90.0, 120.0, 119.0, 100.0, 80.0, 110.0, 20.0}) {
        test::OutboxRecorder recorder;
        output.acceleration_B_mps2 = {0.0, 0.0, -mps2};
        peak.watch(output, recorder.out);
        told += recorder.events<evr::PEAK_DECELERATION>();
        if (mps2 >= 119.0) CHECK(told == 0);
    }
    CHECK(told == 1);
}
