// SPDX-License-Identifier: Apache-2.0
#include "simulation/limits.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

namespace aeolis::simulation {
namespace {

using Bound = ExceededLimit::Bound;

/// The nearer of two distances that may not be known.
std::optional<double> nearer(const std::optional<double>& a, const std::optional<double>& b) {
    if (!a || !b) return a ? a : b;
    return std::min(*a, *b);
}

}  // namespace

const char* name_of(Verdict verdict) {
    switch (verdict) {
    case Verdict::flying: return "flying";
    case Verdict::landed: return "landed";
    case Verdict::landed_outside_limits: return "landed_outside_limits";
    case Verdict::lost: return "lost";
    }
    return "flying";
}

LandingFigures figures_of(const Landing& landing, std::optional<double> least_timeline_margin_s) {
    return {landing.outcome(),    landing.inspect().propellant_kg, landing.touchdown(), landing.parachute(),
            landing.separation(), least_timeline_margin_s};
}

Judgement judge(const Limits& limits, const LandingFigures& figures) {
    if (figures.outcome == Outcome::running) return {Verdict::flying, {}};
    if (figures.outcome != Outcome::touchdown) return {Verdict::lost, {}};
    Judgement judgement{Verdict::landed, {}};
    const auto is = [&](const char* name, std::optional<double> value, Bound bound, double limit) {
        if (!value || (bound == Bound::at_least ? *value >= limit : *value <= limit)) return;
        judgement.exceeded.push_back({name, *value, bound, limit});
        judgement.verdict = Verdict::landed_outside_limits;
    };
    is("propellant_left_min_kg", figures.propellant_left_kg, Bound::at_least, limits.propellant_left_min_kg);
    if (const auto& touchdown = figures.touchdown) {
        is("touchdown_vertical_max_mps", touchdown->vertical_mps, Bound::at_most, limits.touchdown_vertical_max_mps);
        is("touchdown_horizontal_max_mps", touchdown->horizontal_mps, Bound::at_most,
           limits.touchdown_horizontal_max_mps);
        is("touchdown_tilt_max_deg", touchdown->tilt_deg, Bound::at_most, limits.touchdown_tilt_max_deg);
    }
    is("recontact_min_m", nearer(figures.separation.heatshield_least_m, figures.separation.backshell_least_m),
       Bound::at_least, limits.recontact_min_m);
    if (const auto& parachute = figures.parachute) {
        is("parachute_mach_max", parachute->mach, Bound::at_most, limits.parachute_mach_max);
        is("parachute_pressure_max_Pa", parachute->dynamic_pressure_Pa, Bound::at_most,
           limits.parachute_pressure_max_Pa);
    }
    is("timeline_margin_min_s", figures.least_timeline_margin_s, Bound::at_least, limits.timeline_margin_min_s);
    return judgement;
}

std::string text_of(const std::vector<ExceededLimit>& exceeded) {
    std::string text;
    for (const ExceededLimit& one : exceeded) {
        std::array<char, 96> line{};
        std::snprintf(line.data(), line.size(), "%s %.4g instead of at %s %.4g", one.name, one.value,
                      one.bound == Bound::at_least ? "least" : "most", one.limit);
        if (!text.empty()) text += "; ";
        text += line.data();
    }
    return text;
}

std::string reason_of(const Landing& landing, const Judgement& judgement) {
    std::string reason = landing.outcome_reason();
    if (!judgement.exceeded.empty()) reason += "; outside limits: " + text_of(judgement.exceeded);
    return reason;
}

}  // namespace aeolis::simulation
