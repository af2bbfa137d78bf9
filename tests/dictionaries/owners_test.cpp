// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/spreadsheet/owners.hpp"
#include "tests/support/planted.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <algorithm>

namespace dictionaries_owners_test {

using namespace aeolis;
using aeolis::tests::Planted;

TEST_CASE("a second owner and a missing one are refused, by file and line", "[dictionary][R5]") {
    static const std::vector<Planted> all{
        {"second owner of an action", "owners.csv", "action,fire_parachute_mortar,pyro,",
         "action,fire_heatshield_separation,pyro,\naction,fire_parachute_mortar,pyro,",
         "has an owner already, in line ", 4},
        {"second owner of a device", "owners.csv", "device,nvm,edl_comm", "device,tone,edl_comm",
         "device 'tone': has an owner already, in line "},
        {"second owner of a decision", "owners.csv", "decision,touchdown,edl", "decision,do_edl,command_dispatcher",
         "decision 'do_edl': has an owner already, in line "},
        {"an action that no timepoint has", "owners.csv", "action,stop_uhf,", "action,stop_uhf_again,",
         "no timepoint has an action of that name"},
        {"a decision that is none", "owners.csv", "decision,touchdown,", "decision,touchup,",
         "is no label of the enumeration 'Decision'"},
        {"unknown kind", "owners.csv", "device,nvm,", "devise,nvm,",
         "kind 'devise' is none of action, device, decision"},
        {"module no name", "owners.csv", "action,stop_uhf,telecom", "action,stop_uhf,", "module"},
    };
    for (const Planted& planted : all) tests::check_planted(planted);
}

TEST_CASE("what has no owner is named", "[dictionary][R5]") {
    for (const auto& [row, message] : {std::pair{"action,stop_uhf,telecom,\n", "action 'stop_uhf' has no owner"},
                                       std::pair{"decision,touchdown,edl,\n", "decision 'touchdown' has no owner"}}) {
        const tests::MissionCopy mission;
        std::string text = mission.text("owners.csv");
        const auto at = text.find(row);
        REQUIRE(at != std::string::npos);
        text.erase(at, std::string_view{row}.size());
        mission.write("owners.csv", text);
        const auto loaded = mission.load();
        REQUIRE(loaded.findings.size() == 1);
        CHECK(loaded.findings.front().file == "owners.csv");
        CHECK(loaded.findings.front().line == tests::line_at(text, text.size() - 1));
        CHECK(loaded.findings.front().message == message);
    }
}

TEST_CASE("each action of the timeline, each device and each decision has one owner in the shipped dictionary",
          "[dictionary][R5]") {
    const auto& dictionary = tests::shipped_dictionary();
    using Kind = dictionary::OwnerRow::Kind;
    for (const auto& timepoint : dictionary.timeline) {
        if (timepoint.action.empty()) continue;
        CHECK(std::ranges::count_if(dictionary.owners, [&](const auto& row) {
                  return row.kind == Kind::action && row.name == timepoint.action;
              }) == 1);
    }
    CHECK(std::ranges::count(dictionary.owners, Kind::device, &dictionary::OwnerRow::kind) > 10);
    CHECK(std::ranges::count(dictionary.owners, Kind::decision, &dictionary::OwnerRow::kind) > 20);
}

}  // namespace dictionaries_owners_test
