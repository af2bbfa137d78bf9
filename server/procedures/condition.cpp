// SPDX-License-Identifier: Apache-2.0
#include "server/procedures/condition.hpp"

#include "commands/number.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace aeolis::server::procedures {
namespace {

std::string_view after(Since since) {
    switch (since) {
    case Since::run: return "";
    case Since::procedure: return " since the procedure began";
    case Since::step: break;
    }
    return " since the step began";
}

struct InWords {
    const dictionary::Dictionary& dictionary;

    std::string operator()(const ChannelCondition& condition) const {
        const auto& channel = dictionary.channels[condition.channel.value];
        std::string text = fmt::format("{} {} {}", channel.name, name_of(condition.comparison),
                                       exact_text(channel.type, condition.value));
        if (condition.for_s > 0.0) text += fmt::format(" for {} s", commands::shortest_text(condition.for_s));
        return text.append(after(condition.since));
    }
    std::string operator()(const EventCondition& condition) const {
        const auto* event = dictionary.event(condition.event);
        const std::string name = event == nullptr ? std::string{} : event->name;
        return fmt::format("{} received{}", name, after(condition.since));
    }
    std::string operator()(const TimeCondition& condition) const { return "from " + text_of(condition.from); }
};

}  // namespace

std::string exact_text(const dictionary::Type& type, double value) {
    if (type.kind == dictionary::ValueKind::boolean) return value != 0.0 ? "true" : "false";
    for (const auto& entry : type.enumeration)
        if (entry.holds(value)) return entry.label;
    const std::string number = commands::shortest_text(value);
    return type.unit.empty() || type.unit == "1" ? number : number + " " + type.unit;
}

std::string text_of(const Condition& condition, const dictionary::Dictionary& dictionary) {
    return std::visit(InWords{dictionary}, condition);
}

std::string text_of(const PreparedCommand& prepared, const dictionary::Dictionary& dictionary) {
    std::string text = prepared.name;
    const auto* command = dictionary.command(prepared.name);
    for (const auto& [name, value] : prepared.arguments) {
        std::string words = commands::shortest_text(value);
        if (command != nullptr)
            if (const auto known = std::ranges::find(command->arguments, name, &dictionary::Argument::name);
                known != command->arguments.end())
                words = exact_text(known->type, value);
        text += fmt::format(" {}={}", name, words);
    }
    for (const std::string& name : prepared.to_fill) text += fmt::format(" {}=____", name);
    if (prepared.from_solution) text += " (the rest from the navigation solution)";
    return text;
}

std::string text_of(const Target& target, const std::vector<Step>& body) {
    switch (target.kind) {
    case Target::Kind::step: return "step " + body[target.step].id;
    case Target::Kind::confirmation: return "the confirmation";
    case Target::Kind::end: break;
    }
    return "the end, not confirmed";
}

}  // namespace aeolis::server::procedures
