// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/gnc/edl_gnc.hpp"
#include "flight/kernel/outbox.hpp"

#include <cstdint>

namespace aeolis::flight {

/// Tells ground once when GNC loses something that it needs, by event and tone: the IMU, its attitude, propellant,
/// thrusters that do not obey, the word of the engine controllers. The last two are explained. R38
///
/// In      what GNC tells, each cycle
/// Out     IMU_SILENT, IMU_HEARD_AGAIN, ATTITUDE_LOST, PROPELLANT_LOW, THRUSTERS_NOT_FELT, THRUSTERS_FELT_AGAIN,
///         THRUSTERS_NOT_JUDGED, ENGINES_SILENT, ENGINES_HEARD_AGAIN; tones; explanations
class GncHealth {
  public:
    void watch(const Parameters& parameters, const gnc::Output& gnc, Outbox& out);

    template <typename Exchange>
    void carry(Exchange& exchange) {
        exchange(silent_s_, attitude_lost_, propellant_low_, thrusters_unfelt_, engines_silent_s_);
    }

  private:
    void watch_imu(const Parameters& parameters, const gnc::Output& gnc, Outbox& out);
    void watch_thrusters(const Parameters& parameters, const gnc::Output& gnc, Outbox& out);
    void watch_engines(const Parameters& parameters, const gnc::Output& gnc, Outbox& out);

    double silent_s_ = 0.0;  ///< as told last; 0 while the IMU speaks
    bool attitude_lost_ = false;
    bool propellant_low_ = false;
    std::uint8_t thrusters_unfelt_ = 0;  ///< judgements in a row
    double engines_silent_s_ = 0.0;      ///< as told last; 0 while they speak
};

}  // namespace aeolis::flight
