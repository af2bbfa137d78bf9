// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/fixed_vector.hpp"
#include "flight/gnc/edl_gnc.hpp"
#include "flight/kernel/outbox.hpp"
#include "flight/timeline/timeline.hpp"

#include <span>

namespace aeolis::flight {

/// Follows actions whose reply did not come in time, and those of which the IMU knows better than the reply. R50
///
/// In       firings, replies that no timepoint awaits, GNC's output
/// Out      a late reply verifies the action and announces it (TIMEPOINT_VERIFIED_LATE), or refuses it
///          (TIMEPOINT_REFUSED). The IMU bears out an action that was not verified (TIMEPOINT_FELT), also one that was
///          refused, or contradicts one that was not refused (TIMEPOINT_CONTRADICTED). The configuration follows, but
///          for a verified action that the IMU contradicts: were it not done, nothing would be lost by flying on
/// Memory   the last 16 actions
/// Reset    not handed over: the other computer keeps the assumptions of the configuration
class UnverifiedActions {
  public:
    /// Keeps a firing that something may still be learnt about.
    void add(const Firing& firing);

    /// Takes a reply. True: it was that of an unverified action.
    bool on(const ActionReply& reply, ActionContext& context);

    /// Judges a mortar by the force that the IMU senses. Other actions give too small a kick. While the IMU is silent
    /// GNC's force is reckoned, which is no evidence: of a mortar in whose time it was silent nothing is said.
    void watch(const Parameters& parameters, const gnc::Output& gnc, gnc::Configuration& configuration, Outbox& out);

  private:
    struct Followed {
        Firing firing;
        bool by_imu = false;   // the IMU still has to decide
        bool unheard = false;  // the IMU was silent meanwhile
        double felt_mps2 = 0.0;
    };
    static void tell_felt(const Followed& followed, gnc::Configuration& configuration, Outbox& out);
    static void tell_not_felt(const Followed& followed, std::span<const gnc::Condition> conditions,
                              gnc::Configuration& configuration, Outbox& out);

    static constexpr std::size_t kept_max = 16;
    FixedVector<Followed, kept_max> kept_;
};

/// Reports how an awaited action ended: an event, and unless it is verified a tone and an explanation.
void tell_reply(const Firing& firing, const TimepointSpec& row, Outbox& out);

}  // namespace aeolis::flight
