// SPDX-License-Identifier: Apache-2.0
#include "server/campaign/case_table.hpp"

#include "server/campaign/campaign_results.hpp"
#include "server/campaign/campaign_store.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/temporary_folder.hpp"

#include <cmath>
#include <limits>
#include <sstream>

namespace server_case_table_test {

using namespace aeolis;
using namespace aeolis::server;
using namespace aeolis::server::campaign;

namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// Case N: its propellant goes down by two kilograms with each unit of `wind`, and not with `dust`.
CaseResult case_of(std::uint64_t number) {
    const auto x = static_cast<double>(number);
    CaseResult result;
    result.number = number;
    result.outcome = number == 3 ? "lost" : "touchdown";
    if (number != 3) result.touchdown = simulation::TouchdownReport{0.75, 0.1, 10.0 * x, -4.6, 137.4, 1.0};
    const double wind = std::sin(x);
    result.propellant_kg = 40.0 - 2.0 * wind;
    result.events = {{"parachute_deploy", 250.0 + x, 11'000.0, 405.0, 100.0 * x, -50.0 * x}};
    result.margins = {{"backshell", 2.0 + x}, {"sufr", 1.0 + x}};
    result.draws = {{"dust", std::cos(40.0 * x)}, {"still", 1.0}, {"wind", wind}};
    return result;
}

CaseTable table_of(const std::filesystem::path& file, std::uint64_t cases, double more_kg = 0.0) {
    {
        auto store = CampaignStore::open(file, {"made_up", "name: \"made_up\"\n", 1, "4711", "0123456789abcdef"});
        REQUIRE(store);
        std::vector<CaseResult> results;
        for (std::uint64_t number = 1; number <= cases; ++number) {
            results.push_back(case_of(number));
            results.back().propellant_kg += more_kg;
        }
        REQUIRE(store->add(results));
    }
    auto results = CampaignResults::open(file, cases);
    REQUIRE(results);
    auto table = results->table();
    REQUIRE(table);
    return *table;
}

}  // namespace

TEST_CASE("the table of a campaign has each case's figures, events with their places, margins and draws",
          "[campaign][analysis]") {
    const test::TemporaryFolder folder;
    const CaseTable table = table_of(folder / "a.db", 5);
    CHECK(table.numbers == std::vector<std::uint64_t>{1, 2, 3, 4, 5});
    CHECK(table.outcomes[2] == "lost");
    const auto at = [&](const char* name, std::size_t row) {
        const auto* column = table.column(name);
        INFO(name);
        REQUIRE(column != nullptr);
        return column->values.at(row);
    };
    CHECK(at("miss_m", 1) == 20.0);
    CHECK(std::isnan(at("miss_m", 2)));  // it never touched down
    CHECK(at("event.parachute_deploy.e_s", 0) == 251.0);
    CHECK(at("event.parachute_deploy.east_m", 4) == 500.0);
    CHECK(at("event.parachute_deploy.north_m", 4) == -250.0);
    CHECK(at("margin.sufr_s", 3) == 5.0);
    CHECK(at("least_margin_s", 3) == 5.0);
    CHECK(at("draw.wind", 1) == std::sin(2.0));
    CHECK(table.column("draw.rain") == nullptr);

    std::istringstream csv{csv_of(table)};
    std::string heading, row;
    std::getline(csv, heading);
    CHECK_THAT(heading, Catch::StartsWith("case,outcome,vertical_mps,horizontal_mps,miss_m,"));
    CHECK_THAT(heading, Catch::Contains(",draw.wind"));
    for (int line = 0; line < 3; ++line) std::getline(csv, row);
    CHECK_THAT(row, Catch::StartsWith("3,lost,,,,"));
    CHECK(std::count(row.begin(), row.end(), ',') == std::count(heading.begin(), heading.end(), ','));
}

TEST_CASE("a figure is found to go with the draw that makes it, by how much, and with no other",
          "[campaign][analysis]") {
    const test::TemporaryFolder folder;
    const CaseTable table = table_of(folder / "a.db", 200);
    const auto found = correlations(table, {"propellant_kg"});
    REQUIRE(found.size() == 2);  // what stands still goes with nothing
    CHECK(found[0].draw == "wind");
    CHECK(found[0].r == Approx(-1.0));
    CHECK(found[0].slope == Approx(-2.0 * std::sqrt(0.5)).epsilon(0.02));
    CHECK(found[0].cases == 200);
    CHECK(std::abs(found[1].r) < found[1].by_chance);
    CHECK(found[1].by_chance == Approx(3.0 / std::sqrt(200.0)));
    CHECK(correlations(table, {"no_such_figure"}).empty());
}

TEST_CASE("two campaigns are compared quantity by quantity, and only what differs is said to", "[campaign][analysis]") {
    const test::TemporaryFolder folder;
    const CaseTable a = table_of(folder / "a.db", 100), b = table_of(folder / "b.db", 150, 3.0);
    bool seen = false;
    for (const Compared& one : compared(a, b)) {
        INFO(one.name);
        CHECK_FALSE(one.name.starts_with("draw."));
        CHECK(one.cases_b > one.cases_a);
        if (one.name != "propellant_kg") continue;
        seen = true;
        CHECK(one.mean_b - one.mean_a == Approx(3.0).margin(0.1));
        CHECK(one.difference_sigmas > 10.0);
        CHECK(one.p50_a == Approx(40.0).margin(0.1));
    }
    CHECK(seen);
    for (const Compared& one : compared(a, a)) CHECK(one.difference_sigmas == 0.0);
    CHECK(compared(a, CaseTable{{1}, {"touchdown"}, {{"miss_m", {none}}}}).empty());
}

}  // namespace server_case_table_test
