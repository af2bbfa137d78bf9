// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/dictionary.hpp"

#include "common/space_packet.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/mission_copy.hpp"

#include <algorithm>
#include <random>
#include <set>

namespace dictionaries_dictionary_test {

using namespace aeolis;
using namespace aeolis::dictionary;

namespace {

const Dictionary& msl() {
    static const Loaded loaded = load(tests::shipped_mission);
    INFO(tests::lines_of(loaded));
    REQUIRE(loaded.dictionary);
    return *loaded.dictionary;
}

}  // namespace

TEST_CASE("the shipped dictionary breaks no rule and is as large as a landing needs", "[dictionary][R20][R31][R48]") {
    const Dictionary& d = msl();
    CHECK(d.mission == "MSL");
    CHECK(d.channels.size() >= 60);
    CHECK(d.packets.size() - d.events.size() >= 12);
    CHECK(d.events.size() >= 50);
    CHECK(d.commands.size() >= 8);
    CHECK(d.timeline.size() >= 45);
    CHECK(d.tones.size() == 256);
    CHECK(d.timeline.front().name == "descent_imu_power");
    CHECK_FALSE(d.timeline.front().anchor);  // counts from "do edl"
    const auto with_alarms = std::ranges::count_if(
        d.channels, [](const Channel& c) { return !c.type.alarms.ranges.empty() || !c.type.alarms.values.empty(); });
    CHECK(with_alarms >= 12);
}

TEST_CASE("channels, commands, events and packets are found by their names", "[dictionary]") {
    const Dictionary& d = msl();
    REQUIRE(d.channel("altitude_m"));
    CHECK(d.channel("altitude_m") == d.channel(d.channel("altitude_m")->alias));
    CHECK(d.channel("altitude_m") == &d.channels[d.channel("altitude_m")->id.value]);
    REQUIRE(d.command("EDL_DO_EDL"));
    CHECK(d.command("EDL_DO_EDL") == d.command(Opcode{0x0103}));
    REQUIRE(d.event("TOUCHDOWN"));
    CHECK(d.event("TOUCHDOWN") == d.event(d.event("TOUCHDOWN")->id));
    CHECK(d.packets[d.event("TOUCHDOWN")->packet].name == "TOUCHDOWN");
    REQUIRE(d.packet("GncNavigation"));
    CHECK(d.packet("GncNavigation")->apid == Apid{0x020});
    CHECK(d.channel("no_such") == nullptr);
    CHECK(d.command("NO_SUCH") == nullptr);
    CHECK(d.event(EvrId{65535}) == nullptr);
    CHECK(d.packet("NoSuch") == nullptr);
}

TEST_CASE("every event that the landing's report names is an event on board", "[dictionary][R48]") {
    for (const char* name : {"CRUISE_STAGE_SEPARATION",
                             "ENTRY_INTERFACE",
                             "GUIDANCE_START",
                             "BANK_REVERSAL",
                             "PEAK_DECELERATION",
                             "HEADING_ALIGNMENT",
                             "SUFR_START",
                             "PARACHUTE_DEPLOY",
                             "HEATSHIELD_SEPARATION",
                             "RADAR_LOCK",
                             "ENGINE_PRIMING",
                             "BACKSHELL_SEPARATION",
                             "POWERED_APPROACH_START",
                             "CONSTANT_VELOCITY_START",
                             "CONSTANT_DECELERATION_START",
                             "SKY_CRANE_START",
                             "ROVER_SEPARATION",
                             "TOUCHDOWN",
                             "BRIDLE_CUT",
                             "FLYAWAY_END"}) {
        INFO(name);
        CHECK(msl().event(name));
    }
}

TEST_CASE("fields lie between the headers and the CRC, none on another", "[dictionary]") {
    for (const Packet& packet : msl().packets) {
        INFO(packet.name);
        std::set<unsigned> used;
        unsigned bits = 0;
        const auto claim = [&](unsigned position, unsigned count) {
            for (unsigned bit = position; bit < position + count; ++bit) used.insert(bit);
            bits += count;
        };
        std::set<unsigned> flags;  // fields that are defined together share one
        for (const Field& field : packet.fields) {
            claim(field.position_bits, field.type.bits);
            if (field.validity_bit && flags.insert(*field.validity_bit).second) claim(*field.validity_bit, 1);
        }
        CHECK(used.size() == bits);
        if (!used.empty()) {
            CHECK(*used.begin() >= tm_data_offset_octets * 8);
            CHECK(*used.rbegin() < (packet.octets - packet_crc_octets) * 8);
        }
        CHECK(packet.octets <= packet_octets_max);
    }
}

TEST_CASE("parameters read back as they were commanded, field by field and bit by bit", "[dictionary][R48]") {
    const Command& sent = *msl().command("EDL_SET_PARAMETERS");
    const Packet& held = *msl().packet("ParametersHeld");
    REQUIRE(sent.arguments.size() == held.fields.size());
    for (std::size_t i = 0; i < sent.arguments.size(); ++i) {
        const Argument& argument = sent.arguments[i];
        const Field& field = held.fields[i];
        INFO(argument.name);
        CHECK(argument.name == field.name);
        CHECK(argument.type.encoding == field.type.encoding);
        CHECK(argument.type.bits == field.type.bits);
        CHECK(argument.type.unit == field.type.unit);
        CHECK(argument.position_bits + tm_data_offset_octets * 8 == field.position_bits);
    }
}

TEST_CASE("a command is preceded and followed by what its author asks for", "[dictionary][R23]") {
    const Command& begin = *msl().command("EDL_DO_EDL");
    CHECK(begin.significance == Significance::critical);
    REQUIRE(begin.preconditions.size() == 3);
    CHECK(begin.preconditions[0].channel == msl().channel("parameters_received")->id);
    CHECK(begin.preconditions[0].value == 1.0);
    CHECK(begin.preconditions[2].value == 0.0);
    REQUIRE(begin.verifiers.size() == 2);
    CHECK(begin.verifiers[0].stage == "accepted");
    CHECK(begin.verifiers[0].event == msl().event("COMMAND_ACCEPTED")->id);
    CHECK(begin.verifiers[0].failure_event == msl().event("COMMAND_REFUSED")->id);
    CHECK(begin.verifiers[1].stage == "executed");
    CHECK(begin.verifiers[1].window_s == 20.0);
}

TEST_CASE("any change of any file on board changes the dictionary's id", "[dictionary][R20]") {
    std::set<std::uint16_t> ids{msl().id};
    for (const char* file : {"msl.xml", "timeline.csv", "anchors.csv", "tones.csv", "mfsk.csv", "parameters.csv",
                             "constraints.csv", "state_machines.csv", "owners.csv", "telemetry_plan.csv"}) {
        INFO(file);
        const tests::MissionCopy mission;
        mission.write(file, mission.text(file) + "\n");
        const Loaded loaded = mission.load();
        REQUIRE(loaded.dictionary);
        CHECK(ids.insert(loaded.dictionary->id).second);
        CHECK(loaded.dictionary->timeline_version == msl().timeline_version);  // an empty line is no content
    }
}

TEST_CASE("the timeline's version is of what its sheets hold: any cell changes it, line ends and quotes do not",
          "[dictionary][R20]") {
    const tests::MissionCopy mission;
    const std::string text = mission.text("timeline.csv");
    const auto version_of = [&](const std::string& changed) {
        mission.write("timeline.csv", changed);
        const Loaded loaded = mission.load();
        INFO(tests::lines_of(loaded));
        REQUIRE(loaded.dictionary);
        return loaded.dictionary->timeline_version;
    };
    const auto replaced = [&](std::string_view from, std::string_view to) {
        std::string changed = text;
        changed.replace(changed.find(from), from.size(), to);
        return changed;
    };
    std::string line_ends;
    for (const char c : text) line_ends += c == '\n' ? std::string{"\r\n"} : std::string{c};
    CHECK(version_of(line_ends) == msl().timeline_version);
    CHECK(version_of(replaced(",vent_coolant,", ",\"vent_coolant\",")) == msl().timeline_version);
    CHECK(version_of(replaced("Design time (M)", "Design time (L)")) != msl().timeline_version);
    // Every number one larger, where the sheet allows it: all versions differ.
    std::set<std::uint32_t> versions{msl().timeline_version};
    std::size_t tried = 0;
    for (std::size_t at = text.find(",entry,-"); at != std::string::npos; at = text.find(",entry,-", at + 1)) {
        std::string changed = text;
        changed.insert(at + 8, "1");
        versions.insert(version_of(changed));
        ++tried;
    }
    CHECK(tried >= 8);
    CHECK(versions.size() == tried + 1);
    std::string anchors = mission.text("anchors.csv");
    mission.write("anchors.csv", anchors.replace(anchors.find("-14400"), 6, "-14401"));
    CHECK(version_of(text) != msl().timeline_version);
}

TEST_CASE("a change of constraints.csv, which flight checks and does not act on, changes the id and not the version",
          "[dictionary][R19][R20][R39]") {
    const tests::MissionCopy mission;
    std::string text = mission.text("constraints.csv");
    text.resize(text.rfind('\n', text.size() - 2) + 1);
    mission.write("constraints.csv", text);
    const Loaded loaded = mission.load();
    REQUIRE(loaded.dictionary);
    CHECK(loaded.dictionary->constraints.size() == msl().constraints.size() - 1);
    CHECK(loaded.dictionary->id != msl().id);
    CHECK(loaded.dictionary->timeline_version == msl().timeline_version);
}

TEST_CASE("a mission with a file missing, or none at all, says so", "[dictionary]") {
    for (const char* file : {"msl.xml", "timeline.csv", "anchors.csv", "tones.csv", "mfsk.csv", "parameters.csv",
                             "constraints.csv", "state_machines.csv", "owners.csv", "telemetry_plan.csv"}) {
        const tests::MissionCopy mission;
        std::filesystem::remove(mission.path() / file);
        const Loaded loaded = mission.load();
        INFO(file << "\n" << tests::lines_of(loaded));
        CHECK_FALSE(loaded.dictionary);
        CHECK(loaded.findings.size() == 1);
    }
    CHECK(load("/no/such/folder").findings.size() == 12);
}

TEST_CASE("a damaged file never brings the loader down", "[dictionary][fuzz]") {
    std::mt19937 random{20120806};
    const tests::MissionCopy mission;
    for (const char* file : {"msl.xml", "timeline.csv", "anchors.csv", "tones.csv", "mfsk.csv", "parameters.csv",
                             "constraints.csv", "state_machines.csv", "owners.csv", "telemetry_plan.csv"}) {
        const std::string sound = mission.text(file);
        for (int trial = 0; trial < 30; ++trial) {  // the fuzzers try for longer
            std::string text = sound;
            const auto somewhere = [&] { return random() % text.size(); };
            if (trial % 3 == 0) {
                text.resize(somewhere());
            } else {
                for (unsigned changes = 1 + random() % 8; changes > 0; --changes) {
                    const std::size_t at = somewhere();
                    switch (random() % 4) {
                    case 0: text[at] = static_cast<char>(random()); break;
                    case 1: text.erase(at, random() % 200); break;
                    case 2: text.insert(at, text.substr(somewhere(), random() % 200)); break;
                    default: text[at] = "\"<>,&/0-"[random() % 8]; break;
                    }
                    if (text.empty()) break;
                }
            }
            mission.write(file, text);
            const Loaded loaded = mission.load();
            CHECK(loaded.dictionary.has_value() == loaded.findings.empty());
            for (const Finding& finding : loaded.findings) CHECK(finding.line >= 1);
        }
        mission.write(file, sound);
    }
}

TEST_CASE("what a computer says of itself has the same fields for both, in order, and other channels",
          "[dictionary][R29]") {
    for (const std::string name : {"CommStatus", "SyncStatus"}) {
        const auto& a = *msl().packet(name);
        const auto& b = *msl().packet(name + "B");
        INFO(name);
        CHECK(a.octets == b.octets);
        REQUIRE(a.fields.size() == b.fields.size());
        for (std::size_t i = 0; i < a.fields.size(); ++i) {
            CHECK(b.fields[i].name == a.fields[i].name + "_b");
            CHECK(b.fields[i].type.name == a.fields[i].type.name);
            CHECK(b.fields[i].position_bits == a.fields[i].position_bits);
            CHECK(b.fields[i].channel != a.fields[i].channel);
        }
    }
}

}  // namespace dictionaries_dictionary_test
