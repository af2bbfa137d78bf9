// SPDX-License-Identifier: Apache-2.0
#include "server/scenario/scenario_library.hpp"
#include "server/scenario/scenario_text.hpp"
#include "tests/support/catch.hpp"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <functional>
#include <unistd.h>

namespace server_scenario_text_test {

using namespace aeolis;
using namespace aeolis::server;

namespace {

const std::string least = "name: \"x\" entry_scet: \"2012-08-06T05:10:47.4\"\n";

std::string error_of(const std::string& text) {
    const auto scenario = scenario_from_text(text, "s.textproto");
    REQUIRE_FALSE(scenario);
    return scenario.error().message;
}

}  // namespace

TEST_CASE("a scenario of the least text has the defaults of the simulation", "[scenario]") {
    const auto scenario = scenario_from_text(least, "s.textproto");
    REQUIRE(scenario);
    const simulation::Scenario usual;
    CHECK(scenario->entry.speed_mps == usual.entry.speed_mps);
    CHECK(scenario->masses.rover_kg == usual.masses.rover_kg);
    CHECK(scenario->radio.uhf_rate_bps == usual.radio.uhf_rate_bps);
    CHECK(scenario->entry_scet == *scet_from_text("2012-219T05:10:47.4"));
}

TEST_CASE("a wrong scenario text is told with file, line and column", "[scenario]") {
    CHECK(error_of(least + "entry { sped_mps: 3 }") ==
          "s.textproto:2:17: Message type \"aeolis.v1.EntryState\" has no field named \"sped_mps\".");
    CHECK_THAT(error_of(least + "\nstart_before_entry_s: much"), Catch::StartsWith("s.textproto:3:23: "));
    CHECK_THAT(error_of(least + "entry {"), Catch::StartsWith("s.textproto:2:8: "));
    CHECK_THAT(error_of("name: \"a\" name: \"b\""), Catch::StartsWith("s.textproto:1:"));
}

TEST_CASE("an impossible value is told with file and field", "[scenario]") {
    CHECK_THAT(error_of(least + "entry { speed_mps: -3 }"), Catch::StartsWith("s.textproto: entry.speed_mps: -3"));
    CHECK(error_of(least + "masses { rover_kg: nan }") == "s.textproto: masses.rover_kg: nan is not a finite number");
    CHECK(error_of(least + "density_scale { scale: 1 } density_scale { scale: inf }") ==
          "s.textproto: density_scale[1].scale: inf is not a finite number");
    CHECK(error_of("entry_scet: \"2012-08-06T05:10:47.4\"") == "s.textproto: name: missing");
    CHECK(error_of("name: \"x\"") == "s.textproto: entry_scet: missing");
    CHECK_THAT(error_of("name: \"x\" entry_scet: \"yesterday\""),
               Catch::StartsWith("s.textproto: entry_scet: 'yesterday' is"));
    CHECK(error_of(least + "entry_sclk: 397501715.01") ==
          "s.textproto: entry_sclk: 397501715.01 is not a multiple of 1/64 s");
}

TEST_CASE("each impossible value has a line of its own", "[scenario]") {
    const auto text = error_of(least + "entry { speed_mps: -3 } masses { rover_kg: -1 }");
    CHECK(std::count(text.begin(), text.end(), '\n') >= 1);
    CHECK_THAT(text, Catch::Contains("\ns.textproto: "));
}

TEST_CASE("every field of the message reaches the simulation and comes back", "[scenario][R48]") {
    v1::Scenario message;
    // Each number of the schema is moved off its default by a little, so that one that were not carried would show.
    const auto whole = scenario_to_message(*scenario_from_text(least, "s"));
    auto moved = whole;
    moved.add_density_scale()->set_altitude_m(5000.0);
    moved.mutable_density_scale(0)->set_scale(1.25);
    moved.mutable_radio()->set_light_time_s(828.0);
    moved.mutable_radio()->set_uhf_loss_fraction(0.01);
    moved.mutable_triggers()->set_parachute_speed_mps(400.0);
    moved.mutable_triggers()->set_heatshield_speed_mps(140.0);
    moved.mutable_triggers()->set_backshell_altitude_m(1700.0);
    moved.set_telemetry_plan(v1::TELEMETRY_PLAN_WIDEBAND);
    moved.set_steady_wind_east_mps(3.0);
    auto& command = *moved.add_commands();
    command.set_command("NO_OP");
    command.set_send_before_entry_s(100.0);
    command.set_from_solution(true);
    auto& argument = *command.add_arguments();
    argument.set_name("x");
    argument.set_value(2.0);
    const auto scenario = scenario_from_message(moved);
    REQUIRE(scenario);
    CHECK(scenario_to_message(*scenario).SerializeAsString() == moved.SerializeAsString());
    const auto again = scenario_from_text(scenario_to_text(*scenario), "again");
    REQUIRE(again);
    CHECK(scenario_to_message(*again).SerializeAsString() == moved.SerializeAsString());
}

TEST_CASE("no number of the schema is left out on the way to the simulation", "[scenario][R48]") {
    // What is left open is not written: that is a choice of its own.
    const auto whole = scenario_to_message(*scenario_from_text(
        least + "ground_flight: true radio { tones_from_samples: false earth_set_after_entry_s: 299 } believed {}",
        "s"));
    const std::function<void(const google::protobuf::Message&, const std::string&)> check =
        [&](const google::protobuf::Message& message, const std::string& name) {
            const auto* descriptor = message.GetDescriptor();
            for (int i = 0; i < descriptor->field_count(); ++i) {
                const auto* field = descriptor->field(i);
                if (field->is_repeated()) continue;
                INFO(name << field->name());
                if (field->has_presence()) CHECK(message.GetReflection()->HasField(message, field));
                if (field->cpp_type() == google::protobuf::FieldDescriptor::CPPTYPE_MESSAGE)
                    check(message.GetReflection()->GetMessage(message, field), name + field->name() + ".");
            }
        };
    check(whole, "");
}

TEST_CASE("what is believed begins as the truth, and keeps what it says itself", "[scenario][believed]") {
    const auto scenario = scenario_from_text(
        least + "masses { rover_kg: 900 } steady_wind_east_mps: 4 density_scale { altitude_m: 0 scale: 1.1 } "
                "aero_scale { mach: 5 drag: 1.02 } engines { least_thrust_N: 40 } guidance { divert_m: 320 } "
                "believed { masses { propellant_kg: 380 } aero_scale { mach: 5 lift: 0.9 } gravity_fraction: 0.001 }",
        "s");
    INFO((scenario ? "" : scenario.error().message));
    REQUIRE(scenario);
    REQUIRE(scenario->believed);
    const auto& belief = *scenario->believed;
    CHECK(belief.masses.rover_kg == 900.0);
    CHECK(belief.masses.propellant_kg == 380.0);
    CHECK(belief.steady_wind_east_mps == 4.0);
    REQUIRE(belief.density_scale.size() == 1);
    CHECK(belief.density_scale[0].scale == 1.1);
    REQUIRE(belief.aero_scale.size() == 1);
    CHECK(belief.aero_scale[0].drag == 1.0);
    CHECK(belief.aero_scale[0].lift == 0.9);
    CHECK(belief.gravity_fraction == 0.001);
    CHECK(scenario->aero_scale[0].drag == 1.02);
    CHECK(scenario->engines.least_thrust_N == 40.0);
    CHECK(scenario->guidance.divert_m == 320.0);
    const auto again = scenario_from_text(scenario_to_text(*scenario), "again");
    REQUIRE(again);
    CHECK(scenario_to_text(*again) == scenario_to_text(*scenario));
    CHECK_THAT(error_of(least + "believed { masses { entry_kg: 3500 } }"),
               Catch::Contains("believed.masses.entry_kg: 3500 is not the sum of its parts"));
    CHECK_FALSE(scenario_from_text(least, "s")->believed);
}

TEST_CASE("air and winds are believed as they are, or by tables of their own", "[scenario][believed]") {
    const auto air = [](const std::string& density) {
        return "air { altitude_m: 0 temperature_K: 210 density_kgm3: " + density +
               " } air { altitude_m: 100000 temperature_K: 140 density_kgm3: 1e-7 } ";
    };
    const auto scenario = scenario_from_text(least + air("0.02") +
                                                 "winds { altitude_m: 0 east_mps: 5 } winds { altitude_m: 9000 "
                                                 "east_mps: 9 } density_scale { altitude_m: 0 scale: 1.1 } " +
                                                 "believed { " + air("0.015") + "}",
                                             "s");
    INFO((scenario ? "" : scenario.error().message));
    REQUIRE(scenario);
    REQUIRE(scenario->believed);
    const auto world = aeolis::simulation::as_believed(*scenario);
    CHECK(scenario->air.at(0).density_kgm3 == 0.02);
    CHECK(world.air.at(0).density_kgm3 == 0.015);
    CHECK(world.density_scale.empty());  // it scaled the other air
    CHECK(world.winds.at(0).east_mps == 5.0);
    CHECK(scenario_to_text(*scenario_from_text(scenario_to_text(*scenario), "again")) == scenario_to_text(*scenario));
    CHECK_THAT(error_of(least + "believed { " + air("2") + "}"), Catch::Contains("believed.air[0].density_kgm3: 2"));
    CHECK_THAT(error_of(least + "believed { air_table: 'x.txt' }"),
               Catch::Contains("believed.air_table: only a file can name another"));
}

TEST_CASE("the parameters of a vehicle are read by name, and one that flight could not have is refused",
          "[scenario][parameters]") {
    const auto scenario = scenario_from_text(
        least + "parameters { name: 'parachute_range_m' value: 9000 } parameters { name: 'guidance_gain' value: 4 }",
        "s");
    INFO((scenario ? "" : scenario.error().message));
    REQUIRE(scenario);
    CHECK(scenario->parameters.parachute_range_m == 9000.0);
    CHECK(scenario->parameters.guidance_gain == 4.0);
    CHECK(scenario->parameters.sufr_lead_s == aeolis::flight::Parameters{}.sufr_lead_s);
    const auto again = scenario_from_text(scenario_to_text(*scenario), "again");
    REQUIRE(again);
    CHECK(again->parameters == scenario->parameters);
    CHECK_THAT(error_of(least + "parameters { name: 'parachute_rang_m' value: 9 }"),
               Catch::Contains("parameters[0].name: parameters.csv has no parameter 'parachute_rang_m'"));
    CHECK_THAT(error_of(least + "parameters { name: 'do_edl_margin_s' value: 9 }"),
               Catch::Contains("parameters[0].name: do_edl_margin_s is fixed when flight is built"));
    CHECK_THAT(error_of(least + "parameters { name: 'guidance_gain' value: 99 }"),
               Catch::Contains("parameters[0].value: guidance_gain 99 is outside 1 … 10"));
    CHECK_THAT(error_of(least + "parameters { name: 'guidance_gain' value: 4 } "
                                "parameters { name: 'guidance_gain' value: 4 }"),
               Catch::Contains("parameters[1].name: guidance_gain is named twice"));
    CHECK_THAT(error_of(least + "parameters { name: 'guidance_gain' value: nan }"), Catch::Contains("parameters"));
    CHECK_THAT(error_of(least + "guidance { reference_held_to_mps: 900 }"),
               Catch::Contains("guidance.reference_held_to_mps: 900 lies below guidance.reference_up_mps, 980"));
}

TEST_CASE("faults of air and sensors are read, written and read again, and one that cannot be is refused",
          "[scenario]") {
    const auto scenario = scenario_from_text(
        least + "air_shifts { begin_before_entry_s: -60 duration_s: 10 fraction: -0.1 } sensor_errors { device: "
                "DEVICE_RADAR unit: REDUNDANT_UNIT_B begin_before_entry_s: -300 duration_s: 20 grows_per_s: 0.02 } "
                "false_tones { begin_before_entry_s: 9 duration_s: 20 tone: 200 }",
        "s");
    INFO((scenario ? "" : scenario.error().message));
    REQUIRE(scenario);
    REQUIRE(scenario->sensor_errors.size() == 1);
    CHECK(scenario->sensor_errors[0].device == flight::Device::radar);
    CHECK(scenario->sensor_errors[0].unit == flight::Unit::b);
    CHECK(scenario->sensor_errors[0].grows_per_s == 0.02);
    CHECK(scenario->air_shifts.at(0).fraction == -0.1);
    CHECK(scenario->false_tones.at(0).tone == aeolis::ToneId{200});
    CHECK_THAT(error_of(least + "false_tones { duration_s: 3 tone: 256 }"),
               Catch::Contains("false_tones[0].tone: 256 is no id of a tone"));
    CHECK(scenario_to_text(*scenario_from_text(scenario_to_text(*scenario), "again")) == scenario_to_text(*scenario));
    CHECK_THAT(error_of(least + "sensor_errors { unit: REDUNDANT_UNIT_A duration_s: 3 }"),
               Catch::Contains("sensor_errors[0].device: missing"));
    CHECK_THAT(error_of(least + "sensor_errors { device: DEVICE_UHF unit: REDUNDANT_UNIT_A duration_s: 3 }"),
               Catch::Contains("sensor_errors[0].device: only the IMU and the radar"));
    CHECK_THAT(error_of(least + "air_shifts { duration_s: 3 fraction: 7 }"),
               Catch::Contains("air_shifts[0].fraction: 7"));
}

TEST_CASE("a scenario file that cannot be read is named", "[scenario]") {
    CHECK(scenario_from_file("/nowhere/x.textproto").error().message == "/nowhere/x.textproto: cannot be opened");
    CHECK(scenario_from_file("/tmp").error().message == "/tmp: is a directory, not a scenario");
}

TEST_CASE("a scenario file may be like another: what it sets counts, its lists replace", "[scenario]") {
    const auto folder = std::filesystem::temp_directory_path() / fmt::format("aeolis_like_{}", ::getpid());
    std::filesystem::create_directories(folder);
    const auto file = [&](const std::string& name, const std::string& text) {
        std::ofstream{folder / (name + ".textproto")} << text;
        return scenario_from_file(folder / (name + ".textproto"));
    };
    REQUIRE(file("base", least + "radio { light_time_s: 5 uhf_rate_bps: 9000 } system_faults { begin_before_entry_s: 9 "
                                 "duration_s: 1 }"));
    const auto like =
        file("other", "name: \"other\" like: \"base\" test_venue: TEST_VENUE_ALL_BUT_GNC radio { light_time_s: 7 } "
                      "system_faults { begin_before_entry_s: 3 duration_s: 1 }");
    REQUIRE(like);
    CHECK(like->name == "other");
    CHECK(like->radio.light_time_s == 7.0);
    CHECK(like->radio.uhf_rate_bps == 9000.0);
    CHECK(like->test_venue == simulation::TestVenue::all_but_gnc);
    REQUIRE(like->system_faults.size() == 1);
    CHECK(like->system_faults[0].begin_before_entry_s == 3.0);
    const auto third = file("third", "name: \"third\" like: \"other\"");
    CHECK(third->radio.light_time_s == 7.0);
    CHECK(third->system_faults.size() == 1);
    // A list within a message, too.
    REQUIRE(file("passes",
                 "name: \"passes\" like: \"base\" radio { tone_outages { name: \"a\" event: \"sufr\" from_s: 1 "
                 "to_s: 2 } }"));
    const auto fourth = file("fourth", "name: \"fourth\" like: \"passes\" radio { tone_outages { name: \"b\" event: "
                                       "\"sufr\" from_s: 3 to_s: 4 } }");
    REQUIRE(fourth);
    REQUIRE(fourth->radio.tone_outages.size() == 1);
    CHECK(fourth->radio.tone_outages[0].from_s == 3.0);

    CHECK_THAT(file("nameless", "like: \"base\"").error().message, Catch::EndsWith("name: missing"));
    CHECK_THAT(file("lost", "name: \"l\" like: \"nobody\"").error().message, Catch::EndsWith("cannot be opened"));
    CHECK_THAT(file("path", "name: \"p\" like: \"../x\"").error().message, Catch::Contains("is a path"));
    CHECK_THAT(file("round", "name: \"r\" like: \"round\"").error().message, Catch::Contains("is it a circle?"));
    CHECK(error_of(least + "like: \"base\"") == "s.textproto: like: only a file can be like another");
    std::filesystem::remove_all(folder);
}

TEST_CASE("the scenarios that ship can be flown, and a wrong name is told the right ones", "[scenario]") {
    const ScenarioLibrary library{AEOLIS_SOURCE_DIR "/simulation/scenarios"};
    const auto list = library.list();
    std::vector<std::string> names;
    for (const auto& entry : list.scenarios()) {
        names.push_back(entry.name());
        CHECK_FALSE(entry.title().empty());
        CHECK(library.scenario(entry.name())->name == entry.name());
    }
    CHECK_THAT(names, Catch::VectorContains(std::string{"nominal"}));
    CHECK_THAT(names, Catch::VectorContains(std::string{"nominal_auto"}));
    CHECK_THAT(names, Catch::VectorContains(std::string{"bench_wideband"}));
    CHECK_THAT(library.scenario("../scenarios/nominal").error().message, Catch::Contains("there are: "));
}

TEST_CASE("device faults are read by device, unit and kind, and come back as written", "[scenario][R2]") {
    const auto scenario = scenario_from_text(least + R"(
        device_faults { device: DEVICE_PYRO unit: REDUNDANT_UNIT_B kind: DEVICE_FAULT_KIND_SILENT
                        begin_before_entry_s: 900 duration_s: 60 }
        device_faults { device: DEVICE_UHF unit: REDUNDANT_UNIT_A kind: DEVICE_FAULT_KIND_LATE
                        begin_before_entry_s: 800 duration_s: 10 late_s: 7 }
        bus_message_error_fraction: 0.01)",
                                             "s.textproto");
    REQUIRE(scenario);
    REQUIRE(scenario->device_faults.size() == 2);
    CHECK(scenario->device_faults[0].device == flight::Device::pyro);
    CHECK(scenario->device_faults[0].unit == flight::Unit::b);
    CHECK(scenario->device_faults[0].kind == simulation::DeviceFault::Kind::silent);
    CHECK(scenario->device_faults[1].late_s == 7.0);
    CHECK(scenario->bus_message_error_fraction == 0.01);
    const auto again = scenario_from_text(scenario_to_text(*scenario), "again");
    REQUIRE(again);
    CHECK(again->device_faults.size() == 2);
    CHECK(again->device_faults[1].device == flight::Device::uhf);
    CHECK(again->device_faults[1].begin_before_entry_s == 800.0);
}

TEST_CASE("a device fault without device, unit or kind, or one that the device cannot have, is refused by its field",
          "[scenario]") {
    CHECK(error_of(least + "device_faults { unit: REDUNDANT_UNIT_A kind: DEVICE_FAULT_KIND_SILENT duration_s: 1 }") ==
          "s.textproto: device_faults[0].device: missing");
    CHECK_THAT(error_of(least + "device_faults { device: DEVICE_PYRO unit: REDUNDANT_UNIT_A "
                                "kind: DEVICE_FAULT_KIND_DROPOUT duration_s: 1 }"),
               Catch::StartsWith("s.textproto: device_faults[0].kind: "));
}

TEST_CASE("tracking passes are read, written and read again, and a pass that ends before it begins is refused",
          "[scenario][tracking]") {
    const auto text =
        least + "radio { tracking_passes { station: \"DSS-43\" begin_after_entry_s: -7200 end_after_entry_s: 3600 } }";
    const auto scenario = scenario_from_text(text, "s.textproto");
    REQUIRE(scenario);
    const auto again = scenario_from_text(scenario_to_text(*scenario), "again");
    REQUIRE(again);
    REQUIRE(again->radio.tracking_passes.size() == 1);
    CHECK(again->radio.tracking_passes[0].station == "DSS-43");
    CHECK(again->radio.tracking_passes[0].begin_after_entry_s == -7200.0);
    CHECK(again->radio.tracking_passes[0].end_after_entry_s == 3600.0);
    CHECK_THAT(
        error_of(least +
                 "radio { tracking_passes { station: \"DSS-43\" begin_after_entry_s: 1 end_after_entry_s: 0 } }"),
        Catch::Contains(
            "radio.tracking_passes[0]: begin_after_entry_s 1 to end_after_entry_s 0 is no stretch of time"));
    CHECK_THAT(error_of(least + "radio { tracking_passes { end_after_entry_s: 10 } }"),
               Catch::Contains("radio.tracking_passes[0].station"));
}

}  // namespace server_scenario_text_test
