// SPDX-License-Identifier: Apache-2.0
#include "server/procedures/procedure_reader.hpp"

#include "commands/number.hpp"
#include "common/names.hpp"
#include "dictionaries/words.hpp"
#include "server/procedures/condition.hpp"
#include "server/procedures/step_order.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <utility>

namespace aeolis::server::procedures {
namespace {

using dictionary::Type;
using dictionary::ValueKind;
using Kind = YamlNode::Kind;

constexpr std::size_t id_characters_max = 40;  ///< chosen: it stands in a column of the print
constexpr std::array reserved{std::string_view{"confirmation"}, std::string_view{"end"}};
constexpr unsigned revision_max = 9'999;

constexpr std::array stages_until{commands::Stage::radiated, commands::Stage::received, commands::Stage::accepted,
                                  commands::Stage::executed, commands::Stage::verified};
constexpr std::array sinces{EventCondition::Since::run, EventCondition::Since::procedure, EventCondition::Since::step};
constexpr std::array wheres{EntryTime::Where::vehicle, EntryTime::Where::sent, EntryTime::Where::received};

std::string_view kind_name(Kind kind) {
    switch (kind) {
    case Kind::scalar: return "a text";
    case Kind::sequence: return "a list";
    case Kind::mapping: return "a table of names and values";
    }
    return "";
}

std::size_t characters(std::string_view text) {
    return static_cast<std::size_t>(
        std::ranges::count_if(text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

bool is_id(std::string_view text) {
    return !text.empty() && text.size() <= id_characters_max && text.front() >= 'a' && text.front() <= 'z' &&
           std::ranges::all_of(text,
                               [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_'; });
}

/// The file's name without folder and ending.
std::string_view stem(std::string_view file) {
    if (const auto slash = file.rfind('/'); slash != std::string_view::npos) file.remove_prefix(slash + 1);
    return file.substr(0, file.rfind('.'));
}

/// "'capten' is no position; the nearest name is 'command'"
template <typename All, typename NameOf>
std::string unknown_name(std::string_view name, std::string_view what, const All& all, NameOf name_of_one) {
    const auto like = nearest(name, all, name_of_one);
    return like.empty() ? fmt::format("'{}' is no {}", name, what)
                        : fmt::format("'{}' is no {}; the nearest name is '{}'", name, what, like);
}

class ProcedureReader {
  public:
    ProcedureReader(const std::string& file, const dictionary::Dictionary& dictionary,
                    std::span<const std::string> procedures)
        : file_(file), dictionary_(dictionary), procedures_(procedures) {}

    ReadProcedure read(std::string_view text);

  private:
    void add(Mark mark, std::string message) { findings_.push_back({file_, mark, std::move(message)}); }

    // ---- words ----
    bool is(const YamlNode& node, Kind kind, std::string_view what);
    /// Reports names that the form does not have, and those it must have.
    bool table(const YamlNode& node, std::string_view what, std::span<const std::string_view> must,
               std::span<const std::string_view> may);
    std::string words(const YamlNode& node, std::string_view what);
    std::string words(const YamlNode& node, std::string_view name, std::string_view what);
    std::optional<double> number(const YamlNode& node, std::string_view what, double least, double most,
                                 std::string_view unit);
    std::optional<bool> yes_or_no(const YamlNode& node, std::string_view what);
    std::string date(const YamlNode& node, std::string_view what);
    std::string id(const YamlNode& node, std::string_view what);
    std::optional<Position> position(const YamlNode& node);
    Position position_of(const YamlNode& table, std::string_view name);
    std::optional<EntryTime> entry_time(const YamlNode& node);
    /// The items of a list, at most `most`.
    std::span<const YamlNode> list(const YamlNode* node, std::string_view what, std::size_t most);

    // ---- parts ----
    void head(const YamlNode& root, Procedure& procedure);
    std::optional<Condition> condition(const YamlNode& node);
    std::optional<Condition> channel_condition(const YamlNode& node);
    std::optional<Condition> event_condition(const YamlNode& node);
    std::vector<Condition> conditions(const YamlNode* node);
    std::optional<double> value(const YamlNode& node, const Type& type, const std::string& of);
    std::optional<PreparedCommand> command(const YamlNode& node);
    void arguments(const YamlNode& node, const YamlNode* given, const dictionary::Command& command,
                   PreparedCommand& prepared);
    std::vector<Choice> choices(const YamlNode& node);
    Target target(const YamlNode& node);
    std::vector<Position> signatures(const YamlNode& node);
    Step step(const YamlNode& node, bool of_body);
    std::vector<Step> steps(const YamlNode& root, std::string_view part, bool of_body);
    Watchdog watchdog(const YamlNode& node);
    Redline redline(const YamlNode& node, const Procedure& procedure);
    void settle_targets(std::vector<Step>& body);
    void check_order(const Procedure& procedure);

    const std::string& file_;
    const dictionary::Dictionary& dictionary_;
    std::span<const std::string> procedures_;
    std::vector<TextFinding> findings_;
    std::map<std::string, Mark> ids_;  ///< of steps and watchdogs
    /// Targets by name, until all steps are read: a number in Target::step is an index here.
    std::vector<std::pair<std::string, Mark>> named_;
};

// ---- words ---------------------------------------------------------------------------------------------------------

bool ProcedureReader::is(const YamlNode& node, Kind kind, std::string_view what) {
    if (node.kind == kind && !node.is_empty()) return true;
    if (node.is_empty())
        add(node.mark, fmt::format("{} is empty", what));
    else
        add(node.mark, fmt::format("{} is {}, and must be {}", what, kind_name(node.kind), kind_name(kind)));
    return false;
}

bool ProcedureReader::table(const YamlNode& node, std::string_view what, std::span<const std::string_view> must,
                            std::span<const std::string_view> may) {
    if (!is(node, Kind::mapping, what)) return false;
    std::vector<std::string_view> known{must.begin(), must.end()};
    known.insert(known.end(), may.begin(), may.end());
    for (const auto& key : node.keys)
        if (std::ranges::find(known, key.name) == known.end())
            add(key.mark, unknown_name(key.name, fmt::format("part of {}", what), known, std::identity{}));
    for (const std::string_view name : must)
        if (node.member(name) == nullptr) add(node.mark, fmt::format("{} lacks '{}'", what, name));
    return true;
}

std::string ProcedureReader::words(const YamlNode& node, std::string_view what) {
    if (!is(node, Kind::scalar, what)) return {};
    std::string_view text = node.text;
    while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.remove_suffix(1);
    if (text.empty()) add(node.mark, fmt::format("{} is empty", what));
    if (const auto size = characters(text); size > text_characters_max)
        add(node.mark, fmt::format("{} has {} characters, more than {}", what, size, text_characters_max));
    return std::string{text};
}

std::string ProcedureReader::words(const YamlNode& node, std::string_view name, std::string_view what) {
    const YamlNode* member = node.member(name);
    return member == nullptr ? std::string{} : words(*member, what);
}

std::optional<double> ProcedureReader::number(const YamlNode& node, std::string_view what, double least, double most,
                                              std::string_view unit) {
    if (!is(node, Kind::scalar, what)) return std::nullopt;
    const auto read = node.plain ? dictionary::to_number(node.text) : std::nullopt;
    if (!read) {
        add(node.mark, fmt::format("{}: '{}' is no number", what, node.text));
    } else if (*read < least || *read > most) {
        add(node.mark, fmt::format("{} is {}, and must be from {} to {}{}", what, node.text,
                                   commands::shortest_text(least), commands::shortest_text(most), unit));
    } else {
        return read;
    }
    return std::nullopt;
}

std::optional<bool> ProcedureReader::yes_or_no(const YamlNode& node, std::string_view what) {
    if (!is(node, Kind::scalar, what)) return std::nullopt;
    if (node.plain && (node.text == "true" || node.text == "false")) return node.text == "true";
    add(node.mark, fmt::format("{} is '{}', and must be true or false", what, node.text));
    return std::nullopt;
}

std::string ProcedureReader::date(const YamlNode& node, std::string_view what) {
    const std::string text = words(node, "on", what);
    if (text.empty()) return text;
    constexpr std::size_t length = std::string_view{"2012-08-05"}.size();
    if (text.size() != length || !scet_from_text(text + "T00:00:00"))
        add(node.member("on")->mark, fmt::format("{}: '{}' is no day such as 2012-08-05", what, text));
    return text;
}

std::string ProcedureReader::id(const YamlNode& node, std::string_view what) {
    const std::string text = words(node, what);
    if (text.empty()) return text;
    if (!is_id(text))
        add(node.mark, fmt::format("{} '{}' must be of lower-case letters, digits and underscores, {} at most, and "
                                   "begin with a letter",
                                   what, text, id_characters_max));
    else if (std::ranges::find(reserved, text) != reserved.end())
        add(node.mark, fmt::format("{} '{}' has a meaning of its own as a target", what, text));
    if (const auto [before, is_new] = ids_.try_emplace(text, node.mark); !is_new)
        add(node.mark, fmt::format("{} '{}' is that of line {}", what, text, before->second.line));
    return text;
}

std::optional<Position> ProcedureReader::position(const YamlNode& node) {
    const std::string text = words(node, "a position");
    if (text.empty()) return std::nullopt;
    const auto named = position_named(text);
    if (!named)
        add(node.mark, unknown_name(text, "position", positions, [](Position position) { return name_of(position); }));
    return named;
}

Position ProcedureReader::position_of(const YamlNode& table, std::string_view name) {
    const YamlNode* node = table.member(name);
    return node == nullptr ? Position{} : position(*node).value_or(Position{});
}

std::optional<EntryTime> ProcedureReader::entry_time(const YamlNode& node) {
    const std::string text = words(node, "a time from entry");
    if (text.empty()) return std::nullopt;
    const auto space = text.find(' ');
    const auto e_s = seconds_from_entry(std::string_view{text}.substr(0, space));
    if (e_s && space != std::string::npos)
        for (const EntryTime::Where where : wheres)
            if (std::string_view{text}.substr(space + 1) == name_of(where)) return EntryTime{*e_s, where};
    add(node.mark, fmt::format("'{}' is no time from entry such as 'E-47:00 sent', 'E+4:16 vehicle' or 'E+4:16 "
                               "received'",
                               text));
    return std::nullopt;
}

std::span<const YamlNode> ProcedureReader::list(const YamlNode* node, std::string_view what, std::size_t most) {
    if (node == nullptr || !is(*node, Kind::sequence, what)) return {};
    if (node->items.size() > most)
        add(node->items[most].mark, fmt::format("{} has {} entries, more than {}", what, node->items.size(), most));
    return std::span{node->items}.first(std::min(node->items.size(), most));
}

// ---- conditions ----------------------------------------------------------------------------------------------------

/// A value of a channel or an argument, in the words of its type.
std::optional<double> ProcedureReader::value(const YamlNode& node, const Type& type, const std::string& of) {
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

std::optional<Condition> ProcedureReader::channel_condition(const YamlNode& node) {
    static constexpr std::array must{std::string_view{"channel"}, std::string_view{"is"}, std::string_view{"value"}};
    static constexpr std::array may{std::string_view{"unit"}, std::string_view{"for_s"}};
    if (!table(node, "a condition on a channel", must, may)) return std::nullopt;
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
    const std::string name = words(node, "channel", "a channel");
    if (name.empty()) return std::nullopt;
    const auto* channel = dictionary_.channel(name);
    if (channel == nullptr) {
        add(node.member("channel")->mark, unknown_name(name, "channel of the dictionary", dictionary_.channels,
                                                       [](const auto& one) -> std::string_view { return one.name; }));
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
    const YamlNode* unit = node.member("unit");
    const bool has_unit = !type.unit.empty() && type.unit != "1";
    if (unit == nullptr && has_unit) {
        add(node.mark, fmt::format("channel '{}' is in {}; 'unit' must say so", name, type.unit));
        whole = false;
    } else if (unit != nullptr) {
        const std::string text = words(*unit, "a unit");
        if (!text.empty() && text != (has_unit ? type.unit : "1")) {
            add(unit->mark, has_unit ? fmt::format("channel '{}' is in {}, not in {}", name, type.unit, text)
                                     : fmt::format("channel '{}' has no unit", name));
            whole = false;
        }
    }
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

std::optional<Condition> ProcedureReader::event_condition(const YamlNode& node) {
    static constexpr std::array must{std::string_view{"event"}, std::string_view{"since"}};
    if (!table(node, "a condition on an event", must, {})) return std::nullopt;
    EventCondition read;
    bool whole = true;
    const std::string since = words(node, "since", "since");
    const auto named = std::ranges::find(sinces, since, [](auto one) { return name_of(one); });
    if (named == sinces.end()) {
        if (!since.empty())
            add(node.member("since")->mark, fmt::format("since '{}': must be run, procedure or step", since));
        whole = false;
    } else {
        read.since = *named;
    }
    const std::string name = words(node, "event", "an event");
    if (name.empty()) return std::nullopt;
    const auto* event = dictionary_.event(name);
    if (event == nullptr) {
        add(node.member("event")->mark, unknown_name(name, "event of the dictionary", dictionary_.events,
                                                     [](const auto& one) -> std::string_view { return one.name; }));
        return std::nullopt;
    }
    read.event = event->id;
    return whole ? std::optional<Condition>{read} : std::nullopt;
}

std::optional<Condition> ProcedureReader::condition(const YamlNode& node) {
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

std::vector<Condition> ProcedureReader::conditions(const YamlNode* node) {
    std::vector<Condition> all;
    if (node == nullptr) return all;
    const auto items = list(node, "a list of conditions", conditions_max);
    if (node->kind == Kind::sequence && items.empty()) add(node->mark, "a list of conditions is empty");
    all.reserve(items.size());
    for (const YamlNode& item : items)
        if (const auto one = condition(item)) all.push_back(*one);
    return all;
}

// ---- commands ------------------------------------------------------------------------------------------------------

void ProcedureReader::arguments(const YamlNode& node, const YamlNode* given, const dictionary::Command& command,
                                PreparedCommand& prepared) {
    const auto known = [](const dictionary::Argument& one) -> std::string_view { return one.name; };
    std::vector<std::string> named = prepared.to_fill;
    if (given != nullptr && is(*given, Kind::mapping, "'arguments'")) {
        for (std::size_t i = 0; i < given->keys.size(); ++i) {
            const auto& [name, mark] = given->keys[i];
            const auto argument = std::ranges::find(command.arguments, name, &dictionary::Argument::name);
            if (argument == command.arguments.end()) {
                add(mark, unknown_name(name, fmt::format("argument of {}", command.name), command.arguments, known));
                continue;
            }
            if (std::ranges::find(prepared.to_fill, name) != prepared.to_fill.end())
                add(mark, fmt::format("argument '{}' has a value here and is to be filled", name));
            named.push_back(name);
            const auto number = value(given->items[i], argument->type, fmt::format("argument '{}'", name));
            if (!number) continue;
            // The encoder's own judgement of this one argument.
            dictionary::Command alone = command;
            alone.arguments = {*argument};
            const commands::NamedValue filled{name, *number};
            if (const auto encoded = commands::encode(alone, std::span{&filled, 1}, 0); !encoded)
                add(given->items[i].mark, encoded.error().message);
            prepared.arguments.push_back(filled);
        }
    }
    if (prepared.from_solution) return;
    for (const auto& argument : command.arguments)
        if (!argument.default_value && std::ranges::find(named, argument.name) == named.end())
            add(node.mark,
                fmt::format("{} needs argument '{}': give it, or list it in 'to_fill'", command.name, argument.name));
}

std::optional<PreparedCommand> ProcedureReader::command(const YamlNode& node) {
    static constexpr std::array must{std::string_view{"name"}};
    static constexpr std::array may{std::string_view{"arguments"}, std::string_view{"to_fill"},
                                    std::string_view{"from_solution"}, std::string_view{"until"}};
    if (!table(node, "a command", must, may)) return std::nullopt;
    PreparedCommand prepared;
    prepared.name = words(node, "name", "a command's name");
    if (const YamlNode* from = node.member("from_solution"))
        prepared.from_solution = yes_or_no(*from, "from_solution").value_or(false);
    if (const std::string until = words(node, "until", "until"); !until.empty()) {
        const auto stage =
            std::ranges::find(stages_until, until, [](auto one) { return std::string_view{name_of(one)}; });
        if (stage == stages_until.end())
            add(node.member("until")->mark, unknown_name(until, "stage to wait for", stages_until,
                                                         [](auto one) { return std::string_view{name_of(one)}; }));
        else
            prepared.until = *stage;
    }
    if (prepared.name.empty()) return std::nullopt;
    const auto* command = dictionary_.command(prepared.name);
    if (command == nullptr) {
        add(node.member("name")->mark, unknown_name(prepared.name, "command of the dictionary", dictionary_.commands,
                                                    [](const auto& one) -> std::string_view { return one.name; }));
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
            add(item.mark, unknown_name(name, fmt::format("argument of {}", command->name), command->arguments,
                                        [](const auto& one) -> std::string_view { return one.name; }));
        else if (std::ranges::find(prepared.to_fill, name) != prepared.to_fill.end())
            add(item.mark, fmt::format("argument '{}' stands here a second time", name));
        else
            prepared.to_fill.push_back(name);
    }
    arguments(node, node.member("arguments"), *command, prepared);
    return prepared;
}

// ---- steps ---------------------------------------------------------------------------------------------------------

Target ProcedureReader::target(const YamlNode& node) {
    const std::string text = words(node, "a target");
    if (text == "confirmation" || text.empty()) return {};
    if (text == "end") return {Target::Kind::end, 0};
    named_.emplace_back(text, node.mark);
    return {Target::Kind::step, named_.size() - 1};
}

std::vector<Choice> ProcedureReader::choices(const YamlNode& node) {
    static constexpr std::array must{std::string_view{"when"}, std::string_view{"go_to"}};
    static constexpr std::array may{std::string_view{"check"}};
    std::vector<Choice> all;
    const auto items = list(&node, "'choose'", conditions_max);
    if (node.kind == Kind::sequence && items.size() < 2) add(node.mark, "a branch has two ways or more");
    all.reserve(items.size());
    for (const YamlNode& item : items) {
        if (!table(item, "a way of a branch", must, may)) continue;
        Choice& choice = all.emplace_back();
        choice.words = words(item, "when", "the words of a way");
        if (const auto same = std::ranges::find(all, choice.words, &Choice::words); &*same != &choice)
            add(item.mark, fmt::format("two ways of this branch are '{}'", choice.words));
        choice.conditions = conditions(item.member("check"));
        if (const YamlNode* go_to = item.member("go_to")) choice.target = target(*go_to);
    }
    return all;
}

std::vector<Position> ProcedureReader::signatures(const YamlNode& node) {
    std::vector<Position> all;
    const auto items = list(&node, "'sign'", positions.size());
    if (node.kind == Kind::sequence && items.empty()) add(node.mark, "'sign' is empty");
    for (const YamlNode& item : items) {
        const auto read = position(item);
        if (!read) continue;
        if (std::ranges::find(all, *read) != all.end())
            add(item.mark, fmt::format("{} signs twice", name_of(*read)));
        else
            all.push_back(*read);
    }
    return all;
}

Step ProcedureReader::step(const YamlNode& node, bool of_body) {
    static constexpr std::array must{std::string_view{"step"}, std::string_view{"who"}, std::string_view{"do"}};
    static constexpr std::array may{std::string_view{"check"},  std::string_view{"sign"}, std::string_view{"limit_s"},
                                    std::string_view{"by"},     std::string_view{"hold"}, std::string_view{"command"},
                                    std::string_view{"choose"}, std::string_view{"next"}};
    Step read;
    read.mark = node.mark;
    // A precondition or a confirmation is something to be found, in no order: it changes nothing and leads nowhere.
    constexpr std::size_t outside_body = 4;
    if (!table(node, of_body ? "a step" : "a step outside the main body", must,
               std::span{may}.first(of_body ? may.size() : outside_body)))
        return read;
    if (const YamlNode* name = node.member("step")) read.id = id(*name, "step");
    read.who = position_of(node, "who");
    read.text = words(node, "do", "the text of a step");
    read.conditions = conditions(node.member("check"));
    if (const YamlNode* sign = node.member("sign")) read.signatures = signatures(*sign);
    if (const YamlNode* limit = node.member("limit_s"))
        read.limit_s = number(*limit, "limit_s", 1.0, limit_s_max, " s");
    if (const YamlNode* by = node.member("by")) read.limit_e = entry_time(*by);
    if (!of_body) return read;
    if (const YamlNode* hold = node.member("hold")) read.hold = position(*hold);
    if (const YamlNode* prepared = node.member("command")) {
        read.command = command(*prepared);
        if (node.member("who") != nullptr && read.who != Position::command)
            add(node.member("who")->mark,
                fmt::format("a command is sent by position 'command', not by '{}'", name_of(read.who)));
    }
    if (const YamlNode* choose = node.member("choose")) {
        read.choices = choices(*choose);
        if (node.member("command") != nullptr) add(choose->mark, "a step with a command does not branch");
    }
    if (const YamlNode* next = node.member("next")) {
        if (node.member("choose") != nullptr) add(next->mark, "a branch leads on by its ways, not by 'next'");
        read.next = target(*next);
    }
    return read;
}

std::vector<Step> ProcedureReader::steps(const YamlNode& root, std::string_view part, bool of_body) {
    std::vector<Step> all;
    const YamlNode* node = root.member(part);
    const auto items = list(node, fmt::format("'{}'", part), steps_max);
    all.reserve(items.size());
    for (const YamlNode& item : items) all.push_back(step(item, of_body));
    return all;
}

Watchdog ProcedureReader::watchdog(const YamlNode& node) {
    static constexpr std::array must{std::string_view{"watchdog"}, std::string_view{"when"}, std::string_view{"who"},
                                     std::string_view{"do"}};
    static constexpr std::array may{std::string_view{"begin"}, std::string_view{"hold"}};
    Watchdog read;
    read.mark = node.mark;
    if (!table(node, "a watchdog", must, may)) return read;
    if (const YamlNode* name = node.member("watchdog")) read.id = id(*name, "watchdog");
    read.who = position_of(node, "who");
    read.text = words(node, "do", "the text of a watchdog");
    read.conditions = conditions(node.member("when"));
    if (const YamlNode* hold = node.member("hold")) read.hold = yes_or_no(*hold, "hold").value_or(false);
    read.begin = words(node, "begin", "begin");
    if (!read.begin.empty() && std::ranges::find(procedures_, read.begin) == procedures_.end())
        add(node.member("begin")->mark, unknown_name(read.begin, "procedure beside this one", procedures_,
                                                     [](const std::string& one) -> std::string_view { return one; }));
    return read;
}

Redline ProcedureReader::redline(const YamlNode& node, const Procedure& procedure) {
    static constexpr std::array must{std::string_view{"step"}, std::string_view{"do"}, std::string_view{"reason"},
                                     std::string_view{"by"}, std::string_view{"on"}};
    static constexpr std::array may{std::string_view{"approved_by"}};
    Redline read;
    if (!table(node, "a redline", must, may)) return read;
    read.step = words(node, "step", "a step");
    read.text = words(node, "do", "the text of a redline");
    read.reason = words(node, "reason", "the reason of a redline");
    read.by = words(node, "by", "a name");
    read.on = date(node, "the day of a redline");
    read.approved_by = words(node, "approved_by", "a name");
    std::vector<std::string_view> known;
    known.reserve(3 * steps_max);
    for (const auto* part : {&procedure.preconditions, &procedure.body, &procedure.confirmation})
        for (const Step& one : *part) known.emplace_back(one.id);
    if (!read.step.empty() && std::ranges::find(known, read.step) == known.end())
        add(node.member("step")->mark, unknown_name(read.step, "step", known, std::identity{}));
    return read;
}

void ProcedureReader::settle_targets(std::vector<Step>& body) {
    const auto settle = [&](Target& target) {
        if (target.kind != Target::Kind::step) return;
        const auto& [name, mark] = named_[target.step];
        const auto found = std::ranges::find(body, name, &Step::id);
        if (found == body.end()) {
            add(mark, unknown_name(name, "step of the main body, 'confirmation' or 'end'", body,
                                   [](const Step& one) -> std::string_view { return one.id; }));
            target = {};
        } else {
            target.step = static_cast<std::size_t>(found - body.begin());
        }
    };
    for (Step& step : body) {
        if (step.next) settle(*step.next);
        for (Choice& choice : step.choices) settle(choice.target);
    }
}

void ProcedureReader::check_order(const Procedure& procedure) {
    const StepOrder order = follow(procedure.body);
    for (const std::size_t step : order.unreachable)
        add(procedure.body[step].mark, fmt::format("no way leads to step '{}'", procedure.body[step].id));
    for (const auto& circle : order.circles) {
        std::string way;
        for (const std::size_t step : circle) way += (way.empty() ? "" : " → ") + procedure.body[step].id;
        add(procedure.body[circle[circle.size() - 2]].mark, fmt::format("steps go round in a circle: {}", way));
    }
}

void ProcedureReader::head(const YamlNode& root, Procedure& procedure) {
    procedure.id = words(root, "procedure", "'procedure'");
    if (!procedure.id.empty() && procedure.id != stem(file_))
        add(root.member("procedure")->mark,
            fmt::format("procedure '{}' is in a file of another name: '{}'", procedure.id, stem(file_)));
    else if (!procedure.id.empty() && !is_id(procedure.id))
        add(root.member("procedure")->mark,
            fmt::format("procedure '{}' must be of lower-case letters, digits and underscores, {} at most, and begin "
                        "with a letter",
                        procedure.id, id_characters_max));
    procedure.title = words(root, "title", "'title'");
    procedure.purpose = words(root, "purpose", "'purpose'");
    procedure.begin_when = words(root, "begin_when", "'begin_when'");
    procedure.source = words(root, "source", "'source'");
    if (const YamlNode* revision = root.member("revision"))
        if (const auto read = number(*revision, "revision", 1.0, revision_max, "")) {
            if (*read != std::floor(*read)) add(revision->mark, "revision is no whole number");
            procedure.revision = static_cast<unsigned>(*read);
        }
    static constexpr std::array must{std::string_view{"position"}, std::string_view{"name"}, std::string_view{"on"}};
    for (const YamlNode& item : list(root.member("approved"), "'approved'", positions.size())) {
        if (!table(item, "an approval", must, {})) continue;
        const Position by = position_of(item, "position");
        procedure.approvals.push_back({by, words(item, "name", "a name"), date(item, "the day of an approval")});
    }
}

ReadProcedure ProcedureReader::read(std::string_view text) {
    static constexpr std::array must{std::string_view{"procedure"},     std::string_view{"title"},
                                     std::string_view{"revision"},      std::string_view{"purpose"},
                                     std::string_view{"begin_when"},    std::string_view{"source"},
                                     std::string_view{"preconditions"}, std::string_view{"body"},
                                     std::string_view{"watchdogs"},     std::string_view{"confirmation"}};
    static constexpr std::array may{std::string_view{"approved"}, std::string_view{"redlines"}};
    YamlDocument document = read_yaml(text, file_);
    findings_ = std::move(document.findings);
    Procedure procedure;
    if (document.root && table(*document.root, "a procedure", must, may)) {
        const YamlNode& root = *document.root;
        head(root, procedure);
        procedure.preconditions = steps(root, "preconditions", false);
        procedure.body = steps(root, "body", true);
        procedure.confirmation = steps(root, "confirmation", false);
        for (const std::string_view part : {"body", "confirmation"})
            if (const YamlNode* node = root.member(part);
                node != nullptr && node->kind == Kind::sequence && node->items.empty())
                add(node->mark, fmt::format("'{}' has no step", part));
        const auto watchdogs = list(root.member("watchdogs"), "'watchdogs'", steps_max);
        procedure.watchdogs.reserve(watchdogs.size());
        for (const YamlNode& item : watchdogs) procedure.watchdogs.push_back(watchdog(item));
        const auto redlines = list(root.member("redlines"), "'redlines'", steps_max);
        procedure.redlines.reserve(redlines.size());
        for (const YamlNode& item : redlines) procedure.redlines.push_back(redline(item, procedure));
        settle_targets(procedure.body);
        check_order(procedure);
    }
    if (findings_.empty()) return {std::move(procedure), {}};
    std::ranges::stable_sort(findings_, [](const TextFinding& a, const TextFinding& b) {
        return std::pair{a.mark.line, a.mark.column} < std::pair{b.mark.line, b.mark.column};
    });
    if (findings_.size() > findings_max) {
        const auto more = findings_.size() - findings_max;
        findings_.resize(findings_max);
        add(findings_.back().mark, fmt::format("{} more faults follow", more));
    }
    return {std::nullopt, std::move(findings_)};
}

}  // namespace

ReadProcedure read_procedure(std::string_view text, const std::string& file, const dictionary::Dictionary& dictionary,
                             std::span<const std::string> procedures) {
    return ProcedureReader{file, dictionary, procedures}.read(text);
}

}  // namespace aeolis::server::procedures
