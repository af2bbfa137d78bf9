// SPDX-License-Identifier: Apache-2.0
#include "flight/computer.hpp"

#include "simulation/entry_reference.hpp"
#include "simulation/world.hpp"
#include "telemetry/packet_stream.hpp"
#include "tests/simulation/gale.hpp"
#include "tests/support/allocations.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/telecommands.hpp"

#include <algorithm>
#include <memory>
#include <vector>

namespace flight_computer_test {

using namespace aeolis;
using namespace aeolis::flight;

namespace {

/// A computer in a world, without the links home.
struct Flight {
    simulation::World world;
    Computer computer;
    std::unique_ptr<DeviceOutputs> out = std::make_unique<DeviceOutputs>();
    std::uint64_t allocations_in_flight = 0;

    static Load load(const simulation::Scenario& scenario) {
        Load load;
        load.entry_reference = simulation::make_entry_reference(scenario);
        return load;
    }
    explicit Flight(const simulation::Scenario& scenario, std::uint64_t seed)
        : world(scenario, seed), computer(load(scenario), world.sclk()) {
        world.set_nvm(0, 1U << 30);
        world.receive(test::set_parameters(world.solution()));
        for (int cycle = 0; cycle < 64; ++cycle) step();
        world.receive(test::do_edl());
    }
    Flight(const Flight& other)
        : world(other.world), computer(other.computer), out(std::make_unique<DeviceOutputs>(*other.out)) {}

    void step() {
        const DeviceInputs& in = world.sense();
        const std::uint64_t before = test::allocations();
        computer.step(in, *out);
        allocations_in_flight += test::allocations() - before;
        world.advance(*out);
    }
    bool flying() const { return world.outcome() == simulation::Outcome::running; }
};

bool same_outputs(const DeviceOutputs& a, const DeviceOutputs& b) {
    return std::ranges::equal(a.nvm.span(), b.nvm.span()) && std::ranges::equal(a.uhf.span(), b.uhf.span()) &&
           std::ranges::equal(a.pyros.span(), b.pyros.span()) && a.engines.throttle == b.engines.throttle &&
           a.thrusters == b.thrusters && a.tone == b.tone;
}

}  // namespace

TEST_CASE("flight code asks for no memory from the first tick to the last, over a whole landing",
          "[flight][R7][invariant3]") {
    Flight flight{tests::gale_scenario(900.0), 1};
    while (flight.flying()) flight.step();
    INFO(flight.world.outcome_reason());
    CHECK(flight.world.outcome() == simulation::Outcome::touchdown);
    CHECK(flight.allocations_in_flight == 0);
    CHECK(flight.computer.counters().overruns == 0);
    CHECK(flight.computer.counters().mailbox_overflows == 0);
    CHECK(flight.computer.counters().unexpected_messages == 0);
    CHECK(flight.computer.counters().resets == 0);
}

TEST_CASE("a cycle is timeline, GNC, timeline: each acts on the other in the same 1/64 s", "[flight][R17][R18]") {
    Flight flight{tests::gale_scenario(900.0), 1};
    const auto reported = [&](Apid apid, EvrId id) {
        telemetry::PacketStream packets{flight.out->nvm.span()};
        while (const auto packet = packets.next())
            if (read_primary_header(*packet)->apid == apid &&
                read_bits(*packet, tm_data_offset_octets * 8, 16) == id.value)
                return true;
        return false;
    };
    bool gnc_saw_the_timeline = false, timeline_saw_gnc = false;
    while (flight.flying()) {
        flight.step();
        // First pass before GNC: GNC leaves its mode "off" in the cycle in which its timepoint fires.
        if (reported(evr::GNC_ENABLED::apid, evr::GNC_ENABLED::id))
            gnc_saw_the_timeline = reported(evr::GNC_MODE_CHANGED::apid, evr::GNC_MODE_CHANGED::id);
        // Second pass after GNC: the mortar fires in the cycle in which GNC says now.
        if (reported(evr::PARACHUTE_DEPLOY::apid, evr::PARACHUTE_DEPLOY::id))
            timeline_saw_gnc =
                std::ranges::count(flight.out->pyros.span(), PyroId::parachute_mortar, &PyroCommand::id) == 2;
    }
    CHECK(gnc_saw_the_timeline);
    CHECK(timeline_saw_gnc);
}

TEST_CASE("a copied computer fed the same inputs stays bit-identical", "[flight][invariant2]") {
    Flight flight{tests::gale_scenario(900.0), 2};
    for (int cycle = 0; cycle < 64 * 400; ++cycle) flight.step();
    Computer copy{flight.computer};
    auto out = std::make_unique<DeviceOutputs>(*flight.out);
    for (int cycle = 0; cycle < 64 * 300; ++cycle) {
        const DeviceInputs in = flight.world.sense();
        copy.step(in, *out);
        flight.computer.step(in, *flight.out);
        REQUIRE(same_outputs(*out, *flight.out));
        flight.world.advance(*flight.out);
    }
}

TEST_CASE("a copy is a snapshot: what the original does afterwards does not reach it", "[flight][invariant2]") {
    Flight original{tests::gale_scenario(900.0), 2};
    for (int cycle = 0; cycle < 64 * 300; ++cycle) original.step();
    Flight late{original};
    Flight early{original};
    std::vector<std::uint8_t> first, second;
    const auto run = [](Flight& flight, std::vector<std::uint8_t>& recorded) {
        for (int cycle = 0; cycle < 64 * 60; ++cycle) {
            flight.step();
            recorded.insert(recorded.end(), flight.out->nvm.begin(), flight.out->nvm.end());
        }
    };
    run(early, first);
    for (int cycle = 0; cycle < 64 * 60; ++cycle) original.step();
    run(late, second);
    CHECK(first == second);
}

TEST_CASE("a computer that gets no clock, no sensor and no reply does not end", "[flight][R4]") {
    Computer computer{Load{}, Sclk{1000.0}};
    auto out = std::make_unique<DeviceOutputs>();
    DeviceInputs in;
    for (int tick = 1; tick < 6400; ++tick) {
        in.now = Sclk::from_ticks(64000 + tick);
        computer.step(in, *out);
    }
    CHECK(computer.counters().cycles == 6399);
    CHECK(computer.counters().resets == 0);
    CHECK(out->pyros.empty());
}

}  // namespace flight_computer_test
