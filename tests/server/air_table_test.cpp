// SPDX-License-Identifier: Apache-2.0
#include "server/scenario/air_table.hpp"

#include "server/scenario/scenario_text.hpp"
#include "simulation/mars/atmosphere.hpp"
#include "simulation/mars/wind.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/temporary_folder.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <tuple>

namespace server_air_table_test {

using namespace aeolis;
using namespace aeolis::server;

namespace {

struct Folder {
    test::TemporaryFolder folder;

    std::filesystem::path file(const std::string& name, const std::string& text) const {
        std::ofstream{folder.path() / name, std::ios::binary} << text;
        return folder.path() / name;
    }
    std::string refusal(const std::string& text, const std::string& name = "air.csv") const {
        const auto table = air_table_from_file(file(name, text));
        REQUIRE_FALSE(table);
        return table.error().message.substr(folder.path().string().size() + 1);
    }
};

const std::string csv = "# the air of a cold morning\n"
                        "altitude_km,temperature_K,pressure_Pa,density_kgm3,east_mps,north_mps\n"
                        "0,220,831.16,0.02,5,-1\n"
                        "10,210,356.9,0.009,10,0\n"
                        "30,180,37.4,0.0011,40,2\n"
                        "50,170,3.21,1e-4,60,3\n"
                        "70,150,0.283,1e-5,80,4\n"
                        "90,140,0.0106,4e-7,80,4\n"
                        "110,120,0,8e-8,80,4\n";

}  // namespace

TEST_CASE("a table of the air is read in SI units, with its wind, and flown as it stands", "[scenario][atmosphere]") {
    const Folder in;
    const auto table = air_table_from_file(in.file("air.csv", csv));
    REQUIRE(table);
    REQUIRE(table->air.size() == 7);
    CHECK(table->air[2].altitude_m == 30'000.0);
    CHECK(table->air[2].temperature_K == 180.0);
    CHECK(table->air[2].density_kgm3 == 0.0011);
    CHECK(table->winds[3].east_mps == 60.0);

    const auto scenario =
        scenario_from_file(in.file("cold.textproto", "name: \"cold\" like: \"nominal\" air_table: \"air.csv\""),
                           AEOLIS_SOURCE_DIR "/simulation/scenarios");
    REQUIRE(scenario);
    CHECK(scenario->air.size() == 7);
    CHECK(scenario->winds.size() == 7);
    CHECK(scenario->density_scale.empty());  // that of nominal belongs to Gale's table
    const simulation::Atmosphere air{scenario->density_scale, scenario->air};
    CHECK(air.at(10'000.0).density_kgm3 == Approx(0.009));
    CHECK(air.at(20'000.0).density_kgm3 == Approx(std::sqrt(0.009 * 0.0011)));
    CHECK(air.at(20'000.0).speed_of_sound_mps == Approx(std::sqrt(252.0 * 195.0)).epsilon(1e-3));
    // The whole scenario comes back from its own text, tables and all.
    const auto again = scenario_from_text(scenario_to_text(*scenario), "again");
    REQUIRE(again);
    CHECK(scenario_to_text(*again) == scenario_to_text(*scenario));
}

TEST_CASE("a table has the scale of density and its deviation by height", "[scenario][atmosphere]") {
    const Folder in;
    const auto scenario = scenario_from_file(
        in.file("s.textproto",
                "name: \"s\" like: \"nominal\" air_table: \"" +
                    in.file("air.csv", "altitude_m,temperature_K,density_kgm3,density_scale,"
                                       "density_deviation\n0,220,0.02,1.05,0.04\n25000,190,0.002,1,0.04\n"
                                       "50000,170,1e-4,1,0.04\n75000,150,6e-6,1,0.2\n100000,140,1e-7,1,0.2\n")
                        .filename()
                        .string() +
                    "\""),
        AEOLIS_SOURCE_DIR "/simulation/scenarios");
    INFO((scenario ? "" : scenario.error().message));
    REQUIRE(scenario);
    REQUIRE(scenario->density_scale.size() == 5);
    CHECK(scenario->density_scale[0].scale == 1.05);
    CHECK(scenario->density_scale[3].deviation == 0.2);
    CHECK(scenario->air[0].density_kgm3 == 0.02);  // the scale stands beside it
}

TEST_CASE("a forecast of the air may be believed, and the air be another", "[scenario][atmosphere][believed]") {
    const Folder in;
    in.file("forecast.csv", csv);
    const auto scenario = scenario_from_file(
        in.file("off.textproto", "name: \"off\" like: \"nominal\" believed { air_table: \"forecast.csv\" }"),
        AEOLIS_SOURCE_DIR "/simulation/scenarios");
    INFO((scenario ? "" : scenario.error().message));
    REQUIRE(scenario);
    CHECK(scenario->air.empty());
    CHECK_FALSE(scenario->density_scale.empty());
    REQUIRE(scenario->believed);
    CHECK(scenario->believed->air.size() == 7);
    CHECK(scenario->believed->winds.size() == 7);
    CHECK(scenario->believed->density_scale.empty());  // that of nominal belongs to Gale's table
    const auto lost = scenario_from_file(
        in.file("lost.textproto", "name: \"lost\" like: \"nominal\" believed { air_table: \"none.csv\" }"),
        AEOLIS_SOURCE_DIR "/simulation/scenarios");
    REQUIRE_FALSE(lost);
    CHECK_THAT(lost.error().message, Catch::Contains("believed.air_table: ") && Catch::Contains("cannot be opened"));
}

TEST_CASE("wind by height is linear between the rows of its table, held outside, and beside the steady wind",
          "[scenario][simulation][wind]") {
    const Folder in;
    const auto winds =
        wind_table_from_file(in.file("wind.csv", "altitude_m,north_mps,east_mps\n0,0,10\n1000,-4,20\n5000,-4,20\n"));
    REQUIRE(winds);
    simulation::Wind wind{1.0,   0.0, 0.0, {1, 1, simulation::Stream::wind}, {0.0, {1, 1, simulation::Stream::gust}},
                          *winds};
    const simulation::Vector3 p{3.4e6, 0.0, 0.0};  // east is y, north is z
    for (const auto& [altitude_m, east_mps, north_mps] :
         {std::tuple{-50.0, 11.0, 0.0}, std::tuple{500.0, 16.0, -2.0}, std::tuple{9000.0, 21.0, -4.0}}) {
        INFO(altitude_m);
        CHECK(wind.at(p, altitude_m).y() == Approx(east_mps));
        CHECK(wind.at(p, altitude_m).z() == Approx(north_mps).margin(1e-12));
    }
}

TEST_CASE("a profile of Mars-GRAM is read: kilometres above its own zero, and 0 is none", "[scenario][atmosphere]") {
    const Folder in;
    // Height km, latitude, longitude, T, p, density, eastward and northward wind, and deviations.
    const std::string profile = "Hgtkm Lat LonE Temp Pres Dens EWind NSWind sdT sdP sdD sdE sdN\n"
                                "-5 -4.6 137.4 230 869.0 0 3 1 2 1 1 5 5\n"
                                "15 -4.6 137.4 0 170.0 0.0047 12 1 2 1 1 5 5\n"
                                "35 -4.6 137.4 175 0 0.0006 30 2 2 1 1 5 5\n"
                                "55 -4.6 137.4 165 0 6e-5 30 2 2 1 1 5 5\n"
                                "75 -4.6 137.4 150 0 5e-6 30 2 2 1 1 5 5\n"
                                "95 -4.6 137.4 140 0 3e-7 30 2 2 1 1 5 5\n"
                                "115 -4.6 137.4 130 0 1e-8 30 2 2 1 1 5 5\n";
    const auto table = air_table_from_file(in.file("gram.txt", profile), -4500.0);
    REQUIRE(table);
    CHECK(table->air[0].altitude_m == -500.0);  // 5 km below the areoid is half a kilometre below the landing site
    CHECK(table->air[0].density_kgm3 == Approx(869.0 / (188.9 * 230.0)));
    CHECK(table->air[1].temperature_K == Approx(170.0 / (188.9 * 0.0047)));
    CHECK(table->winds[1].east_mps == 12.0);
    const auto scenario =
        scenario_from_file(in.file("g.textproto", "name: \"g\" like: \"nominal\" air_table: \"gram.txt\" "
                                                  "air_table_landing_m: -4500"),
                           AEOLIS_SOURCE_DIR "/simulation/scenarios");
    REQUIRE(scenario);
    CHECK(scenario->air.front().altitude_m == -500.0);
}

TEST_CASE("a bad table of the air is refused by file, line and reason, and nothing is flown",
          "[scenario][atmosphere]") {
    const Folder in;
    const std::string heading = "altitude_m,temperature_K,density_kgm3\n0,220,0.02\n";
    struct Row {
        std::string text;
        const char* says;
    };
    const Row rows[] = {
        {heading + "0,210,0.01\n", "air.csv:3: 0 m does not lie above the row before, 0 m"},
        {heading + "5000,210,0.01\n4000,210,0.01\n", "air.csv:4: 4000 m does not lie above the row before, 5000 m"},
        {heading + "40000,210,0.01\n", "air.csv:3: a gap of 40 km below 40000 m"},
        {heading + "5000,nan,0.01\n", "air.csv:3: 'nan' is no number"},
        {heading + "5000,inf,0.01\n", "air.csv:3: 'inf' is no number"},
        {heading + "5000,,0.01\n", "air.csv:3: '' is no number"},
        {heading + "5000,210\n", "air.csv:3: 2 values, the heading has 3"},
        {heading + "5000,-53,0.01\n", "air.csv:3: a temperature of -53"},
        {heading + "5000,33,0.01\n", "air.csv:3: 33 K and 0.01 kg/m3 are no air of Mars: other units?"},
        {heading + "5000,0,0.01\n", "air.csv:3: two of temperature, pressure and density are needed"},
        {"altitude_m,temperature_C,density_kgm3\n", "air.csv:1: column 'temperature_C' is none of altitude_m, "},
        {"altitude_m,altitude_km,density_kgm3\n", "air.csv:1: column 'altitude_km' says again what another does"},
        {"temperature_K,density_kgm3\n", "air.csv:1: no column is the altitude"},
        {"altitude_m,temperature_K,pressure_Pa,density_kgm3\n0,220,8.3,0.02\n5000,210,4,0.01\n",
         "air.csv:2: pressure 8.3 Pa, while density 0.02 kg/m3 and 220 K make 831.2 Pa: other units?"},
        {heading, "air.csv: has 1 rows, a table needs two"},
        {"", "air.csv: has 0 rows, a table needs two"},
    };
    for (const Row& row : rows) {
        INFO(row.text);
        CHECK_THAT(in.refusal(row.text), Catch::StartsWith(row.says));
    }
    // A profile's first line is no row.
    CHECK(in.refusal("0 -4.6 137.4 220 831 0.02 0 0\n1 -4.6 137.4 220 800 0.019 0 0\n", "gram.txt") ==
          "gram.txt:1: a profile begins with a line of heading, this one is of numbers");
    // Its rows have eight values at least.
    CHECK(in.refusal("heading\n0 -4.6 137.4 220 831\n", "gram.txt") == "gram.txt:2: 5 values, the heading has 8");
    CHECK_THAT(air_table_from_file("/nowhere/air.csv").error().message,
               Catch::Contains("/nowhere/air.csv: cannot be opened"));
    CHECK_THAT(air_table_from_file("/tmp").error().message, Catch::Contains("is a directory"));

    const auto of = [&](const std::string& more) {
        const auto scenario = scenario_from_file(in.file("s.textproto", "name: \"s\" like: \"nominal\" " + more),
                                                 AEOLIS_SOURCE_DIR "/simulation/scenarios");
        REQUIRE_FALSE(scenario);
        CHECK(std::ranges::count(scenario.error().message, '\n') == 0);
        return scenario.error().message;
    };
    in.file("low.csv", heading + "5000,210,0.01\n");
    CHECK_THAT(
        of("air_table: \"low.csv\""),
        Catch::EndsWith("s.textproto: air: covers 0 … 5000 m above the landing radius, an entry needs 1000 … 100000"));
    in.file("step.csv", heading + "0,210,0.01\n");
    CHECK_THAT(of("air_table: \"step.csv\""),
               Catch::Contains("s.textproto: air_table: ") && Catch::Contains("step.csv:3: "));
    CHECK_THAT(of("air_table: \"none.csv\""), Catch::Contains("none.csv: cannot be opened"));
    CHECK_THAT(of("wind_table: \"low.csv\""), Catch::Contains("a table of wind has the columns"));
    CHECK_THAT(of("air_table_landing_m: -4500"), Catch::Contains("air_table_landing_m: there is no air_table"));
    CHECK_THAT(of("winds { altitude_m: 0 east_mps: 900 } winds { altitude_m: 5 }"),
               Catch::Contains("winds[0].east_mps: 900 is outside -300 … 300"));
}

TEST_CASE("a scenario in any folder is like one that ships, and one beside it comes first", "[scenario]") {
    const Folder in;
    const std::filesystem::path shipped = AEOLIS_SOURCE_DIR "/simulation/scenarios";
    const auto mine = in.file("mine.textproto", "name: \"mine\" like: \"nominal_auto\"");
    const auto like = scenario_from_file(mine, shipped);
    REQUIRE(like);
    CHECK(like->commands.size() == 2);
    CHECK_FALSE(scenario_from_file(mine).ok());
    in.file("nominal_auto.textproto",
            "name: \"nominal_auto\" like: \"nominal\" commands { send_before_entry_s: 9 command: \"EDL_DO_EDL\" }");
    CHECK(scenario_from_file(mine, shipped)->commands.size() == 1);
    CHECK_THAT(scenario_from_file(in.file("no.textproto", "name: \"n\" like: \"nobody\""), shipped).error().message,
               Catch::Contains("/simulation/scenarios/nobody.textproto: cannot be opened"));
}

}  // namespace server_air_table_test
