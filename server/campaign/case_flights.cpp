// SPDX-License-Identifier: Apache-2.0
#include "server/campaign/case_flights.hpp"

#include "common/check.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

namespace aeolis::server::campaign {
namespace {

const std::atomic<bool> never{false};

constexpr double degree_rad = std::numbers::pi / 180.0;

/// Whether the sequence passes from one anchor to another at this row.
bool begins_after_another_anchor(const dictionary::Dictionary& dictionary, std::size_t row) {
    const auto& timeline = dictionary.timeline;
    if (!timeline[row].anchor) return false;
    for (std::size_t before = row; before-- > 0;)
        if (timeline[before].anchor) return *timeline[before].anchor != *timeline[row].anchor;
    return true;
}

/// SCLK from which the case differs from the others.
double dispersion_sclk(const simulation::Scenario& scenario) {
    return scenario.entry_sclk.seconds - scenario.disperse_before_entry_s.value_or(scenario.start_before_entry_s);
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
    const auto& received = landing.step();
    ++cycles;
    if (!landing.script_sent()) {
        landing.hear(received);
        landing.take_stages();
    }
    const auto& report = landing.landing().report();
    firings.read(report.recorded);
    for (const auto& event : report.events)
        events.push_back({event.name, event.e_s, event.altitude_m, event.speed_mps});
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
        summarise(*flight, result);
    } catch (const CheckFailed& bug) {
        lost(text_of_bug(bug));
    } catch (const std::exception& error) {
        lost(std::string{"the simulation ended: "} + error.what());
    }
    return result;
}

void CaseFlights::summarise(const Flight& flight, CaseResult& result) const {
    const auto& landing = flight.landing.landing();
    result.outcome = simulation::name_of(landing.outcome());
    result.reason = landing.outcome_reason();
    result.end_cycle = flight.cycles;
    result.touchdown = landing.touchdown();
    if (result.touchdown) {
        const auto& target = scenario_.target;
        const double east_deg = std::remainder(result.touchdown->longitude_deg - target.longitude_deg, 360.0);
        result.east_m = target.radius_m * std::cos(target.latitude_deg * degree_rad) * east_deg * degree_rad;
        result.north_m = target.radius_m * (result.touchdown->latitude_deg - target.latitude_deg) * degree_rad;
    }
    result.parachute = landing.parachute();
    result.separation = landing.separation();
    result.peak_deceleration_mps2 = landing.peak_deceleration_mps2();
    result.propellant_kg = landing.inspect().propellant_kg;
    result.margins = timeline_margins(flight.firings.all(), dictionary_, dispersion_sclk(scenario_));
    result.events = flight.events;
    std::ranges::sort(result.events, {}, [](const CaseEvent& event) { return std::tie(event.e_s, event.name); });
}

std::vector<TimelineMargin> timeline_margins(const std::vector<RecordedFiring>& firings,
                                             const dictionary::Dictionary& dictionary, double after_sclk) {
    std::vector<TimelineMargin> margins;
    for (std::size_t i = 1; i < firings.size(); ++i) {
        const RecordedFiring& firing = firings[i];
        if (firing.row >= dictionary.timeline.size() || firing.triggered_sclk < after_sclk) continue;
        const auto& row = dictionary.timeline[firing.row];
        if (!row.minimum_offset_s || !begins_after_another_anchor(dictionary, firing.row)) continue;
        margins.push_back({firing.name, firing.triggered_sclk - (firings[i - 1].fired_sclk + *row.minimum_offset_s)});
    }
    return margins;
}

}  // namespace aeolis::server::campaign
