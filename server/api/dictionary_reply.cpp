// SPDX-License-Identifier: Apache-2.0
#include "server/api/dictionary_reply.hpp"

#include "telemetry/alarms.hpp"

#include <fmt/format.h>
#include <map>

namespace aeolis::server {
namespace {

void add_labels(const dictionary::Type& type, google::protobuf::RepeatedPtrField<v1::EnumLabel>& labels) {
    for (const auto& [value, label, last] : type.enumeration) {
        auto& added = *labels.Add();
        added.set_value(value);
        added.set_label(label);
        if (last) added.set_last(*last);
    }
}

const char* name_of(dictionary::Significance significance) {
    using dictionary::Significance;
    switch (significance) {
    case Significance::none: return "none";
    case Significance::watch: return "watch";
    case Significance::warning: return "warning";
    case Significance::distress: return "distress";
    case Significance::critical: return "critical";
    case Significance::severe: return "severe";
    }
    return "none";
}

const char* name_of(dictionary::ToneSet set) {
    switch (set) {
    case dictionary::ToneSet::prime: return "prime";
    case dictionary::ToneSet::second_chance: return "second_chance";
    case dictionary::ToneSet::spare: return "spare";
    }
    return "spare";
}

void add_channel(const dictionary::Dictionary& dictionary, const dictionary::Channel& channel,
                 const dictionary::Packet* packet, v1::DictionaryReply& reply) {
    auto& added = *reply.add_channels();
    added.set_id(channel.id.value);
    added.set_name(channel.name);
    added.set_alias(channel.alias);
    added.set_unit(channel.type.unit);
    added.set_text(channel.text);
    added.set_needs_text(needs_text(channel.type));
    add_labels(channel.type, *added.mutable_labels());
    add_limits(channel.type.alarms, "", *added.mutable_limits());
    for (const auto& [context, alarms] : channel.type.alarms.contexts)
        add_limits(alarms, telemetry::context_text(dictionary, context), *added.mutable_limits());
    if (packet == nullptr) return;
    added.set_packet(packet->name);
    added.set_expected_rate_hz(packet->expected_rate_hz.value_or(0.0));
}

void add_command(const dictionary::Dictionary& dictionary, const dictionary::Command& command,
                 v1::DictionaryReply& reply) {
    auto& added = *reply.add_commands();
    added.set_opcode(command.opcode.value);
    added.set_name(command.name);
    added.set_text(command.text);
    added.set_significance(name_of(command.significance));
    added.set_reason_for_warning(command.reason_for_warning);
    for (const auto& argument : command.arguments) {
        auto& out = *added.add_arguments();
        out.set_name(argument.name);
        out.set_text(argument.text);
        out.set_unit(argument.type.unit);
        if (argument.type.valid_min) out.set_min(*argument.type.valid_min);
        if (argument.type.valid_max) out.set_max(*argument.type.valid_max);
        if (argument.default_value) out.set_default_value(*argument.default_value);
        add_labels(argument.type, *out.mutable_labels());
        out.set_integer(argument.type.encoding != dictionary::Encoding::ieee754);
    }
    for (const auto& condition : command.preconditions) {
        auto& comparable = *added.add_conditions();
        comparable.set_channel(condition.channel.value);
        comparable.set_comparison(condition.comparison);
        comparable.set_value(condition.value);
        added.add_preconditions(condition.text.empty()
                                    ? fmt::format("{} {} {}", dictionary.channels[condition.channel.value].name,
                                                  condition.comparison, condition.value)
                                    : condition.text);
    }
}

}  // namespace

void add_limits(const dictionary::Alarms& alarms, const std::string& context,
                google::protobuf::RepeatedPtrField<v1::AlarmLimit>& limits) {
    for (const auto& range : alarms.ranges) {
        auto& limit = *limits.Add();
        limit.set_severity(telemetry::name_of(range.severity));
        if (range.below) limit.set_below(*range.below);
        if (range.above) limit.set_above(*range.above);
        limit.set_at_below(range.at_below);
        limit.set_at_above(range.at_above);
        limit.set_context(context);
    }
}

v1::DictionaryReply dictionary_reply(const dictionary::Dictionary& dictionary, const procedures::CallList& calls) {
    v1::DictionaryReply reply;
    reply.set_read_back_s(calls.read_back_s);
    for (const auto& call : calls.calls) {
        auto& added = *reply.add_calls();
        added.set_call(call.id);
        added.set_key(std::string(1, call.key));
        added.set_says(call.says);
        added.set_asks(call.asks);
    }
    reply.set_mission(dictionary.mission);
    reply.set_id(dictionary.id);
    std::map<ChannelId, const dictionary::Packet*> carriers;
    for (const auto& packet : dictionary.packets)
        for (const auto& field : packet.fields)
            if (field.channel) carriers.emplace(*field.channel, &packet);
    for (const auto& channel : dictionary.channels) {
        const auto carrier = carriers.find(channel.id);
        add_channel(dictionary, channel, carrier == carriers.end() ? nullptr : carrier->second, reply);
    }
    for (const auto& command : dictionary.commands) add_command(dictionary, command, reply);
    for (const auto& tone : dictionary.tones) {
        auto& added = *reply.add_tones();
        added.set_id(tone.id.value);
        added.set_name(tone.name);
        added.set_meaning(tone.meaning);
        added.set_set(name_of(tone.set));
    }
    return reply;
}

}  // namespace aeolis::server
