// SPDX-License-Identifier: Apache-2.0
#include "server/procedures/call_list.hpp"

#include "server/instruction/plan_library.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"
#include "tests/support/temporary_folder.hpp"

#include <algorithm>
#include <fstream>

namespace server_procedures_call_list_test {

using namespace aeolis;
using namespace aeolis::server;
using procedures::read_calls;

namespace {

constexpr const char* head = "calls: c\nsource: S\nread_back_s: 20\nlist:\n";

std::string findings(const std::string& list, const std::string& before = head) {
    const auto read = read_calls(before + list, "c.yaml");
    CHECK(read.calls.has_value() == read.findings.empty());
    std::string all;
    for (const auto& finding : read.findings) all += (all.empty() ? "" : "\n") + finding.text();
    return all;
}

}  // namespace

TEST_CASE("standard calls are read with their keys, and with what some of them ask for", "[calls][R59]") {
    const auto read = read_calls(std::string{head} + "  - {call: a, key: p, says: Parachute seen}\n"
                                                     "  - {call: b, key: 7, says: Tone heard, asks: which tone}\n",
                                 "c.yaml");
    REQUIRE(read.calls);
    CHECK(read.calls->read_back_s == 20.0);
    REQUIRE(read.calls->calls.size() == 2);
    CHECK(read.calls->calls[1].key == '7');
    CHECK(read.calls->calls[1].asks == "which tone");
    REQUIRE(read.calls->call("a") != nullptr);
    CHECK(read.calls->call("a")->says == "Parachute seen");
    CHECK(read.calls->call("c") == nullptr);
}

TEST_CASE("a list of calls that breaks a rule is refused with each fault, by line and column", "[calls][R59]") {
    const std::string good = "  - {call: a, key: p, says: Parachute seen}\n";
    CHECK(findings(good).empty());
    CHECK(findings(good + "  - {call: a, key: q, says: Other}\n").starts_with("c.yaml:6:12: "));
    CHECK(findings(good + "  - {call: b, key: p, says: Other}\n") == "c.yaml:6:20: the key 'p' is another call's, too");
    CHECK(findings(good + "  - {call: b, key: Q, says: Other}\n") ==
          "c.yaml:6:20: 'Q' is no key: a small letter or a digit");
    CHECK(findings(good + "  - {call: b, key: q, says: Parachute seen}\n") ==
          "c.yaml:6:29: another call says 'Parachute seen', too");
    CHECK(findings(good + "  - {call: b, key: q, says: " + std::string(61, 'x') + "}\n") ==
          "c.yaml:6:29: says has 61 octets, at most 60");
    CHECK_THAT(findings(good + "  - {call: b, says: Other}\n"), Catch::Contains("lacks 'key'"));
    CHECK_THAT(findings(good + "  - {call: b, key: q, says: Other, by: gnc}\n"), Catch::Contains("'by' is no part"));
    CHECK_THAT(findings(good, "calls: c\nsource: S\nlist:\n"), Catch::Contains("lacks 'read_back_s'"));
    CHECK_THAT(findings(good, "calls: d\nsource: S\nread_back_s: 20\nlist:\n"), Catch::StartsWith("c.yaml:1:"));
    CHECK(!findings("  - {call: [}\n").empty());  // no YAML
}

TEST_CASE("the calls that ship break no rule, a mission without the file has none, and a broken file says where",
          "[calls][R59]") {
    const auto& dictionary = tests::shipped_dictionary();
    const auto shipped = instruction::PlanLibrary{AEOLIS_SOURCE_DIR "/dictionaries/msl", dictionary}.calls();
    REQUIRE(shipped);
    CHECK(shipped->calls.size() >= 8);
    test::TemporaryFolder folder;
    const instruction::PlanLibrary other{folder / "", dictionary};
    REQUIRE(other.calls());
    CHECK(other.calls()->calls.empty());
    CHECK(instruction::PlanLibrary({}, dictionary).calls()->calls.empty());
    std::ofstream{folder / "calls.yaml"} << "calls: calls\n";
    REQUIRE(!other.calls());
    CHECK_THAT(other.calls().error().message, Catch::Contains("calls.yaml:1:1: ") && Catch::Contains("lacks 'list'"));
}

}  // namespace server_procedures_call_list_test
