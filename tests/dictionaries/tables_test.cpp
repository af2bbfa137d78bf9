// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/spreadsheet/tables.hpp"
#include "tests/support/planted.hpp"

namespace dictionaries_tables_test {

using namespace aeolis;
using aeolis::tests::Planted;

TEST_CASE("each broken rule of the spreadsheets gives one line, and nothing is loaded", "[dictionary][R13][R20][R40]") {
    static const std::vector<Planted> all{
        // anchors
        {"cycle of anchors", "anchors.csv", "entry,root,undefined", "entry,pre_edl_end,undefined",
         "a cycle of anchors: entry -> pre_edl_end -> entry"},
        {"dangling parent", "anchors.csv", "pre_edl_end,entry,", "pre_edl_end,exit,", "there is no anchor 'exit'"},
        {"two roots", "anchors.csv", "parachute,root,undefined", "parachute,,", "has no parent"},
        {"offset of the root", "anchors.csv", "root,,,", "root,,5,", "the root stands at zero"},
        {"anchor twice", "anchors.csv", "priming,root", "backshell,root,undefined,\npriming,root",
         "is there twice, first in line 10", 2},
        {"anchor off the ticks", "anchors.csv", "-14400", "-14400.1", "-14400.1 is not a multiple of 1/64 s"},
        {"undefined has one spelling", "anchors.csv", "parachute,root,undefined", "parachute,root,nan",
         "'nan' is neither a number nor undefined"},
        {"reserved anchor name", "anchors.csv", "pre_edl_end,", "previous,", "the name means something else"},
        // timeline
        {"off the ticks", "timeline.csv", "-519.40625", "-519.4", "-519.4 is not a multiple of 1/64 s"},
        {"offset no number", "timeline.csv", "-519.40625", "soon", "'soon' is neither a number nor undefined"},
        {"offset left empty", "timeline.csv", "-519.40625", "", "'' is neither a number nor undefined"},
        {"dangling reference", "timeline.csv", "gnc_enable,entry", "gnc_enable,exit",
         "reference 'exit' is neither previous nor an anchor"},
        {"timepoint twice", "timeline.csv", "\ndetumble,", "\ngnc_enable,", "is there twice, first in line 17", 1},
        {"dangling tone", "timeline.csv", ",yes,no,touchdown,,", ",yes,no,touchup,,", "there is no tone 'touchup'"},
        {"tone of Second Chance", "timeline.csv", ",yes,no,touchdown,,", ",yes,no,sc_touchdown,,",
         "is not one of prime's"},
        {"dangling event", "timeline.csv", "GNC_ENABLED", "GNC_DISABLED", "there is no event 'GNC_DISABLED'"},
        {"event with arguments", "timeline.csv", "GNC_ENABLED", "PARACHUTE_DEPLOY", "has arguments"},
        {"action no name", "timeline.csv", "start_detumble", "start-detumble", "action has characters other"},
        {"reply without action", "timeline.csv", "start_uhf,12", ",12", "waits for a reply, but has no action"},
        {"time-out not above 0", "timeline.csv", "power_on_radar,4", "power_on_radar,0",
         "reply_timeout_s is not above 0"},
        {"dangling backtrack", "timeline.csv", "start_uhf,12,done,4,uhf_start", "start_uhf,12,done,4,uhf_begin",
         "there is no timepoint 'uhf_begin'"},
        {"backtrack forward", "timeline.csv", "vent_coolant,4,done,,descent_imu_power",
         "vent_coolant,4,done,,touchdown", "comes later"},
        {"nothing said of no reply", "timeline.csv", "start_uhf,12,done", "start_uhf,12,",
         "if_unverified does not say what holds without one"},
        {"no reply, but said what holds without one", "timeline.csv", "start_turn_to_entry,undefined,",
         "start_turn_to_entry,undefined,done", "no reply is waited for"},
        {"taken for something else", "timeline.csv", "done_unless_imu", "perhaps",
         "'perhaps' is none of done, not_done"},
        {"held after separation", "timeline.csv", "enable_thrusters,2,done,,", "enable_thrusters,2,done,1,",
         "held before separation only"},
        {"held for longer than a reply is waited for", "timeline.csv", "start_uhf,12,done,4,", "start_uhf,12,done,12,",
         "is not below reply_timeout_s"},
        {"a row that does nothing and does not say why", "timeline.csv",
         "\"Place of the bogie release, 6 s (H): the row keeps its time. The mobility system is not simulated\"", "",
         "its note does not say what it is for"},
        {"late without an anchor", "timeline.csv", "descent_imu_power,yes,no", "descent_imu_power,yes,yes",
         "timepoint 'descent_imu_power': may_be_late without an anchor: it follows the row before it"},
        {"essential neither yes nor no", "timeline.csv", "uhf_start,yes", "uhf_start,maybe",
         "'maybe' is neither yes nor no"},
        {"name a keyword", "timeline.csv", "\ndetumble,", "\nreturn,", "is a keyword of C++", 1},
        // tones
        {"tone number too large", "tones.csv", "\n255,", "\n256,", "'256' is not a whole number from 0 to 255", 1},
        {"tone number twice", "tones.csv", "\n255,", "\n254,", "the id is there twice", 1},
        {"unknown set", "tones.csv", "\n255,spare", "\n255,prim", "'prim' is none of prime", 1},
        {"supersedes nothing", "tones.csv", ",127,120,rover_separation", ",127,120,rover", "there is no tone 'rover'"},
        {"supersedes of another set", "tones.csv", ",127,120,rover_separation", ",127,120,sc_rover_separation",
         "of another set"},
        {"no expiry", "tones.csv", ",127,120,", ",127,0,", "expires_s is not above 0"},
        {"named spare", "tones.csv", "\n255,spare,,", "\n255,spare,left_over,", "a spare tone has no name", 1},
        // parameters
        // the waveform
        {"number of the waveform unknown", "mfsk.csv", "source\n", "source\nmfsk_hz,1,Hz,Text,[chosen]\n",
         "is none that the waveform has", 1},
        {"number of the waveform twice", "mfsk.csv", "source\n", "source\nsymbol_s,10,s,Text,[chosen]\n",
         "is there twice", 5},
        {"number of the waveform missing", "mfsk.csv", "symbol_s,10,s,A tone lasts this long,[facts]\n", "",
         "there is no symbol_s", -4},
        {"index in radians", "mfsk.csv", "32,deg", "0.5,rad", "is in 'rad', not in deg"},
        {"tones not orthogonal", "mfsk.csv", "spacing_hz,1,", "spacing_hz,0.05,", "the tones are not orthogonal", -3},
        {"tones on a harmonic", "mfsk.csv", "first_tone_hz,300,", "first_tone_hz,100,", "reaches the third harmonic",
         -2},
        {"no carrier left", "mfsk.csv", "32,deg", "90,deg", "no carrier is left", -5},
        {"negative frequency", "mfsk.csv", "spacing_hz,1,", "spacing_hz,-1,", "is not above 0"},
        // parameters
        {"default outside its range", "parameters.csv", "guidance_gain,5,", "guidance_gain,11,",
         "default 11 is outside 1 ... 10"},
        {"range upside down", "parameters.csv", "guidance_gain,5,1,10", "guidance_gain,5,10,1",
         "min 10 is above max 1"},
        {"no unit", "parameters.csv", "guidance_gain,5,1,10,until_gnc,1,", "guidance_gain,5,1,10,until_gnc,,",
         "has no unit"},
        {"no source", "parameters.csv", "Bridle,[facts] (H)", "Bridle,", "source is empty"},
        {"unknown time of change", "parameters.csv", "guidance_gain,5,1,10,until_gnc,", "guidance_gain,5,1,10,always,",
         "parameter 'guidance_gain': change 'always' is none of until_gnc, build"},
        {"bad number", "parameters.csv", "guidance_gain,5,", "guidance_gain,five,", "default 'five' is not a number"},
        {"parameter twice", "parameters.csv", "sufr_duration_s,", "guidance_start_drag_mps2,",
         "is there twice, first in line 43"},
        // constraints
        {"unknown timepoint", "constraints.csv", "required,coolant_vent,", "required,coolant_went,",
         "from 'coolant_went': there is no timepoint 'coolant_went'"},
        {"anchor without its suffix", "constraints.csv", "required,heatshield:anchor,", "required,heatshield,",
         "the anchor is written 'heatshield:anchor'"},
        {"unknown anchor", "constraints.csv", "required,heatshield:anchor,", "required,backshield:anchor,",
         "there is no anchor 'backshield'"},
        {"unknown moment", "constraints.csv", "required,sky_crane:triggered", "required,sky_crane:began",
         "'began' is none of triggered, fired, anchor"},
        {"unknown kind", "constraints.csv", "required,coolant_vent,", "wanted,coolant_vent,",
         "kind 'wanted' is none of required, given, ensured"},
        {"bound off the ticks", "constraints.csv", "uhf_start,20,", "uhf_start,20.1,",
         "minimum_s 20.1 is not a multiple of 1/64 s"},
        {"bound no number", "constraints.csv", "uhf_start,20,", "uhf_start,,",
         "minimum_s '' is neither a number nor undefined"},
        {"no bound", "constraints.csv", "uhf_start,20,", "uhf_start,undefined,",
         "neither minimum_s nor maximum_s bounds anything"},
        {"bounds upside down", "constraints.csv", "cruise_balance_2,0.5,1,", "cruise_balance_2,1.5,1,",
         "minimum_s 1.5 is above maximum_s 1"},
        {"from is to", "constraints.csv", "required,coolant_vent,uhf_start,", "required,uhf_start:triggered,uhf_start,",
         "from and to are the same moment"},
        {"constraint twice", "constraints.csv", "required,uhf_start,cruise_stage_separation,",
         "required,coolant_vent:fired,uhf_start:triggered,",
         "from 'coolant_vent:fired' is there twice, first in line 21"},
        {"a timepoint given", "constraints.csv", "given,do_edl,entry:anchor,", "given,do_edl,coolant_vent,",
         "only an anchor can be given"},
        {"a timepoint ensured", "constraints.csv", "ensured,engine_priming:triggered,backshell:anchor,",
         "ensured,engine_priming:triggered,backshell_separation,", "only an anchor can be given"},
        {"no source of a constraint", "constraints.csv", "uhf_start,20,undefined,[chosen],", "uhf_start,20,undefined,,",
         "source is empty"},
        // the sheet itself
        {"ragged row", "parameters.csv", "guidance_gain,5,", "guidance_gain,5,5,", "the row has 9 cells, the header 8"},
        {"open quote", "tones.csv", "\n255,spare,,Spare", "\n255,spare,,\"Spare",
         "the quote that opens here is never closed", 1},
    };
    for (const Planted& planted : all) tests::check_planted(planted);
}

TEST_CASE("a column too many is named", "[dictionary]") {
    std::vector<dictionary::Finding> all;
    dictionary::Findings findings{"anchors.csv", all};
    CHECK_FALSE(dictionary::read_anchors("name,parent,offset_s,note,Note\nroot,,,,\n", findings));
    REQUIRE(all.size() == 1);
    CHECK(all.front().text() == "anchors.csv:1: unknown column 'Note'");
}

TEST_CASE("a column that is missing is named", "[dictionary]") {
    std::vector<dictionary::Finding> all;
    dictionary::Findings findings{"anchors.csv", all};
    CHECK_FALSE(dictionary::read_anchors("name,parent,note\nroot,,\n", findings));
    REQUIRE(all.size() == 1);
    CHECK(all.front().text() == "anchors.csv:1: column 'offset_s' is missing");
}

TEST_CASE("a tone without its Second Chance twin is found", "[dictionary][R35]") {
    tests::check_planted(
        {"twin", "tones.csv", "sc_coolant_vent", "coolant_vent_again", "there is no Second Chance tone", 10 - 106});
}

TEST_CASE("anchors are put in topological order, else as in the file", "[dictionary][R12]") {
    std::vector<dictionary::Finding> all;
    dictionary::Findings findings{"anchors.csv", all};
    const auto rows = dictionary::read_anchors("name,parent,offset_s,note\n"
                                               "late,entry,60,\n"
                                               "root,,,\n"
                                               "other,root,undefined,\n"
                                               "entry,root,undefined,\n",
                                               findings);
    REQUIRE(all.empty());
    REQUIRE(rows->size() == 4);
    CHECK(rows->at(0).name == "root");
    CHECK(rows->at(0).offset_s == 0.0);
    CHECK_FALSE(rows->at(0).parent);
    CHECK(rows->at(3).name == "late");
    for (const auto& row : *rows)
        if (row.parent) CHECK(row.parent->value < row.id.value);
}

TEST_CASE("constraints are read as moments of timepoints and anchors", "[dictionary][R19]") {
    const std::vector<dictionary::AnchorRow> anchors{{AnchorId{0}, "root", {}, 0.0, ""},
                                                     {AnchorId{1}, "jump", AnchorId{0}, {}, ""}};
    std::vector<dictionary::TimelineRow> timeline(2);
    timeline[0].name = "ready";
    timeline[1].name = "jump";
    std::vector<dictionary::Finding> all;
    dictionary::Findings findings{"constraints.csv", all};
    const auto rows = dictionary::read_constraints("kind,from,to,minimum_s,maximum_s,source,note\n"
                                                   "required,ready,jump,0.5,undefined,[chosen],\n"
                                                   "given,do_edl,jump:anchor,undefined,-2,[chosen],early\n"
                                                   "required,jump:triggered,jump:fired,0,1,[chosen],\n"
                                                   "ensured,ready:triggered,jump:anchor,3,undefined,[chosen],\n",
                                                   {&timeline, &anchors}, findings);
    REQUIRE(all.empty());
    REQUIRE(rows->size() == 4);
    CHECK(rows->at(3).kind == dictionary::ConstraintRow::Kind::ensured);
    using Kind = dictionary::Moment::Kind;
    CHECK(rows->at(0).from == dictionary::Moment{Kind::fired, 0});
    CHECK(rows->at(0).to == dictionary::Moment{Kind::triggered, 1});
    CHECK(rows->at(0).minimum_s == 0.5);
    CHECK_FALSE(rows->at(0).maximum_s);
    CHECK(rows->at(1).kind == dictionary::ConstraintRow::Kind::given);
    CHECK(rows->at(1).from == dictionary::Moment{});
    CHECK(rows->at(1).to == dictionary::Moment{Kind::anchor, 1});
    CHECK(rows->at(1).maximum_s == -2.0);
    CHECK(rows->at(2).from == dictionary::Moment{Kind::triggered, 1});
    CHECK(rows->at(2).to == dictionary::Moment{Kind::fired, 1});
    CHECK(rows->at(2).line == 4);
}

TEST_CASE("a timepoint's offset counts from its neighbour or an anchor, from no other timepoint", "[timeline][R19]") {
    tests::check_planted({"another timepoint", "timeline.csv", "gnc_enable,entry,", "gnc_enable,coolant_vent,",
                          "reference 'coolant_vent' is neither previous nor an anchor"});
}

}  // namespace dictionaries_tables_test
