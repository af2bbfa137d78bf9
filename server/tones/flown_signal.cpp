#include "server/tones/flown_signal.hpp"

#include "server/rehearsal/scripted_landing.hpp"
#include "simulation/mars/earth.hpp"
#include "simulation/vectors.hpp"

namespace aeolis::server {
namespace {

constexpr double light_speed_mps = 299792458.0; // [bipm-si]

} // namespace

FlownSignal fly_signal(simulation::Scenario scenario, std::uint64_t seed, std::uint64_t case_number,
                       const dictionary::Dictionary& dictionary, double from_before_entry_s) {
    FlownSignal flown;
    scenario.radio.tones_from_samples = false; // what is sent is the same
    flown.earth_set_s = scenario.radio.earth_set_after_entry_s;
    ScriptedLanding landing{scenario, seed, case_number, dictionary};
    std::vector<double> time_s, doppler_hz;
    double entry_sclk_s = 0.0;
    while (!landing.landing().finished()) {
        const simulation::CycleReport& report = landing.step();
        landing.hear(report);
        for (const simulation::TruthEvent& event : report.events)
            if (event.name == "parachute_deploy") flown.parachute_s = event.e_s;
        for (const simulation::ReceivedTone& tone : report.tones)
            if (tone.sent) flown.tones.push_back({tone.sent_at.seconds - entry_sclk_s, tone.sent->value});
        if (landing.landing().outcome() != simulation::Outcome::running) continue;
        const simulation::TruthState truth = landing.landing().truth();
        entry_sclk_s = truth.sclk.seconds - truth.e_s;
        if (truth.sclk.ticks() % 4 != 0 || truth.e_s < -from_before_entry_s) continue;
        time_s.push_back(truth.e_s);
        doppler_hz.push_back(-simulation::earth_range_rate_mps(simulation::vector3(truth.p_MoB_M_m),
                                                               simulation::vector3(truth.v_MB_M_mps), truth.e_s) /
                             light_speed_mps * dictionary.mfsk.carrier_hz);
    }
    if (auto table = TimeTable::make(std::move(time_s), std::move(doppler_hz))) flown.doppler_hz = *table;
    return flown;
}

} // namespace aeolis::server
