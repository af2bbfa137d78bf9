// SPDX-License-Identifier: Apache-2.0
#include "server/procedures/form_reader.hpp"

#include "commands/number.hpp"
#include "dictionaries/words.hpp"

#include <algorithm>
#include <array>
#include <functional>

namespace aeolis::server::procedures {
namespace {

using Kind = YamlNode::Kind;

constexpr std::size_t id_characters_max = 40;  ///< chosen: it stands in a column of the print

bool is_id(std::string_view text) {
    return !text.empty() && text.size() <= id_characters_max && text.front() >= 'a' && text.front() <= 'z' &&
           std::ranges::all_of(text,
                               [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_'; });
}

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

}  // namespace

bool FormReader::is(const YamlNode& node, Kind kind, std::string_view what) {
    if (node.kind == kind && !node.is_empty()) return true;
    if (node.is_empty())
        add(node.mark, fmt::format("{} is empty", what));
    else
        add(node.mark, fmt::format("{} is {}, and must be {}", what, kind_name(node.kind), kind_name(kind)));
    return false;
}

bool FormReader::table(const YamlNode& node, std::string_view what, std::span<const std::string_view> must,
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

std::string FormReader::words(const YamlNode& node, std::string_view what) {
    if (!is(node, Kind::scalar, what)) return {};
    std::string_view text = node.text;
    while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.remove_suffix(1);
    if (text.empty()) add(node.mark, fmt::format("{} is empty", what));
    if (const auto size = characters(text); size > text_characters_max)
        add(node.mark, fmt::format("{} has {} characters, more than {}", what, size, text_characters_max));
    return std::string{text};
}

std::string FormReader::words(const YamlNode& node, std::string_view name, std::string_view what) {
    const YamlNode* member = node.member(name);
    return member == nullptr ? std::string{} : words(*member, what);
}

std::optional<double> FormReader::number(const YamlNode& node, std::string_view what, double least, double most,
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

std::optional<bool> FormReader::yes_or_no(const YamlNode& node, std::string_view what) {
    if (!is(node, Kind::scalar, what)) return std::nullopt;
    if (node.plain && (node.text == "true" || node.text == "false")) return node.text == "true";
    add(node.mark, fmt::format("{} is '{}', and must be true or false", what, node.text));
    return std::nullopt;
}

std::string FormReader::date(const YamlNode& node, std::string_view what) {
    const std::string text = words(node, "on", what);
    if (text.empty()) return text;
    constexpr std::size_t length = std::string_view{"2012-08-05"}.size();
    if (text.size() != length || !scet_from_text(text + "T00:00:00"))
        add(node.member("on")->mark, fmt::format("{}: '{}' is no day such as 2012-08-05", what, text));
    return text;
}

std::optional<Position> FormReader::position(const YamlNode& node) {
    const std::string text = words(node, "a position");
    if (text.empty()) return std::nullopt;
    const auto named = position_named(text);
    if (!named)
        add(node.mark, unknown_name(text, "position", positions, [](Position position) { return name_of(position); }));
    return named;
}

Position FormReader::position_of(const YamlNode& table, std::string_view name) {
    const YamlNode* node = table.member(name);
    return node == nullptr ? Position{} : position(*node).value_or(Position{});
}

std::optional<EntryTime> FormReader::entry_time(const YamlNode& node) {
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

std::span<const YamlNode> FormReader::list(const YamlNode* node, std::string_view what, std::size_t most) {
    if (node == nullptr || !is(*node, Kind::sequence, what)) return {};
    if (node->items.size() > most)
        add(node->items[most].mark, fmt::format("{} has {} entries, more than {}", what, node->items.size(), most));
    return std::span{node->items}.first(std::min(node->items.size(), most));
}

std::string FormReader::id(const YamlNode& node, std::string_view what, std::span<const std::string_view> reserved) {
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

std::string FormReader::id_of_file(const YamlNode& root, std::string_view what) {
    const std::string text = words(root, what, fmt::format("'{}'", what));
    if (text.empty()) return text;
    std::string_view stem = file_;
    if (const auto slash = stem.rfind('/'); slash != std::string_view::npos) stem.remove_prefix(slash + 1);
    const auto ending = stem.rfind('.');
    const Mark mark = root.member(what)->mark;
    if (ending != std::string_view::npos && text != stem.substr(0, ending))
        add(mark, fmt::format("{} '{}' is in a file of another name: '{}'", what, text, stem.substr(0, ending)));
    else if (!is_id(text))
        add(mark, fmt::format("{} '{}' must be of lower-case letters, digits and underscores, {} at most, and begin "
                              "with a letter",
                              what, text, id_characters_max));
    return text;
}

std::vector<TextFinding> FormReader::all_findings() {
    std::ranges::stable_sort(findings_, [](const TextFinding& a, const TextFinding& b) {
        return std::pair{a.mark.line, a.mark.column} < std::pair{b.mark.line, b.mark.column};
    });
    if (findings_.size() > findings_max) {
        const auto more = findings_.size() - findings_max;
        findings_.resize(findings_max);
        add(findings_.back().mark, fmt::format("{} more faults follow", more));
    }
    return std::move(findings_);
}

}  // namespace aeolis::server::procedures
