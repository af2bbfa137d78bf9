// SPDX-License-Identifier: Apache-2.0
#include "simulation/world.hpp"

#include "simulation/mars/mars.hpp"
#include "tests/simulation/gale.hpp"
#include "tests/simulation/truth_pilot.hpp"
#include "tests/support/catch.hpp"

namespace simulation_world_test {

using namespace aeolis;
using namespace aeolis::simulation;
using tests::TruthPilot;

TEST_CASE("a world flown by its truth goes through every moment of a landing", "[simulation][world]") {
    TruthPilot pilot{tests::undisturbed_scenario()};
    pilot.run();
    INFO(pilot.world.outcome_reason());
    REQUIRE(pilot.world.outcome() == Outcome::touchdown);
    for (const char* name :
         {"cruise_stage_separation", "entry_interface", "bank_reversal_1", "bank_reversal_2", "bank_reversal_3",
          "peak_deceleration", "sufr_start", "parachute_deploy", "heatshield_separation", "engine_priming",
          "backshell_separation", "sky_crane_start", "rover_separation", "bridle_cut", "flyaway_end"})
        CHECK(pilot.events.count(name) == 1);
    CHECK(pilot.events.count("bank_reversal_4") == 0);

    // Bands around the published flight, which had another bank history. [od137]
    CHECK(std::abs(pilot.events["entry_interface"].e_s) <= 1.0 / 64);
    CHECK(pilot.events["entry_interface"].speed_mps == Approx(5845.2).margin(0.1));
    CHECK(pilot.world.peak_deceleration_mps2() == Approx(121.1).epsilon(0.08));
    CHECK(pilot.events["peak_deceleration"].e_s == Approx(79.35).margin(3.0));
    const auto touchdown = pilot.world.touchdown();
    REQUIRE(touchdown);
    CHECK(touchdown->vertical_mps == Approx(0.75).margin(0.1));
    CHECK(touchdown->horizontal_mps < 0.5);
    CHECK(pilot.world.inspect().propellant_kg > 0.0);
}

TEST_CASE("the same seed gives the same bits, another seed or case does not", "[simulation][world][invariant1]") {
    const auto digest = [](std::uint64_t seed, std::uint64_t case_number) {
        TruthPilot pilot{tests::gale_scenario(620.0), seed, case_number};
        pilot.run_until(30.0);
        return pilot.digest;
    };
    const std::uint64_t first = digest(1, 0);
    CHECK(digest(1, 0) == first);
    CHECK(digest(2, 0) != first);
    CHECK(digest(1, 1) != first);
}

TEST_CASE("a copied world flown alike ends bit-identical", "[simulation][world][invariant2]") {
    TruthPilot original{tests::gale_scenario(620.0)};
    original.run_until(60.0);
    TruthPilot copy{original};
    original.run();
    copy.run();
    CHECK(copy.digest == original.digest);
    CHECK(copy.world.outcome() == original.world.outcome());
    CHECK(copy.world.truth().p_MoB_M_m == original.world.truth().p_MoB_M_m);
}

TEST_CASE("nobody who commands nothing lands", "[simulation][world]") {
    World world{tests::gale_scenario(60.0), 1};
    while (world.outcome() == Outcome::running) {
        world.sense();
        world.advance(flight::DeviceOutputs{});
    }
    CHECK(world.outcome() == Outcome::not_commanded);
    CHECK(world.outcome_reason() == "entered with the cruise stage attached: its separation was not commanded");
    CHECK(world.truth().e_s > 0.0);
}

TEST_CASE("octets that reach the receiver command nothing by themselves", "[simulation][world]") {
    World world{tests::gale_scenario(60.0), 1};
    REQUIRE(world.receive(std::array<std::uint8_t, 3>{1, 2, 3}));
    while (world.outcome() == Outcome::running) {
        world.sense();
        world.advance(flight::DeviceOutputs{});
    }
    CHECK(world.outcome() == Outcome::not_commanded);
}

TEST_CASE("without a parachute the vehicle ends in an impact", "[simulation][world]") {
    World world{tests::undisturbed_scenario(60.0), 1};
    flight::DeviceOutputs out;
    out.pyros.push_back({flight::PyroId::cruise_stage_separation});
    while (world.outcome() == Outcome::running) {
        world.sense();
        world.advance(out);
        out.begin_cycle();
    }
    CHECK(world.outcome() == Outcome::impact);
}

TEST_CASE("devices answer a little after they are asked, and once", "[simulation][devices]") {
    World world{tests::gale_scenario(620.0), 1};
    flight::DeviceOutputs out;
    out.pyros.push_back({flight::PyroId::coolant_vent});
    out.switches.push_back({flight::SwitchId::radar, true});
    out.thrusters_enabled = false;
    int pyro_tick = 0, radar_tick = 0, thruster_tick = 0, replies = 0;
    for (int tick = 0; tick < 64; ++tick) {
        const auto& in = world.sense();
        for (const auto& reply : in.pyro_replies) {
            CHECK((reply.pyro == flight::PyroId::coolant_vent && reply.fired));
            pyro_tick = tick;
            ++replies;
        }
        for (const auto& reply : in.switch_replies) {
            CHECK((reply.id == flight::SwitchId::radar && reply.on));
            radar_tick = tick;
            ++replies;
        }
        if (in.thrusters) {
            CHECK_FALSE(in.thrusters->enabled);
            thruster_tick = tick;
            ++replies;
        }
        world.advance(out);
        out.begin_cycle();
    }
    CHECK(replies == 3);
    // A tick to the frame, the device's own time, and for the radar's switch up to 1/8 s to a frame of 8 Hz, twice.
    CHECK((pyro_tick >= 3 && pyro_tick <= 5));
    CHECK((thruster_tick >= 4 && thruster_tick <= 6));
    CHECK((radar_tick >= 13 && radar_tick <= 14 + 16));
}

TEST_CASE("ground's solution departs from the truth by its knowledge error, and not at all without one",
          "[simulation][world]") {
    const World perfect{tests::undisturbed_scenario(1200.0), 1};
    CHECK(perfect.solution().p_MoB_M_m == perfect.truth().p_MoB_M_m);
    CHECK(perfect.solution().v_MB_M_mps == perfect.truth().v_MB_M_mps);
    CHECK(perfect.solution().entry == Sclk{397501715.0});
    CHECK(perfect.solution().epoch == perfect.sclk());

    double sum_m2 = 0.0;
    for (std::uint64_t i = 0; i < 200; ++i) {
        Scenario scenario = tests::gale_scenario(60.0);
        scenario.dispersions.knowledge_velocity_mps = 0.0;
        const World world{scenario, 5, i};
        CHECK(is_multiple_of_tick(world.solution().entry.seconds));
        sum_m2 += (vector3(world.solution().p_MoB_M_m) - vector3(world.truth().p_MoB_M_m)).squaredNorm();
    }
    CHECK(std::sqrt(sum_m2 / 200.0) == Approx(930.0).epsilon(0.15));
}

TEST_CASE("in late cruise the spin axis points as published, 21.5 degrees from the velocity", "[simulation][world]") {
    // [od137] at E−550 s
    const World world{tests::undisturbed_scenario(550.0), 1};
    CHECK(vector3(world.truth().v_MB_M_mps).norm() == Approx(5171.0).margin(5.0));
    const auto q = world.inspect().q_MB;
    const Vector3 z = Quaternion{q[0], q[1], q[2], q[3]} * Vector3::UnitZ();
    const double angle_rad = std::acos(z.dot(vector3(world.truth().v_MB_M_mps).normalized()));
    CHECK(angle_rad / degree_rad == Approx(21.47).margin(1.0));
}

}  // namespace simulation_world_test
