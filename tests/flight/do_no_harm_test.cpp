// SPDX-License-Identifier: Apache-2.0
#include "flight/computer.hpp"

#include "flight/computer_state.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random_message.hpp"

#include <memory>
#include <random>

namespace flight_do_no_harm_test {

// Second Chance does no harm: whatever messages it is fed, in whatever order, nothing reaches a device. R34
using namespace aeolis;
using namespace aeolis::flight;

namespace {

Load backup_load() {
    Load load;
    load.string = String::b;
    load.role = Role::second_chance;
    return load;
}

bool commands_something(const DeviceOutputs& out) {
    return out.in_command || !out.pyros.empty() || !out.switches.empty() || !out.telecom.empty() ||
           out.thrusters_enabled || out.engines.ignited || out.pay_out_bridle || out.tone || out.designate_b_prime ||
           !out.cross_string.empty() || out.thrusters != ThrusterCommand{};
}

/// A backup computer under a rain of random messages and inputs.
struct Rain {
    std::mt19937 random;
    Computer backup{backup_load(), Sclk{1000.0}};
    std::unique_ptr<DeviceOutputs> out = std::make_unique<DeviceOutputs>();
    DeviceInputs in;
    std::int64_t ticks = 64000;

    explicit Rain(std::uint32_t seed) : random(seed) { in.nvm_capacity_octets = 1U << 30; }

    /// Ground's permission, and a state of prime's from which Second Chance would fly if it were silent.
    void prepare(bool enabled, bool touchdown) {
        ComputerState& state = backup.state();
        state.outbox.begin(ModuleId::cross_string, Sclk{1000.0}, *out);
        if (enabled) state.cross_string.on(EnableSecondChanceCommand{{}, true}, state.outbox);
        EdlMain prime{Load{}};
        const StateHeader header{
            .time = Sclk{1000.0}, .revision = 1, .begun = true, .separated = true, .touchdown = touchdown, .units = {}};
        StateFrame::of(header, prime).in_parts([&](const StatePart& part) {
            state.cross_string.on(part, state.outbox);
        });
    }

    template <typename Allowed>
    void rain(const Allowed& allowed) {
        ComputerState& state = backup.state();
        for (int i = 0; i < 20; ++i) {
            const Message message = test::random_message(random);
            const auto to = static_cast<ModuleId>(random() % module_count);
            if (!allowed(to, message) || !is_loaded(Role::second_chance, to)) continue;
            (void)state.mailboxes[static_cast<std::size_t>(to)].try_push(message);
            state.ready |= bit_of(to);
        }
        in.uplink.clear();
        if (random() % 4 == 0) {
            UplinkPacket packet;
            packet.size = static_cast<std::uint16_t>(random() % packet.octets.size());
            for (std::size_t i = 0; i < packet.size; ++i) packet.octets[i] = static_cast<std::uint8_t>(random());
            in.uplink.push_back(packet);
        }
        if (random() % 8 == 0) in.pyro_replies.push_back({PyroId::parachute_mortar, true});
    }
    void cycle() {
        in.now = Sclk::from_ticks(++ticks);
        backup.step(in, *out);
        in.pyro_replies.clear();
        in.cross_string.clear();
    }
};

bool enables(const Message& message) {
    return std::holds_alternative<EnableSecondChanceCommand>(message);
}

}  // namespace

TEST_CASE("without ground's enabling a backup fires nothing, whatever messages it is fed", "[second_chance][R34]") {
    for (std::uint32_t seed = 1; seed <= 8; ++seed) {
        Rain rain{seed};
        rain.prepare(false, false);
        for (int cycle = 0; cycle < 1500; ++cycle) {
            rain.rain([](ModuleId, const Message& message) { return !enables(message); });
            rain.cycle();
            INFO("seed " << seed << ", cycle " << cycle);
            REQUIRE_FALSE(commands_something(*rain.out));
        }
        CHECK(rain.backup.counters().resets == 0);  // else it would have been still for that reason
    }
}

TEST_CASE("while prime is alive an enabled backup fires nothing, whatever messages it is fed",
          "[second_chance][R1][R34]") {
    for (std::uint32_t seed = 1; seed <= 8; ++seed) {
        Rain rain{seed};
        rain.prepare(true, false);
        for (int cycle = 0; cycle < 1500; ++cycle) {
            rain.rain([](ModuleId, const Message&) { return true; });
            // Life on the line, with or without a state that can be read.
            rain.in.cross_string.append(std::array<std::uint8_t, 3>{1, 2, 3});
            rain.cycle();
            INFO("seed " << seed << ", cycle " << cycle);
            REQUIRE_FALSE(commands_something(*rain.out));
        }
        CHECK(rain.backup.counters().resets == 0);  // else it would have been still for that reason
    }
}

TEST_CASE("after touchdown an enabled backup fires nothing, whatever messages it is fed and however silent prime is",
          "[second_chance][R34]") {
    for (std::uint32_t seed = 1; seed <= 8; ++seed) {
        Rain rain{seed};
        rain.prepare(true, true);
        for (int cycle = 0; cycle < 1500; ++cycle) {
            rain.rain([](ModuleId, const Message&) { return true; });
            rain.cycle();
            INFO("seed " << seed << ", cycle " << cycle);
            REQUIRE_FALSE(commands_something(*rain.out));
        }
        CHECK(rain.backup.counters().resets == 0);  // else it would have been still for that reason
    }
}

TEST_CASE("the same rain on a backup that may take over does reach devices: the tests above can fail",
          "[second_chance][R34]") {
    Rain rain{1};
    rain.prepare(true, false);
    bool commanded = false;
    for (int cycle = 0; cycle < 200; ++cycle) {
        if (cycle > 40) rain.rain([](ModuleId to, const Message&) { return to == ModuleId::pyro; });
        rain.cycle();
        commanded |= commands_something(*rain.out);
    }
    CHECK(commanded);
}

}  // namespace flight_do_no_harm_test
