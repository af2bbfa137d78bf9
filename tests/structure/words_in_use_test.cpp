// SPDX-License-Identifier: Apache-2.0
#include "common/space_packet.hpp"
#include "tests/structure/source_tree.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <algorithm>
#include <regex>
#include <set>
#include <utility>

namespace structure_words_in_use_test {

using namespace aeolis::structure;

TEST_CASE("every event and every tone of prime's that the dictionary words is asked for by flight or by a row of the "
          "timeline, or is a heartbeat",
          "[structure][R48]") {
    const auto& dictionary = aeolis::tests::shipped_dictionary();
    std::string flight;
    for (const std::string& file : files_under("flight", {".cpp", ".hpp"}))
        for (const std::string& line : lines_of(file)) flight += line + '\n';
    const std::string station = text_of("telemetry/station/station_packets.hpp");
    std::string unused;
    for (const auto& event : dictionary.events) {
        if (aeolis::is_made_on_ground(dictionary.packets[event.packet].apid)) {
            if (station.find('"' + event.name + '"') == std::string::npos) unused += event.name + ' ';
            continue;
        }
        const bool by_timeline =
            std::ranges::count(dictionary.timeline, event.name, &aeolis::dictionary::TimelineRow::event) > 0;
        if (!by_timeline && flight.find("evr::" + event.name) == std::string::npos) unused += event.name + ' ';
    }
    for (const auto& tone : dictionary.tones) {
        if (tone.set != aeolis::dictionary::ToneSet::prime) continue;
        if (tone.name.starts_with(aeolis::dictionary::heartbeat_prefix)) continue;
        const bool by_timeline =
            std::ranges::any_of(dictionary.timeline, [&](const auto& row) { return row.tone == tone.id; });
        if (!by_timeline && flight.find("tone::" + tone.name) == std::string::npos) unused += tone.name + ' ';
    }
    INFO("nobody asks for " << unused);
    CHECK(unused.empty());
}

TEST_CASE("every decision, verdict and quantity of explanations that the dictionary words is named in flight's code",
          "[structure][R38][R48]") {
    const auto& dictionary = aeolis::tests::shipped_dictionary();
    std::string flight;
    for (const std::string& file : files_under("flight", {".cpp", ".hpp"}))
        for (const std::string& line : lines_of(file)) flight += line.substr(0, line.find("//")) + '\n';
    const auto named = [&](const std::string& word) {
        return std::regex_search(flight, std::regex{"\\b" + word + "\\b"});
    };
    const auto* packet = dictionary.packet("Explanation");
    REQUIRE(packet != nullptr);
    std::string unused;
    for (const auto& [field, type] : {std::pair{"decision", "Decision::"}, std::pair{"verdict", "ExplanationVerdict::"},
                                      std::pair{"condition_1", "Quantity::"}})
        for (const auto& each : packet->fields)
            if (each.name == field)
                for (const auto& entry : each.type.enumeration)
                    if (entry.label != "none" && !named(type + entry.label)) unused += type + entry.label + ' ';
    INFO("flight never names " << unused);
    CHECK(unused.empty());
}

TEST_CASE("every name of the mission in the console's layout is a word of the shipped dictionary", "[structure][R48]") {
    const auto& dictionary = aeolis::tests::shipped_dictionary();
    std::set<std::string> words;
    for (const auto& channel : dictionary.channels)
        for (const auto& value : channel.type.enumeration) words.insert(value.label);
    for (const auto& packet : dictionary.packets)
        for (const auto& field : packet.fields) words.insert(field.name);
    for (const auto& event : dictionary.events) words.insert(event.name);
    for (const auto& command : dictionary.commands) words.insert(command.name);
    for (const auto& row : dictionary.timeline) words.insert(row.name);
    for (const auto& tone : dictionary.tones) words.insert(tone.name);
    static const std::regex name{"'([A-Za-z0-9]+(?:_[A-Za-z0-9]+)+)'"};  // words of text have no underscore
    const std::string layout = text_of("web/src/layout.ts");
    std::string unknown;
    std::size_t seen = 0;
    for (std::sregex_iterator match{layout.begin(), layout.end(), name}, end; match != end; ++match, ++seen)
        if (!words.contains((*match)[1])) unknown += (*match)[1].str() + ' ';
    CHECK(seen > 70);
    INFO("the dictionary does not have " << unknown);
    CHECK(unknown.empty());
}

TEST_CASE("every name of the mission in the situation desk is a word of the shipped dictionary",
          "[structure][situation]") {
    const auto& dictionary = aeolis::tests::shipped_dictionary();
    std::set<std::string> words;
    for (const auto& event : dictionary.events) words.insert(event.name);
    for (const auto& command : dictionary.commands) words.insert(command.name);
    for (const auto& tone : dictionary.tones) words.insert(tone.name);
    for (const auto& channel : dictionary.channels) words.insert(channel.name);
    static const std::regex name{"\"([A-Za-z0-9]+(?:_[A-Za-z0-9]+)+)\""};
    const std::string desk = text_of("telemetry/situation_desk.cpp");
    std::string unknown;
    std::size_t seen = 0;
    for (std::sregex_iterator match{desk.begin(), desk.end(), name}, end; match != end; ++match, ++seen)
        if (!words.contains((*match)[1])) unknown += (*match)[1].str() + ' ';
    CHECK(seen > 30);
    INFO("the dictionary does not have " << unknown);
    CHECK(unknown.empty());
}

}  // namespace structure_words_in_use_test
