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
        {"second owner of a device", "owners.csv", "device,nvm,edl_comm", "device,tone,edl_comm",
         "device 'tone': has an owner already, in line "},
        {"second owner of a decision", "owners.csv", "decision,touchdown,edl", "decision,command,command_dispatcher",
         "decision 'command': has an owner already, in line "},
        {"a decision that is none", "owners.csv", "decision,touchdown,", "decision,touchup,",
         "is no label of the enumeration 'Decision'"},
        {"unknown kind", "owners.csv", "device,nvm,", "devise,nvm,", "kind 'devise' is none of device, decision"},
        {"module no name", "owners.csv", "decision,touchdown,edl", "decision,touchdown,", "module"},
    };
    for (const Planted& planted : all) tests::check_planted(planted);
}

TEST_CASE("what has no owner is named", "[dictionary][R5]") {
    const tests::MissionCopy mission;
    std::string text = mission.text("owners.csv");
    const std::string_view row = "decision,touchdown,edl,\n";
    const auto at = text.find(row);
    REQUIRE(at != std::string::npos);
    text.erase(at, row.size());
    mission.write("owners.csv", text);
    const auto loaded = mission.load();
    REQUIRE(loaded.findings.size() == 1);
    CHECK(loaded.findings.front().file == "owners.csv");
    CHECK(loaded.findings.front().line == tests::line_at(text, text.size() - 1));
    CHECK(loaded.findings.front().message == "decision 'touchdown' has no owner");
}

TEST_CASE("each device and each decision has one owner in the shipped dictionary", "[dictionary][R5]") {
    const auto& dictionary = tests::shipped_dictionary();
    using Kind = dictionary::OwnerRow::Kind;
    CHECK(std::ranges::count(dictionary.owners, Kind::device, &dictionary::OwnerRow::kind) > 10);
    CHECK(std::ranges::count(dictionary.owners, Kind::decision, &dictionary::OwnerRow::kind) > 20);
}

}  // namespace dictionaries_owners_test
