// SPDX-License-Identifier: Apache-2.0
#include "flight/edl/edl_main.hpp"

#include "common/space_packet.hpp"
#include "flight/edl/solution.hpp"
#include "flight/gnc/navigation/strapdown.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/flown_computers.hpp"
#include "tests/support/mission_copy.hpp"
#include "tests/support/outbox.hpp"

#include <algorithm>

namespace flight_edl_main_test {

using namespace aeolis;
using namespace aeolis::flight;

namespace {

constexpr double entry_s = 1'000'000.0;

/// A state so long before entry that comes to entry interface at `entry_s`.
command::EDL_SET_PARAMETERS parameters_before(double before_entry_s) {
    const auto at_epoch = gnc::propagate(
        {.p_MoB_M = {build_parameters.entry_radius_m, 0.0, 0.0}, .v_MB_M = {-1625.0, 5615.0, 0.0}}, -before_entry_s);
    command::EDL_SET_PARAMETERS p;
    p.solution_id = 7;
    p.epoch_sclk = entry_s - before_entry_s;
    p.position_x_m = at_epoch.p_MoB_M.x();
    p.position_y_m = at_epoch.p_MoB_M.y();
    p.velocity_x_mps = at_epoch.v_MB_M.x();
    p.velocity_y_mps = at_epoch.v_MB_M.y();
    p.entry_sclk = entry_s;
    p.target_longitude_deg = 10.8;  // 640 km ahead
    p.target_radius_m = 3391148.0;
    p.parachute_speed_mps = 405.0F;
    return p;
}

command::EDL_SET_PARAMETERS possible_parameters() {
    return parameters_before(1200.0);
}

struct Fixture {
    EdlMain edl{Load{}};
    test::OutboxRecorder recorder;

    template <typename M>
    void handle(const M& message, double at_s) {
        recorder.begin(ModuleId::edl, Sclk{at_s});
        edl.on(message, recorder.out);
    }
    void set_parameters(double at_s) { handle(ParametersUpdate{{}, possible_parameters()}, at_s); }
    std::optional<CommandRefusal> do_edl(double at_s) {
        handle(DoEdlCommand{}, at_s);
        REQUIRE(recorder.sent<CommandOutcome>().size() == 1);
        return recorder.sent<CommandOutcome>()[0].refused;
    }
};

}  // namespace

TEST_CASE("do edl before parameters is refused and not remembered", "[edl][R23]") {
    Fixture f;
    CHECK(f.do_edl(entry_s - 1200) == CommandRefusal::no_parameters);
    f.set_parameters(entry_s - 1190);
    f.handle(Tick{Sclk{entry_s - 1189}}, entry_s - 1189);
    CHECK_FALSE(f.edl.timeline().begun());
    CHECK_FALSE(f.do_edl(entry_s - 1188).has_value());
    CHECK(f.edl.timeline().begun());
}

TEST_CASE("what GNC takes the vehicle to be is told each second, also before do edl", "[edl][R30]") {
    Fixture f;
    f.set_parameters(entry_s - 1190);
    const auto told_in = [&](double from_s, int seconds) {
        int told = 0;
        for (int tick = 0; tick < 64 * seconds; ++tick) {
            const double now_s = from_s + tick * seconds_per_tick;
            f.handle(Tick{Sclk{now_s}}, now_s);
            told += f.recorder.packets<packet::GncConfiguration>();
        }
        return told;
    };
    CHECK(told_in(entry_s - 1189, 32) == 32);
    CHECK_FALSE(f.do_edl(entry_s - 1157).has_value());
    CHECK(told_in(entry_s - 1157, 32) == 32);
}

TEST_CASE("a turn of another time is reported and confirmed, and nothing is flown to it", "[edl][R4]") {
    Fixture f;
    f.set_parameters(entry_s - 1190);
    f.handle(Tick{Sclk{entry_s - 1189}}, entry_s - 1189);
    CHECK(f.recorder.events<evr::UNEXPECTED_MESSAGE>() == 0);
    for (const double other_s : {entry_s + 4.0e9, 0.0, entry_s - 1186}) {
        f.handle(Tick{Sclk{other_s}}, entry_s - 1188);
        CHECK(f.recorder.events<evr::UNEXPECTED_MESSAGE>() == 1);
        CHECK(f.recorder.sent<Confirm>().size() == 1);
        CHECK(f.recorder.sent<FireThrusters>().empty());
    }
}

TEST_CASE("parameters that cannot be flown are refused by who flies them, too", "[edl][R23]") {
    Fixture f;
    auto impossible = possible_parameters();
    impossible.epoch_sclk = 0.0;
    f.handle(ParametersUpdate{{}, impossible}, entry_s - 1190);
    REQUIRE(f.recorder.sent<CommandOutcome>().size() == 1);
    CHECK(f.recorder.sent<CommandOutcome>()[0].refused == CommandRefusal::bad_argument);
    CHECK(f.do_edl(entry_s - 1189) == CommandRefusal::no_parameters);
}

TEST_CASE("entry is where the position and velocity of the parameters have it, or the parameters are refused",
          "[edl][R23][R51]") {
    CHECK(std::abs(navigated_entry(possible_parameters()).value().at - Sclk{entry_s}) < 1.0e-3);
    for (const double off_s : {-300.0, -10.5, -9.5, 0.0, 9.5, 10.5, 300.0}) {
        INFO(off_s);
        Fixture f;
        auto said = possible_parameters();
        said.entry_sclk += off_s;
        f.handle(ParametersUpdate{{}, said}, entry_s - 1190);
        const bool refused = std::abs(off_s) > build_parameters.entry_moved_max_s;
        REQUIRE(f.recorder.sent<CommandOutcome>().size() == 1);
        CHECK(f.recorder.sent<CommandOutcome>()[0].refused ==
              (refused ? std::optional{CommandRefusal::unsafe_change} : std::nullopt));
        CHECK(f.recorder.events<evr::ANCHOR_CHANGE_REFUSED>() == int{refused});
        CHECK(f.edl.timeline().anchor_time(anchor::entry).defined() != refused);
    }
}

TEST_CASE(
    "entry is navigated from a week before as from twenty minutes, and not at all from a state that never comes there",
    "[edl][R51]") {
    auto week = possible_parameters();
    const auto before = gnc::propagate({.p_MoB_M = {week.position_x_m, week.position_y_m, week.position_z_m},
                                        .v_MB_M = {week.velocity_x_mps, week.velocity_y_mps, week.velocity_z_mps}},
                                       -600'000.0);
    week.epoch_sclk = 1.0e6;
    week.entry_sclk = week.epoch_sclk + 601'200.0;
    week.position_x_m = before.p_MoB_M.x();
    week.position_y_m = before.p_MoB_M.y();
    week.velocity_x_mps = before.v_MB_M.x();
    week.velocity_y_mps = before.v_MB_M.y();
    const auto navigated = navigated_entry(week);
    REQUIRE(navigated);
    CHECK(std::abs(navigated->at - Sclk{week.entry_sclk}) < 0.05);

    auto rising = possible_parameters();
    rising.velocity_x_mps = 5000.0;
    CHECK_FALSE(navigated_entry(rising));
    auto endless = possible_parameters();
    endless.entry_sclk = 4.0e9;
    CHECK_FALSE(navigated_entry(endless));
    for (const auto& never : {rising, endless}) {
        Fixture f;
        f.handle(ParametersUpdate{{}, never}, entry_s - 1190);
        CHECK(f.recorder.sent<CommandOutcome>()[0].refused == CommandRefusal::unsafe_change);
    }
}

TEST_CASE("do edl is possible in late cruise only, from a week before entry", "[edl][R23]") {
    Fixture f;
    f.handle(ParametersUpdate{{}, parameters_before(620'000.0)}, entry_s - 620'000.0);
    const double late_cruise_s = entry_s - build_parameters.late_cruise_before_entry_s;
    CHECK(f.do_edl(late_cruise_s - 1.0 / 64) == CommandRefusal::too_early);
    CHECK_FALSE(f.do_edl(late_cruise_s).has_value());
}

TEST_CASE("do edl is refused when timepoints are overdue, for they would fire in a burst", "[edl][R23]") {
    Fixture f;
    f.set_parameters(entry_s - 1200);
    const double first_due_s = entry_s + *timeline_specs[0].desired_offset_s;
    CHECK(f.do_edl(first_due_s) == CommandRefusal::too_late);
    CHECK_FALSE(f.edl.timeline().begun());
    const double last_s = f.edl.timeline().first_desired().get()->seconds - build_parameters.do_edl_margin_s;
    CHECK(f.do_edl(last_s) == CommandRefusal::too_late);
    CHECK_FALSE(f.do_edl(last_s - 1.0 / 64).has_value());
}

TEST_CASE("a second do edl is refused", "[edl][R23]") {
    Fixture f;
    f.set_parameters(entry_s - 1200);
    CHECK_FALSE(f.do_edl(entry_s - 1100).has_value());
    CHECK(f.do_edl(entry_s - 1099) == CommandRefusal::already_running);
}

TEST_CASE("parameters may come again with each navigation update, and are read back", "[edl][R23][R25]") {
    Fixture f;
    f.set_parameters(entry_s - 1200);
    CHECK(f.recorder.packets<packet::ParametersHeld>() == 1);
    auto renewed = possible_parameters();
    renewed.entry_sclk += 5.0;
    f.handle(ParametersUpdate{{}, renewed}, entry_s - 1100);
    CHECK(f.recorder.packets<packet::ParametersHeld>() == 1);
    CHECK(f.recorder.events<evr::EDL_PARAMETERS_ACCEPTED>() == 1);
    CHECK(f.edl.timeline().anchor_time(anchor::entry).get() == Sclk{entry_s + 5.0});
}

TEST_CASE("do edl explains why it was refused", "[edl][R38]") {
    Fixture f;
    const auto conditions = [&] { return f.recorder.sent<CommandOutcome>()[0].conditions; };
    (void)f.do_edl(entry_s - 1200);
    REQUIRE_FALSE(conditions().empty());
    CHECK(conditions()[0].quantity == Quantity::parameters_received);
    CHECK_FALSE(conditions()[0].holds);
    f.handle(ParametersUpdate{{}, parameters_before(620'000.0)}, entry_s - 620'000.0);
    CHECK(f.do_edl(entry_s - 610'000.0) == CommandRefusal::too_early);
    CHECK(conditions()[0].quantity == Quantity::time_to_uplinked_entry_s);
    CHECK(conditions()[0].value == 610'000.0);
    CHECK(conditions()[0].bound == build_parameters.late_cruise_before_entry_s);
    CHECK_FALSE(conditions()[0].holds);
    CHECK(f.do_edl(entry_s - 800) == CommandRefusal::too_late);
    CHECK(conditions()[0].quantity == Quantity::time_to_first_timepoint_s);
    CHECK_FALSE(conditions()[0].holds);
    CHECK_FALSE(f.do_edl(entry_s - 1000).has_value());
    CHECK(all_hold(conditions()));
    CHECK(f.do_edl(entry_s - 999) == CommandRefusal::already_running);
    CHECK(conditions()[0].quantity == Quantity::edl_enabled);
}

TEST_CASE("parameters explain why they were taken or refused", "[edl][R23][R38]") {
    Fixture f;
    const auto conditions = [&] { return f.recorder.sent<CommandOutcome>()[0].conditions; };
    f.set_parameters(entry_s - 1190);
    CHECK(all_hold(conditions()));
    REQUIRE(conditions().size() == 4);
    CHECK(conditions()[0].quantity == Quantity::gnc_enabled);
    CHECK(conditions()[1].quantity == Quantity::entry_apart_from_navigation_s);
    CHECK(conditions()[1].value < 0.001);
    CHECK(conditions()[2].quantity == Quantity::time_to_uplinked_entry_s);
    CHECK(conditions()[2].value == 1190.0);
    CHECK(conditions()[3].quantity == Quantity::solution_age_s);
    CHECK(conditions()[3].value == 10.0);
    auto moved = possible_parameters();
    moved.entry_sclk += 20.0;
    f.handle(ParametersUpdate{{}, moved}, entry_s - 1190);
    CHECK(conditions()[0].quantity == Quantity::entry_apart_from_navigation_s);
    CHECK(conditions()[0].value == Approx(20.0).margin(1.0));
    CHECK(conditions()[0].bound == build_parameters.entry_moved_max_s);
    CHECK_FALSE(conditions()[0].holds);
    f.handle(ParametersUpdate{{}, possible_parameters()}, entry_s + 1.0);
    CHECK(conditions()[0].quantity == Quantity::time_to_uplinked_entry_s);
    CHECK(conditions()[0].value == -1.0);
}

TEST_CASE("parameters are taken until GNC is enabled, and then refused with the reason", "[edl][R25][R38]") {
    Fixture f;
    const auto outcome = [&] { return f.recorder.sent<CommandOutcome>()[0]; };
    f.set_parameters(entry_s - 1190);
    REQUIRE_FALSE(f.do_edl(entry_s - 1180).has_value());
    double at_s = entry_s - 1170;
    for (; !f.edl.configuration().enabled && at_s < entry_s; at_s += 1.0 / 64) f.handle(Tick{Sclk{at_s}}, at_s);
    REQUIRE(f.edl.configuration().enabled);
    f.set_parameters(at_s);
    CHECK(outcome().refused == CommandRefusal::wrong_phase);
    REQUIRE(outcome().conditions.size() == 1);
    CHECK(outcome().conditions[0].quantity == Quantity::gnc_enabled);
    CHECK_FALSE(outcome().conditions[0].holds);
}

TEST_CASE("two decisions of one cycle have each its own conditions", "[edl][R17][R38]") {
    Fixture f;
    f.set_parameters(entry_s - 1190);
    gnc::Output told;
    gnc::JudgedTrigger lock{gnc::Trigger::radar_lock, {}}, priming{gnc::Trigger::engine_priming, {}};
    lock.conditions.push_back(gnc::at_most(Quantity::radar_altitude_m, 7900.0, 9000.0));
    priming.conditions.push_back(gnc::at_most(Quantity::time_to_backshell_s, 15.25, 15.5));
    told.triggers.push_back(lock);
    told.triggers.push_back(priming);
    f.edl.replace_gnc(told);
    f.handle(Tick{Sclk{entry_s - 1189}}, entry_s - 1189);
    std::vector<test::Explained> decisions;
    for (const auto& each : f.recorder.explanations())
        if (each.verdict == ExplanationVerdict::decided) decisions.push_back(each);
    REQUIRE(decisions.size() == 2);
    CHECK(decisions[0].decision == Decision::radar_lock);
    REQUIRE(decisions[0].conditions.size() == 1);
    CHECK(decisions[0].conditions[0].value == 7900.0);
    CHECK(decisions[1].decision == Decision::engine_priming);
    REQUIRE(decisions[1].conditions.size() == 1);
    CHECK(decisions[1].conditions[0].value == 15.25);
}

TEST_CASE("without do edl the timeline fires nothing up to and past entry", "[edl][R23]") {
    Fixture f;
    f.set_parameters(entry_s - 1200);
    for (int tick = 0; tick < 64 * 1300; tick += 16) {
        const double at_s = entry_s - 1190 + tick / 64.0;
        f.handle(Tick{Sclk{at_s}}, at_s);
        REQUIRE(f.recorder.sent<FirePyro>().empty());
        REQUIRE(f.recorder.packets<packet::TimepointFired>() == 0);
    }
}

TEST_CASE("in pre-EDL fault protection holds the timeline, and it goes on when released", "[edl][R24]") {
    Fixture f;
    const double pre_edl_s = entry_s - 15'000;
    f.set_parameters(pre_edl_s);
    CHECK_FALSE(f.do_edl(pre_edl_s).has_value());
    f.handle(InhibitEdl{true}, pre_edl_s + 1);
    CHECK(f.recorder.events<evr::FAULT_PROTECTION_INHIBITS_EDL>() == 1);
    for (double at_s = pre_edl_s + 1; at_s < pre_edl_s + 20; at_s += 1.0 / 64) {
        f.handle(Tick{Sclk{at_s}}, at_s);
        REQUIRE(f.edl.timeline().state() == TimepointState::pending);
        REQUIRE(f.recorder.sent<SetSwitch>().empty());
    }
    f.handle(InhibitEdl{false}, pre_edl_s + 20);
    CHECK(f.recorder.events<evr::FAULT_PROTECTION_RELEASES_EDL>() == 1);
    f.handle(Tick{Sclk{pre_edl_s + 20}}, pre_edl_s + 20);
    CHECK(f.recorder.sent<SetSwitch>().size() == 1);  // the first timepoint, two seconds after "do edl"
}

TEST_CASE("do edl is refused while fault protection inhibits EDL", "[edl][R23][R24]") {
    Fixture f;
    f.set_parameters(entry_s - 17'000);
    f.handle(InhibitEdl{true}, entry_s - 16'900);
    CHECK(f.do_edl(entry_s - 16'800) == CommandRefusal::inhibited);
    f.handle(InhibitEdl{false}, entry_s - 16'700);
    CHECK_FALSE(f.do_edl(entry_s - 16'600).has_value());
}

TEST_CASE("after pre-EDL fault protection cannot inhibit EDL, and an inhibition ends with it", "[edl][R24]") {
    const double pre_edl_ends_s = entry_s + *anchor_specs[anchor::pre_edl_end.value].offset_s;
    Fixture f;
    f.set_parameters(pre_edl_ends_s - 100);
    f.handle(InhibitEdl{true}, pre_edl_ends_s - 1.0 / 64);
    CHECK(f.recorder.events<evr::FAULT_PROTECTION_INHIBITS_EDL>() == 1);
    f.handle(Tick{Sclk{pre_edl_ends_s}}, pre_edl_ends_s);
    CHECK(f.recorder.events<evr::PRE_EDL_ENDED>() == 1);
    CHECK(f.recorder.events<evr::FAULT_PROTECTION_RELEASES_EDL>() == 1);
    f.handle(InhibitEdl{true}, pre_edl_ends_s + 1);
    CHECK(f.recorder.events<evr::FAULT_PROTECTION_TOO_LATE>() == 1);
    CHECK(f.recorder.events<evr::FAULT_PROTECTION_INHIBITS_EDL>() == 0);
    f.handle(InhibitEdl{true}, pre_edl_ends_s + 2);
    CHECK(f.recorder.events<evr::FAULT_PROTECTION_TOO_LATE>() == 0);
    CHECK_FALSE(f.do_edl(pre_edl_ends_s + 3).has_value());
}

TEST_CASE("an offset that is no multiple of 1/64 s, or of a row that is not there, is refused", "[edl][R16][R21]") {
    Fixture f;
    f.handle(SetTimepointOffsetCommand{{}, {.timepoint = 0, .desired_offset_s = 0.3, .minimum_offset_s = 0.0}}, 5.0);
    CHECK(f.recorder.sent<CommandOutcome>()[0].refused == CommandRefusal::bad_argument);
    f.handle(SetTimepointOffsetCommand{{}, {.timepoint = 9999, .desired_offset_s = 1.0, .minimum_offset_s = 0.0}}, 5.0);
    CHECK(f.recorder.sent<CommandOutcome>()[0].refused == CommandRefusal::bad_argument);
    f.handle(SetTimepointOffsetCommand{{}, {.timepoint = 0, .desired_offset_s = -800.0, .minimum_offset_s = 0.0}}, 5.0);
    CHECK_FALSE(f.recorder.sent<CommandOutcome>()[0].refused.has_value());
    CHECK(f.recorder.events<evr::TIMEPOINT_OFFSET_CHANGED>() == 1);
}

TEST_CASE("an unsafe change is refused on board when it comes, with an event that says why, and changes nothing",
          "[edl][timeline][R51]") {
    const auto begun = [] {
        Fixture f;
        f.set_parameters(entry_s - 1190);
        CHECK_FALSE(f.do_edl(entry_s - 1170).has_value());
        for (double at_s = entry_s - 1170; at_s < entry_s - 1000; at_s += 1.0 / 64) f.handle(Tick{Sclk{at_s}}, at_s);
        return f;
    };
    const auto outcome = [](Fixture& f, const auto& command) {
        f.handle(command, entry_s - 1000);
        REQUIRE(f.recorder.sent<CommandOutcome>().size() == 1);
        return f.recorder.sent<CommandOutcome>()[0].refused;
    };
    const auto anchor_at = [](AnchorId id, double offset_s) {
        return SetAnchorOffsetCommand{{}, {.anchor = id.value, .offset_s = offset_s}};
    };
    const auto timepoint_at = [](TimepointId id, double desired_s) {
        return SetTimepointOffsetCommand{
            {}, {.timepoint = id.value, .desired_offset_s = desired_s, .minimum_offset_s = 0.0}};
    };
    for (const double off_s : {-900.0, -11.0, 11.0, 300.0}) {  // among them that of cases/flight/anchor_entry
        Fixture f = begun();
        CHECK(outcome(f, anchor_at(anchor::entry, entry_s + off_s)) == CommandRefusal::unsafe_change);
        CHECK(f.recorder.events<evr::ANCHOR_CHANGE_REFUSED>() == 1);
        CHECK(f.recorder.events<evr::ANCHOR_OFFSET_CHANGED>() == 0);
        CHECK(f.edl.timeline().anchor_time(anchor::entry).get() == Sclk{entry_s});
    }
    for (const double off_s : {-5.0, 5.0}) {
        Fixture f = begun();
        CHECK_FALSE(outcome(f, anchor_at(anchor::entry, entry_s + off_s)).has_value());
        CHECK(f.recorder.events<evr::ANCHOR_OFFSET_CHANGED>() == 1);
    }
    for (const AnchorId id : {anchor::parachute, anchor::touchdown}) {
        Fixture f = begun();
        CHECK(outcome(f, anchor_at(id, entry_s + 425)) == CommandRefusal::unsafe_change);
        CHECK(f.recorder.events<evr::ANCHOR_CHANGE_REFUSED>() == 1);
    }
    {
        Fixture f = begun();
        CHECK(outcome(f, timepoint_at(timepoint::coolant_vent, -1001.0)) == CommandRefusal::unsafe_change);
        CHECK(f.recorder.events<evr::TIMELINE_CHANGE_REFUSED>() == 1);
        CHECK(f.recorder.events<evr::TIMEPOINT_OFFSET_CHANGED>() == 0);
        const auto why = f.recorder.sent<CommandOutcome>()[0].conditions;
        REQUIRE(why.size() == 2);
        CHECK_FALSE(why[0].holds);
        CHECK(why[1].quantity == Quantity::unsafe_timepoint);
    }
    {
        Fixture f = begun();
        CHECK(outcome(f, timepoint_at(timepoint::cruise_stage_separation, -300.0)) == CommandRefusal::unsafe_change);
        CHECK(f.recorder.events<evr::TIMELINE_CHANGE_REFUSED>() == 1);
    }
    {
        Fixture f = begun();
        CHECK_FALSE(outcome(f, timepoint_at(timepoint::coolant_vent, -827.0)).has_value());
        CHECK(f.recorder.events<evr::TIMEPOINT_OFFSET_CHANGED>() == 1);
    }
}

TEST_CASE("entry is not set by its anchor while nobody has navigated it", "[edl][timeline][R51]") {
    Fixture f;
    f.handle(SetAnchorOffsetCommand{{}, {.anchor = anchor::entry.value, .offset_s = entry_s}}, entry_s - 1200);
    CHECK(f.recorder.sent<CommandOutcome>()[0].refused == CommandRefusal::unsafe_change);
    f.handle(SetAnchorOffsetCommand{{}, {.anchor = 0, .offset_s = 5.0}}, entry_s - 1200);
    CHECK(f.recorder.sent<CommandOutcome>()[0].refused == CommandRefusal::bad_argument);
    f.handle(SetAnchorOffsetCommand{{}, {.anchor = 9999, .offset_s = 5.0}}, entry_s - 1200);
    CHECK(f.recorder.sent<CommandOutcome>()[0].refused == CommandRefusal::bad_argument);
}

TEST_CASE("prime that was reset after touchdown was declared is not ordered on",
          "[edl][second_chance][R32][R34][R38]") {
    test::FlownComputers flown;
    for (const bool touchdown : {false, true}) {
        flown.fly_until([&](test::FlownComputers& at) {
            const auto& done = at.prime().gnc_configuration();
            return touchdown ? done.touchdown_declared : done.parachute_out;
        });
        const Sclk told = flown.world().sclk();
        Load load;
        load.resets = 1;
        load.told_until = told;
        EdlMain restarted{load};
        test::OutboxRecorder recorder;
        const auto handle = [&](const auto& message) {
            recorder.begin(ModuleId::edl, told + restart_s);
            restarted.on(message, recorder.out);
        };
        StateFrame::of(StateHeader{.time = told, .begun = true, .separated = true}, flown.prime().state().edl)
            .in_parts(handle);
        handle(Resume{ResumeReason::restart});
        REQUIRE(recorder.events<evr::PRIME_STANDS_BY>() == 1);
        const auto why = recorder.explanations();
        REQUIRE(why.size() == 1);
        CHECK(why[0].decision == Decision::stand_by);
        REQUIRE(why[0].conditions.size() == 2);
        CHECK(why[0].conditions[0].quantity == Quantity::edl_enabled);
        CHECK(why[0].conditions[1].quantity == Quantity::separation_triggered);
        REQUIRE(restarted.stands_by());
        handle(ResumePrimeCommand{});
        CHECK(restarted.stands_by() == touchdown);
        CHECK(recorder.events<evr::PRIME_RESUMES>() == (touchdown ? 0 : 1));
        REQUIRE(recorder.sent<CommandOutcome>().size() == 1);
        CHECK(recorder.sent<CommandOutcome>()[0].refused.has_value() == touchdown);
        handle(ResumePrimeCommand{});
        CHECK(recorder.sent<CommandOutcome>()[0].refused == CommandRefusal::wrong_phase);  // it flies, or may not
    }
}

TEST_CASE("a firing is recorded with its triggering, its time and how it ended", "[edl][timeline][R14]") {
    constexpr double begun_s = entry_s - 1170;
    Fixture f;
    f.set_parameters(begun_s - 20);
    CHECK_FALSE(f.do_edl(begun_s).has_value());
    std::vector<Record> fired;
    for (double at_s = begun_s; at_s < begun_s + 7; at_s += 1.0 / 64) {
        f.handle(Tick{Sclk{at_s}}, at_s);
        for (const auto& record : f.recorder.sent<Record>())
            if (record.apid == packet::TimepointFired::apid) fired.push_back(record);
    }
    REQUIRE(fired.size() == 1);  // due 2 s after "do edl"; nothing answers within its 4 s
    BitReader in{fired[0].data};
    CHECK(in.get(16) == timepoint::descent_imu_power.value);
    CHECK(in.get_double() == begun_s + 2);
    CHECK(in.get_double() == begun_s + 6);
    CHECK(static_cast<TimepointVerdict>(in.get(8)) == TimepointVerdict::unverified);
}

TEST_CASE("every cycle ends with one confirmation to sync", "[edl][R18][R22]") {
    Fixture f;
    f.handle(Tick{Sclk{5.0}}, 5.0);
    CHECK(f.recorder.sent<Confirm>().size() == 1);
}

TEST_CASE("the version of the timeline on board is in telemetry every second", "[edl][timeline][R20]") {
    const auto loaded = dictionary::load(tests::shipped_mission);
    REQUIRE(loaded.dictionary);
    const auto& fields = loaded.dictionary->packet("TimelineStatus")->fields;
    const auto version = std::ranges::find(fields, "timeline_version", &dictionary::Field::name);
    REQUIRE(version != fields.end());
    const unsigned position_bits = version->position_bits - tm_data_offset_octets * 8;
    Fixture f;
    for (const double second : {1000.0, 1001.0}) {
        f.handle(Tick{Sclk{second}}, second);
        std::vector<std::uint64_t> versions;
        for (const auto& record : f.recorder.sent<Record>())
            if (record.apid == packet::TimelineStatus::apid)
                versions.push_back(read_bits(record.data, position_bits, version->type.bits));
        CHECK(versions == std::vector<std::uint64_t>{loaded.dictionary->timeline_version});
    }
}

}  // namespace flight_edl_main_test
