// SPDX-License-Identifier: Apache-2.0
#include "server/instruction/plan_conductor.hpp"

#include "telemetry/packet_stream.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

namespace aeolis::server::instruction {

PlanConductor::PlanConductor(InjectPlan plan, const dictionary::Dictionary& dictionary,
                             const procedures::EntryPrediction& prediction)
    : plan_(std::move(plan)), dictionary_(&dictionary), watch_(dictionary), decommutator_(dictionary) {
    for (const Inject& inject : plan_.injects) {
        auto& followed = followed_.emplace_back();
        for (const auto& condition : inject.when) {
            followed.conditions.push_back(watch_.add(condition));
            follow_packets_of(condition);
        }
    }
    watch_.predict(prediction);
}

void PlanConductor::follow_packets_of(const procedures::Condition& condition) {
    if (const auto* of_event = std::get_if<procedures::EventCondition>(&condition)) {
        if (const auto* event = dictionary_->event(of_event->event))
            apids_.insert(dictionary_->packets[event->packet].apid);
    } else if (const auto* of_channel = std::get_if<procedures::ChannelCondition>(&condition)) {
        for (const auto& packet : dictionary_->packets)
            if (std::ranges::find(packet.fields, of_channel->channel, &dictionary::Field::channel) !=
                packet.fields.end())
                apids_.insert(packet.apid);
    }
}

void PlanConductor::read(std::span<const std::uint8_t> recorded, Ert now) {
    telemetry::PacketStream packets{recorded};
    while (const auto octets = packets.next()) {
        const auto header = read_primary_header(*octets);
        if (!header || !apids_.contains(header->apid) || decommutator_.decode(*octets, decoded_)) continue;
        const auto& packet = dictionary_->packets[decoded_.packet];
        for (std::size_t i = 0; i < packet.fields.size(); ++i)
            if (packet.fields[i].channel)
                watch_.on(procedures::ChannelSample{*packet.fields[i].channel, decoded_.value[i], now});
        for (const auto& event : dictionary_->events)
            if (event.packet == decoded_.packet) watch_.on(procedures::EventReceived{event.id, now});
    }
}

std::vector<const Inject*> PlanConductor::pass(std::span<const std::uint8_t> recorded, Ert now) {
    if (!apids_.empty()) read(recorded, now);
    watch_.pass(now);
    std::vector<const Inject*> due;
    for (std::size_t i = 0; i < followed_.size(); ++i) {
        auto& [conditions, held_since, settled] = followed_[i];
        if (settled || conditions.empty()) continue;
        if (!held_since && std::ranges::all_of(conditions, [&](std::size_t condition) {
                return watch_.judge(condition, {}).verdict == procedures::Verdict::holds;
            }))
            held_since = now;
        if (!held_since) continue;
        const double held_s = static_cast<double>(now.microseconds - held_since->microseconds) * 1.0e-6;
        if (held_s < plan_.injects[i].after_s) continue;
        settled = true;
        due.push_back(&plan_.injects[i]);
    }
    return due;
}

Result<const Inject*> PlanConductor::waiting(const std::string& id) const {
    const auto inject = std::ranges::find(plan_.injects, id, &Inject::id);
    if (inject == plan_.injects.end()) return Error{fmt::format("plan: '{}' has no inject '{}'", plan_.id, id)};
    if (followed_[static_cast<std::size_t>(inject - plan_.injects.begin())].settled)
        return Error{fmt::format("plan: inject '{}' waits no more: it was done or skipped", id)};
    return &*inject;
}

void PlanConductor::settle(const std::string& id) {
    const auto inject = std::ranges::find(plan_.injects, id, &Inject::id);
    if (inject != plan_.injects.end())
        followed_[static_cast<std::size_t>(inject - plan_.injects.begin())].settled = true;
}

}  // namespace aeolis::server::instruction
