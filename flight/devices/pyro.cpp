// SPDX-License-Identifier: Apache-2.0
#include "flight/devices/pyro.hpp"

namespace aeolis::flight {

void PyroManager::on(const FirePyro& command, Outbox& out) {
    const auto number = static_cast<std::size_t>(command.pyro);
    if (number >= pyro_count || !due_.try_push_back(command.pyro))
        return out.event(evr::PYRO_QUEUE_FULL{.pyro = static_cast<std::uint8_t>(command.pyro)});
    reply_due_[number] = true;
}

void PyroManager::on(const PyroReply& reply, Outbox& out) {
    const auto number = static_cast<std::size_t>(reply.pyro);
    if (number >= pyro_count || !reply_due_[number] || reply.unit != unit_)
        return out.event(evr::REPLY_UNEXPECTED{.device_number = static_cast<std::uint8_t>(Device::pyro)});
    reply_due_[number] = false;
    const auto pyro = static_cast<std::uint8_t>(reply.pyro);
    if (reply.fired)
        out.send(ModuleId::edl, ActionReply{ReplyKind::pyro, pyro});
    else
        out.event(evr::PYRO_NOT_FIRED{.pyro = pyro});
}

void PyroManager::on(const UnitsSelected& selected, Outbox&) {
    unit_ = selected.units[Device::pyro];
}

void PyroManager::on(const Tick&, Outbox& out) {
    out.bus().units[Device::pyro] = unit_;
    // Pyros without room on the bus, after a second turn in one cycle, wait for the next cycle.
    while (!due_.empty() && out.bus().pyros.try_push_back(due_[0])) due_.erase_at(0);
    out.send(ModuleId::sync, Confirm{ModuleId::pyro});
}

}  // namespace aeolis::flight
