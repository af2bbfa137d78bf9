// SPDX-License-Identifier: Apache-2.0
#include "server/campaign/campaign.hpp"

#include "server/base/json.hpp"
#include "server/campaign/campaign_plots.hpp"
#include "server/campaign/campaign_report.hpp"
#include "server/campaign/case_flights.hpp"
#include "server/rehearsal/rehearsal.hpp"
#include "server/scenario/scenario_text.hpp"
#include "tests/server/running_server.hpp"
#include "tests/support/child_process.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <fmt/format.h>
#include <fstream>
#include <google/protobuf/struct.pb.h>
#include <map>
#include <mutex>
#include <unistd.h>

namespace server_campaign_test {

using namespace aeolis;
using namespace aeolis::server;
using namespace aeolis::server::campaign;

namespace {

const Identity identity{"made_up", "name: \"made_up\"\nseed_of: 1\n", 1, "4711", "0123456789abcdef"};

/// A case that is nothing but a function of its number.
CaseResult made_up(std::uint64_t number) {
    CaseResult result;
    result.number = number;
    result.outcome = "touchdown";
    result.reason = "made up";
    result.end_cycle = 1000 + number;
    const auto x = static_cast<double>(number);
    result.touchdown = simulation::TouchdownReport{0.75 + 0.001 * std::sin(x), 0.1, 1000.0 * std::cos(x), -4.6, 137.4};
    result.east_m = 5000.0 * std::sin(7.0 * x);
    result.north_m = 2000.0 * std::cos(3.0 * x);
    result.parachute = simulation::ParachuteReport{1.7 + 0.01 * std::sin(x), 500.0};
    result.propellant_kg = 40.0;
    result.separation.backshell_least_m = 300.0 + x;
    result.margins = {{"sufr", 2.0 + std::sin(x)}, {"backshell", 0.5}};
    result.events = {{"entry_interface", 0.0, 131052.0, 5845.2}, {"touchdown", 420.0 + std::sin(x), 7.4, 0.7}};
    return result;
}

Progress run(const std::filesystem::path& file, std::uint64_t cases, unsigned jobs,
             const std::function<CaseResult(std::uint64_t)>& fly = made_up) {
    auto store = CampaignStore::open(file, identity);
    REQUIRE(store);
    const std::atomic<bool> stop{false};
    const auto progress = run_campaign(*store, cases, jobs, fly, stop, {});
    REQUIRE(progress);
    return *progress;
}

/// Every row of both tables, as text.
std::vector<std::string> rows_of(const std::filesystem::path& file) {
    auto database = archive::sqlite::Database::open(file.string(), archive::sqlite::Mode::read_write_create);
    REQUIRE(database);
    std::vector<std::string> rows;
    for (const auto& [sql, columns] : {std::pair{"SELECT * FROM cases ORDER BY number", 20},
                                       std::pair{"SELECT * FROM events ORDER BY case_number, place", 6}}) {
        auto select = database->prepare(sql);
        REQUIRE(select);
        for (;;) {
            const auto row = select->step();
            REQUIRE(row);
            if (!*row) break;
            std::string& text = rows.emplace_back();
            for (int column = 0; column < columns; ++column) text += fmt::format("{}|", select->text(column));
        }
    }
    return rows;
}

std::int64_t count_of(const std::filesystem::path& file, const char* sql) {
    auto database = archive::sqlite::Database::open(file.string(), archive::sqlite::Mode::read_only);
    if (!database) return 0;
    const auto count = database->integer_of(sql);
    return count ? *count : 0;  // it may be made just now
}

Summary summary_of(const std::filesystem::path& file, std::uint64_t cases) {
    auto results = CampaignResults::open(file, cases);
    REQUIRE(results);
    const auto summary = results->summary();
    REQUIRE(summary);
    return *summary;
}

std::string refusal(const std::filesystem::path& file, const Identity& other) {
    const auto store = CampaignStore::open(file, other);
    REQUIRE_FALSE(store);
    return store.error().message;
}

/// A file with the quickest landing there is: GNC alone, from shortly before entry.
std::string light_scenario(const test::TemporaryFolder& folder) {
    auto scenario = test::shipped_scenario("gnc_alone");
    scenario.disperse_before_entry_s = 10.0;
    const auto file = folder / "light.textproto";
    std::ofstream{file} << scenario_to_text(scenario);
    return file.string();
}

struct Ended {
    int code = -1;
    std::string out;
};

/// `aeolis campaign`, both its streams into a file.
test::ChildProcess start(std::vector<std::string> arguments, const std::filesystem::path& out) {
    arguments.insert(arguments.begin(), {test::program(), "campaign"});
    return test::ChildProcess{std::move(arguments), out};
}

Ended wait_for(test::ChildProcess child, const std::filesystem::path& out) {
    const int code = child.ended_within(std::chrono::hours{1});
    std::ifstream stream{out};
    return {code, {std::istreambuf_iterator<char>{stream}, {}}};
}

google::protobuf::Struct json_of(const std::string& text) {
    google::protobuf::Struct parsed;
    INFO(text);
    REQUIRE(from_json(text, parsed));
    return parsed;
}

double number_at(const google::protobuf::Struct& object, std::initializer_list<const char*> path) {
    const auto* at = &object;
    for (auto name = path.begin(); name + 1 != path.end(); ++name) at = &at->fields().at(*name).struct_value();
    return at->fields().at(*(path.end() - 1)).number_value();
}

}  // namespace

TEST_CASE("case K of a campaign is the landing that rehearse --case K flies, bit for bit", "[campaign]") {
    const auto scenario = test::shipped_scenario("campaign");
    const auto& dictionary = tests::shipped_dictionary();
    const CaseFlights flights{scenario, 3, dictionary};
    (void)flights.fly(6);  // no case leaves anything to the next
    const auto result = flights.fly(7);
    REQUIRE(result);
    const CaseResult& flown = *result;

    Rehearsal rehearsal{scenario, 3, 7, dictionary};
    while (rehearsal.landing().outcome() == simulation::Outcome::running) rehearsal.step();
    CHECK(flown.outcome == name_of(rehearsal.outcome()));
    CHECK(flown.reason == rehearsal.outcome_reason());
    CHECK(flown.end_cycle == rehearsal.cycles());
    const auto touchdown = rehearsal.landing().touchdown();
    REQUIRE(touchdown);
    REQUIRE(flown.touchdown);
    CHECK(flown.touchdown->vertical_mps == touchdown->vertical_mps);
    CHECK(flown.touchdown->horizontal_mps == touchdown->horizontal_mps);
    CHECK(flown.touchdown->latitude_deg == touchdown->latitude_deg);
    CHECK(flown.touchdown->longitude_deg == touchdown->longitude_deg);
    CHECK(std::hypot(flown.east_m, flown.north_m) == Approx(touchdown->miss_m).epsilon(1e-3));
    CHECK(flown.peak_deceleration_mps2 == rehearsal.landing().peak_deceleration_mps2());
    CHECK(flown.propellant_kg == rehearsal.landing().inspect().propellant_kg);
    REQUIRE(flown.parachute);
    CHECK(flown.parachute->mach == rehearsal.landing().parachute()->mach);
    REQUIRE(flown.events.size() == rehearsal.events().size());
    for (const auto& event : rehearsal.events()) {
        const auto same = std::ranges::find(flown.events, event.name, &CaseEvent::name);
        INFO(event.name);
        REQUIRE(same != flown.events.end());
        CHECK(same->e_s == event.e_s);
        CHECK(same->altitude_m == event.altitude_m);
        CHECK(same->speed_mps == event.speed_mps);
    }
    REQUIRE(flown.margins.size() > 1);
    CHECK(std::ranges::all_of(flown.margins, [](const TimelineMargin& margin) { return margin.margin_s >= 0.0; }));
}

TEST_CASE("a copy of the common flight that takes a case is that case's landing, its whole recording bit for bit",
          "[campaign]") {
    auto scenario = test::shipped_scenario("campaign");
    scenario.start_before_entry_s = 700.0;  // commanded by nobody: it ends in the air, and soon
    scenario.commands.clear();
    const auto& dictionary = tests::shipped_dictionary();
    ScriptedLanding whole{scenario, 1, 4, dictionary}, common{scenario, 1, 0, dictionary};
    while (common.landing().truth().e_s < -10.0) common.step();
    CHECK_FALSE(common.landing().dispersed());
    ScriptedLanding copy{common};
    copy.take_case(4);
    while (copy.landing().outcome() == simulation::Outcome::running) copy.step();
    while (whole.landing().outcome() == simulation::Outcome::running) whole.step();
    CHECK(copy.landing().dispersed());
    CHECK_THROWS_AS(copy.take_case(5), CheckFailed);
    CHECK(copy.landing().truth().p_MoB_M_m == whole.landing().truth().p_MoB_M_m);
    CHECK(std::ranges::equal(copy.landing().recording(), whole.landing().recording()));
}

TEST_CASE("a resumed campaign is the uninterrupted one, each case flown once", "[campaign]") {
    const test::TemporaryFolder folder;
    std::mutex mutex;
    std::map<std::uint64_t, int> times;
    const auto counted = [&](std::uint64_t number) {
        const std::scoped_lock lock{mutex};
        ++times[number];
        return made_up(number);
    };
    CHECK(run(folder / "resumed.db", 17, 3, counted).flown == 17);
    const auto second = run(folder / "resumed.db", 60, 2, counted);
    CHECK(second.flown == 43);
    CHECK(second.done == 60);
    CHECK(times.size() == 60);
    CHECK(std::ranges::all_of(times, [](const auto& each) { return each.second == 1; }));
    CHECK(run(folder / "resumed.db", 60, 2, counted).flown == 0);
    run(folder / "whole.db", 60, 1);
    CHECK(rows_of(folder / "resumed.db") == rows_of(folder / "whole.db"));
}

TEST_CASE("a campaign that is asked to stop keeps what is flown and can go on", "[campaign]") {
    const test::TemporaryFolder folder;
    {
        auto store = CampaignStore::open(folder / "a.db", identity);
        REQUIRE(store);
        std::atomic<bool> stop{false};
        const auto progress = run_campaign(*store, 1000, 2,
                                           [&](std::uint64_t number) {
                                               if (number == 20) stop = true;
                                               return made_up(number);
                                           },
                                           stop, {});
        REQUIRE(progress);
        CHECK(progress->flown >= 19);
        CHECK(progress->flown < 40);
    }
    const auto kept = count_of(folder / "a.db", "SELECT count(*) FROM cases");
    CHECK(kept >= 19);
    CHECK(run(folder / "a.db", 100, 2).flown == 100 - static_cast<std::uint64_t>(kept));
}

TEST_CASE("a case that throws is lost, with its reason, and the campaign goes on", "[campaign]") {
    const test::TemporaryFolder folder;
    run(folder / "a.db", 9, 2, [](std::uint64_t number) {
        AEOLIS_CHECK(number != 3);
        if (number == 5) throw std::runtime_error{"no room"};
        return made_up(number);
    });
    const auto summary = summary_of(folder / "a.db", 9);
    CHECK(summary.kept == 9);
    CHECK(summary.failed == 2);
    REQUIRE(summary.failures.size() == 2);
    CHECK(summary.failures[0].number == 3);
    CHECK(summary.failures[0].outcome == "lost");
    CHECK_THAT(summary.failures[0].reason, Catch::Contains("number != 3"));
    CHECK(summary.failures[1].reason == "no room");
    const auto text = campaign_table(summary, {}, {.scenario = "made_up.textproto"});
    CHECK_THAT(text, Catch::Contains("aeolis rehearse --scenario made_up.textproto --seed 1 --case 3"));
    const auto json = json_of(campaign_json(summary, {}, {}));
    CHECK(number_at(json, {"failed"}) == 2);
    CHECK(number_at(json, {"outcomes", "lost"}) == 2);
}

TEST_CASE("a case that lands outside the limits is a touchdown, counted and named beside them", "[campaign][limits]") {
    const test::TemporaryFolder folder;
    run(folder / "a.db", 9, 2, [](std::uint64_t number) {
        CaseResult result = made_up(number);
        if (number == 4) {
            result.reason = "the rover stands; outside limits: propellant_left_min_kg 1.2 instead of at least 4";
            result.limits_exceeded = 1;
        }
        return result;
    });
    const auto summary = summary_of(folder / "a.db", 9);
    CHECK(summary.failed == 0);
    CHECK(summary.vertical_mps.count == 9);
    CHECK(summary.outside_limits == 1);
    REQUIRE(summary.outside.size() == 1);
    CHECK(summary.outside[0].number == 4);
    const auto text = campaign_table(summary, {}, {.scenario = "made_up.textproto"});
    CHECK_THAT(text, Catch::Contains("1 landed outside limits"));
    CHECK_THAT(text, Catch::Contains("propellant_left_min_kg 1.2 instead of at least 4"));
    CHECK(number_at(json_of(campaign_json(summary, {}, {})), {"outside_limits"}) == 1);
}

TEST_CASE("a landing that diverges ends as lost with reason and cycle, or as what it came to", "[campaign]") {
    auto scenario = test::shipped_scenario("gnc_alone");
    scenario.start_before_entry_s = 60.0;  // still spinning behind the cruise stage: it cannot land
    const CaseFlights flights{scenario, 1, tests::shipped_dictionary()};
    const auto result = flights.fly(1);
    REQUIRE(result);
    const CaseResult& flown = *result;
    INFO(flown.outcome << ": " << flown.reason);
    CHECK(flown.outcome != "touchdown");
    CHECK(flown.outcome != "running");
    CHECK_FALSE(flown.reason.empty());
    CHECK(flown.end_cycle > 60 * 64);
}

TEST_CASE("results of another scenario, seed, dictionary or program are refused by the field's name", "[campaign]") {
    const test::TemporaryFolder folder;
    const auto file = folder / "a.db";
    run(file, 2, 1);
    auto other = identity;
    other.scenario = "other";
    CHECK_THAT(refusal(file, other), Catch::Contains("a.db: scenario: 'made_up' there, 'other' here"));
    other = identity;
    other.scenario_text = "name: \"made_up\"\nseed_of: 2\n";
    CHECK_THAT(refusal(file, other), Catch::Contains("scenario: 'seed_of: 1' there, 'seed_of: 2' here"));
    other = identity;
    other.seed = 2;
    CHECK_THAT(refusal(file, other), Catch::Contains("seed: 1 there, 2 here"));
    other = identity;
    other.dictionary = "4712";
    CHECK_THAT(refusal(file, other), Catch::Contains("dictionary: "));
    other = identity;
    other.program = "fedcba9876543210";
    CHECK_THAT(refusal(file, other), Catch::Contains("program: "));
    CHECK(rows_of(file).size() == 2 * 3);  // as it was

    std::ofstream{folder / "text.db"} << "this is no database, and long enough to be read as one's first page, it is";
    CHECK_THAT(refusal(folder / "text.db", identity), Catch::Contains("text.db"));
    {
        auto database =
            archive::sqlite::Database::open((folder / "else.db").string(), archive::sqlite::Mode::read_write_create);
        REQUIRE(database);
        REQUIRE(database->execute("CREATE TABLE something (x)"));
    }
    CHECK_THAT(refusal(folder / "else.db", identity), Catch::Contains("campaign: "));
    const auto held = CampaignStore::open(file, identity);
    REQUIRE(held);
    CHECK_THAT(refusal(file, identity), Catch::Contains("is being written by another process"));
}

TEST_CASE("kill -9 loses nothing that was committed and repeats nothing", "[campaign]") {
    if (test::program().empty()) return;
    const test::TemporaryFolder folder;
    const auto file = folder / "killed.db", out = folder / "out";
    std::vector<std::string> arguments{"--scenario", light_scenario(folder), "--cases", "12", "--jobs", "1", "--json",
                                       "--results",  file.string()};
    auto child = start(arguments, out);
    std::int64_t seen = 0;
    for (int i = 0; i < 3000 && seen < 1; ++i) {
        usleep(10'000);
        seen = count_of(file, "SELECT count(*) FROM cases");
    }
    child.kill();
    const auto committed = count_of(file, "SELECT count(*) FROM cases");
    CHECK(committed >= seen);
    CHECK(seen >= 1);
    CHECK(committed < 12);

    arguments[5] = "2";  // jobs: what comes out does not depend on them
    const auto resumed = wait_for(start(arguments, out), out);
    const auto json = json_of(resumed.out);
    CHECK(number_at(json, {"kept"}) == 12);
    CHECK(number_at(json, {"flown"}) == 12 - committed);
    auto uninterrupted = arguments;
    uninterrupted.back() = (folder / "whole.db").string();
    wait_for(start(uninterrupted, out), out);
    CHECK(rows_of(file) == rows_of(folder / "whole.db"));

    // The same file for another seed, from the command line.
    auto other = arguments;
    other.insert(other.end(), {"--seed", "2"});
    const auto refused = wait_for(start(other, out), out);
    CHECK(refused.code == 1);
    CHECK_THAT(refused.out, Catch::Contains("seed: 1 there, 2 here"));
}

TEST_CASE("an interrupt ends the program cleanly, with a report of what is kept", "[campaign]") {
    if (test::program().empty()) return;
    const test::TemporaryFolder folder;
    const auto file = folder / "a.db", out = folder / "out";
    auto child = start(
        {"--scenario", light_scenario(folder), "--cases", "5000", "--jobs", "1", "--json", "--results", file.string()},
        out);
    for (int i = 0; i < 3000 && count_of(file, "SELECT count(*) FROM cases") < 1; ++i) usleep(50'000);
    child.signal(SIGINT);
    const auto ended = wait_for(std::move(child), out);
    CHECK(ended.code == 1);  // not all are flown
    CHECK_FALSE(std::filesystem::exists(folder / "a.db-wal"));
    const auto kept = number_at(json_of(ended.out), {"kept"});
    CHECK(kept >= 1);
    CHECK(kept == static_cast<double>(count_of(file, "SELECT count(*) FROM cases")));
}

namespace {

/// The bands of Dispersed landings [facts], over the cases 1 … `cases` of the campaign that ships.
void check_bands(int cases) {
    if (test::program().empty()) return;
    const test::TemporaryFolder folder;
    const auto out = folder / "out";
    const auto ended = wait_for(start({"--scenario", "campaign", "--cases", fmt::format("{}", cases), "--json",
                                       "--results", (folder / "a.db").string()},
                                      out),
                                out);
    const auto json = json_of(ended.out);
    CHECK(number_at(json, {"kept"}) == cases);
    CHECK(number_at(json, {"outcomes", "touchdown"}) >= std::floor(0.997 * static_cast<double>(cases)));
    CHECK(number_at(json, {"touchdown", "vertical_mps", "min"}) >= 0.65);
    CHECK(number_at(json, {"touchdown", "vertical_mps", "max"}) <= 0.85);
    CHECK(number_at(json, {"touchdown", "horizontal_mps", "max"}) <= 0.5);
    CHECK(number_at(json, {"touchdown", "ellipse_99", "major_km"}) < 20.0);
    CHECK(number_at(json, {"touchdown", "ellipse_99", "major_km"}) > 4.0);
    CHECK(number_at(json, {"touchdown", "ellipse_99", "minor_km"}) <
          13.0);  // published 7: docs/validation.md says why not
    CHECK(number_at(json, {"parachute", "mach", "min"}) > 1.4);
    CHECK(number_at(json, {"parachute", "mach", "max"}) < 2.2);
    CHECK(number_at(json, {"parachute", "dynamic_pressure_Pa", "min"}) > 200.0);
    CHECK(number_at(json, {"parachute", "dynamic_pressure_Pa", "max"}) < 750.0);
    CHECK(number_at(json, {"propellant_kg", "min"}) > 0.0);
    CHECK(number_at(json, {"recontacts"}) == 0);
    CHECK(number_at(json, {"backshell_least_m", "min"}) > 10.0);
    CHECK(number_at(json, {"least_margin", "margin_s"}) >= 0.0);
}

}  // namespace

TEST_CASE("twenty dispersed cases land within the published bands", "[campaign]") {
    check_bands(20);
}

TEST_CASE("five hundred dispersed cases land within the published bands", "[.long][campaign]") {
    check_bands(500);
}

TEST_CASE("a campaign is studied by the program: verdict, table of all numbers, correlations, ellipses, comparison",
          "[campaign][analysis]") {
    if (test::program().empty()) return;
    const test::TemporaryFolder folder;
    const auto scenario = light_scenario(folder);
    const auto in = [&](const char* name) { return (folder / name).string(); };
    const auto ran = [&](std::vector<std::string> arguments) {
        return wait_for(start(std::move(arguments), folder / "out"), folder / "out");
    };
    for (const char* seed : {"1", "2"}) {
        const auto flown =
            ran({"--scenario", scenario, "--cases", "12", "--seed", seed, "--json", "--results", in(seed) + ".db"});
        const auto json = json_of(flown.out);
        // The exit code is the verdict's.
        const bool passed = json.fields().at("limits").struct_value().fields().at("verdict").string_value() == "passed";
        CHECK(flown.code == (passed ? 0 : 1));
        CHECK(number_at(json, {"limits", "within_limits"}) <= 12.0);
        CHECK(json.fields().at("limits").struct_value().fields().at("limits").list_value().values_size() >= 5);
    }
    const auto table = ran({"export", in("1") + ".db", "--csv", in("cases.csv"), "--hdf5", in("cases.h5")});
    INFO(table.out);
    CHECK(table.code == 0);
    std::string signature(8, ' ');
    std::ifstream{folder / "cases.h5"}.read(signature.data(), 8);
    CHECK(signature == "\x89HDF\r\n\x1a\n");
    std::ifstream csv{folder / "cases.csv"};
    std::string heading, row;
    int rows = 0;
    std::getline(csv, heading);
    while (std::getline(csv, row)) ++rows;
    CHECK(rows == 12);
    for (const char* column : {",miss_m", ",draw.density_fraction", ",draw.wind_east_mps",
                               ",event.parachute_deploy.east_m", ",event.touchdown.e_s"})
        CHECK_THAT(heading, Catch::Contains(column));

    const auto correlated = ran({"correlate", in("1") + ".db", "--most", "3"});
    INFO(correlated.out);
    CHECK(correlated.code == 0);
    CHECK_THAT(correlated.out, Catch::Contains("parachute_pressure_Pa") && Catch::Contains("slow_drag_fraction"));
    const auto ellipses = ran({"footprints", in("1") + ".db"});
    CHECK(ellipses.code == 0);
    for (const char* at : {"parachute", "backshell separation", "touchdown"})
        CHECK_THAT(ellipses.out, Catch::Contains(at));
    const auto both = ran({"compare", in("1") + ".db", in("2") + ".db"});
    CHECK(both.code == 0);
    CHECK_THAT(both.out, Catch::Contains("propellant_kg") && Catch::Contains("quantities differ"));

    const auto studied = ran({"sensitivity", "--scenario", scenario, "--cases", "2", "--folder", folder.path().string(),
                              "--csv", in("tornado.csv")});
    INFO(studied.out);
    CHECK(studied.code == 0);
    for (const char* group : {"delivery", "knowledge", "attitude", "imu", "density", "drag", "wind", "parachute",
                              "radar", "all errors at once", "root of sum of squares"})
        CHECK_THAT(studied.out, Catch::Contains(group));
    CHECK(std::filesystem::exists(folder / "tornado.csv"));

    // One line each.
    const std::vector<std::pair<std::vector<std::string>, const char*>> refused{
        {{"export", in("1") + ".db", "--csv", in("cases.csv")}, "cases.csv is there already"},
        {{"export", in("1") + ".db", "--hdf5", in("cases.h5")}, "cases.h5 is there already"},
        {{"export", in("1") + ".db"}, "--csv"},
        {{"export", in("none.db"), "--csv", in("new.csv")}, "none.db: "},
        {{"compare", in("1") + ".db", in("cases.csv")}, "cases.csv: "},
        {{"correlate", in("1") + ".db", "--figure", "luck"}, "has no quantity 'luck'"},
        {{"footprints"}, "FILE is required"},
        {{"sensitivity", "--scenario", scenario}, "--cases is required"},
        {{"--scenario", scenario}, "--cases is required"},
        {{"--cases", "3"}, "--scenario is required"},
    };
    for (const auto& [arguments, says] : refused) {
        const auto ended = ran(arguments);
        INFO(arguments.front() << " -> " << ended.code << ": " << ended.out);
        CHECK(ended.code != 0);
        CHECK_THAT(ended.out, Catch::Contains(says));
        CHECK(std::ranges::count(ended.out, '\n') == 1);
    }
}

TEST_CASE("the progress line tells cases, rate and what remains", "[campaign]") {
    CHECK(progress_line({.done = 0, .of = 10}) == "[>                             ] 0/10");
    CHECK(progress_line({.done = 15, .of = 30, .flown = 10, .wall_s = 5.0}) ==
          "[===============>              ] 15/30  2.00 cases/s, 0 min 08 s remain");
    CHECK_THAT(progress_line({.done = 30, .of = 30, .flown = 30, .wall_s = 5.0}),
               Catch::StartsWith("[==============================] 30/30"));
}

TEST_CASE("what is asked of a file of results ends when it is not wanted any more", "[campaign]") {
    const test::TemporaryFolder folder;
    run(folder / "a.db", 2'000, 1);
    auto results = CampaignResults::open(folder / "a.db", 2'000);
    REQUIRE(results);
    bool wanted = true;
    results->stop_when([&] { return !wanted; });
    CHECK(results->brief().ok());
    CHECK(results->arrivals(0, 2'000).ok());
    wanted = false;
    CHECK_FALSE(results->brief().ok());
    CHECK_FALSE(results->arrivals(0, 2'000).ok());
}

TEST_CASE("plots hold a dot a case and stay within their frames", "[campaign]") {
    const test::TemporaryFolder folder;
    run(folder / "a.db", 80, 2);
    auto results = CampaignResults::open(folder / "a.db", 80);
    REQUIRE(results);
    const auto summary = results->summary();
    REQUIRE(summary);
    REQUIRE(write_plots(*results, *summary, folder / "plots"));
    for (const auto& [name, dots] :
         {std::pair{"touchdown", 80}, std::pair{"parachute", 80}, std::pair{"touchdown_speed", 0}}) {
        std::ifstream stream{folder / "plots" / (std::string{name} + ".svg")};
        const std::string text{std::istreambuf_iterator<char>{stream}, {}};
        INFO(name);
        CHECK(text.starts_with("<svg "));
        CHECK(text.ends_with("</svg>\n"));
        CHECK(text.find("nan") == std::string::npos);
        CHECK(text.find("inf") == std::string::npos);
        int found = 0;
        for (std::size_t at = 0; (at = text.find("class=\"dot\"", at)) != std::string::npos; ++at) ++found;
        CHECK(found == dots);
    }
    CHECK_FALSE(write_plots(*results, *summary, folder / "a.db"));
}

TEST_CASE("a campaign counts the cases that were struck by what they had let go, and says how near the others came",
          "[campaign]") {
    const test::TemporaryFolder folder;
    run(folder / "a.db", 10, 2, [](std::uint64_t number) {
        CaseResult result = made_up(number);
        if (number == 4) result.separation = {{}, 7.5, "backshell"};
        if (number == 5) result.separation = {};
        return result;
    });
    const auto summary = summary_of(folder / "a.db", 10);
    CHECK(summary.recontacts == 1);
    CHECK(summary.heatshield_least_m.count == 0);
    CHECK(summary.backshell_least_m.count == 9);
    CHECK(summary.backshell_least_m.least == 7.5);
    const auto json = json_of(campaign_json(summary, {}, {}));
    CHECK(number_at(json, {"recontacts"}) == 1);
    CHECK(number_at(json, {"backshell_least_m", "max"}) == 310.0);
    CHECK_THAT(campaign_table(summary, {}, {}), Catch::Contains("1 recontacts; backshell never nearer than 7.5 m"));
}

}  // namespace server_campaign_test
