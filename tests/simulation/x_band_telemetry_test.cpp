// SPDX-License-Identifier: Apache-2.0
#include "generated/dictionary_flight.hpp"
#include "simulation/devices/avionics.hpp"
#include "simulation/landing.hpp"
#include "telemetry/proximity_packets.hpp"
#include "tests/simulation/gale.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"
#include "tests/support/telecommands.hpp"

#include <algorithm>
#include <map>
#include <vector>

namespace simulation_x_band_telemetry_test {

using namespace aeolis;
using namespace aeolis::simulation;

// Telemetry goes over X-band in cruise, and over UHF once X-band sends tones.
namespace {

/// What reached Earth up to an instant of a landing that starts at E-900 s; light time 0.
struct Heard {
    std::vector<std::uint8_t> radiated,
        came;  ///< octets given to the radio, and received on Earth, over whichever link
    std::map<std::string, std::pair<double, double>> octets_e_s;  ///< by link: of its first octets and its last
    std::size_t missing_frames = 0, packets = 0;
    std::optional<double> first_tone_e_s;
    std::size_t over_both = 0;  ///< cycles with octets from both links

    const std::pair<double, double>* of(const telemetry::Link& link) const {
        const auto found = octets_e_s.find(link.name);
        return found == octets_e_s.end() ? nullptr : &found->second;
    }
};

Heard hear(double until_e_s, std::vector<DeviceFault> faults = {}) {
    Scenario scenario = tests::gale_scenario(900.0);
    scenario.device_faults = std::move(faults);
    REQUIRE(impossible_values(scenario).empty());
    Landing landing{scenario, 1};
    landing.uplink(test::set_parameters(landing.solution()));
    for (int i = 0; i < 64; ++i) landing.step();
    landing.uplink(test::do_edl());
    Heard heard;
    telemetry::PltuReceiver pltus;
    telemetry::ProximityPackets packets;
    while (landing.sclk() - scenario.entry_sclk < until_e_s) {
        const CycleReport& report = landing.step();
        const double e_s = landing.sclk() - scenario.entry_sclk;
        heard.radiated.insert(heard.radiated.end(), report.radiated.begin(), report.radiated.end());
        for (const auto& piece : report.earth.octets) {
            heard.came.insert(heard.came.end(), piece.octets.begin(), piece.octets.end());
            heard.octets_e_s.try_emplace(piece.link.name, e_s, e_s).first->second.second = e_s;
            pltus.receive(piece.octets);
        }
        if (report.earth.octets.size() > 1) ++heard.over_both;
        while (const auto frame = pltus.next()) {
            packets.add(*frame);
            while (packets.next()) ++heard.packets;
        }
        if (!report.symbols.empty() && !heard.first_tone_e_s)
            heard.first_tone_e_s = report.symbols.front().at - scenario.entry_sclk;
    }
    heard.missing_frames = pltus.counters().missing_frames;
    return heard;
}

constexpr double on_the_bus_s = 1.0;  ///< from a row's instant to the end of its effect

std::vector<DeviceFault> both_units(flight::Device device, double begin_s, double duration_s) {
    std::vector<DeviceFault> faults;
    for (const auto unit : {flight::Unit::a, flight::Unit::b})
        faults.push_back({device, unit, DeviceFault::Kind::silent, begin_s, duration_s});
    return faults;
}

}  // namespace

TEST_CASE("telemetry goes over X-band until it sends tones, then over UHF, never over both, and nothing is lost",
          "[simulation][links][R30]") {
    const Heard heard = hear(-650.0);
    const auto* x_band = heard.of(telemetry::x_band_telemetry_link);
    const auto* uhf = heard.of(telemetry::uhf_live_link);
    REQUIRE(x_band != nullptr);
    REQUIRE(uhf != nullptr);
    CHECK(x_band->first < -898.0);
    CHECK(x_band->second == Approx(-750.0).margin(on_the_bus_s));
    CHECK(uhf->first >= x_band->second);
    CHECK(uhf->first < x_band->second + on_the_bus_s);
    CHECK(heard.over_both == 0);
    CHECK(heard.missing_frames == 0);
    CHECK(heard.packets > 100);
    // The end may still be under way.
    REQUIRE(heard.came.size() <= heard.radiated.size());
    CHECK(heard.radiated.size() - heard.came.size() < 300);
    CHECK(std::equal(heard.came.begin(), heard.came.end(), heard.radiated.begin()));
}

TEST_CASE("no tone is on the air before X-band goes over to them", "[simulation][links][R31]") {
    const Heard heard = hear(-700.0);
    REQUIRE(heard.first_tone_e_s);
    CHECK(*heard.first_tone_e_s == Approx(-750.0).margin(on_the_bus_s));
}

TEST_CASE("when UHF did not start there is no telemetry once X-band sends tones", "[simulation][links][faults][R30]") {
    const Heard heard = hear(-650.0, both_units(flight::Device::uhf, 810.0, 60.0));
    CHECK(heard.of(telemetry::uhf_live_link) == nullptr);
    REQUIRE(heard.of(telemetry::x_band_telemetry_link) != nullptr);
    CHECK(heard.of(telemetry::x_band_telemetry_link)->second == Approx(-750.0).margin(on_the_bus_s));
    CHECK(heard.first_tone_e_s);
}

TEST_CASE("X-band that does not go over to tones brings telemetry until the cruise stage takes its antenna away",
          "[simulation][links][faults][R30]") {
    const Heard heard = hear(-580.0, both_units(flight::Device::x_band, 760.0, 30.0));
    CHECK_FALSE(heard.first_tone_e_s);
    REQUIRE(heard.of(telemetry::x_band_telemetry_link) != nullptr);
    REQUIRE(heard.of(telemetry::uhf_live_link) != nullptr);
    CHECK(heard.of(telemetry::x_band_telemetry_link)->second == Approx(-600.0).margin(on_the_bus_s));
    CHECK(heard.of(telemetry::uhf_live_link)->first == Approx(-600.0).margin(on_the_bus_s));
}

TEST_CASE("a run that starts after a row for the radio starts as if it had been carried out", "[simulation][links]") {
    const auto& timeline = tests::shipped_dictionary().timeline;
    const auto row_e_s = [&](TimepointId id) { return timeline[id.value].desired_offset_s; };
    CHECK(row_e_s(flight::timepoint::uhf_start) == -Avionics::uhf_start_before_entry_s);
    CHECK(row_e_s(flight::timepoint::x_band_tones) == -Avionics::x_band_tones_before_entry_s);
    const auto on = [](double start_before_entry_s) {
        const Avionics devices{start_before_entry_s, Random{1, 0, Stream::devices}};
        return std::pair{devices.on(flight::SwitchId::uhf), devices.on(flight::SwitchId::x_band_tones)};
    };
    CHECK(on(800.0) == std::pair{false, false});
    CHECK(on(799.0) == std::pair{true, false});
    CHECK(on(750.0) == std::pair{true, false});
    CHECK(on(749.0) == std::pair{true, true});
}

}  // namespace simulation_x_band_telemetry_test
