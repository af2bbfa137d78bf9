// SPDX-License-Identifier: Apache-2.0
// What a reply tells of a command besides yes or no.
#include "server/gateway/command_gateway.hpp"

#include "common/check.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace aeolis::server {
namespace {

std::string hex_text(std::span<const std::uint8_t> octets) {
    std::string text;
    text.reserve(octets.size() * 2);
    for (const auto octet : octets) fmt::format_to(std::back_inserter(text), "{:02x}", octet);
    return text;
}

}  // namespace

void CommandGateway::tell(const Prepared& prepared, Ert now, v1::CommandReply& reply) const {
    reply.set_octets(hex_text(prepared.packet));
    reply.set_arguments(prepared.arguments);
    for (const auto& condition : prepared.preconditions) {
        auto& told = *reply.add_preconditions();
        told.set_text(condition.text);
        told.set_state(commands::name_of(condition.state));
    }
    reply.set_service(prepared.wanted.value_or(link_.suitable(now)) == commands::Fop::Service::expedited ? "BD" : "AD");
    tell_arrival(*prepared.command, prepared.packet, now, prepared.release_at.value_or(now), reply);
}

void CommandGateway::tell_arrival(const dictionary::Command& command, std::span<const std::uint8_t> packet, Ert now,
                                  Ert leaves, v1::CommandReply& reply) const {
    const auto light_time_us = static_cast<std::int64_t>(light_time_s_ * 1.0e6);
    reply.set_leaves(day_of_year_text(leaves));
    reply.set_arrives(day_of_year_text(Scet{leaves.microseconds + light_time_us}));
    reply.set_effect_seen(day_of_year_text(Ert{leaves.microseconds + 2 * light_time_us}));
    const auto arguments = commands::decode(command, packet);
    AEOLIS_CHECK(arguments.ok());  // it was encoded here
    if (const auto deadline = deadlines_.of(command, *arguments, leaves)) {
        reply.set_latest_useful(day_of_year_text(deadline->latest));
        reply.set_useful_before(deadline->timepoint);
    }
    for (const auto& timepoint : deadlines_.missed(now, leaves)) reply.add_too_late_for(timepoint);
}

void CommandGateway::tell_station(Ert leaves, v1::CommandReply& reply) const {
    const auto* pass = stations_.pass_at(leaves);
    if (pass == nullptr) return;
    reply.set_station(pass->station);
    reply.set_station_until(day_of_year_text(pass->end));
}

void CommandGateway::tell_leaving(const Underway& command, Ert now, v1::CommandReply& reply) const {
    const auto* entry = waiting(command.number);
    const bool waits = entry != nullptr && !entry->held && !entry->needs_approval;
    if (!waits && command.lifecycle.status(commands::Stage::released) != commands::Status::ok) return;
    const Ert leaves = waits ? std::max(entry->release_at.value_or(now), now) : now;
    tell_arrival(command.lifecycle.command(), command.packet, now, leaves, reply);
    tell_station(leaves, reply);
}

}  // namespace aeolis::server
