// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "server/archive/sqlite.hpp"
#include "server/campaign/statistics.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace aeolis::server::campaign {

/// How a number is spread over the cases that have it.
struct Spread {
    std::uint64_t count = 0;
    double least = 0.0, p1 = 0.0, p50 = 0.0, p99 = 0.0, most = 0.0;
    double mean = 0.0, sigma = 0.0;
};

struct EventSpread {
    std::string name;
    Spread e_s, altitude_m, speed_mps;
};

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

/// What the cases 1 … `cases` of a file come to. Touchdown's numbers are of the cases with that outcome.
struct Summary {
    std::string scenario;
    std::uint64_t seed = 0;
    std::uint64_t cases = 0;                                      ///< asked for
    std::uint64_t kept = 0;                                       ///< that the file holds of them
    std::vector<std::pair<std::string, std::uint64_t>> outcomes;  ///< most frequent first
    std::vector<EventSpread> events;                              ///< in the order of their mean time
    Spread vertical_mps, horizontal_mps, miss_m, latitude_deg, longitude_deg;
    Ellipse ellipse;
    Spread parachute_mach, parachute_pressure_Pa;
    Spread peak_deceleration_mps2, propellant_kg;
    Spread heatshield_least_m, backshell_least_m;  ///< of the cases in which the vehicle came nearer to it again
    std::uint64_t recontacts = 0;
    std::vector<MarginSpread> margins;  ///< in the order of the timeline
    std::optional<LeastMargin> least_margin;
    std::vector<Failure> failures;  ///< the first `failures_max`
    std::uint64_t failed = 0;

    static constexpr std::size_t failures_max = 20;  ///< ours: a screenful; the file has them all

    double touchdown_fraction() const;
};

/// What a file of results says of itself, now.
struct Heading {
    std::string scenario;
    std::uint64_t seed = 0;
    std::uint64_t cases = 0;  ///< that the last call asked for
    std::uint64_t kept = 0;   ///< that the file holds of them
};
/// An Error names the file, and what it is when it is no campaign's of this version.
Result<Heading> heading_of(const std::filesystem::path& file);

/// Where a case came to the ground.
struct Touchdown {
    std::uint64_t place = 0;  ///< in the order in which the cases came
    std::uint64_t number = 0;
    std::string outcome;
    std::optional<double> east_m, north_m;  ///< of the target; none: it never touched down
};

/// The results of a campaign, read from its file: rows pass one after another and are not kept.
class CampaignResults {
  public:
    /// Of the cases 1 … `cases`.
    static Result<CampaignResults> open(const std::filesystem::path& file, std::uint64_t cases);
    /// From now on what is asked ends with an Error soon after `stop` says so.
    void stop_when(std::function<bool()> stop) { database_.stop_when(std::move(stop)); }

    Result<Summary> summary();
    /// Without events, whose spreads take most of the time.
    Result<Summary> brief();
    /// Those that came after `place`, in that order, `limit` at most.
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
    /// Of a column of `source`; `name` is bound when it has a parameter.
    Result<Spread> spread(const char* column, const char* source, const std::string& name = {});
    Result<void> each(const char* sql, const std::function<void(Point)>& take);
    Result<Summary> read(bool with_events);
    Result<void> read_outcomes(Summary& into);
    Result<void> read_events(Summary& into);
    Result<void> read_spreads(Summary& into);
    Result<void> read_margins(Summary& into);
    Result<void> read_recontacts(Summary& into);

    archive::sqlite::Database database_;
    std::uint64_t cases_;
};

}  // namespace aeolis::server::campaign
