// SPDX-License-Identifier: Apache-2.0
#include "server/instruction/team_reader.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <functional>

namespace aeolis::server::instruction {
namespace {

using procedures::unknown_name;
using Act = Expectation::Act;

constexpr std::size_t word_least = 3;  ///< chosen
constexpr std::size_t names_max = 20;  ///< of alarms, words or commands that count alike; chosen

/// Links are a scenario's: their names are known by how they begin.
bool is_link(std::string_view name) {
    return std::ranges::any_of(std::array{"uhf", "x_band", "relay"},
                               [&](std::string_view begin) { return name.starts_with(begin); });
}

}  // namespace

std::vector<std::string> TeamReader::names(const YamlNode& node, std::string_view what) {
    std::vector<std::string> all;
    for (const YamlNode& item : list(&node, what, names_max)) all.push_back(words(item, what));
    if (node.kind == YamlNode::Kind::sequence && node.items.empty()) add(node.mark, fmt::format("{} is empty", what));
    return all;
}

double TeamReader::within_s(const YamlNode& node) {
    const YamlNode* within = node.member("within_s");
    return within == nullptr ? 0.0 : number(*within, "within_s", 1.0, within_s_max, " s").value_or(0.0);
}

std::optional<int> TeamReader::enumerator(const YamlNode& node, std::string_view what,
                                          const google::protobuf::EnumDescriptor& all, std::string_view prefix) {
    const std::string text = words(node, what);
    if (text.empty()) return std::nullopt;
    std::vector<std::string> known;
    for (int i = 1; i < all.value_count(); ++i) {  // 0 is "unspecified"
        std::string name{all.value(i)->name().substr(prefix.size())};
        std::ranges::transform(name, name.begin(), [](unsigned char letter) { return std::tolower(letter); });
        if (name == text) return all.value(i)->number();
        known.push_back(std::move(name));
    }
    add(node.mark, unknown_name(text, what, known, std::identity{}));
    return std::nullopt;
}

bool TeamReader::is_report(const std::string& name) const {
    return dictionary_.event(name) != nullptr ||
           std::ranges::find(dictionary_.tones, name, &dictionary::ToneRow::name) != dictionary_.tones.end();
}

bool TeamReader::is_alarm(const std::string& name) const {
    return dictionary_.channel(name) != nullptr || dictionary_.packet(name) != nullptr || is_link(name);
}

Expectation TeamReader::expectation(const YamlNode& node) {
    static constexpr std::array must{std::string_view{"of"}, std::string_view{"within_s"}};
    static constexpr std::array acts{std::string_view{"acknowledge"}, std::string_view{"note"},
                                     std::string_view{"command"}, std::string_view{"no_command"}};
    Expectation read;
    if (!table(node, "something that a team does", must, acts)) return read;
    read.within_s = within_s(node);
    if (const YamlNode* of = node.member("of")) {
        const std::string text = words(*of, "what is judged");
        const auto* const skill = std::ranges::find(skills, text, [](Skill each) { return name_of(each); });
        if (skill != skills.end())
            read.of = *skill;
        else if (!text.empty())
            add(of->mark, unknown_name(text, "skill", skills, [](Skill each) { return name_of(each); }));
    }
    const auto given = std::ranges::count_if(acts, [&](std::string_view act) { return node.member(act) != nullptr; });
    if (given != 1) {
        add(node.mark, "a team does one of these: acknowledge, note, command, no_command");
        return read;
    }
    const auto* const act =
        std::ranges::find_if(acts, [&](std::string_view each) { return node.member(each) != nullptr; });
    read.act = static_cast<Act>(act - acts.begin());
    const YamlNode& names_of = *node.member(*act);
    const bool any = read.act == Act::note || read.act == Act::no_command;
    if (any && names_of.kind == YamlNode::Kind::scalar && names_of.plain && names_of.text == "any") return read;
    read.names = names(names_of, fmt::format("'{}'", *act));
    for (std::size_t i = 0; i < read.names.size(); ++i) {
        const auto& name = read.names[i];
        const auto mark = names_of.items[i].mark;
        if (name.empty()) continue;
        if (read.act == Act::note) {
            if (name.size() < word_least)
                add(mark, fmt::format("'{}' stands in too many words: {} characters at least", name, word_least));
            continue;
        }
        if (read.act == Act::acknowledge && !is_alarm(name))
            add(mark, fmt::format("'{}' is no alarm: a channel, a packet or a link", name));
        if (read.act != Act::acknowledge && dictionary_.command(name) == nullptr)
            add(mark, unknown_name(name, "command of the dictionary", dictionary_.commands,
                                   [](const auto& command) -> std::string_view { return command.name; }));
    }
    return read;
}

Handling TeamReader::handling(const YamlNode& node) {
    Handling read;
    if (const YamlNode* signs = node.member("signs")) {
        read.signs = names(*signs, "'signs'");
        for (std::size_t i = 0; i < read.signs.size(); ++i)
            if (!read.signs[i].empty() && !is_alarm(read.signs[i]) && !is_report(read.signs[i]))
                add(signs->items[i].mark,
                    fmt::format("'{}' is no sign: an event, a tone, or an alarm of a channel, a packet or a link",
                                read.signs[i]));
    }
    for (const YamlNode& item : list(node.member("team"), "'team'", expectations_max))
        read.team.push_back(expectation(item));
    return read;
}

}  // namespace aeolis::server::instruction
