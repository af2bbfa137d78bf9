// SPDX-License-Identifier: Apache-2.0
#include "flight/edl/gnc_health.hpp"

#include "flight/explanation/explanation.hpp"

#include <array>
#include <utility>

namespace aeolis::flight {
namespace {

void explain_lost(Device device, std::span<const gnc::Condition> conditions, Outbox& out) {
    out.record(explanation(Decision::device_lost, ExplanationVerdict::decided, static_cast<std::uint16_t>(device),
                           conditions));
}

}  // namespace

void GncHealth::watch(const Parameters& parameters, const gnc::Output& gnc, Outbox& out) {
    watch_imu(parameters, gnc, out);
    watch_thrusters(parameters, gnc, out);
    watch_engines(parameters, gnc, out);
    if (const bool was = std::exchange(attitude_lost_, gnc.attitude_uncertainty_deg >= parameters.attitude_lost_deg);
        attitude_lost_ && !was) {
        out.event(evr::ATTITUDE_LOST{.attitude_uncertainty_deg = single(gnc.attitude_uncertainty_deg)});
        out.send(ModuleId::mfsk, ToneRequest{tone::attitude_lost, out.now()});
    }
    if (!gnc.propellant_low || std::exchange(propellant_low_, true)) return;
    out.event(evr::PROPELLANT_LOW{.propellant_kg = single(gnc.propellant_kg), .altitude_m = single(gnc.altitude_m)});
    out.send(ModuleId::mfsk, ToneRequest{tone::propellant_low, out.now()});
}

// A tick without samples is no silence: messages are garbled now and then.
void GncHealth::watch_imu(const Parameters& parameters, const gnc::Output& gnc, Outbox& out) {
    const double before_s = silent_s_;
    if (gnc.dead_reckoned_s == 0.0) {
        silent_s_ = 0.0;
        if (before_s > 0.0)
            out.event(evr::IMU_HEARD_AGAIN{.dead_reckoned_s = before_s,
                                           .attitude_uncertainty_deg = single(gnc.attitude_uncertainty_deg),
                                           .velocity_uncertainty_mps = single(gnc.velocity_uncertainty_mps),
                                           .altitude_uncertainty_m = single(gnc.altitude_uncertainty_m)});
    } else if (gnc.dead_reckoned_s >= parameters.imu_silence_told_s) {
        silent_s_ = gnc.dead_reckoned_s;
        if (before_s > 0.0) return;
        out.event(evr::IMU_SILENT{.dead_reckoned_s = silent_s_});
        out.send(ModuleId::mfsk, ToneRequest{tone::imu_silent, out.now()});
    }
}

void GncHealth::watch_thrusters(const Parameters& parameters, const gnc::Output& gnc, Outbox& out) {
    const auto in_a_row = static_cast<std::uint8_t>(parameters.thrusters_unfelt_windows);
    const bool told = thrusters_unfelt_ >= in_a_row;
    const bool over = gnc.mode > gnc::Mode::parachute_descent;  // engines steer from then on
    if (!gnc.thrusters_judged && (!told || over)) {
        if (told) out.event(evr::THRUSTERS_NOT_JUDGED{});
        thrusters_unfelt_ = 0;
    }
    if (!gnc.thrusters_felt) return;
    const double felt = *gnc.thrusters_felt;
    if (felt >= parameters.thrusters_felt_min) {
        thrusters_unfelt_ = 0;
        if (told) out.event(evr::THRUSTERS_FELT_AGAIN{.thrusters_felt = single(felt)});
        return;
    }
    if (told || ++thrusters_unfelt_ < in_a_row) return;
    out.event(evr::THRUSTERS_NOT_FELT{.thrusters_felt = single(felt)});
    out.send(ModuleId::mfsk, ToneRequest{tone::thrusters_not_felt, out.now()});
    explain_lost(Device::thrusters,
                 std::array{below(Quantity::thrusters_felt, felt, parameters.thrusters_felt_min),
                            at_least(Quantity::judgements_in_a_row, thrusters_unfelt_, in_a_row)},
                 out);
}

void GncHealth::watch_engines(const Parameters& parameters, const gnc::Output& gnc, Outbox& out) {
    const double before_s = engines_silent_s_;
    const auto silent = at_least(Quantity::engines_silent_s, gnc.engines_silent_s, parameters.engines_silent_told_s);
    engines_silent_s_ = silent.holds ? gnc.engines_silent_s : 0.0;
    if (before_s > 0.0 && gnc.engines_heard) out.event(evr::ENGINES_HEARD_AGAIN{.engines_silent_s = before_s});
    if (before_s > 0.0 || !silent.holds) return;
    out.event(evr::ENGINES_SILENT{.engines_silent_s = gnc.engines_silent_s});
    out.send(ModuleId::mfsk, ToneRequest{tone::engines_silent, out.now()});
    explain_lost(Device::descent_engines, {&silent, 1}, out);
}

}  // namespace aeolis::flight
