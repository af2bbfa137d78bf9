// SPDX-License-Identifier: Apache-2.0
#include "server/rehearsal/predicted_doppler.hpp"

#include "common/check.hpp"
#include "simulation/initial_state.hpp"
#include "simulation/landing.hpp"
#include "simulation/mars/earth.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace aeolis::server {
namespace {

constexpr double light_mps = 299792458.0;  // [bipm-si]
// Chosen: before anything of the cruise stage is cut, the first at E−608 s.
constexpr double flown_from_before_entry_s = 620.0, coast_row_s = 10.0;
constexpr std::int64_t flight_row_ticks = 4;

struct DopplerRows {
    double carrier_hz;
    std::vector<double> time_s{}, doppler_hz{};

    void add(double e_s, const simulation::Vector3& p_MoB_M, const simulation::Vector3& v_MB_M) {
        time_s.push_back(e_s);
        doppler_hz.push_back(-simulation::earth_range_rate_mps(p_MoB_M, v_MB_M, e_s) / light_mps * carrier_hz);
    }
};

}  // namespace

PredictedFlight predicted_flight(const simulation::Scenario& scenario, const MfskWaveform& waveform) {
    simulation::Scenario expected = simulation::as_believed(simulation::undispersed(scenario));
    expected.disperse_before_entry_s.reset();
    expected.test_venue = simulation::TestVenue::gnc_alone;
    expected.radio = {};
    expected.radio.tones_from_samples = false;
    expected.start_before_entry_s = std::min(scenario.start_before_entry_s, flown_from_before_entry_s);

    DopplerRows rows{waveform.carrier_hz};
    std::vector<double> reversals_s;
    const simulation::InitialState start =
        simulation::state_before_entry(expected, scenario.start_before_entry_s, 0, 0);
    simulation::PointMass at = start.truth;
    for (double e_s = -scenario.start_before_entry_s; e_s < -expected.start_before_entry_s; e_s += coast_row_s) {
        rows.add(e_s, at.p_MoB_M, at.v_MB_M);
        at = simulation::coast(at, coast_row_s);
    }
    // The last coasting row may be closer than its step to the first flown row: TimeTable accepts any distance.
    simulation::Landing landing{expected, 0, 0};
    while (landing.outcome() == simulation::Outcome::running) {
        const simulation::TruthState truth = landing.truth();
        if (truth.sclk.ticks() % flight_row_ticks == 0)
            rows.add(truth.e_s, simulation::vector3(truth.p_MoB_M_m), simulation::vector3(truth.v_MB_M_mps));
        for (const auto& event : landing.step().events)
            if (event.name.starts_with("bank_reversal")) reversals_s.push_back(event.e_s);
    }
    auto table = TimeTable::make(std::move(rows.time_s), std::move(rows.doppler_hz));
    AEOLIS_CHECK(table.ok());
    return {std::move(*table), std::move(reversals_s)};
}

TimeTable predicted_doppler_hz(const simulation::Scenario& scenario, const MfskWaveform& waveform) {
    return predicted_flight(scenario, waveform).doppler_hz;
}

}  // namespace aeolis::server
