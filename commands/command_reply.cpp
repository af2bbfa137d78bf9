// SPDX-License-Identifier: Apache-2.0
// The details of a reply besides acceptance or refusal.
#include "commands/authorise.hpp"
#include "commands/command_gateway.hpp"

#include "common/check.hpp"

#include <algorithm>

namespace aeolis::commands {
void CommandGateway::tell(const Prepared& prepared, Ert now, Reply& reply) const {
    reply.octets = prepared.packet;
    reply.arguments = prepared.arguments;
    reply.preconditions = prepared.preconditions;
    reply.service = prepared.wanted.value_or(link_.suitable(now)) == Fop::Service::expedited ? "BD" : "AD";
    const bool leaves_at_once = is_hazardous(*prepared.command) || !waits_for_room_;
    if (prepared.release_at || leaves_at_once)
        tell_arrival(*prepared.command, prepared.packet, now, prepared.release_at.value_or(now), reply);
}

void CommandGateway::tell_arrival(const dictionary::Command& command, std::span<const std::uint8_t> packet, Ert now,
                                  Ert leaves, Reply& reply) const {
    const auto light_time_us = static_cast<std::int64_t>(light_time_s_ * 1.0e6);
    reply.leaves = leaves;
    reply.arrives = Scet{leaves.microseconds + light_time_us};
    reply.effect_seen = Ert{leaves.microseconds + 2 * light_time_us};
    const auto arguments = decode(command, packet);
    AEOLIS_CHECK(arguments.ok());  // it was encoded here
    reply.deadline = deadlines_.of(command, *arguments, leaves);
    reply.too_late_for = deadlines_.missed(now, leaves);
}

void CommandGateway::tell_station(Ert leaves, Reply& reply) const {
    const auto* pass = stations_.pass_at(leaves);
    if (pass == nullptr) return;
    reply.station = pass->station;
    reply.station_until = pass->end;
}

void CommandGateway::tell_leaving(const Underway& command, Ert now, Reply& reply) const {
    const auto* entry = waiting(command.number);
    const bool waits = entry != nullptr && !entry->held && !entry->needs_approval;
    if (!waits && command.lifecycle.status(Stage::released) != Status::ok) return;
    if (waits && waits_for_turn(command, now)) return;
    const Ert leaves = waits ? std::max(entry->release_at.value_or(now), now) : now;
    tell_arrival(command.lifecycle.command(), command.packet, now, leaves, reply);
    tell_station(leaves, reply);
}

}  // namespace aeolis::commands
