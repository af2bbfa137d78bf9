// SPDX-License-Identifier: Apache-2.0
#include "server/scenario/height_grid_text.hpp"

#include "server/scenario/scenario_text.hpp"
#include "tests/simulation/gale.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/temporary_folder.hpp"

#include <fmt/format.h>
#include <fstream>
#include <random>
#include <string>
#include <tuple>

namespace server_height_grid_text_test {

using namespace aeolis;
using namespace aeolis::server;

namespace {

const std::string small = "NCOLS 3\n"
                          "nrows 2\r\n"
                          "xllcorner 1000\n"
                          "yllcorner -200\n"
                          "\n"
                          "cellsize 100\n"
                          "NODATA_value -9999\n"
                          "-4490 -4480.5 -4470\n"
                          "-4500 -4501 -4.502e3\n";

/// `small` with the words of one line replaced.
std::string with(const std::string& from, const std::string& to, std::string text = small) {
    const auto at = text.find(from);
    REQUIRE(at != std::string::npos);
    return text.replace(at, from.size(), to);
}

std::string refusal(const std::string& text, const GridDatum& datum = {0.0, 0.0, -4500.0}) {
    const auto grid = height_grid_from_text(text, datum);
    REQUIRE_FALSE(grid.ok());
    return grid.error().message;
}

/// A square of level ground with a mound, by the coordinates and heights of another mission's map.
std::string map_of(std::size_t nodes, double cell_m, double x_m = 0.0, double landing_m = 0.0) {
    const double corner_m = -0.5 * cell_m * static_cast<double>(nodes);
    std::string text = fmt::format("ncols {0}\nnrows {0}\nxllcorner {1}\nyllcorner {2}\ncellsize {3}\n", nodes,
                                   x_m + corner_m, corner_m, cell_m);
    for (std::size_t row = 0; row < nodes; ++row)
        for (std::size_t column = 0; column < nodes; ++column)
            text += fmt::format("{}{}", landing_m + (row == 1 && column == 2 ? 12.5 : 0.0),
                                column + 1 == nodes ? "\n" : " ");
    return text;
}

}  // namespace

TEST_CASE("a grid in the form of ESRI is read: corners or middles, any case, north first", "[scenario][terrain]") {
    const auto grid = height_grid_from_text(small, {1150.0, -150.0, -4500.0});
    REQUIRE(grid.ok());
    CHECK(grid->shape().columns == 3);
    CHECK(grid->shape().rows == 2);
    CHECK(grid->shape().west_m == -100.0);
    CHECK(grid->shape().south_m == 0.0);
    CHECK(grid->at_node(0, 0) == 0.0);
    CHECK(grid->at_node(2, 0) == -2.0);
    CHECK(grid->at_node(1, 1) == 19.5);
    CHECK(grid->height_m(0.0, 0.0) == -1.0);

    const auto by_middles = height_grid_from_text(with("xllcorner 1000", "xllcenter 1050"), {1150.0, -150.0, -4500.0});
    REQUIRE(by_middles.ok());
    CHECK(by_middles->shape().west_m == -100.0);
}

TEST_CASE("what is wrong with a grid is told by its line, and what to look at", "[scenario][terrain]") {
    for (const auto& [text, told] : {
             std::tuple{with("cellsize 100\n", ""), "line 7: cellsize is missing before the first row"},
             {with("xllcorner", "xllcenter 3\nxllcorner"),
              "line 9: one of xllcorner and xllcenter is needed before the first row"},
             {with("nrows", "rows"), "line 2: 'rows' is none of ncols, nrows, xllcorner"},
             {with("nrows 2", "nrows 2\nnrows 2"), "line 3: nrows is said twice"},
             {with("nrows 2", "nrows two"), "line 2: nrows is followed by no number"},
             {with("nrows 2", "nrows 2.5"), "3 columns and 2.5 rows are no grid"},
             {with("nrows 2", "nrows 40000"), "are more than 65536 heights: crop the grid, or take larger cells"},
             {with("nrows 2", "nrows 3"), "the grid ends after 2 rows, nrows says 3"},
             {with("nrows 2", "nrows 2") + "1 2 3\n", "line 10: more rows than the 2 that nrows says"},
             {with("cellsize 100", "cellsize 0"), "a cellsize of 0 is not above 0 and up to 10000 m"},
             {with("-4480.5 ", ""), "line 8: 2 heights, ncols says 3"},
             {with("-4480.5", "-4480,5"), "line 8: '-4480,5' is no number"},
             {with("-4480.5", "nan"), "line 8: column 2 has no height (nan): fill the grid or crop it"},
             {with("-4490", "nan"), "line 8: column 1 has no height (nan): fill the grid or crop it"},
             {with("-9999\n-4490", "nan\nNaN"), "line 8: column 1 has no height (NaN)"},
             {with("-4480.5", "-9999"), "line 8: column 2 has no height (-9999): fill the grid or crop it"},
             {with("-4480.5", "-32768"), "line 8: column 2 lies -28268 m from the landing radius"},
             {with("-4480.5", "-3900"), "line 9: beside column 2 the ground steps by 601 m within 100 m"},
             {std::string{}, "line 0: ncols is missing before the first row"},
         }) {
        INFO(text);
        CHECK_THAT(refusal(text), Catch::Contains(told));
    }
}

TEST_CASE("whatever a text holds, it is a grid that can be flown over or is refused by its line",
          "[scenario][terrain]") {
    std::mt19937_64 random{11};
    int read = 0;
    for (int i = 0; i < 20000; ++i) {
        std::string text = small;
        for (auto changes = 1 + random() % 4; changes > 0; --changes) {
            const auto at = random() % text.size();
            switch (random() % 3) {
            case 0: text[at] = static_cast<char>(random() % 256); break;
            case 1: text.erase(at, 1 + random() % 5); break;
            default: text.insert(at, text.substr(random() % text.size(), random() % 12)); break;
            }
        }
        const auto grid = height_grid_from_text(text, {1150.0, -150.0, -4500.0});
        if (!grid) {
            CHECK_THAT(grid.error().message, Catch::StartsWith("line "));
            continue;
        }
        ++read;
        for (const double offset_m : {-1e7, -120.0, 0.0, 77.0, 1e7}) {
            REQUIRE(std::abs(grid->height_m(offset_m, -offset_m)) <= 10000.0);
            REQUIRE(std::isfinite(grid->rise(offset_m, offset_m).east));
        }
        const auto again = height_grid_from_text(grid_text(*grid));
        REQUIRE(again.ok());
        CHECK(grid_text(*again) == grid_text(*grid));
    }
    CHECK(read > 200);
}

TEST_CASE("a scenario names a grid beside it, holds it whole, and says which part of it does not fit",
          "[scenario][terrain]") {
    const test::TemporaryFolder folder;
    const auto file = [&](const std::string& name, const std::string& text) {
        std::ofstream{folder.path() / name, std::ios::binary} << text;
        return folder.path() / name;
    };
    const auto scenario_of = [&](const std::string& ground) {
        return scenario_from_file(
            file("hills.textproto", "name: \"hills\" like: \"nominal\" ground { " + ground + " }"),
            AEOLIS_SOURCE_DIR "/simulation/scenarios");
    };
    file("site.asc", map_of(60, 350.0, 8.1e6, -4501.0));
    const auto scenario =
        scenario_of("grid_file: \"site.asc\" grid_target_x_m: 8.1e6 grid_landing_m: -4501 slope_deg: 1");
    INFO((scenario ? "" : scenario.error().message));
    REQUIRE(scenario.ok());
    REQUIRE(scenario->ground.grid);
    CHECK(scenario->ground.slope_deg == 1.0);
    CHECK(scenario->ground.grid->height_m(-9625.0, 9975.0) == 12.5);

    const auto again = scenario_from_text(scenario_to_text(*scenario), "again");
    INFO((again ? "" : again.error().message));
    REQUIRE(again.ok());
    REQUIRE(again->ground.grid);
    CHECK(grid_text(*again->ground.grid) == grid_text(*scenario->ground.grid));

    // Another target under the same hills would be another place.
    const auto moved =
        scenario_from_file(file("moved.textproto", "name: \"moved\" like: \"hills\" target { latitude_deg: -4.5 }"),
                           AEOLIS_SOURCE_DIR "/simulation/scenarios");
    REQUIRE_FALSE(moved.ok());
    CHECK_THAT(moved.error().message, Catch::Contains("the grid of the ground of 'hills' lies about another target"));

    const auto refused = [&](const std::string& ground) {
        const auto none = scenario_of(ground);
        REQUIRE_FALSE(none.ok());
        return none.error().message;
    };
    CHECK_THAT(
        refused("grid_file: \"site.asc\""),
        Catch::Contains("at the target it lies -4501 m over the landing radius: is that the zero of its heights"));
    CHECK_THAT(refused("grid_file: \"site.asc\" grid_landing_m: -4501"),
               Catch::Contains("ground.grid: does not reach 10000 m from the target to all sides"));
    CHECK_THAT(refused("grid_file: \"site.asc\" grid_target_x_m: nan"),
               Catch::Contains("ground.grid_target_x_m: nan is not a finite number"));
    CHECK_THAT(refused("grid_file: \"none.asc\""), Catch::Contains("none.asc: cannot be opened"));
    CHECK_THAT(refused("grid_file: \".\""), Catch::Contains("is a directory, not a grid"));
    CHECK_THAT(refused("grid_landing_m: 3"), Catch::Contains("ground.grid_file: missing"));
    CHECK_THAT(refused("grid: \"ncols 2\""), Catch::Contains("ground.grid: line 1: nrows is missing"));
    file("broken.asc", with("12.5", "x", map_of(60, 50.0)));
    CHECK_THAT(refused("grid_file: \"broken.asc\""), Catch::Contains("broken.asc:7: 'x' is no number"));
    file("large.asc", std::string((1 << 20) + 1, ' '));
    CHECK_THAT(refused("grid_file: \"large.asc\""),
               Catch::Contains("large.asc: larger than 1048576 octets, which are all that a grid may have"));
    file("high.asc", map_of(60, 50.0, 0.0, 2500.0));
    CHECK_THAT(refused("grid_file: \"high.asc\""),
               Catch::Contains("ground.grid: at the target it lies 2500 m over the landing radius"));
}

}  // namespace server_height_grid_text_test
