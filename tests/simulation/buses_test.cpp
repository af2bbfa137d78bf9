// SPDX-License-Identifier: Apache-2.0
#include "simulation/buses/buses.hpp"

#include "simulation/world.hpp"
#include "tests/simulation/gale.hpp"
#include "tests/support/catch.hpp"

#include <vector>

namespace simulation_buses_test {

using namespace aeolis;
using namespace aeolis::simulation;
using flight::Device;
using flight::PyroId;
using flight::SwitchId;
using flight::Unit;

namespace {

Scenario without_errors() {
    Scenario scenario = tests::gale_scenario();
    scenario.bus_message_error_fraction = 0.0;
    return scenario;
}

DeviceFault fault(Device device, DeviceFault::Kind kind, double begin_before_entry_s, double duration_s,
                  Unit unit = Unit::a) {
    return {device, unit, kind, begin_before_entry_s, duration_s};
}

/// The buses with nobody behind them but the test, from tick 0: SCLK 1000.
struct Bench {
    Buses buses;
    std::int64_t tick = 64000;

    explicit Bench(const Scenario& scenario, std::uint64_t seed = 1) : buses(scenario, seed, 0) {}
    /// A cycle that commands `out`, and the frames after it; the replies they brought.
    flight::DeviceInputs cycle(const flight::DeviceOutputs& out) {
        buses.take(out);
        return frame();
    }
    flight::DeviceInputs frame() {
        buses.frame(Sclk::from_ticks(++tick));
        flight::DeviceInputs in;
        buses.reply(in);
        return in;
    }
};

flight::DeviceOutputs fire(PyroId pyro, Unit controller = Unit::a) {
    flight::DeviceOutputs out;
    out.pyros.push_back({pyro, controller});
    return out;
}

flight::DeviceOutputs set(SwitchId id, bool on) {
    flight::DeviceOutputs out;
    out.switches.push_back({id, on});
    return out;
}

Scenario entry_at_tick(std::int64_t tick, Scenario scenario = without_errors()) {
    scenario.entry_sclk = Sclk::from_ticks(tick);
    return scenario;
}

}  // namespace

TEST_CASE("a command goes out with the next frame of its bus: 1/64 s, or the next multiple of 1/8 s", "[buses][R2]") {
    for (std::int64_t phase = 0; phase < 8; ++phase) {
        Bench bench{without_errors()};
        bench.tick += phase;
        flight::DeviceOutputs out = set(SwitchId::radar, true);
        out.pyros.push_back({PyroId::coolant_vent});
        bench.cycle(out);
        CHECK(bench.buses.fired().size() == 1);
        while (!bench.buses.devices().on(SwitchId::radar)) bench.cycle({});
        CHECK(bench.tick == 64008);
    }
}

TEST_CASE("replies come in later frames of the same bus, by device and seed", "[buses][R2][R14]") {
    const auto ticks_to_reply = [](std::uint64_t seed) {
        Bench bench{without_errors(), seed};
        flight::DeviceOutputs out = set(SwitchId::uhf, true);
        out.pyros.push_back({PyroId::coolant_vent});
        out.thrusters_enabled = true;
        std::array<std::int64_t, 3> ticks{};
        bench.tick += 3;
        for (int i = 0; i < 100; ++i) {
            const auto in = bench.cycle(out);
            out = {};
            if (!in.pyro_replies.empty()) ticks[0] = bench.tick - 64003;
            if (in.thrusters) ticks[1] = bench.tick - 64003;
            if (!in.switch_replies.empty()) ticks[2] = bench.tick - 64003;
        }
        return ticks;
    };
    bool differs = false;
    for (std::uint64_t seed = 1; seed < 20; ++seed) {
        const auto ticks = ticks_to_reply(seed);
        CHECK((ticks[0] >= 3 && ticks[0] <= 5));
        CHECK((ticks[1] >= 4 && ticks[1] <= 6));
        // To the frame after 5 ticks, 32 … 34 of work, then a frame again: of 1/8 s.
        CHECK((ticks[2] == 5 + 32 || ticks[2] == 5 + 40));
        CHECK(ticks == ticks_to_reply(seed));
        differs |= ticks != ticks_to_reply(1);
    }
    CHECK(differs);
}

TEST_CASE("garbled messages are repeated, in their frame or in the next, and the order of commands stays",
          "[buses][R2]") {
    Scenario scenario = without_errors();
    scenario.bus_message_error_fraction = 0.3;
    int as_last_commanded = 0;
    std::uint64_t repeated = 0, failed = 0;
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
        Bench bench{scenario, seed};
        flight::DeviceOutputs out = set(SwitchId::radar, true);
        out.switches.push_back({SwitchId::radar, false});
        out.switches.push_back({SwitchId::radar, true});
        for (int i = 0; i < 64; ++i) {
            bench.cycle(out);
            out = {};
        }
        as_last_commanded += bench.buses.devices().on(SwitchId::radar) ? 1 : 0;
        repeated += bench.buses.counters_8_hz().repeated;
        failed += bench.buses.counters_8_hz().failed;
    }
    CHECK(as_last_commanded >= 195);  // three tries in three frames fail in 0.3^6 of the cases
    CHECK(repeated > 100);
    CHECK(failed > 20);
}

TEST_CASE("without errors nothing is repeated", "[buses]") {
    Bench bench{without_errors()};
    for (int i = 0; i < 640; ++i) bench.cycle(fire(PyroId::coolant_vent));
    CHECK(bench.buses.counters_64_hz().messages > 640);
    CHECK(bench.buses.counters_64_hz().repeated == 0);
    CHECK(bench.buses.counters_64_hz().given_up == 0);
}

TEST_CASE("a silent terminal is tried in three frames and given up; nothing comes back", "[buses][R2][R14]") {
    // Silent for 4 ticks from the first frame on, and for 2.
    for (const auto& [ticks, fired] : {std::pair{4, false}, std::pair{2, true}}) {
        Scenario scenario = entry_at_tick(64001);
        scenario.device_faults = {fault(Device::pyro, DeviceFault::Kind::silent, 0.0, ticks / 64.0)};
        Bench bench{scenario};
        bool answered = bench.cycle(fire(PyroId::coolant_vent)).pyro_replies.size() != 0;
        for (int i = 0; i < 32; ++i) answered |= bench.cycle({}).pyro_replies.size() != 0;
        CHECK(bench.buses.devices().fired(PyroId::coolant_vent) == fired);
        CHECK(answered == fired);
        CHECK(bench.buses.counters_64_hz().given_up == (fired ? 0U : 1U));
    }
}

TEST_CASE("only the addressed unit answers, and says which it is", "[buses][R2]") {
    Scenario scenario = entry_at_tick(64000);
    scenario.device_faults = {fault(Device::pyro, DeviceFault::Kind::silent, 10.0, 100.0)};
    Bench bench{scenario};
    flight::DeviceOutputs out = fire(PyroId::coolant_vent, Unit::b);
    std::vector<flight::PyroReply> replies;
    for (int i = 0; i < 16; ++i) {
        for (const auto& reply : bench.cycle(out).pyro_replies) replies.push_back(reply);
        out.pyros.clear();
    }
    REQUIRE(replies.size() == 1);
    CHECK((replies[0].fired && replies[0].unit == Unit::b));
}

TEST_CASE("a silent unit holds up its own commands, not those of the other unit of its device", "[buses][R2][R50]") {
    Scenario scenario = entry_at_tick(64000);
    scenario.device_faults = {fault(Device::pyro, DeviceFault::Kind::silent, 10.0, 100.0)};
    Bench bench{scenario};
    flight::DeviceOutputs out = fire(PyroId::parachute_mortar);
    out.pyros.push_back({PyroId::parachute_mortar, Unit::b});
    bench.cycle(out);
    CHECK(bench.buses.fired().size() == 1);
}

TEST_CASE("a device whose replies are doubled says all twice, a tick apart", "[buses][R50]") {
    Scenario scenario = entry_at_tick(64000);
    scenario.device_faults = {fault(Device::pyro, DeviceFault::Kind::doubled, 10.0, 100.0)};
    Bench bench{scenario};
    std::vector<std::int64_t> at;
    flight::DeviceOutputs out = fire(PyroId::coolant_vent);
    for (int i = 0; i < 16; ++i) {
        for (const auto& reply : bench.cycle(out).pyro_replies) at.push_back(reply.fired ? bench.tick : 0);
        out = {};
    }
    REQUIRE(at.size() == 2);
    CHECK(at[1] == at[0] + 1);
}

TEST_CASE("a device that refuses says so and does nothing; one that is late does it and says so later",
          "[buses][R2][R14]") {
    Scenario scenario = entry_at_tick(64000);
    scenario.device_faults = {fault(Device::pyro, DeviceFault::Kind::refuses, 10.0, 100.0),
                              fault(Device::thrusters, DeviceFault::Kind::late, 10.0, 100.0)};
    scenario.device_faults[1].late_s = 2.0;
    Bench bench{scenario};
    flight::DeviceOutputs out = fire(PyroId::coolant_vent);
    out.thrusters_enabled = false;
    std::int64_t thrusters_after = 0;
    std::vector<flight::PyroReply> replies;
    for (int i = 0; i < 200; ++i) {
        const auto in = bench.cycle(out);
        for (const auto& reply : in.pyro_replies) replies.push_back(reply);
        if (in.thrusters) thrusters_after = bench.tick - 64000;
        out = {};
    }
    REQUIRE(replies.size() == 1);
    CHECK_FALSE(replies[0].fired);
    CHECK_FALSE(bench.buses.devices().fired(PyroId::coolant_vent));
    CHECK_FALSE(bench.buses.devices().thrusters_enabled());
    CHECK((thrusters_after >= 128 + 4 && thrusters_after <= 128 + 6));
}

TEST_CASE("engines that hear nothing keep their last command for two seconds and then go safe; thrusters close at once",
          "[buses][R2]") {
    Bench bench{without_errors()};
    flight::DeviceOutputs out;
    out.engines.ignited = true;
    out.thrusters.on_s[3] = 0.01;
    bench.cycle(out);
    CHECK(bench.buses.thrusters().on_s[3] == 0.01);
    bench.buses.leave_alone();
    for (int i = 0; i < 128; ++i) bench.frame();
    CHECK(bench.buses.engines().ignited);
    CHECK(bench.buses.thrusters().on_s[3] == 0.0);
    bench.frame();
    CHECK_FALSE(bench.buses.engines().ignited);
    bench.cycle(out);
    CHECK(bench.buses.engines().ignited);
}

TEST_CASE("the IMU's samples come at 200 Hz with the tick in which they end, whatever happens on the buses",
          "[buses][R2]") {
    Scenario scenario = tests::gale_scenario(60.0);
    scenario.bus_message_error_fraction = 0.5;
    World world{scenario, 1};
    flight::DeviceOutputs out;
    std::size_t samples = 0;
    std::uint32_t count = 0;
    for (int tick = 0; tick <= 640; ++tick) {
        for (const auto& sample : world.sense().imu) {
            CHECK(sample.count == ++count);
            ++samples;
        }
        CHECK(samples == static_cast<std::size_t>(tick * 200 / 64));
        // A change of unit on the way: the other counts on.
        if (tick == 320) out.units[Device::imu] = Unit::b;
        world.advance(out);
    }
}

TEST_CASE("each unit of a sensor has errors of its own", "[buses][R2]") {
    const auto felt = [](Unit unit) {
        World world{tests::gale_scenario(60.0), 1};
        flight::DeviceOutputs out;
        out.units[Device::imu] = unit;
        world.advance(out);
        return world.sense().imu[0].delta_v_mps;
    };
    CHECK(felt(Unit::a) == felt(Unit::a));
    CHECK(felt(Unit::a) != felt(Unit::b));
}

}  // namespace simulation_buses_test
