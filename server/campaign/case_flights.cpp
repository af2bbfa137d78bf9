// SPDX-License-Identifier: Apache-2.0
#include "server/campaign/case_flights.hpp"

#include "common/check.hpp"
#include "simulation/limits.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

namespace aeolis::server::campaign {
namespace {

const std::atomic<bool> never{false};

constexpr double degree_rad = std::numbers::pi / 180.0;

/// SCLK from which the case differs from the others.
double dispersion_sclk(const simulation::Scenario& scenario) {
    return scenario.entry_sclk.seconds - scenario.disperse_before_entry_s.value_or(scenario.start_before_entry_s);
}

struct Place {
    double east_m = 0.0, north_m = 0.0;
};
Place place_of(double latitude_deg, double longitude_deg, const simulation::Target& target) {
    const double east_deg = std::remainder(longitude_deg - target.longitude_deg, 360.0);
    return {target.radius_m * std::cos(target.latitude_deg * degree_rad) * east_deg * degree_rad,
            target.radius_m * (latitude_deg - target.latitude_deg) * degree_rad};
}

}  // namespace

CaseFlights::CaseFlights(const simulation::Scenario& scenario, std::uint64_t seed,
                         const dictionary::Dictionary& dictionary)
    : CaseFlights(scenario, seed, dictionary, never) {}

CaseFlights::CaseFlights(const simulation::Scenario& scenario, std::uint64_t seed,
                         const dictionary::Dictionary& dictionary, const std::atomic<bool>& abandon)
    : scenario_(scenario), seed_(seed), dictionary_(dictionary), abandon_(abandon) {
    if (!simulation::disperses_later(scenario)) return;
    auto common = std::make_unique<Flight>(
        Flight{ScriptedLanding{scenario, seed, 0, dictionary}, RecordedFirings{dictionary}, {}, 0});
    const auto& landing = common->landing.landing();
    while (landing.outcome() == simulation::Outcome::running && landing.sclk().seconds < dispersion_sclk(scenario) &&
           !abandon_)
        common->step();
    common_ = std::move(common);
}

void CaseFlights::Flight::step() {
    auto& received = landing.step();
    ++cycles;
    if (!landing.script_sent()) {
        landing.hear(received);
        landing.take_stages();
    }
    const auto& report = landing.landing().report();
    firings.read(report.recorded);
    events.insert(events.end(), report.events.begin(), report.events.end());
}

std::unique_ptr<CaseFlights::Flight> CaseFlights::begun(std::uint64_t case_number) const {
    if (!common_)
        return std::make_unique<Flight>(
            Flight{ScriptedLanding{scenario_, seed_, case_number, dictionary_}, RecordedFirings{dictionary_}, {}, 0});
    auto flight = std::make_unique<Flight>(*common_);
    flight->landing.take_case(case_number);
    return flight;
}

std::optional<CaseResult> CaseFlights::fly(std::uint64_t case_number) const {
    if (abandon_) return std::nullopt;  // the common flight may be incomplete
    CaseResult result;
    result.number = case_number;
    std::unique_ptr<Flight> flight;
    const auto lost = [&](std::string why) {
        result.outcome = simulation::name_of(simulation::Outcome::lost);
        result.reason = std::move(why);
        if (flight) result.end_cycle = flight->cycles;
    };
    try {
        flight = begun(case_number);
        while (flight->landing.landing().outcome() == simulation::Outcome::running) {
            if (abandon_) return std::nullopt;
            flight->step();
        }
        result = result_of(flight->landing.landing(), flight->firings, flight->events, scenario_, dictionary_,
                           dispersion_sclk(scenario_));
        result.number = case_number;
        result.end_cycle = flight->cycles;
    } catch (const CheckFailed& bug) {
        lost(text_of_bug(bug));
    } catch (const std::exception& error) {
        lost(std::string{"the simulation ended: "} + error.what());
    }
    return result;
}

CaseResult result_of(const simulation::Landing& landing, const RecordedFirings& firings,
                     std::span<const simulation::TruthEvent> events, const simulation::Scenario& scenario,
                     const dictionary::Dictionary& dictionary, double from_sclk) {
    CaseResult result;
    result.outcome = simulation::name_of(landing.outcome());
    const auto least_margin_s = least_timeline_margin_s(firings.all(), dictionary);
    const auto judgement = simulation::judge(scenario.limits, simulation::figures_of(landing, least_margin_s));
    result.reason = simulation::reason_of(landing, judgement);
    result.limits_exceeded = judgement.exceeded.size();
    result.touchdown = landing.touchdown();
    if (result.touchdown) {
        const Place at = place_of(result.touchdown->latitude_deg, result.touchdown->longitude_deg, scenario.target);
        result.east_m = at.east_m;
        result.north_m = at.north_m;
    }
    result.parachute = landing.parachute();
    result.separation = landing.separation();
    result.peak_deceleration_mps2 = landing.peak_deceleration_mps2();
    result.propellant_kg = landing.inspect().propellant_kg;
    result.margins = timeline_margins(firings.all(), dictionary, from_sclk);
    for (const simulation::TruthEvent& event : events) {
        const auto& [x, y, z] = event.p_MoB_M_m;
        const Place at =
            place_of(std::atan2(z, std::hypot(x, y)) / degree_rad, std::atan2(y, x) / degree_rad, scenario.target);
        result.events.push_back({event.name, event.e_s, event.altitude_m, event.speed_mps, at.east_m, at.north_m});
    }
    result.draws = landing.draws();
    std::ranges::sort(result.events, {}, [](const CaseEvent& event) { return std::tie(event.e_s, event.name); });
    return result;
}

}  // namespace aeolis::server::campaign
