#include "simulation/devices/avionics.hpp"

namespace aeolis::simulation {
namespace {

constexpr std::int64_t jitter_ticks = 3; // 0 … 2
constexpr std::int64_t pyro_ticks = 2;
constexpr std::int64_t thruster_ticks = 3;

constexpr std::int64_t switch_ticks(flight::SwitchId id) {
    switch (id) {
    case flight::SwitchId::radar:
        return 12;
    case flight::SwitchId::uhf:
        return 32;
    case flight::SwitchId::descent_imu:
        return 8;
    case flight::SwitchId::entry_antenna:
        return 6;
    case flight::SwitchId::parachute_antenna:
        return 6;
    case flight::SwitchId::thruster_heaters:
        return 4;
    }
    return 1;
}

} // namespace

void Avionics::later(Pending reply, std::int64_t tick, std::int64_t delay_ticks) {
    reply.due_tick = tick + delay_ticks + static_cast<std::int64_t>(random_.bits() % jitter_ticks);
    // A bus that is flooded loses replies; flight's time-outs cover it.
    (void)pending_.try_push_back(reply);
}

bool Avionics::fire(flight::PyroId pyro, std::int64_t tick) {
    const auto index = static_cast<std::size_t>(pyro);
    if (index >= fired_.size()) return false;
    const bool first = !fired_[index];
    fired_[index] = true;
    later({0, Pending::Kind::pyro, pyro, {}, true}, tick, pyro_ticks);
    return first;
}

void Avionics::set(const flight::SwitchReply& wanted, std::int64_t tick) {
    using flight::SwitchId;
    const auto index = static_cast<std::size_t>(wanted.id);
    if (index >= on_.size()) return;
    on_[index] = wanted.on;
    if (wanted.on && wanted.id == SwitchId::entry_antenna)
        on_[static_cast<std::size_t>(SwitchId::parachute_antenna)] = false;
    if (wanted.on && wanted.id == SwitchId::parachute_antenna)
        on_[static_cast<std::size_t>(SwitchId::entry_antenna)] = false;
    later({0, Pending::Kind::device, {}, wanted.id, wanted.on}, tick, switch_ticks(wanted.id));
}

void Avionics::enable_thrusters(bool enabled, std::int64_t tick) {
    thrusters_enabled_ = enabled;
    later({0, Pending::Kind::thrusters, {}, {}, enabled}, tick, thruster_ticks);
}

void Avionics::reply(std::int64_t tick, flight::DeviceInputs& in) {
    for (std::size_t i = 0; i < pending_.size();) {
        const Pending& reply = pending_[i];
        bool delivered = false;
        if (reply.due_tick <= tick) {
            switch (reply.kind) {
            case Pending::Kind::pyro:
                delivered = in.pyro_replies.try_push_back({reply.pyro, reply.on});
                break;
            case Pending::Kind::device:
                delivered = in.switch_replies.try_push_back({reply.device, reply.on});
                break;
            case Pending::Kind::thrusters:
                delivered = !in.thrusters.has_value();
                if (delivered) in.thrusters = flight::ThrusterReply{reply.on};
                break;
            }
        }
        if (delivered)
            pending_.erase_at(i);
        else
            ++i;
    }
}

} // namespace aeolis::simulation
