// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/gnc/edl_gnc.hpp"
#include "flight/kernel/outbox.hpp"

namespace aeolis::flight {

/// Tells ground once when GNC loses something that it needs, by event and tone: the IMU, its attitude, propellant.
///
/// In      what GNC tells, each cycle        Out   IMU_SILENT, IMU_HEARD_AGAIN, ATTITUDE_LOST, PROPELLANT_LOW; tones
class GncHealth {
  public:
    void watch(const Parameters& parameters, const gnc::Output& gnc, Outbox& out);

    template <typename Exchange>
    void carry(Exchange& exchange) {
        exchange(silent_s_, attitude_lost_, propellant_low_);
    }

  private:
    void watch_imu(const Parameters& parameters, const gnc::Output& gnc, Outbox& out);

    double silent_s_ = 0.0;  ///< as told last; 0 while the IMU speaks
    bool attitude_lost_ = false;
    bool propellant_low_ = false;
};

}  // namespace aeolis::flight
