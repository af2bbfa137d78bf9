// SPDX-License-Identifier: Apache-2.0
#include "flight/edl/gnc_health.hpp"

#include <utility>

namespace aeolis::flight {

void GncHealth::watch(const Parameters& parameters, const gnc::Output& gnc, Outbox& out) {
    watch_imu(parameters, gnc, out);
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

}  // namespace aeolis::flight
