// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/fixed_vector.hpp"
#include "flight/gnc/edl_gnc.hpp"
#include "flight/kernel/outbox.hpp"
#include "flight/timeline/timeline.hpp"

#include <optional>
#include <span>

namespace aeolis::flight {

/// Follows actions whose reply did not come in time, and those of which something else on board knows better than the
/// reply. R50
///
/// In       firings, replies that no timepoint awaits, GNC's output, the bridle's length
/// Out      a late reply verifies the action (TIMEPOINT_VERIFIED_LATE), also one that was refused, or refuses it
///          (TIMEPOINT_REFUSED). A witness bears out an action that was not verified, also one that was refused: the
///          IMU a mortar (TIMEPOINT_FELT), others as below (TIMEPOINT_WITNESSED). Whichever comes first announces the
///          action; the other announces nothing more. The IMU contradicts a mortar that was
///          not refused (TIMEPOINT_CONTRADICTED). The configuration follows, but for a verified action that the IMU
///          contradicts: were it not done, nothing would be lost by flying on. A refusal after a witness has borne the
///          action out changes nothing (REPLY_CONTRADICTS)
/// Memory   the last 16 actions
/// Reset    handed over. What a witness said between the last state of the one computer and the first cycle of the
///          other is not known: then the IMU still bears out, but contradicts nothing
///
///   action                 witness    bears it out by
///   parachute mortar       IMU        its load, which the air alone does not give
///   heatshield separation  radar      a solution: it sees nothing through the heatshield
///   engine valves          engines    their controllers' report, which comes with open valves
///   backshell separation   IMU        free fall before the engines push: the parachute carries no more
///   rover separation       bridle     being paid out
///
/// Source   ours: which devices tell of another's deed. Radar, engine controllers and bridle are assumed to be right;
///          in the simulation they tell its truth, so that no landing has a wrong one
class UnverifiedActions {
  public:
    /// Keeps a firing that something may still be learnt about.
    void add(const Firing& firing);

    /// Takes a reply. True: it was that of an unverified action.
    bool on(const ActionReply& reply, ActionContext& context);

    /// Hears the witnesses, once a cycle. The IMU is one only while it measures: what GNC reckons is no evidence. Of a
    /// mortar in whose time it was silent, or before which as much was felt, nothing is said. A single increment is no
    /// evidence either.
    void watch(const Parameters& parameters, const gnc::Output& gnc, double bridle_m, gnc::Configuration& configuration,
               Outbox& out);

    /// Takes note that cycles were missed, by a computer that takes over.
    void miss_some();

    template <typename Exchange>
    void carry(Exchange& exchange) {
        exchange(kept_, felt_before_mps2_);
    }

  private:
    enum class By : std::uint8_t { nothing, imu_load, imu_free_fall, radar, engines, bridle };
    struct Followed {
        Firing firing;
        By by{};                   // has not spoken yet
        double before_mps2 = 0.0;  // felt when the action's reply came, or should have
        double felt_mps2 = 0.0;    // most since
        std::uint16_t cycles = 0;  // in a row, in which the witness bore it out
        bool borne_out = false;
        bool unheard = false;  // the IMU was silent meanwhile, or nobody listened

        template <typename Exchange>
        void carry(Exchange& exchange) {
            exchange(firing, by, before_mps2, felt_mps2, cycles, borne_out, unheard);
        }
    };
    static By witness_of(const Firing& firing);
    static std::optional<gnc::Condition> said(const Followed& followed, const Parameters& parameters,
                                              const gnc::Output& gnc, double bridle_m);
    static void bear_out(Followed& followed, std::span<const gnc::Condition> conditions,
                         gnc::Configuration& configuration, Outbox& out);
    static void contradict(Followed& followed, std::span<const gnc::Condition> conditions,
                           gnc::Configuration& configuration, Outbox& out);

    static constexpr std::size_t kept_max = 16;
    FixedVector<Followed, kept_max> kept_;
    double felt_before_mps2_ = 0.0;  // in the last cycle in which the IMU measured
};

/// Reports how an awaited action ended: an event, and unless it is verified a tone and an explanation.
void tell_reply(const Firing& firing, const TimepointSpec& row, Outbox& out);

}  // namespace aeolis::flight
