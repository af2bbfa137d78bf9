// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "server/archive/sqlite.hpp"
#include "server/campaign/case_table.hpp"
#include "server/campaign/limit_margins.hpp"
#include "server/campaign/statistics.hpp"
#include "simulation/scenario.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace aeolis::server::campaign {

/// Statistics of a number over the cases that have it.
struct Spread {
    std::uint64_t count = 0;
    double least = 0.0, p1 = 0.0, p50 = 0.0, p99 = 0.0, most = 0.0;
    double mean = 0.0, sigma = 0.0;
};

struct EventSpread {
    std::string name;
    Spread e_s, altitude_m, speed_mps;
};

/// A case that was lost, or that landed outside the scenario's limits.
struct Failure {
    std::uint64_t number = 0;
    std::string outcome, reason;
    std::uint64_t end_cycle = 0;
};

struct MarginSpread {
    std::string timepoint;
    Spread margin_s;
};

struct LeastMargin {
    double margin_s = 0.0;
    std::string timepoint;
    std::uint64_t number = 0;  ///< the case
};

/// Statistics of the cases 1 … `cases` of a file. Touchdown figures are of the cases with that outcome.
struct Summary {
    std::string scenario;
    std::uint64_t seed = 0;
    std::uint64_t cases = 0;                                      ///< requested
    std::uint64_t kept = 0;                                       ///< stored in the file
    std::vector<std::pair<std::string, std::uint64_t>> outcomes;  ///< most frequent first
    std::vector<EventSpread> events;                              ///< in the order of their mean time
    Spread vertical_mps, horizontal_mps, miss_m, latitude_deg, longitude_deg;
    Ellipse ellipse;
    Spread parachute_mach, parachute_pressure_Pa;
    Spread peak_deceleration_mps2, propellant_kg;
    Spread heatshield_least_m, backshell_least_m;  ///< of the cases in which the vehicle approached it again
    std::uint64_t recontacts = 0;
    std::vector<MarginSpread> margins;  ///< in the order of the timeline
    std::optional<LeastMargin> least_margin;
    std::vector<Failure> failures;  ///< the first `failures_max`
    std::uint64_t failed = 0;
    std::vector<Failure> outside;  ///< that landed, and not within the scenario's limits; the first `failures_max`
    std::uint64_t outside_limits = 0;

    static constexpr std::size_t failures_max = 20;  ///< chosen: a screenful; the file has them all

    double touchdown_fraction() const;
};

/// The campaign that a results file belongs to, and its size.
struct ResultsHeader {
    std::string scenario;
    std::uint64_t seed = 0;
    std::uint64_t cases = 0;  ///< requested by the last call
    std::uint64_t kept = 0;   ///< stored in the file
};
/// Reads the header. The Error names the file and, if it is not a campaign file of this version, says what it is.
Result<ResultsHeader> results_header(const std::filesystem::path& file);

/// The touchdown of a case.
struct Touchdown {
    std::uint64_t place = 0;  ///< rank in the order in which cases were stored
    std::uint64_t number = 0;
    std::string outcome;
    std::optional<double> east_m, north_m;  ///< relative to the target; none: it never touched down
};

/// The results of a campaign, read from its file row by row; rows are not kept.
class CampaignResults {
  public:
    /// Opens the results of the cases 1 … `cases`.
    static Result<CampaignResults> open(const std::filesystem::path& file, std::uint64_t cases);
    /// Sets the stop condition: a query ends with an Error soon after `stop` returns true.
    void stop_when(std::function<bool()> stop) { database_.stop_when(std::move(stop)); }

    Result<Summary> summary();
    /// The summary without events, whose statistics take most of the time.
    Result<Summary> brief();
    /// All numbers of all cases. Fails with more than table_cases_max.
    Result<CaseTable> table();
    /// Whether the campaign passes by its scenario's limits. Of any number of cases.
    Result<CampaignVerdict> verdict();
    /// The scenario that the file keeps.
    Result<simulation::Scenario> scenario();
    /// At most `limit` touchdowns whose place is after `place`, in order.
    Result<std::vector<Touchdown>> arrivals(std::uint64_t place, std::uint64_t limit);

    struct Point {
        double x = 0.0, y = 0.0;
    };
    Result<void> each_touchdown_m(const std::function<void(Point east_north)>& take);
    Result<void> each_parachute(const std::function<void(Point mach_pressure_Pa)>& take);
    Result<void> each_touchdown_speed_mps(const std::function<void(Point vertical_horizontal)>& take);

  private:
    CampaignResults(archive::sqlite::Database database, std::uint64_t cases)
        : database_(std::move(database)), cases_(cases) {}
    /// Statistics of a column of `source`; `name` is bound when `source` has a parameter.
    Result<Spread> spread(const char* column, const char* source, const std::string& name = {});
    Result<void> each(const char* sql, const std::function<void(Point)>& take);
    Result<Summary> read(bool with_events);
    Result<CaseTable> figures();
    Result<void> read_cells(const char* sql, CaseTable& into);
    Result<void> read_outcomes(Summary& into);
    Result<void> read_failures(const char* condition, std::vector<Failure>& into);
    Result<void> read_events(Summary& into);
    Result<void> read_spreads(Summary& into);
    Result<void> read_margins(Summary& into);
    Result<void> read_recontacts(Summary& into);

    archive::sqlite::Database database_;
    std::uint64_t cases_;
};

}  // namespace aeolis::server::campaign
