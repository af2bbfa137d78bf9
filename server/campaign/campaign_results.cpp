// SPDX-License-Identifier: Apache-2.0
#include "server/campaign/campaign_results.hpp"

#include "server/campaign/campaign_store.hpp"
#include "server/scenario/scenario_text.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <limits>
#include <map>

namespace aeolis::server::campaign {
namespace {

using archive::sqlite::Database;
using archive::sqlite::Mode;
using archive::sqlite::Statement;

constexpr const char* all = "flown";
constexpr const char* landed = "flown WHERE outcome = 'touchdown'";
constexpr const char* moments = "moments WHERE name = ?";

/// Passes each row to `take`; ends at the first Error.
Result<void> each_row(Statement& statement, const std::function<void(const Statement&)>& take) {
    for (;;) {
        const auto row = statement.step();
        if (!row) return row.error();
        if (!*row) return {};
        take(statement);
    }
}

}  // namespace

Result<ResultsHeader> results_header(const std::filesystem::path& file) {
    auto database = Database::open(file.string(), Mode::read_only);
    if (!database) return database.error();
    const auto id = database->integer_of("PRAGMA application_id");
    if (!id) return id.error();
    if (*id != campaign_application_id)
        return Error{file.string() + ": holds something else than a campaign's results"};
    const auto version = database->integer_of("SELECT schema_version FROM campaign");
    if (!version) return version.error();
    if (*version != campaign_schema_version)
        return Error{
            fmt::format("{}: schema_version: {} there, {} here", file.string(), *version, campaign_schema_version)};
    auto select =
        database->prepare("SELECT scenario, seed, cases, (SELECT count(*) FROM cases WHERE number <= campaign.cases)"
                          " FROM campaign");
    if (!select) return select.error();
    const auto row = select->step();
    if (!row) return row.error();
    if (!*row) return Error{file.string() + ": says of no campaign that it is its own"};
    return ResultsHeader{std::string{select->text(0)}, static_cast<std::uint64_t>(select->integer(1)),
                         static_cast<std::uint64_t>(select->integer(2)),
                         static_cast<std::uint64_t>(select->integer(3))};
}

double Summary::touchdown_fraction() const {
    return kept == 0 ? 0.0 : static_cast<double>(kept - failed) / static_cast<double>(kept);
}

Result<CampaignResults> CampaignResults::open(const std::filesystem::path& file, std::uint64_t cases) {
    // Not read-only: the last connection to close checkpoints the WAL into the file, which needs write access.
    auto database = Database::open(file.string(), Mode::read_write_create);
    if (!database) return database.error();
    const auto views = fmt::format("CREATE TEMP VIEW flown AS SELECT * FROM cases WHERE number <= {0};"
                                   "CREATE TEMP VIEW moments AS SELECT * FROM events WHERE case_number <= {0};"
                                   "CREATE TEMP VIEW allowances AS SELECT * FROM margins WHERE case_number <= {0};"
                                   "CREATE TEMP VIEW drawn AS SELECT * FROM draws WHERE case_number <= {0};",
                                   cases);
    if (const auto made = database->execute(views.c_str()); !made) return made.error();
    return CampaignResults{std::move(*database), cases};
}

Result<Spread> CampaignResults::spread(const char* column, const char* source, const std::string& name) {
    const bool has_where = std::string_view{source}.find(" WHERE ") != std::string_view::npos;
    const auto of = fmt::format("FROM {} {} {} IS NOT NULL", source, has_where ? "AND" : "WHERE", column);
    auto count = database_.prepare(fmt::format("SELECT count(*) {}", of).c_str());
    if (!count) return count.error();
    auto values = database_.prepare(fmt::format("SELECT {0} {1} ORDER BY {0}", column, of).c_str());
    if (!values) return values.error();
    if (!name.empty()) {
        count->bind(1, std::string_view{name});
        values->bind(1, std::string_view{name});
    }
    if (const auto row = count->step(); !row) return row.error();
    Spread spread;
    spread.count = static_cast<std::uint64_t>(count->integer(0));
    Moments moments_of;
    Percentile p1{0.01, spread.count}, p50{0.5, spread.count}, p99{0.99, spread.count};
    const auto read = each_row(*values, [&](const Statement& row) {
        const double value = row.real(0);
        if (moments_of.count() == 0) spread.least = value;
        spread.most = value;
        moments_of.add(value);
        p1.add(value);
        p50.add(value);
        p99.add(value);
    });
    if (!read) return read.error();
    spread.p1 = p1.value();
    spread.p50 = p50.value();
    spread.p99 = p99.value();
    spread.mean = moments_of.mean();
    spread.sigma = moments_of.deviation();
    return spread;
}

Result<Summary> CampaignResults::summary() {
    return read(true);
}
Result<Summary> CampaignResults::brief() {
    return read(false);
}

Result<Summary> CampaignResults::read(bool with_events) {
    const auto instant = archive::sqlite::Transaction::begin_read(database_);  // one snapshot, while cases may be added
    if (!instant) return instant.error();
    Summary summary;
    summary.cases = cases_;
    auto campaign = database_.prepare("SELECT scenario, seed FROM campaign");
    if (!campaign) return campaign.error();
    if (const auto row = campaign->step(); !row) return row.error();
    summary.scenario = campaign->text(0);
    summary.seed = static_cast<std::uint64_t>(campaign->integer(1));
    campaign->reset();

    if (const auto read = read_outcomes(summary); !read) return read.error();
    if (with_events)
        if (const auto read = read_events(summary); !read) return read.error();
    if (const auto read = read_spreads(summary); !read) return read.error();
    if (const auto read = read_margins(summary); !read) return read.error();
    if (const auto read = read_recontacts(summary); !read) return read.error();
    PlaneMoments plane;
    if (const auto read = each_touchdown_m([&](Point at) { plane.add(at.x, at.y); }); !read) return read.error();
    summary.ellipse = plane.ellipse_99();
    return summary;
}

Result<void> CampaignResults::read_outcomes(Summary& into) {
    auto outcomes = database_.prepare("SELECT outcome, count(*) AS n FROM flown GROUP BY outcome ORDER BY n DESC");
    if (!outcomes) return outcomes.error();
    const auto counted = each_row(*outcomes, [&](const Statement& row) {
        const auto count = static_cast<std::uint64_t>(row.integer(1));
        into.outcomes.emplace_back(row.text(0), count);
        into.kept += count;
        if (row.text(0) != "touchdown") into.failed += count;
    });
    if (!counted) return counted;
    auto outside = database_.integer_of("SELECT count(*) FROM flown WHERE limits_exceeded > 0");
    if (!outside) return outside.error();
    into.outside_limits = static_cast<std::uint64_t>(*outside);
    if (const auto read = read_failures("outcome <> 'touchdown'", into.failures); !read) return read;
    return read_failures("limits_exceeded > 0", into.outside);
}

Result<void> CampaignResults::read_failures(const char* condition, std::vector<Failure>& into) {
    auto failures = database_.prepare(fmt::format("SELECT number, outcome, reason, end_cycle FROM flown"
                                                  " WHERE {} ORDER BY number LIMIT ?",
                                                  condition)
                                          .c_str());
    if (!failures) return failures.error();
    failures->bind(1, static_cast<std::int64_t>(Summary::failures_max));
    return each_row(*failures, [&](const Statement& row) {
        into.push_back({static_cast<std::uint64_t>(row.integer(0)), std::string{row.text(1)}, std::string{row.text(2)},
                        static_cast<std::uint64_t>(row.integer(3))});
    });
}

Result<void> CampaignResults::read_events(Summary& into) {
    auto names = database_.prepare("SELECT name FROM moments GROUP BY name ORDER BY avg(e_s)");
    if (!names) return names.error();
    const auto read =
        each_row(*names, [&](const Statement& row) { into.events.push_back({std::string{row.text(0)}, {}, {}, {}}); });
    if (!read) return read;
    for (EventSpread& event : into.events)
        for (const auto& [column, spread_of] :
             {std::pair{"e_s", &EventSpread::e_s}, std::pair{"altitude_m", &EventSpread::altitude_m},
              std::pair{"speed_mps", &EventSpread::speed_mps}}) {
            const auto found = spread(column, moments, event.name);
            if (!found) return found.error();
            event.*spread_of = *found;
        }
    return {};
}

Result<void> CampaignResults::read_spreads(Summary& into) {
    struct Wanted {
        const char* column;
        const char* source;
        Spread* into;
    };
    for (const Wanted& wanted :
         {Wanted{"vertical_mps", landed, &into.vertical_mps}, Wanted{"horizontal_mps", landed, &into.horizontal_mps},
          Wanted{"miss_m", landed, &into.miss_m}, Wanted{"latitude_deg", landed, &into.latitude_deg},
          Wanted{"longitude_deg", landed, &into.longitude_deg}, Wanted{"propellant_kg", landed, &into.propellant_kg},
          Wanted{"parachute_mach", all, &into.parachute_mach},
          Wanted{"parachute_pressure_Pa", all, &into.parachute_pressure_Pa},
          Wanted{"peak_deceleration_mps2", all, &into.peak_deceleration_mps2},
          Wanted{"heatshield_least_m", all, &into.heatshield_least_m},
          Wanted{"backshell_least_m", all, &into.backshell_least_m}}) {
        const auto found = spread(wanted.column, wanted.source);
        if (!found) return found.error();
        *wanted.into = *found;
    }
    return {};
}

Result<void> CampaignResults::read_margins(Summary& into) {
    auto timepoints = database_.prepare("SELECT timepoint FROM allowances GROUP BY timepoint ORDER BY avg(place)");
    if (!timepoints) return timepoints.error();
    const auto read =
        each_row(*timepoints, [&](const Statement& row) { into.margins.push_back({std::string{row.text(0)}, {}}); });
    if (!read) return read;
    for (MarginSpread& margin : into.margins) {
        const auto found = spread("margin_s", "allowances WHERE timepoint = ?", margin.timepoint);
        if (!found) return found.error();
        margin.margin_s = *found;
    }
    auto least = database_.prepare("SELECT margin_s, timepoint, case_number FROM allowances"
                                   " ORDER BY margin_s, case_number LIMIT 1");
    if (!least) return least.error();
    return each_row(*least, [&](const Statement& row) {
        into.least_margin =
            LeastMargin{row.real(0), std::string{row.text(1)}, static_cast<std::uint64_t>(row.integer(2))};
    });
}

Result<void> CampaignResults::read_recontacts(Summary& into) {
    auto struck = database_.prepare("SELECT count(*) FROM flown WHERE struck_by IS NOT NULL");
    if (!struck) return struck.error();
    return each_row(*struck,
                    [&](const Statement& row) { into.recontacts = static_cast<std::uint64_t>(row.integer(0)); });
}

/// The figures by which cases are judged, without events, margins of each timepoint and draws.
Result<CaseTable> CampaignResults::figures() {
    constexpr std::array columns{"vertical_mps",
                                 "horizontal_mps",
                                 "miss_m",
                                 "latitude_deg",
                                 "longitude_deg",
                                 "east_m",
                                 "north_m",
                                 "tilt_deg",
                                 "peak_deceleration_mps2",
                                 "parachute_mach",
                                 "parachute_pressure_Pa",
                                 "propellant_kg",
                                 "heatshield_least_m",
                                 "backshell_least_m",
                                 "limits_exceeded"};
    CaseTable table;
    auto numbers = database_.prepare("SELECT number, outcome FROM flown ORDER BY number");
    if (!numbers) return numbers.error();
    const auto numbered = each_row(*numbers, [&](const Statement& row) {
        table.numbers.push_back(static_cast<std::uint64_t>(row.integer(0)));
        table.outcomes.emplace_back(row.text(1));
    });
    if (!numbered) return numbered.error();
    for (const char* column : columns)
        if (const auto read =
                read_cells(fmt::format("SELECT number, '{0}', {0} FROM flown ORDER BY number", column).c_str(), table);
            !read)
            return read.error();
    const auto read = read_cells("SELECT case_number, 'least_margin_s', min(margin_s) FROM allowances"
                                 " GROUP BY case_number ORDER BY case_number",
                                 table);
    if (!read) return read.error();
    return table;
}

Result<CampaignVerdict> CampaignResults::verdict() {
    const auto instant = archive::sqlite::Transaction::begin_read(database_);
    if (!instant) return instant.error();
    const auto limits = scenario();
    if (!limits) return limits.error();
    const auto table = figures();
    if (!table) return table.error();
    return verdict_of(*table, limits->limits);
}

Result<CaseTable> CampaignResults::table() {
    const auto instant = archive::sqlite::Transaction::begin_read(database_);
    if (!instant) return instant.error();
    const auto count = database_.integer_of("SELECT count(*) FROM flown");
    if (!count) return count.error();
    if (static_cast<std::uint64_t>(*count) > table_cases_max)
        return Error{fmt::format("{}: holds {} cases, a table at most {}", database_.file(), *count, table_cases_max)};
    auto table = figures();
    if (!table) return table;
    std::vector<std::string> queries;
    constexpr std::size_t queries_made = 7;
    queries.reserve(queries_made);
    for (const char* part : {"e_s", "altitude_m", "speed_mps", "east_m", "north_m"})
        queries.push_back(fmt::format("SELECT case_number, 'event.' || name || '.{0}', {0} FROM moments"
                                      " ORDER BY case_number, place",
                                      part));
    queries.emplace_back("SELECT case_number, 'margin.' || timepoint || '_s', margin_s FROM allowances"
                         " ORDER BY case_number, place");
    queries.emplace_back("SELECT case_number, 'draw.' || name, value FROM drawn ORDER BY case_number, name");
    for (const std::string& query : queries)
        if (const auto read = read_cells(query.c_str(), *table); !read) return read.error();
    return table;
}

/// Rows of case, column's name and value.
Result<void> CampaignResults::read_cells(const char* sql, CaseTable& into) {
    auto cells = database_.prepare(sql);
    if (!cells) return cells.error();
    std::map<std::string, std::size_t, std::less<>> places;  // of this query's columns
    return each_row(*cells, [&](const Statement& row) {
        const auto number = static_cast<std::uint64_t>(row.integer(0));
        const auto at = std::ranges::lower_bound(into.numbers, number);
        if (at == into.numbers.end() || *at != number) return;
        auto place = places.find(row.text(1));
        if (place == places.end()) {
            place = places.emplace(std::string{row.text(1)}, into.columns.size()).first;
            into.columns.push_back(
                {place->first, std::vector<double>(into.numbers.size(), std::numeric_limits<double>::quiet_NaN())});
        }
        if (!row.is_null(2))
            into.columns[place->second].values[static_cast<std::size_t>(at - into.numbers.begin())] = row.real(2);
    });
}

Result<simulation::Scenario> CampaignResults::scenario() {
    auto select = database_.prepare("SELECT scenario_text FROM campaign");
    if (!select) return select.error();
    if (const auto row = select->step(); !row) return row.error();
    return scenario_from_text(select->text(0), database_.file());
}

Result<std::vector<Touchdown>> CampaignResults::arrivals(std::uint64_t place, std::uint64_t limit) {
    auto select = database_.prepare("SELECT place, number, outcome, east_m, north_m FROM arrivals"
                                    " JOIN flown ON number = case_number WHERE place > ? ORDER BY place LIMIT ?");
    if (!select) return select.error();
    select->bind(1, static_cast<std::int64_t>(place)).bind(2, static_cast<std::int64_t>(limit));
    std::vector<Touchdown> touchdowns;
    const auto read = each_row(*select, [&](const Statement& row) {
        const auto metres = [&](int column) {
            return row.is_null(column) ? std::nullopt : std::optional{row.real(column)};
        };
        touchdowns.push_back({static_cast<std::uint64_t>(row.integer(0)), static_cast<std::uint64_t>(row.integer(1)),
                              std::string{row.text(2)}, metres(3), metres(4)});
    });
    if (!read) return read.error();
    return touchdowns;
}

Result<void> CampaignResults::each(const char* sql, const std::function<void(Point)>& take) {
    auto points = database_.prepare(sql);
    if (!points) return points.error();
    return each_row(*points, [&](const Statement& row) { take({row.real(0), row.real(1)}); });
}

Result<void> CampaignResults::each_touchdown_m(const std::function<void(Point)>& take) {
    return each("SELECT east_m, north_m FROM flown WHERE outcome = 'touchdown' ORDER BY number", take);
}
Result<void> CampaignResults::each_parachute(const std::function<void(Point)>& take) {
    return each("SELECT parachute_mach, parachute_pressure_Pa FROM flown WHERE parachute_mach IS NOT NULL"
                " ORDER BY number",
                take);
}
Result<void> CampaignResults::each_touchdown_speed_mps(const std::function<void(Point)>& take) {
    return each("SELECT vertical_mps, horizontal_mps FROM flown WHERE outcome = 'touchdown' ORDER BY number", take);
}

}  // namespace aeolis::server::campaign
