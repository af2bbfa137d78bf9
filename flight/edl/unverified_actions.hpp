// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/fixed_vector.hpp"
#include "flight/gnc/edl_gnc.hpp"
#include "flight/kernel/outbox.hpp"
#include "flight/timeline/timeline.hpp"

namespace aeolis::flight {

/// Follows actions whose reply did not come in time. R50
///
/// In       unverified firings, replies that no timepoint awaits, GNC's output
/// Out      a late reply verifies the action and announces it (TIMEPOINT_VERIFIED_LATE), or refuses it
///          (TIMEPOINT_REFUSED). The IMU bears out an action taken as done (TIMEPOINT_FELT) or contradicts it
///          (TIMEPOINT_CONTRADICTED). The configuration follows
/// Memory   the last 16 actions
/// Reset    not handed over: the other computer keeps the assumptions of the configuration
class UnverifiedActions {
  public:
    void add(const Firing& firing);

    /// Takes a reply. True: it was that of an unverified action.
    bool on(const ActionReply& reply, ActionContext& context);

    /// Judges a silent mortar by the force that the IMU senses. Other actions give too small a kick. While the IMU is
    /// silent GNC's force is reckoned, which is no evidence: a mortar in whose time it was silent stays unverified.
    void watch(const Parameters& parameters, const gnc::Output& gnc, gnc::Configuration& configuration, Outbox& out);

  private:
    struct Unverified {
        Firing firing;
        bool by_imu = false;   // the IMU still has to decide
        bool unheard = false;  // the IMU was silent meanwhile
        double felt_mps2 = 0.0;
    };
    static constexpr std::size_t kept_max = 16;
    FixedVector<Unverified, kept_max> kept_;
};

/// Reports how an awaited action ended: an event, and unless it is verified a tone and an explanation.
void tell_reply(const Firing& firing, const TimepointSpec& row, Outbox& out);

}  // namespace aeolis::flight
