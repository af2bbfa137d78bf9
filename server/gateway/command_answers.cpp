// SPDX-License-Identifier: Apache-2.0
// What reaches Earth and decides what is known of commands: values for preconditions, answers, reports of what is held.
#include "server/gateway/command_gateway.hpp"

#include "commands/read_back.hpp"
#include "telemetry/text.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace aeolis::server {
namespace {

std::optional<double> argument_value(const dictionary::Packet& packet, const telemetry::Decoded& decoded,
                                     std::string_view name) {
    const auto index = telemetry::field_index(packet, name);
    return index ? decoded.value[*index] : std::nullopt;
}

}  // namespace

void CommandGateway::receive(std::span<const std::uint8_t> packet, bool live, Ert ert,
                             std::vector<archive::StageRecord>& stages) {
    // What comes later tells the past: it decides no precondition, but an answer that was lost live still counts.
    if (!live && underway_.empty()) return;
    if (decommutator_.decode(packet, decoded_)) return;
    const auto& container = dictionary_.packets[decoded_.packet];
    if (live) note_channels(container, ert);
    if (live)
        for (const FieldPlace& clcw : clcw_)
            if (decoded_.packet == clcw.packet && decoded_.value[clcw.field])
                hear_clcw(static_cast<std::uint32_t>(*decoded_.value[clcw.field]), ert, stages);
    if (underway_.empty()) return;
    if (container.event) note_answer(ert, stages);
    note_report(container, packet, ert, stages);
    std::erase_if(underway_, [](const Underway& underway) { return underway.lifecycle.finished(); });
}

std::vector<commands::LatestValue> CommandGateway::latest(Ert now) const {
    std::vector<commands::LatestValue> values(heard_.size());
    for (std::size_t i = 0; i < heard_.size(); ++i)
        if (heard_[i].at)
            values[i] = {heard_[i].value, static_cast<double>(now.microseconds - heard_[i].at->microseconds) * 1e-6};
    return values;
}

void CommandGateway::note_channels(const dictionary::Packet& packet, Ert ert) {
    for (std::size_t i = 0; i < packet.fields.size(); ++i)
        if (const auto& channel = packet.fields[i].channel) heard_[channel->value] = {decoded_.value[i], ert};
}

void CommandGateway::note_answer(Ert ert, std::vector<archive::StageRecord>& stages) {
    const auto* event = telemetry::event_of(dictionary_, decoded_);
    const auto& packet = dictionary_.packets[decoded_.packet];
    const auto opcode = argument_value(packet, decoded_, "opcode");
    const auto count = argument_value(packet, decoded_, "count");
    if (event == nullptr || !opcode || !count) return;
    const commands::Answer answer{event->id,
                                  event->name,
                                  telemetry::event_text(dictionary_, *event, decoded_),
                                  Opcode{static_cast<std::uint16_t>(*opcode)},
                                  static_cast<std::uint16_t>(*count),
                                  decoded_.header.time,
                                  ert};
    for (auto& underway : underway_) {
        if (underway.lifecycle.command().opcode != answer.opcode || underway.lifecycle.count() != answer.count)
            continue;
        changes_.clear();
        underway.lifecycle.on(answer, changes_);
        append(underway, changes_, stages);
    }
}

void CommandGateway::note_report(const dictionary::Packet& packet, std::span<const std::uint8_t> octets, Ert ert,
                                 std::vector<archive::StageRecord>& stages) {
    for (auto& underway : underway_) {
        if (underway.report != &packet) continue;
        changes_.clear();
        underway.lifecycle.on(commands::compare(underway.lifecycle.command(), underway.packet, packet, octets), ert,
                              changes_);
        append(underway, changes_, stages);
    }
}

void CommandGateway::note_read_back(const Underway& underway, const commands::StageChange& change) {
    using commands::Stage;
    using commands::Status;
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
        if (change.status == Status::ok) sent.erase(sent.begin(), told);  // none before it is held any more
    } else if (change.status == Status::failed) {  // it was not carried out: what is held is still of the one before
        sent.erase(told);
    }
}

}  // namespace aeolis::server
