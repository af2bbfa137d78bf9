#include "flight/kernel/executive.hpp"

#include <algorithm>

namespace aeolis::flight {
namespace {

// Who asked for the clock tick itself; the rate group gets its turn from sync.
constexpr std::array clock_subscribers{ModuleId::sync, ModuleId::edl_bg, ModuleId::mfsk, ModuleId::edl_comm};

}  // namespace

void Executive::cycle(const DeviceInputs& in, DeviceOutputs& out) {
    state_.now = in.now;
    out.begin_cycle();
    for (const Envelope& envelope : state_.next_cycle) deliver(envelope.to, envelope.message);
    state_.next_cycle.clear();
    state_.sync.set_executive_counts(state_.mailbox_overflows, state_.unexpected_messages);
    post_interrupts(in);

    for (std::size_t id = 0; id < module_count;) {
        auto& mailbox = state_.mailboxes[id];
        if (mailbox.empty()) {
            ++id;
            continue;
        }
        const Message message = mailbox.front();
        mailbox.pop();
        dispatch(static_cast<ModuleId>(id), message, out);
        id = 0;  // its messages may have woken one of higher priority
    }
}

void Executive::post_interrupts(const DeviceInputs& in) {
    if (!in.imu.empty()) deliver(ModuleId::imu, ImuReadings{in.imu});
    if (!in.radar.empty()) deliver(ModuleId::radar, RadarReturns{in.now, in.radar});
    for (const auto& reply : in.pyro_replies) deliver(ModuleId::pyro, reply);
    for (const auto& reply : in.switch_replies) deliver(ModuleId::power, reply);
    if (in.engines) deliver(ModuleId::descent_engines, *in.engines);
    if (in.bridle) deliver(ModuleId::descent_engines, *in.bridle);
    if (in.thrusters) deliver(ModuleId::thrusters, *in.thrusters);
    if (in.cruise_attitude) deliver(ModuleId::edl, *in.cruise_attitude);
    if (in.system_fault) deliver(ModuleId::system_fault_protection, *in.system_fault);
    for (const auto& uplink : in.uplink) {
        UplinkReceived received;
        received.size = uplink.size;
        std::copy_n(uplink.octets.begin(), std::min<std::size_t>(uplink.size, uplink_octets_max),
                    received.octets.begin());
        deliver(ModuleId::command_dispatcher, received);
    }
    deliver(ModuleId::edl_comm, NvmStatus{in.nvm_used_octets, in.nvm_capacity_octets});
    for (const ModuleId subscriber : clock_subscribers) deliver(subscriber, ClockTick{in.now});
}

void Executive::deliver(ModuleId to, const Message& message) {
    if (!state_.mailboxes[static_cast<std::size_t>(to)].try_push(message)) ++state_.mailbox_overflows;
}

template <typename Module>
void Executive::handle(Module& module, const Message& message) {
    std::visit(
        [&](const auto& content) {
            if constexpr (requires { module.on(content, state_.outbox); }) {
                module.on(content, state_.outbox);
            } else {
                // A module has a handler for any message at any time: this is the handler of those it does not know. R4
                ++state_.unexpected_messages;
                state_.outbox.event(evr::UNEXPECTED_MESSAGE{.module_number = static_cast<std::uint8_t>(state_.outbox.from()),
                                                           .message_type = static_cast<std::uint8_t>(message.index())});
            }
        },
        message);
}

void Executive::dispatch(ModuleId id, const Message& message, DeviceOutputs& out) {
    state_.outbox.begin(id, state_.now, out);
    switch (id) {
    case ModuleId::sync: handle(state_.sync, message); break;
    case ModuleId::radar: handle(state_.radar, message); break;
    case ModuleId::imu: handle(state_.imu, message); break;
    case ModuleId::edl: handle(state_.edl, message); break;
    case ModuleId::pyro: handle(state_.pyro, message); break;
    case ModuleId::descent_engines: handle(state_.descent_engines, message); break;
    case ModuleId::thrusters: handle(state_.thrusters, message); break;
    case ModuleId::power: handle(state_.power, message); break;
    case ModuleId::system_fault_protection: handle(state_.system_fault_protection, message); break;
    case ModuleId::command_dispatcher: handle(state_.command_dispatcher, message); break;
    case ModuleId::edl_bg: handle(state_.edl_bg, message); break;
    case ModuleId::mfsk: handle(state_.mfsk, message); break;
    case ModuleId::edl_comm: handle(state_.edl_comm, message); break;
    }
    distribute(id);
}

void Executive::distribute(ModuleId from) {
    state_.mailbox_overflows += state_.outbox.dropped();
    for (const Envelope& envelope : state_.outbox.sent()) {
        if (in_rate_group(from))
            deliver(envelope.to, envelope.message);
        else if (!state_.next_cycle.try_push_back(envelope))
            ++state_.mailbox_overflows;
    }
}

}  // namespace aeolis::flight
