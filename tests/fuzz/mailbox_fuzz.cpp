// SPDX-License-Identifier: Apache-2.0
// Any message to any module of a computer at any time, any uplink, anything from any device: the computer counts and
// reports what it does not expect, refuses what it cannot do, and goes on. A failed check is a bug here, though in
// flight it would only be a reset. The first octet chooses where it begins: a computer that was just started, or one in
// the middle of a landing that is flown before the fuzzing begins.
#include "dictionaries/dictionary.hpp"
#include "flight/computer.hpp"
#include "flight/kernel/dispatch.hpp"
#include "flight/kernel/executive.hpp"
#include "tests/support/any_message.hpp"
#include "tests/support/flown_computers.hpp"

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <vector>

namespace {

using namespace aeolis;
using namespace aeolis::flight;

constexpr int steps_max = 200;  // of one input, so that none is slow

/// What is needed once and costs time to make.
struct Computers {
    std::vector<std::unique_ptr<const ComputerState>> starts;
    std::unique_ptr<ComputerState> state;  // the one under test
    DeviceOutputs out;

    Computers() {
        for (const Role role : {Role::prime, Role::second_chance}) {
            Load load;
            load.role = role;
            load.string = role == Role::prime ? String::a : String::b;
            starts.push_back(std::make_unique<const ComputerState>(load, Sclk{1000.0}));
        }
        using test::FlownComputers;
        const auto keep = [&](Computer& computer) {
            starts.push_back(std::make_unique<const ComputerState>(computer.state()));
        };
        const auto flown = std::make_unique<FlownComputers>();
        const auto phase = [](FlownComputers& now) -> const gnc::Configuration& {
            return now.prime().gnc_configuration();
        };
        keep(flown->prime());  // pre-EDL
        keep(flown->backup());
        flown->fly_until([](FlownComputers& now) { return now.world().truth().e_s >= 100.0; });
        keep(flown->prime());  // range control
        flown->fly_until([&](FlownComputers& now) { return phase(now).heatshield_gone; });
        keep(flown->prime());  // on the parachute
        {
            const auto without_prime = std::make_unique<FlownComputers>(*flown);
            without_prime->silence_prime();
            without_prime->fly_until([](FlownComputers& now) { return now.backup_in_control(); });
            keep(without_prime->backup());  // Second Chance flies
        }
        flown->fly_until([&](FlownComputers& now) { return phase(now).sky_crane_started; });
        keep(flown->prime());  // sky crane
        state = std::make_unique<ComputerState>(*starts.front());
    }
};

Computers& computers() {
    static Computers made;
    return made;
}

bool expects(ComputerState& state, ModuleId id, const Message& message) {
    return with_module(state, id, [&](auto& module) {
        return std::visit(
            [&]<typename Content>(const Content&) { return Handles<std::remove_cvref_t<decltype(module)>, Content>; },
            message);
    });
}

/// Messages that their module does not expect and has not come to: in the rate group mail waits for its turn.
std::uint64_t still_waiting(ComputerState& state) {
    std::uint64_t count = 0;
    for (std::size_t id = 0; id < module_count; ++id)
        for (auto& mailbox = state.mailboxes[id]; !mailbox.empty(); mailbox.pop())
            count += !expects(state, static_cast<ModuleId>(id), mailbox.front());
    return count;
}

void fill_inputs(test::Source& from, DeviceInputs& in) {
    test::fill_each(from, in.imu, in.cruise_attitude, in.radar, in.pyro_replies, in.switch_replies, in.engines,
                    in.thrusters, in.bridle, in.system_fault, in.nvm_used_octets, in.nvm_capacity_octets);
}

const dictionary::Dictionary& mission() {
    static const auto loaded = dictionary::load(AEOLIS_SOURCE_DIR "/dictionaries/msl");
    if (!loaded.dictionary) std::abort();
    return *loaded.dictionary;
}

/// A telecommand with a good CRC: one of the dictionary's with as many octets as it has, or any.
std::vector<std::uint8_t> telecommand(test::Source& from) {
    const auto choice = from.take<std::uint8_t>();
    Opcode opcode;
    std::size_t octets = 0;
    if (choice < mission().commands.size()) {
        opcode = mission().commands[choice].opcode;
        octets = tc_overhead_octets + mission().commands[choice].argument_octets;
    } else {
        opcode = Opcode{from.take<std::uint16_t>()};
        octets = tc_overhead_octets + from.take<std::uint8_t>();
    }
    std::vector<std::uint8_t> packet(octets);
    for (std::size_t i = tc_arguments_offset_octets; i + packet_crc_octets < octets; ++i)
        packet[i] = from.take<std::uint8_t>();
    seal_tc_packet(packet, Apid{1}, from.take<std::uint8_t>(), opcode);
    return packet;
}

std::vector<std::uint8_t> octets_as_they_are(test::Source& from) {
    std::vector<std::uint8_t> octets(from.take<std::uint8_t>() * 2U);
    for (std::uint8_t& octet : octets) octet = from.take<std::uint8_t>();
    return octets;
}

void add_uplink(test::Source& from, DeviceInputs& in) {
    const auto octets = from.take<std::uint8_t>() % 4 == 0 ? octets_as_they_are(from) : telecommand(from);
    UplinkPacket uplink;
    uplink.size = static_cast<std::uint16_t>(octets.size());
    std::ranges::copy(octets, uplink.octets.begin());
    static_cast<void>(in.uplink.try_push_back(uplink));
}

}  // namespace

// Before the fuzzer's own clock begins.
extern "C" int LLVMFuzzerInitialize(int*, char***) {
    static_cast<void>(computers());
    return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    test::Source from{{data, size}};
    ComputerState& state = *computers().state;
    state = *computers().starts[from.take<std::uint8_t>() % computers().starts.size()];
    std::uint64_t unexpected = state.unexpected_messages;
    std::int64_t tick = state.now.ticks();
    for (int step = 0; step < steps_max && !from.empty(); ++step) {
        const auto what = from.take<std::uint8_t>();
        if (what % 4 == 0) {
            DeviceInputs in;
            tick += 1 + what / 4;
            in.now = Sclk::from_ticks(tick);
            in.nvm_capacity_octets = 1U << 30U;
            if (what & 4U) fill_inputs(from, in);
            if (what & 8U) add_uplink(from, in);
            Executive{state}.cycle(in, computers().out);  // a CheckFailed is not caught: it ends the fuzzer
            continue;
        }
        const auto to = static_cast<ModuleId>(from.take<std::uint8_t>() % module_count);
        const Message message = test::message_of(what % std::variant_size_v<Message>, from);
        if (!is_loaded(state.load.role, to)) continue;
        if (!state.mailboxes[static_cast<std::size_t>(to)].try_push(message)) continue;
        if (wakes(to, message)) state.ready |= bit_of(to);
        if (!expects(state, to, message)) ++unexpected;
    }
    if (state.unexpected_messages + still_waiting(state) != unexpected) std::abort();  // one was lost in silence
    return 0;
}
