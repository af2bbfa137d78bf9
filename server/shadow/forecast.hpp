// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "commands/request.hpp"
#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"
#include "server/campaign/case_result.hpp"
#include "server/rehearsal/scripted_landing.hpp"
#include "server/shadow/ground_flight.hpp"
#include "simulation/scenario.hpp"

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

// What would come of a landing: many cases flown from where it is, with and without what is assumed.
namespace aeolis::server::shadow {

/// What is assumed of a flight from its present on.
struct Assumption {
    /// Sent through the landing's own command path: the first at once, each other once those before are answered.
    std::vector<commands::Request> commands;
    std::vector<simulation::Fault> faults;  ///< from the next cycle on, whatever start they state

    bool empty() const { return commands.empty() && faults.empty(); }
};

struct ForecastOrder {
    std::uint64_t seed = 1;    ///< of the errors that are drawn anew
    std::uint64_t cases = 32;  ///< of each side
    unsigned jobs = 1;         ///< cases flown at a time
    bool idle = false;         ///< only while nothing else wants the processor
};

struct ForecastProgress {
    std::uint64_t done = 0, of = 0;                     ///< flights
    std::uint64_t without = 0, with = 0;                ///< of them, by side,
    std::uint64_t within_without = 0, within_with = 0;  ///< and those that landed within the limits
};

/// From what cases begin: the truth of a landing, an instructor's or a program's, which ground must not see; or the
/// flight that ground keeps by telemetry.
enum class Basis : std::uint8_t { truth, telemetry };
/// "truth", "telemetry".
const char* name_of(Basis basis);

/// What a case passed through, in ground's terms.
struct Course {
    /// Its truth at a whole second of the vehicle's clock.
    struct Second {
        float altitude_m = 0.0F;  ///< above the target's radius
        float speed_mps = 0.0F;
        double range_rate_mps = 0.0;  ///< of the distance from Earth
    };
    Sclk first;                              ///< of the seconds below, which follow each other
    std::vector<Second> seconds;             ///< from where the cases part
    std::vector<std::optional<Sclk>> fired;  ///< by row of the timeline, from the beginning of the forecast
};

/// Cases flown from a landing's present.
struct FlownForecast {
    Basis basis = Basis::truth;
    std::optional<double> heard_e_s;  ///< by telemetry: of the state last heard; none: from ground's solution alone
    std::optional<simulation::StateKnowledge> knowledge;  ///< by telemetry: how well that state was known
    double from_e_s = 0.0;                                ///< the landing's present, from which the assumption acts
    double apart_e_s = 0.0;                               ///< from which the cases' errors differ
    /// By number. The case of a number has the same errors on both sides. `with`: empty when nothing is assumed.
    std::vector<campaign::CaseResult> without, with;
    double processor_s = 0.0, wall_s = 0.0;
};

/// The most cases of a forecast. Chosen: some minutes of two processors, and enough for a 99 % interval of each time.
inline constexpr std::uint64_t forecast_cases_max = 1000;

/// Air acts later than this before entry, whatever the case: it begins at 250 km, some 80 s before entry.
inline constexpr double airless_before_entry_s = 100.0;

/// Flies `order.cases` copies of `landing`, whose state, masses and errors on board are the truth, to their ends,
/// without recorder and links as soon as no command is on its way.
///
/// Errors that lie ahead (air, wind, aerodynamics, parachute, ground, radar, luck of buses) are drawn anew, each case
/// from the seed and its number. They act from the air on: until then the cases of a side share one flight. Where the
/// scenario draws its own errors later than now, a case is the campaign's of that number instead.
///
/// In       stop: ends all flights with their next second. tell: on the calling thread, ten times a second
/// Out      depends on landing, assumption, seed and cases only, not on jobs
/// Memory   one landing a job, some megabytes
/// Faults   an Error names a command that is refused, a check that fails before the cases part, or says that it was
///          stopped; a check that fails in a case ends that case as lost, with its reason
Result<FlownForecast> forecast_from_truth(const ScriptedLanding& landing, const simulation::Scenario& scenario,
                                          const dictionary::Dictionary& dictionary, const Assumption& assumption,
                                          const ForecastOrder& order, const std::atomic<bool>& stop,
                                          const std::function<void(const ForecastProgress&)>& tell = {});

/// As forecast_by_ground(), without an assumption and from a flight at its present: what the cases pass through.
Result<std::vector<Course>> courses_by_ground(const ScriptedLanding& landing,
                                              const simulation::StateKnowledge& knowledge,
                                              const simulation::Scenario& scenario,
                                              const dictionary::Dictionary& dictionary, const ForecastOrder& order,
                                              const std::atomic<bool>& stop);

/// Flies copies of the flight that ground keeps, each with a draw of all errors: of the state, by how well it is known,
/// of air, vehicle and instruments, as large as the scenario says they may be. Otherwise as forecast_from_truth().
Result<FlownForecast> forecast_by_ground(const GroundFlight& ground, const simulation::Scenario& scenario,
                                         const dictionary::Dictionary& dictionary, const Assumption& assumption,
                                         const ForecastOrder& order, const std::atomic<bool>& stop,
                                         const std::function<void(const ForecastProgress&)>& tell = {});

}  // namespace aeolis::server::shadow
