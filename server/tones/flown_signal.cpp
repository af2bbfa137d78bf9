// SPDX-License-Identifier: Apache-2.0
#include "server/tones/flown_signal.hpp"

#include "server/rehearsal/scripted_landing.hpp"

#include <cmath>
#include <string_view>
#include <vector>

namespace aeolis::server {
namespace {

constexpr std::int64_t row_ticks = 4;

void add_outages(const simulation::Radio& radio, std::string_view event, double at_s, FlownSignal& flown) {
    for (const simulation::ToneOutage& outage : radio.tone_outages)
        if (outage.event == event) flown.outages.push_back({outage.name, at_s + outage.from_s, at_s + outage.to_s});
}

}  // namespace

FlownSignal fly_signal(simulation::Scenario scenario, std::uint64_t seed, std::uint64_t case_number,
                       const dictionary::Dictionary& dictionary, double from_before_entry_s) {
    FlownSignal flown;
    scenario.radio.tones_from_samples = true;  // the signal that reaches Earth, as transmitted
    ScriptedLanding landing{scenario, seed, case_number, dictionary};
    std::vector<double> time_s, doppler_hz, gain_db;
    bool set = false;
    while (!landing.landing().finished()) {
        landing.hear(landing.step());
        const simulation::CycleReport& report = landing.landing().report();
        for (const simulation::TruthEvent& event : report.events)
            add_outages(scenario.radio, event.name, event.e_s, flown);
        for (const simulation::SentSymbol& symbol : report.symbols)
            flown.tones.push_back({symbol.at - scenario.entry_sclk, symbol.tone.value});
        for (const simulation::XBandField& field : report.x_band) {
            if (set || field.e_s < -from_before_entry_s) continue;
            set = !field.up && !time_s.empty();
            flown.earth_set_s = field.e_s;
            const auto tick = static_cast<std::int64_t>(std::llround(field.e_s / seconds_per_tick));
            if (!field.up || tick % row_ticks != 0) continue;
            time_s.push_back(field.e_s);
            doppler_hz.push_back(field.doppler_hz);
            gain_db.push_back(field.gain_db);
        }
    }
    if (set) add_outages(scenario.radio, "earth_set", flown.earth_set_s, flown);
    if (auto table = TimeTable::make(time_s, std::move(doppler_hz))) flown.doppler_hz = *table;
    if (auto table = TimeTable::make(std::move(time_s), std::move(gain_db))) flown.gain_db = *table;
    return flown;
}

}  // namespace aeolis::server
