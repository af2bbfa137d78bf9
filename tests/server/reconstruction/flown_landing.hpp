// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/reconstruction/path.hpp"
#include "simulation/landing.hpp"
#include "telemetry/packet_stream.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"
#include "tests/support/telecommands.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

// A landing that was flown, for tests of its reconstruction: what it recorded, and the truth beside it, which the
// reconstruction never sees.
namespace aeolis::tests {

using flight::gnc::NavigatedState;
using reconstruction::LandingSite;
using reconstruction::Path;
using reconstruction::RecordedLanding;
using reconstruction::SensorErrors;

struct Truth {
    Sclk at;
    NavigatedState state;
    double density_kgm3 = 0.0;
};

struct Flown {
    std::vector<std::vector<std::uint8_t>> packets;
    std::vector<Truth> truth;         ///< of each tick from entry on
    std::optional<LandingSite> site;  ///< where the rover stands

    /// @param reset_e_s  when prime is reset; none: never
    explicit Flown(const simulation::Scenario& scenario, std::uint64_t seed, std::optional<double> reset_e_s = {}) {
        simulation::Landing landing{scenario, seed};
        landing.uplink(test::set_parameters(landing.solution()));
        for (int tick = 0; tick < 64; ++tick) landing.step();
        if (reset_e_s) landing.uplink(test::enable_second_chance());
        landing.uplink(test::do_edl());
        while (!landing.flown()) {
            landing.step();
            if (reset_e_s && landing.truth().e_s >= *reset_e_s) {
                landing.reset_prime();
                reset_e_s.reset();
            }
            if (landing.truth().e_s < -60.0 || landing.outcome() != simulation::Outcome::running) continue;
            note(landing.truth(), landing.inspect());
        }
        INFO(landing.outcome_reason());
        REQUIRE(landing.outcome() == simulation::Outcome::touchdown);
        site = LandingSite{landing.touchdown()->latitude_deg, landing.touchdown()->longitude_deg,
                           scenario.target.radius_m};
        telemetry::PacketStream stream{landing.recording()};
        while (const auto packet = stream.next()) packets.emplace_back(packet->begin(), packet->end());
    }
    void note(const simulation::TruthState& state, const simulation::Inspection& seen) {
        truth.push_back({state.sclk,
                         {flight::gnc::to_vector(state.p_MoB_M_m), flight::gnc::to_vector(state.v_MB_M_mps),
                          flight::gnc::to_quaternion(seen.q_MB)},
                         seen.density_kgm3});
    }
    /// Between ticks; none outside.
    std::optional<NavigatedState> true_at(Sclk at) const {
        const auto after = std::ranges::lower_bound(truth, at, {}, &Truth::at);
        if (after == truth.begin() || after == truth.end()) return std::nullopt;
        const auto before = std::prev(after);
        const double part = (at - before->at) / (after->at - before->at);
        return NavigatedState{before->state.p_MoB_M + part * (after->state.p_MoB_M - before->state.p_MoB_M),
                              before->state.v_MB_M + part * (after->state.v_MB_M - before->state.v_MB_M),
                              before->state.q_MB.slerp(part, after->state.q_MB)};
    }
    /// Between ticks, by its logarithm; none outside.
    std::optional<double> density_at_kgm3(Sclk at) const {
        const auto after = std::ranges::lower_bound(truth, at, {}, &Truth::at);
        if (after == truth.begin() || after == truth.end()) return std::nullopt;
        const auto before = std::prev(after);
        const double part = (at - before->at) / (after->at - before->at);
        return before->density_kgm3 * std::pow(after->density_kgm3 / before->density_kgm3, part);
    }
};

using Keep = std::function<bool(const std::vector<std::uint8_t>&)>;

inline RecordedLanding recorded_of(const Flown& flown, const Keep& keep = {}) {
    auto recorded = RecordedLanding::with(shipped_dictionary());
    REQUIRE(recorded);
    for (const auto& packet : flown.packets)
        if (!keep || keep(packet)) recorded->add(packet);
    CHECK(recorded->not_decoded() == 0);
    return *recorded;
}

inline Result<Path> rebuilt(const Flown& flown, const SensorErrors& errors = {}, const Keep& keep = {},
                            const std::optional<LandingSite>& site = {}) {
    return reconstruction::reconstruct(recorded_of(flown, keep), errors, site);
}

}  // namespace aeolis::tests
