// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/landing.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

// Judges landings by the limits that the scenario sets; the same for rehearsals, campaigns and tests.
namespace aeolis::simulation {

enum class Verdict : std::uint8_t { flying, landed, landed_outside_limits, lost };
/// "flying", "landed", …
const char* name_of(Verdict verdict);

/// Figures by which a landing is judged. A figure not reached yet is none and violates no limit.
struct LandingFigures {
    Outcome outcome = Outcome::running;
    double propellant_left_kg = 0.0;
    std::optional<TouchdownReport> touchdown;
    std::optional<ParachuteReport> parachute;
    SeparationReport separation;
    std::optional<double> least_timeline_margin_s;  ///< from the recording, read by ground's dictionary
};
LandingFigures figures_of(const Landing& landing, std::optional<double> least_timeline_margin_s = {});

/// A limit that was exceeded.
struct ExceededLimit {
    enum class Bound : std::uint8_t { at_least, at_most };

    const char* name;  ///< of the scenario's field: "touchdown_vertical_max_mps"
    double value;
    Bound bound;
    double limit;
};

struct Judgement {
    Verdict verdict = Verdict::flying;
    std::vector<ExceededLimit> exceeded;  ///< of a landing only; for a lost vehicle the outcome says why
};
Judgement judge(const Limits& limits, const LandingFigures& figures);

/// "touchdown_vertical_max_mps 0.91 instead of at most 0.85; …"; empty when all were kept.
std::string text_of(const std::vector<ExceededLimit>& exceeded);
/// Why the landing ended as it did, with the limits that it exceeded.
std::string reason_of(const Landing& landing, const Judgement& judgement);

}  // namespace aeolis::simulation
