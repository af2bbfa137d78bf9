// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/spreadsheet/telemetry_plan.hpp"

#include "tests/support/planted.hpp"
#include "tests/support/shipped_dictionary.hpp"

namespace dictionaries_telemetry_plan_test {

using namespace aeolis;
using aeolis::tests::Planted;

TEST_CASE("each broken rule of the telemetry plan gives one line, and nothing is loaded", "[dictionary][R30][R40]") {
    static const std::vector<Planted> all{
        {"unknown packet", "telemetry_plan.csv", "mission,Wideband,", "mission,Wideband,normal,0,0,0,0,0,\nall,Gnc,",
         "packet 'Gnc': there is no such packet", 1},
        {"packet in a plan twice", "telemetry_plan.csv", "mission,Wideband,",
         "mission,EdlStatus,high,0,0,0,0,0,\nmission,Wideband,",
         "packet 'EdlStatus': plan 'mission' has it already, in line 8"},
        {"unknown priority", "telemetry_plan.csv", "mission,Wideband,normal", "mission,Wideband,middling",
         "priority 'middling' is none of first, high, normal, low"},
        {"thinned, yet first", "telemetry_plan.csv", "ToneSelected,first,1,1", "ToneSelected,first,1,2",
         "entry 2: what goes first is never thinned"},
        {"not sent, yet first", "telemetry_plan.csv", "ToneSelected,first,1,1,1,1", "ToneSelected,first,1,1,1,0",
         "landed 0: what goes first is never thinned"},
        {"no whole number", "telemetry_plan.csv", "GncRadar,normal,0,0,1", "GncRadar,normal,0,0,1.5",
         "descent '1.5' is not a whole number from 0 to 4096"},
        {"rate left empty", "telemetry_plan.csv", "GncRadar,normal,0,0,1,", "GncRadar,normal,0,0,,",
         "descent '' is not a whole number"},
        {"no rate of recording", "telemetry_plan.csv", "GncRadar,normal,0,0,1,0,1,", "GncRadar,normal,0,0,1,0,,",
         "recorded_hz '' is not a whole number from 0 to 200"},
        {"rate too small", "telemetry_plan.csv", "GncRadar,normal,0,0,1", "GncRadar,normal,0,0,5000",
         "descent '5000' is not a whole number from 0 to 4096"},
    };
    for (const Planted& planted : all) tests::check_planted(planted);
}

TEST_CASE("each plan says what becomes of each packet, and what it leaves out is named", "[dictionary][R30]") {
    const tests::MissionCopy mission;
    std::string text = mission.text("telemetry_plan.csv");
    const std::string row = "mission,Wideband,normal,0,0,0,0,0,\n";
    text.replace(text.find(row), row.size(), "mission,GncRadar,normal,0,0,1,0,1,\n");
    const std::string all = "all,GncRadar,normal,0,0,1,0,1,\n";
    text.erase(text.find(all), all.size());
    mission.write("telemetry_plan.csv", text);
    const auto loaded = mission.load();
    INFO(tests::lines_of(loaded));
    REQUIRE(loaded.findings.size() == 2);
    CHECK(loaded.findings[0].text() == "telemetry_plan.csv:1: plan 'mission' says nothing of packet 'Wideband': add a "
                                       "row for it, with 0 where it shall only be recorded");
    CHECK(loaded.findings[1].text() == "telemetry_plan.csv:1: plan 'wideband' says nothing of packet 'GncRadar': add a "
                                       "row for it, with 0 where it shall only be recorded");
}

TEST_CASE("a sheet without a plan's name plans nothing", "[dictionary][R30]") {
    std::vector<dictionary::Finding> all;
    dictionary::Findings findings{"telemetry_plan.csv", all};
    const auto& packets = tests::shipped_dictionary().packets;
    CHECK(dictionary::read_telemetry_plan("plan,packet,priority,before_entry,entry,descent,landed,recorded_hz,"
                                          "note\nall,events,first,1,1,1,1,0,\n",
                                          &packets, findings));
    REQUIRE(all.size() == 1);
    CHECK(all.front().text() == "telemetry_plan.csv:1: no plan is named: each row says 'all'");
}

TEST_CASE("a packet that its own file has wrong is one fault, not one more for its plan", "[dictionary][R30]") {
    tests::check_planted({"unknown type", "msl.xml", "parameterTypeRef=\"EdlPhase\"", "parameterTypeRef=\"EdlFace\"",
                          "there is no type 'EdlFace'"});
}

}  // namespace dictionaries_telemetry_plan_test
