// SPDX-License-Identifier: Apache-2.0
#include "flight/edl/decisions.hpp"

#include "flight/timeline/actions.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/outbox.hpp"

#include <array>
#include <bit>
#include <set>

namespace flight_decisions_test {

using namespace aeolis;
using namespace aeolis::flight;

TEST_CASE("what GNC starts and the timeline waits for has an anchor", "[edl][R17]") {
    CHECK(anchor_of(gnc::Trigger::parachute) == anchor::parachute);
    CHECK(anchor_of(gnc::Trigger::touchdown) == anchor::touchdown);
    CHECK_FALSE(anchor_of(gnc::Trigger::radar_lock).has_value());
    std::set<std::uint16_t> set_by_gnc, awaited;
    for (std::size_t i = 0; i < gnc::trigger_count; ++i)
        if (const auto anchor = anchor_of(static_cast<gnc::Trigger>(i))) set_by_gnc.insert(anchor->value);
    // The plan leaves them undefined; entry alone is ground's.
    for (std::uint16_t i = 1; i < anchor_count; ++i)
        if (AnchorId{i} != anchor::entry && !anchor_specs.at(i).offset_s) awaited.insert(i);
    CHECK(set_by_gnc == awaited);
}

TEST_CASE("each decision of GNC is an event of its own and an explanation with its conditions", "[edl][R38]") {
    // In the order of gnc::Trigger.
    constexpr std::array<EvrId, gnc::trigger_count> events{evr::GUIDANCE_START::id,
                                                           evr::HEADING_ALIGNMENT::id,
                                                           evr::SUFR_START::id,
                                                           evr::PARACHUTE_DEPLOY::id,
                                                           evr::HEATSHIELD_SEPARATION::id,
                                                           evr::RADAR_LOCK::id,
                                                           evr::ENGINE_PRIMING::id,
                                                           evr::BACKSHELL_SEPARATION::id,
                                                           evr::POWERED_APPROACH_START::id,
                                                           evr::CONSTANT_VELOCITY_START::id,
                                                           evr::CONSTANT_DECELERATION_START::id,
                                                           evr::SKY_CRANE_START::id,
                                                           evr::ROVER_SEPARATION::id,
                                                           evr::TOUCHDOWN::id};
    for (std::size_t i = 0; i < gnc::trigger_count; ++i) {
        test::OutboxRecorder recorder;
        gnc::JudgedTrigger fired{static_cast<gnc::Trigger>(i), {}};
        fired.conditions.push_back(gnc::at_most(Quantity::speed_mps, 404.6, 405.0));
        announce(fired.trigger, gnc::Output{}, recorder.out);
        const auto records = recorder.sent<Record>();
        REQUIRE(records.size() == 1);
        CHECK(records[0].apid == evr::PARACHUTE_DEPLOY::apid);
        CHECK(EvrId{static_cast<std::uint16_t>(read_bits(records[0].data, 0, 16))} == events.at(i));
        explain(fired, 0, recorder.out);
        const auto told = recorder.explanations();
        REQUIRE(told.size() == 1);
        CHECK(told[0].decision == decision_of(fired.trigger));
        CHECK(told[0].verdict == ExplanationVerdict::decided);
        REQUIRE(told[0].conditions.size() == 1);
        CHECK(told[0].conditions[0].value == 404.6);
    }
}

TEST_CASE("a bank reversal, a change of mode or phase and a judged radar solution are explained", "[edl][R38]") {
    test::OutboxRecorder recorder;
    gnc::Output output;
    output.bank_reversal.number = 2;
    output.bank_reversal.conditions.push_back(gnc::below(Quantity::crossrange_m, -4100.0, -4000.0));
    announce_bank_reversal(output, recorder.out);
    explain(gnc::ModeChange{gnc::Mode::straighten_up, GncModeEvent::straightened_up, gnc::Mode::wait_for_parachute,
                            gnc::at_least(Quantity::time_in_mode_s, 14.0, 14.0)},
            recorder.out);
    explain(PhaseChange{EdlPhase::pre_edl, EdlPhaseEvent::late_cruise_begins, EdlPhase::late_cruise},
            MaybeTime{recorder.out.now() + 17'999.0}, recorder.out);
    gnc::RadarDecision decision;
    decision.conditions.push_back(gnc::at_most(Quantity::radar_altitude_residual_m, 2000.0, 160.0));
    explain(decision, recorder.out);
    decision.believed = true;
    explain(decision, recorder.out);

    const auto told = recorder.explanations();
    REQUIRE(told.size() == 5);
    CHECK(told[0].decision == Decision::bank_reversal);
    CHECK(told[0].subject == 2);
    CHECK(told[0].conditions[0].value == -4100.0);
    CHECK(told[1].decision == Decision::gnc_mode);
    CHECK(told[1].subject == static_cast<unsigned>(gnc::Mode::wait_for_parachute));
    REQUIRE(told[1].conditions.size() == 3);
    CHECK(told[1].conditions[0].value == static_cast<double>(gnc::Mode::straighten_up));
    CHECK(told[1].conditions[1].value == static_cast<double>(GncModeEvent::straightened_up));
    CHECK(told[1].conditions[2].quantity == Quantity::time_in_mode_s);
    CHECK(told[2].decision == Decision::edl_phase);
    CHECK(told[2].subject == static_cast<unsigned>(EdlPhase::late_cruise));
    REQUIRE(told[2].conditions.size() == 3);
    CHECK(told[2].conditions[2].value == 17'999.0);
    CHECK(told[2].conditions[2].holds);
    CHECK(told[3].decision == Decision::radar_solution);
    CHECK(told[3].verdict == ExplanationVerdict::refused);
    CHECK(told[4].verdict == ExplanationVerdict::believed);
}

TEST_CASE("what GNC holds though it is near is told with its conditions", "[edl][R38]") {
    test::OutboxRecorder recorder;
    HeldExplanations held;
    gnc::Output output;
    explain_held(output, held, recorder.out);
    CHECK(recorder.packets<packet::Explanation>() == 0);
    gnc::Conditions conditions;
    conditions.push_back(gnc::at_most(gnc::Quantity::speed_mps, 407.1, 405.0));
    output.held.push_back({gnc::Trigger::parachute, conditions});
    explain_held(output, held, recorder.out);
    const auto records = recorder.sent<Record>();
    REQUIRE(records.size() == 1);
    BitReader in{records[0].data};
    CHECK(static_cast<Decision>(in.get(16)) == Decision::parachute_deploy);
    CHECK(static_cast<ExplanationVerdict>(in.get(8)) == ExplanationVerdict::held);
    CHECK(in.get(16) == 0);
    CHECK(in.get(8) == 1);
    CHECK(static_cast<Quantity>(in.get(16)) == Quantity::speed_mps);
    CHECK(in.get_double() == 407.1);
}

namespace {

void waits_for_a_reply(ActionContext& context) {
    context.await({ReplyKind::pyro, 3});
}

/// Row 0 fires at 1000 and waits 4 s for its reply; row 1 is due at once and has a minimum of 8 s.
const std::array<AnchorSpec, 2> held_anchors{{{"root", {}, {}}, {"start", AnchorId{0}, MaybeOffset{1000.0}}}};
const std::array<TimepointSpec, 2> held_rows{
    {{"asks",
      AnchorId{1},
      MaybeOffset{0.0},
      MaybeOffset{0.0},
      &waits_for_a_reply,
      4.0,
      {},
      {},
      {},
      true,
      false,
      {},
      nullptr},
     {"minimum", AnchorId{1}, MaybeOffset{0.0}, MaybeOffset{8.0}, nullptr, {}, {}, {}, {}, true, false, {}, nullptr}}};

}  // namespace

TEST_CASE("a timepoint that waits for a reply, or for its minimum, is told after half a second", "[edl][R38]") {
    Timeline timeline{held_rows, held_anchors};
    HeldExplanations held;
    test::OutboxRecorder recorder;
    gnc::Configuration configuration;
    timeline.begin(Sclk{990.0});
    // Quantity and value of the first condition that is told in that cycle.
    const auto told_at = [&](double sclk) -> std::optional<std::pair<Quantity, double>> {
        recorder.begin(ModuleId::edl, Sclk{sclk});
        timeline.begin_cycle();
        Firings firings;
        ActionContext context{recorder.out, configuration};
        timeline.pass(Sclk{sclk}, context, firings);
        explain_held(Parameters{}, timeline, held, recorder.out);
        for (const auto& record : recorder.sent<Record>())
            if (record.apid == packet::Explanation::apid)
                return std::pair{static_cast<Quantity>(read_bits(record.data, 48, 16)),
                                 std::bit_cast<double>(read_bits(record.data, 64, 64))};
        return std::nullopt;
    };
    CHECK_FALSE(told_at(999.0));
    CHECK_FALSE(told_at(1000.0));
    CHECK_FALSE(told_at(1000.484375));
    CHECK(told_at(1000.5) == std::pair{Quantity::reply_wait_s, 0.5});
    CHECK_FALSE(told_at(1001.0));
    timeline.reply({ReplyKind::pyro, 3});
    CHECK(told_at(1001.5) == std::pair{Quantity::time_since_previous_timepoint_s, 0.0});
    CHECK_FALSE(told_at(1002.0));
    CHECK(told_at(1005.5) == std::pair{Quantity::time_since_previous_timepoint_s, 4.0});
    CHECK_FALSE(told_at(1009.5));  // the minimum has come: it fires
    CHECK(timeline.finished());
}

TEST_CASE("the peak of deceleration is told once, after it has passed, with the state at the peak", "[edl]") {
    PeakDeceleration peak;
    gnc::Output output;
    output.mode = gnc::Mode::range_control;
    int told = 0;
    for (const double mps2 : {5.0, 40.0, 90.0, 120.0, 119.0, 100.0, 80.0, 110.0, 20.0}) {
        test::OutboxRecorder recorder;
        output.acceleration_B_mps2 = {0.0, 0.0, -mps2};
        peak.watch(Parameters{}, output, recorder.out);
        told += recorder.events<evr::PEAK_DECELERATION>();
        if (mps2 >= 119.0) CHECK(told == 0);
    }
    CHECK(told == 1);
}

}  // namespace flight_decisions_test
