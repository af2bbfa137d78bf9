// SPDX-License-Identifier: Apache-2.0
#include "simulation/placed_state.hpp"

#include "simulation/landing.hpp"
#include "simulation/limits.hpp"
#include "simulation/vectors.hpp"
#include "tests/simulation/gale.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/telecommands.hpp"

#include <algorithm>
#include <array>
#include <optional>

namespace simulation_placed_landing_test {

using namespace aeolis;
using namespace aeolis::simulation;

namespace {

constexpr double start_before_entry_s = 1200.0;

Landing commanded() {
    Landing landing{tests::gale_scenario(start_before_entry_s), 1};
    landing.uplink(test::set_parameters(landing.solution()));
    for (int i = 0; i < 640; ++i) landing.step();
    landing.uplink(test::do_edl());
    return landing;
}

void fly_to(Landing& landing, double e_s) {
    while (landing.truth().e_s < e_s && !landing.flown()) landing.step();
}

/// Flown once for all tests of this file, to the guided entry.
const Landing& in_entry() {
    static const Landing landing = [] {
        Landing flown = commanded();
        fly_to(flown, 40.0);
        return flown;
    }();
    return landing;
}

struct End {
    Outcome outcome{};
    double touchdown_s = 0.0, propellant_kg = 0.0;
    TouchdownReport touchdown;
    Verdict verdict{};

    friend bool operator==(const End& a, const End& b) {
        return a.outcome == b.outcome && a.touchdown_s == b.touchdown_s && a.propellant_kg == b.propellant_kg &&
               a.touchdown.miss_m == b.touchdown.miss_m && a.touchdown.vertical_mps == b.touchdown.vertical_mps &&
               a.touchdown.latitude_deg == b.touchdown.latitude_deg;
    }
};

End end_of(Landing landing) {
    End end;
    while (landing.outcome() == Outcome::running) {
        landing.step();
        if (landing.touchdown() && end.touchdown_s == 0.0) end.touchdown_s = landing.truth().e_s;
    }
    end.outcome = landing.outcome();
    end.propellant_kg = landing.inspect().propellant_kg;
    end.touchdown = landing.touchdown().value_or(TouchdownReport{});
    end.verdict = judge(Limits{}, figures_of(landing)).verdict;
    return end;
}

double apart_m(const End& a, const End& b) {
    constexpr double degree_m = 3391148.0 * degree_rad;
    return degree_m * std::hypot(a.touchdown.latitude_deg - b.touchdown.latitude_deg,
                                 a.touchdown.longitude_deg - b.touchdown.longitude_deg);
}

}  // namespace

TEST_CASE("a copy of a landing in mid-flight ends like the original, bit for bit", "[simulation][shadow]") {
    const End original = end_of(in_entry());
    CHECK(original.outcome == Outcome::touchdown);
    CHECK(end_of(Landing{in_entry()}) == original);
}

TEST_CASE("a landing that nobody hears flies the same, bit for bit, and records nothing", "[simulation][shadow]") {
    Landing unheard{in_entry()};
    unheard.fly_unheard();
    CHECK(unheard.recording().empty());
    for (int cycle = 0; cycle < 64; ++cycle) {
        unheard.step();
        CHECK(unheard.recording().size() == unheard.report().recorded.size());
        CHECK(unheard.report().earth.octets.empty());
    }
    CHECK(end_of(unheard) == end_of(in_entry()));
}

TEST_CASE("a backup that ground has enabled stays on in a landing that nobody hears, and takes over",
          "[simulation][shadow]") {
    Landing landing = commanded();
    landing.uplink(test::enable_second_chance());
    fly_to(landing, 40.0);
    landing.fly_unheard();
    landing.reset_prime();
    CHECK(end_of(landing).outcome == Outcome::touchdown);
    Landing not_enabled{in_entry()};
    not_enabled.fly_unheard();
    not_enabled.reset_prime();
    CHECK(end_of(not_enabled).outcome != Outcome::touchdown);
}

TEST_CASE("drawn anew, a copy lands elsewhere, the same draw at the same place, and what was flown is not touched",
          "[simulation][shadow]") {
    const End original = end_of(in_entry());
    std::array<End, 3> ends;
    for (std::size_t i = 0; i < ends.size(); ++i) {
        Landing copy{in_entry()};
        copy.redraw(7, i == 2 ? 1 : i + 1);
        CHECK(copy.truth().p_MoB_M_m == in_entry().truth().p_MoB_M_m);
        ends[i] = end_of(copy);
        CHECK(ends[i].outcome == Outcome::touchdown);
        CHECK(apart_m(ends[i], original) > 1.0);
    }
    CHECK(apart_m(ends[0], ends[1]) > 1.0);
    CHECK(ends[2] == ends[0]);
}

TEST_CASE("of a state that is known within deviations the true one departs by a draw of them", "[simulation][shadow]") {
    const StateKnowledge knowledge{.position_m = 300.0, .velocity_mps = 0.6, .attitude_rad = 1e-3};
    double position_m2 = 0.0, velocity_mps2 = 0.0;
    constexpr int cases = 200;
    for (std::uint64_t number = 1; number <= cases; ++number) {
        Landing copy{in_entry()};
        copy.redraw(1, number, knowledge);
        const auto apart = [](const std::array<double, 3>& a, const std::array<double, 3>& b) {
            return (vector3(a) - vector3(b)).squaredNorm();
        };
        position_m2 += apart(copy.truth().p_MoB_M_m, in_entry().truth().p_MoB_M_m);
        velocity_mps2 += apart(copy.truth().v_MB_M_mps, in_entry().truth().v_MB_M_mps);
    }
    CHECK(std::sqrt(position_m2 / cases) == Approx(300.0).epsilon(0.15));
    CHECK(std::sqrt(velocity_mps2 / cases) == Approx(0.6).epsilon(0.15));
}

TEST_CASE("placed at its own state, from numbers alone too, a landing flies on the same within the stated bounds",
          "[simulation][shadow]") {
    struct Bounds {
        double apart_m, time_s, propellant_kg;
    };
    struct Moment {
        double e_s;
        Bounds copy, from_numbers;
    };
    // From numbers the IMU's noise is another; before the bank reversals, at E+60 s, small differences grow.
    constexpr std::array moments{
        Moment{60.0, {10.0, 0.05, 1.0}, {1000.0, 1.0, 1.0}}, Moment{150.0, {10.0, 0.05, 1.0}, {50.0, 0.25, 1.0}},
        Moment{270.0, {1.0, 0.05, 0.1}, {5.0, 0.25, 1.0}},   Moment{330.0, {1.0, 0.05, 0.1}, {2.0, 0.25, 1.0}},
        Moment{385.0, {1.0, 0.05, 0.1}, {2.0, 0.25, 1.0}},   Moment{400.0, {1.0, 0.05, 0.2}, {2.0, 0.25, 1.0}},
        Moment{415.0, {1.0, 0.05, 0.2}, {2.0, 0.5, 2.0}}};
    Landing flown{in_entry()};
    const End original = end_of(flown);
    for (const Moment& at : moments) {
        fly_to(flown, at.e_s);
        const PlacedState state = flown.placed_state();
        Landing copy{flown}, fresh{tests::gale_scenario(start_before_entry_s), 1};
        for (Landing* const placed : {&copy, &fresh}) {
            const Bounds& bounds = placed == &copy ? at.copy : at.from_numbers;
            INFO((placed == &copy ? "a copy" : "from numbers") << " at E+" << at.e_s << " s");
            REQUIRE(placed->place(state));
            CHECK(placed->truth().p_MoB_M_m == flown.truth().p_MoB_M_m);
            CHECK(placed->truth().v_MB_M_mps == flown.truth().v_MB_M_mps);
            CHECK(placed->inspect().mass_kg == Approx(flown.inspect().mass_kg).epsilon(1e-12));
            const End end = end_of(*placed);
            CHECK(end.verdict == original.verdict);
            CHECK(apart_m(end, original) < bounds.apart_m);
            CHECK(std::abs(end.touchdown_s - original.touchdown_s) < bounds.time_s);
            CHECK(std::abs(end.propellant_kg - original.propellant_kg) < bounds.propellant_kg);
        }
    }
}

TEST_CASE("what cannot be placed is refused by name and changes nothing", "[simulation][shadow]") {
    const PlacedState good = in_entry().placed_state();
    const auto refusal = [](const PlacedState& state) {
        Landing landing{in_entry()};
        const auto placed = landing.place(state);
        CHECK(landing.truth().p_MoB_M_m == in_entry().truth().p_MoB_M_m);
        landing.step();  // as its original does
        Landing original{in_entry()};
        original.step();
        CHECK(landing.truth().p_MoB_M_m == original.truth().p_MoB_M_m);
        return placed ? std::string{} : placed.error().message;
    };
    PlacedState bad = good;
    bad.sclk = good.sclk + 0.001;
    CHECK(refusal(bad) == "the time is not a whole tick of 1/64 s");
    bad = good;
    bad.computer.pop_back();
    CHECK(refusal(bad) == "the computer's state is not a state frame of this build");
    bad = good;
    bad.fired[static_cast<std::size_t>(flight::PyroId::cruise_stage_separation)] = false;
    CHECK(refusal(bad) == "the cruise stage is still attached");
    bad = good;
    bad.fired[static_cast<std::size_t>(flight::PyroId::bridle_cutter)] = true;
    CHECK(refusal(bad) == "the bridle is cut: the rover stands");
    bad = good;
    bad.sclk = good.sclk - 1300.0;
    CHECK(refusal(bad) == "the time is before the landing's start");
}

}  // namespace simulation_placed_landing_test
