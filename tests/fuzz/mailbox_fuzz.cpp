// Any message to any module of a computer at any time, any uplink, anything from any device: the computer counts and
// reports what it does not expect, refuses what it cannot do, and goes on. A failed check is a bug here, though in
// flight it would only be a reset.
#include "flight/computer.hpp"
#include "flight/kernel/dispatch.hpp"
#include "flight/kernel/executive.hpp"
#include "tests/fuzz/any_message.hpp"

#include <cstdlib>
#include <memory>

namespace {

using namespace aeolis;
using namespace aeolis::flight;

constexpr int steps_max = 200; // of one input, so that none is slow

/// What is needed once and costs time to make.
struct Computers {
    ComputerState prime{load_of(Role::prime), Sclk{1000.0}};
    ComputerState backup{load_of(Role::second_chance), Sclk{1000.0}};
    ComputerState state{prime}; // the one under test
    DeviceOutputs out;

    static Load load_of(Role role) {
        Load load;
        load.role = role;
        load.string = role == Role::prime ? String::a : String::b;
        return load;
    }
};

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

void fill_inputs(fuzz::Source& from, DeviceInputs& in) {
    fuzz::fill_each(from, in.imu, in.cruise_attitude, in.radar, in.pyro_replies, in.switch_replies, in.engines,
                    in.thrusters, in.bridle, in.system_fault, in.nvm_used_octets, in.nvm_capacity_octets);
}

void add_uplink(fuzz::Source& from, DeviceInputs& in) {
    UplinkPacket uplink;
    uplink.size = static_cast<std::uint16_t>(from.take<std::uint8_t>() * 2U);
    for (std::size_t i = 0; i < uplink.size; ++i)
        uplink.octets[i] = from.take<std::uint8_t>();
    static_cast<void>(in.uplink.try_push_back(uplink));
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const auto computers = std::make_unique<Computers>();
    fuzz::Source from{{data, size}};
    ComputerState& state = computers->state;
    const bool backup = from.take<std::uint8_t>() % 2 != 0;
    state = backup ? computers->backup : computers->prime;
    std::uint64_t unexpected = 0;
    std::int64_t tick = 64000;
    for (int step = 0; step < steps_max && !from.empty(); ++step) {
        const auto what = from.take<std::uint8_t>();
        if (what % 4 == 0) {
            DeviceInputs in;
            tick += 1 + what / 4;
            in.now = Sclk::from_ticks(tick);
            in.nvm_capacity_octets = 1U << 30U;
            if (what & 4U) fill_inputs(from, in);
            if (what & 8U) add_uplink(from, in);
            Executive{state}.cycle(in, computers->out); // a CheckFailed is not caught: it ends the fuzzer
            continue;
        }
        const auto to = static_cast<ModuleId>(from.take<std::uint8_t>() % module_count);
        const Message message = fuzz::message_of(what % std::variant_size_v<Message>, from);
        if (!is_loaded(state.load.role, to)) continue;
        if (!state.mailboxes[static_cast<std::size_t>(to)].try_push(message)) continue;
        if (wakes(to, message)) state.ready |= bit_of(to);
        if (!expects(state, to, message)) ++unexpected;
    }
    if (state.unexpected_messages + still_waiting(state) != unexpected) std::abort(); // one was lost in silence
    return 0;
}
