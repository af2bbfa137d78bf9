// SPDX-License-Identifier: Apache-2.0
#include "server/procedures/term_reader.hpp"

#include "commands/encoder.hpp"
#include "commands/read_back.hpp"
#include "dictionaries/words.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace aeolis::server::procedures {
namespace {

using dictionary::Type;
using dictionary::ValueKind;
using Kind = YamlNode::Kind;

constexpr std::array stages_until{commands::Stage::radiated, commands::Stage::received, commands::Stage::accepted,
                                  commands::Stage::executed, commands::Stage::verified};
constexpr std::array sinces{Since::run, Since::procedure, Since::step};

/// Its name, for those that are found by one.
constexpr auto name_of_entry = [](const auto& entry) -> std::string_view { return entry.name; };
constexpr auto name_of_stage = [](commands::Stage stage) -> std::string_view { return name_of(stage); };

/// One argument as the vehicle gets it; null: its default. The Error is the encoder's.
Result<commands::NamedValue> as_encoded(const dictionary::Command& command, const dictionary::Argument& argument,
                                        const commands::NamedValue* given) {
    dictionary::Command alone = command;
    alone.arguments = {argument};
    const auto packet = commands::encode(alone, {given, given == nullptr ? 0U : 1U}, 0);
    if (!packet) return packet.error();
    auto read = commands::decode(alone, *packet);
    if (!read) return read.error();
    return std::move(read->front());
}

}  // namespace

/// A value of a channel or an argument, in the words of its type.
std::optional<double> TermReader::value(const YamlNode& node, const Type& type, const std::string& of) {
    if (!is(node, Kind::scalar, of)) return std::nullopt;
    if (type.kind == ValueKind::boolean) {
        const auto read = yes_or_no(node, of);
        return read ? std::optional{*read ? 1.0 : 0.0} : std::nullopt;
    }
    if (type.kind == ValueKind::enumerated) {
        const auto entry = std::ranges::find(type.enumeration, node.text, &dictionary::EnumValue::label);
        if (entry == type.enumeration.end())
            add(node.mark, fmt::format("{}: {}", of,
                                       unknown_name(node.text, "label of it", type.enumeration,
                                                    [](const auto& one) -> std::string_view { return one.label; })));
        else if (entry->last)
            add(node.mark, fmt::format("{}: the label '{}' stands for a range of values", of, node.text));
        else
            return static_cast<double>(entry->value);
        return std::nullopt;
    }
    const auto read = node.plain ? dictionary::to_number(node.text) : std::nullopt;
    if (!read)
        add(node.mark, fmt::format("{}: '{}' is no number", of, node.text));
    else if (type.kind == ValueKind::integer && type.calibrator.empty() && *read != std::floor(*read))
        add(node.mark, fmt::format("{}: {} is no whole number", of, node.text));
    else
        return read;
    return std::nullopt;
}

bool TermReader::unit_is_right(const YamlNode& node, const dictionary::Channel& channel) {
    const YamlNode* unit = node.member("unit");
    const std::string& of_channel = channel.type.unit;
    const bool has_unit = !of_channel.empty() && of_channel != "1";
    if (unit == nullptr) {
        if (has_unit)
            add(node.mark, fmt::format("channel '{}' is in {}; 'unit' must say so", channel.name, of_channel));
        return !has_unit;
    }
    const std::string text = words(*unit, "a unit");
    if (text == (has_unit ? of_channel : "1")) return true;
    if (!text.empty())
        add(unit->mark, has_unit ? fmt::format("channel '{}' is in {}, not in {}", channel.name, of_channel, text)
                                 : fmt::format("channel '{}' has no unit", channel.name));
    return false;
}

std::optional<Condition> TermReader::channel_condition(const YamlNode& node) {
    static constexpr std::array must{std::string_view{"channel"}, std::string_view{"is"}, std::string_view{"value"}};
    static constexpr std::array may{std::string_view{"unit"}, std::string_view{"for_s"}, std::string_view{"since"}};
    if (!table(node, "a condition on a channel", must, std::span{may}.first(in_steps_ ? may.size() : may.size() - 1)))
        return std::nullopt;
    ChannelCondition read;
    bool whole = true;

    const YamlNode* comparison = node.member("is");
    if (const std::string text = words(node, "is", "a comparison"); !text.empty()) {
        if (const auto named = comparison_named(text)) {
            read.comparison = *named;
        } else {
            add(comparison->mark, fmt::format("'{}' is no comparison: ==, !=, <, <=, > or >=", text));
            whole = false;
        }
    }
    if (const YamlNode* for_s = node.member("for_s")) {
        const auto seconds = number(*for_s, "for_s", 0.0, condition_for_s_max, " s");
        whole = whole && seconds;
        read.for_s = seconds.value_or(0.0);
    }
    if (node.member("since") != nullptr) {
        const auto since = since_of(node);
        whole = whole && since;
        read.since = since.value_or(Since::run);
    }
    const std::string name = words(node, "channel", "a channel");
    if (name.empty()) return std::nullopt;
    const auto* channel = dictionary_.channel(name);
    if (channel == nullptr) {
        add(node.member("channel")->mark,
            unknown_name(name, "channel of the dictionary", dictionary_.channels, name_of_entry));
        return std::nullopt;
    }
    read.channel = channel->id;
    const Type& type = channel->type;
    if (needs_text(type)) {
        add(node.member("channel")->mark, fmt::format("channel '{}' is no number that can be compared", name));
        return std::nullopt;
    }
    const bool equality = read.comparison == Comparison::equal || read.comparison == Comparison::unequal;
    if (whole && comparison != nullptr && type.kind == ValueKind::boolean && !equality) {
        add(comparison->mark, fmt::format("channel '{}' is true or false, compared by == or !=", name));
        whole = false;
    }
    if (whole && comparison != nullptr && type.kind == ValueKind::real && equality) {
        add(comparison->mark, fmt::format("channel '{}' is a real number, compared by <, <=, > or >=", name));
        whole = false;
    }
    if (!unit_is_right(node, *channel)) whole = false;
    const YamlNode* given = node.member("value");
    if (given == nullptr) return std::nullopt;
    const auto number = value(*given, type, fmt::format("the value of channel '{}'", name));
    if (!number || !whole) return std::nullopt;
    if ((type.valid_min && *number < *type.valid_min) || (type.valid_max && *number > *type.valid_max)) {
        add(given->mark, fmt::format("channel '{}' never is {}: outside its range", name, given->text));
        return std::nullopt;
    }
    read.value = *number;
    return read;
}

std::optional<Since> TermReader::since_of(const YamlNode& node) {
    const std::string text = words(node, "since", "since");
    const auto named = std::ranges::find(sinces, text, [](Since one) { return name_of(one); });
    if (named != sinces.end()) return *named;
    if (!text.empty()) add(node.member("since")->mark, fmt::format("since '{}': must be run, procedure or step", text));
    return std::nullopt;
}

std::optional<Condition> TermReader::event_condition(const YamlNode& node) {
    static constexpr std::array must{std::string_view{"event"}, std::string_view{"since"}};
    if (!table(node, "a condition on an event", std::span{must}.first(in_steps_ ? must.size() : must.size() - 1), {}))
        return std::nullopt;
    EventCondition read;
    bool whole = true;
    if (!in_steps_)
        read.since = Since::run;
    else if (const auto since = since_of(node))
        read.since = *since;
    else
        whole = false;
    const std::string name = words(node, "event", "an event");
    if (name.empty()) return std::nullopt;
    const auto* event = dictionary_.event(name);
    if (event == nullptr) {
        add(node.member("event")->mark,
            unknown_name(name, "event of the dictionary", dictionary_.events, name_of_entry));
        return std::nullopt;
    }
    read.event = event->id;
    return whole ? std::optional<Condition>{read} : std::nullopt;
}

std::optional<Condition> TermReader::condition(const YamlNode& node) {
    if (!is(node, Kind::mapping, "a condition")) return std::nullopt;
    if (node.member("channel") != nullptr) return channel_condition(node);
    if (node.member("event") != nullptr) return event_condition(node);
    if (const YamlNode* from = node.member("from")) {
        static constexpr std::array must{std::string_view{"from"}};
        if (!table(node, "a condition on the time", must, {})) return std::nullopt;
        const auto time = entry_time(*from);
        return time ? std::optional<Condition>{TimeCondition{*time}} : std::nullopt;
    }
    add(node.mark, "a condition names a 'channel', an 'event' or a time ('from')");
    return std::nullopt;
}

std::vector<Condition> TermReader::conditions(const YamlNode* node) {
    std::vector<Condition> all;
    if (node == nullptr) return all;
    const auto items = list(node, "a list of conditions", conditions_max);
    if (node->kind == Kind::sequence && items.empty()) add(node->mark, "a list of conditions is empty");
    all.reserve(items.size());
    for (const YamlNode& item : items)
        if (const auto one = condition(item)) all.push_back(*one);
    return all;
}

void TermReader::arguments(const YamlNode& node, const YamlNode* given, const dictionary::Command& command,
                           PreparedCommand& prepared) {
    std::vector<std::string> named = prepared.to_fill;
    if (given != nullptr && is(*given, Kind::mapping, "'arguments'")) {
        for (std::size_t i = 0; i < given->keys.size(); ++i) {
            const auto& [name, mark] = given->keys[i];
            const auto argument = std::ranges::find(command.arguments, name, &dictionary::Argument::name);
            if (argument == command.arguments.end()) {
                add(mark,
                    unknown_name(name, fmt::format("argument of {}", command.name), command.arguments, name_of_entry));
                continue;
            }
            if (std::ranges::find(prepared.to_fill, name) != prepared.to_fill.end())
                add(mark, fmt::format("argument '{}' has a value here and is to be filled", name));
            named.push_back(name);
            const auto number = value(given->items[i], argument->type, fmt::format("argument '{}'", name));
            if (!number) continue;
            const commands::NamedValue filled{name, *number};
            if (const auto encoded = as_encoded(command, *argument, &filled))
                prepared.fixed.push_back(*encoded);
            else
                add(given->items[i].mark, encoded.error().message);
            prepared.arguments.push_back(filled);
        }
    }
    if (prepared.from_solution) return;
    for (const auto& argument : command.arguments) {
        if (std::ranges::find(named, argument.name) != named.end()) continue;
        if (!argument.default_value)
            add(node.mark,
                fmt::format("{} needs argument '{}': give it, or list it in 'to_fill'", command.name, argument.name));
        else if (const auto encoded = as_encoded(command, argument, nullptr))
            prepared.fixed.push_back(*encoded);
    }
}

std::optional<PreparedCommand> TermReader::command(const YamlNode& node) {
    static constexpr std::array must{std::string_view{"name"}};
    static constexpr std::array may{std::string_view{"arguments"}, std::string_view{"to_fill"},
                                    std::string_view{"from_solution"}, std::string_view{"until"}};
    if (!table(node, "a command", must, may)) return std::nullopt;
    PreparedCommand prepared;
    prepared.name = words(node, "name", "a command's name");
    if (const YamlNode* from = node.member("from_solution"))
        prepared.from_solution = yes_or_no(*from, "from_solution").value_or(false);
    if (const std::string until = words(node, "until", "until"); !until.empty()) {
        const auto stage = std::ranges::find(stages_until, until, name_of_stage);
        if (stage == stages_until.end())
            add(node.member("until")->mark, unknown_name(until, "stage to wait for", stages_until, name_of_stage));
        else
            prepared.until = *stage;
    }
    if (prepared.name.empty()) return std::nullopt;
    const auto* command = dictionary_.command(prepared.name);
    if (command == nullptr) {
        add(node.member("name")->mark,
            unknown_name(prepared.name, "command of the dictionary", dictionary_.commands, name_of_entry));
        return std::nullopt;
    }
    if (prepared.until == commands::Stage::verified && commands::read_back_packet(dictionary_, *command) == nullptr)
        add(node.member("until")->mark,
            fmt::format("{} is not read back, so it has no stage 'verified'", command->name));
    const YamlNode* to_fill = node.member("to_fill");
    for (const YamlNode& item : list(to_fill, "'to_fill'", command->arguments.size())) {
        const std::string name = words(item, "an argument");
        if (name.empty()) continue;
        if (std::ranges::find(command->arguments, name, &dictionary::Argument::name) == command->arguments.end())
            add(item.mark,
                unknown_name(name, fmt::format("argument of {}", command->name), command->arguments, name_of_entry));
        else if (std::ranges::find(prepared.to_fill, name) != prepared.to_fill.end())
            add(item.mark, fmt::format("argument '{}' stands here a second time", name));
        else
            prepared.to_fill.push_back(name);
    }
    arguments(node, node.member("arguments"), *command, prepared);
    return prepared;
}

}  // namespace aeolis::server::procedures
