// SPDX-License-Identifier: Apache-2.0
// How the gateway hears of commands: from a packet on Earth it takes values for preconditions, the CLCW, answers and
// read-back reports.
#include "commands/command_gateway.hpp"

#include "commands/read_back.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace aeolis::commands {
void CommandGateway::receive(const DownlinkedPacket& packet, std::vector<StageReport>& stages) {
    // A recording is too old for preconditions and the CLCW, but it may hold an answer or a report that was lost live.
    const auto& decoded = packet.decoded;
    if (packet.live) note_channels(packet);
    if (packet.live) judge_.hear(decoded);
    if (packet.live)
        for (const FieldPlace& clcw : clcw_)
            if (decoded.packet == clcw.packet && decoded.value[clcw.field])
                hear_clcw(static_cast<std::uint32_t>(*decoded.value[clcw.field]), packet.ert, stages);
    if (underway_.empty()) return;
    if (packet.event != nullptr) note_answer(packet, stages);
    note_report(packet, stages);
    forget_finished();
}

void CommandGateway::forget_finished() {
    std::erase_if(underway_, [](const Underway& underway) { return underway.lifecycle.finished(); });
}

std::vector<LatestValue> CommandGateway::latest(Ert now) const {
    std::vector<LatestValue> values(heard_.size());
    for (std::size_t i = 0; i < heard_.size(); ++i)
        if (heard_[i].at)
            values[i] = {heard_[i].value, static_cast<double>(now.microseconds - heard_[i].at->microseconds) * 1e-6};
    return values;
}

void CommandGateway::note_channels(const DownlinkedPacket& packet) {
    const auto& fields = dictionary_.packets[packet.decoded.packet].fields;
    for (std::size_t i = 0; i < fields.size(); ++i)
        if (const auto& channel = fields[i].channel) heard_[channel->value] = {packet.decoded.value[i], packet.ert};
}

void CommandGateway::note_answer(const DownlinkedPacket& packet, std::vector<StageReport>& stages) {
    const auto argument = [&](std::string_view name) {
        const auto index = dictionary::field_index(dictionary_.packets[packet.decoded.packet], name);
        return index ? packet.decoded.value[*index] : std::nullopt;
    };
    const auto opcode = argument("opcode"), count = argument("count");
    if (!opcode || !count) return;
    const Answer answer{packet.event->id,
                        packet.event->name,
                        packet.text,
                        Opcode{static_cast<std::uint16_t>(*opcode)},
                        static_cast<std::uint16_t>(*count),
                        packet.decoded.header.time,
                        packet.ert};
    for (auto& underway : underway_) {
        if (underway.lifecycle.command().opcode != answer.opcode || underway.lifecycle.count() != answer.count)
            continue;
        changes_.clear();
        underway.lifecycle.on(answer, changes_);
        append(underway, changes_, stages);
    }
}

void CommandGateway::note_report(const DownlinkedPacket& packet, std::vector<StageReport>& stages) {
    const auto& container = dictionary_.packets[packet.decoded.packet];
    for (auto& underway : underway_) {
        if (underway.report != &container) continue;
        changes_.clear();
        underway.lifecycle.on(compare(underway.lifecycle.command(), underway.packet, container, packet.octets),
                              packet.ert, changes_);
        append(underway, changes_, stages);
    }
}

void CommandGateway::note_read_back(const Underway& underway, const StageChange& change) {
    if (underway.report == nullptr) return;
    const auto& name = underway.lifecycle.command().name;
    if (change.stage == Stage::radiated && change.status == Status::ok) {
        auto& sent = read_backs_[name];
        if (std::ranges::find(sent, underway.number, &ReadBack::number) == sent.end())
            sent.push_back({underway.number, Status::pending, !sent.empty()});
        return;
    }
    auto& sent = read_backs_[name];
    const auto told = std::ranges::find(sent, underway.number, &ReadBack::number);
    if (told == sent.end()) return;
    if (change.stage == Stage::verified) {
        told->held = change.status;
        if (change.status == Status::ok) sent.erase(sent.begin(), told);  // the vehicle has replaced earlier values
    } else if (change.status == Status::failed) {  // not carried out: the vehicle keeps earlier values
        sent.erase(told);
    }
}

}  // namespace aeolis::commands
