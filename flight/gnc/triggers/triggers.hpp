// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/gnc/quantities.hpp"
#include "generated/dictionary_flight.hpp"

#include <cstdint>

// When GNC says "now": each trigger is a short list of conditions on navigated quantities, all of which must hold.
// The list itself is what explains the decision afterwards. R17, R38
//
// In       navigated speed (relative to Mars), altitude (above ground once the radar locked), descent rate, and times
// Rate     64 Hz        Memory   none; whoever asks keeps count of cycles held
// Source   [facts] Timeline; bounds that ground may change come with its solution
namespace aeolis::flight::gnc::triggers {

inline constexpr double guidance_start_drag_mps2 = parameters.guidance_start_drag_mps2;
inline constexpr double sufr_lead_s = parameters.sufr_lead_s;  ///< before the parachute
inline constexpr auto parachute_cycles = static_cast<std::uint32_t>(parameters.parachute_cycles);
inline constexpr auto backshell_cycles = static_cast<std::uint32_t>(parameters.backshell_cycles);
inline constexpr double heatshield_delay_s = parameters.heatshield_delay_min_s;  ///< after the mortar
inline constexpr double priming_lead_s = parameters.priming_lead_s;              ///< before backshell separation
inline constexpr double radar_patience_s = parameters.radar_patience_s;          ///< after heatshield separation
inline constexpr double sky_crane_settling_s = parameters.sky_crane_settle_s;    ///< to rover separation

/// Counts how long a condition has held without a break.
class Persistence {
  public:
    std::uint32_t on(bool holds) { return cycles_ = holds ? cycles_ + 1 : 0; }

    template <typename Exchange>
    void carry(Exchange& exchange) {
        exchange(cycles_);
    }

  private:
    std::uint32_t cycles_ = 0;
};

/// Whether a decision that does not fire is near enough to tell ground what holds it: its first condition, which is its
/// subject, holds or is within a twentieth of its bound. A mere timer never is. Ours.
bool near(const Conditions& conditions);

/// Without a count of cycles that has not begun: it says no more than the condition that it counts.
Conditions worth_telling(const Conditions& conditions);

Conditions guidance_start(double filtered_drag_mps2);
Conditions heading_alignment(double speed_mps);

/// What the triggers of the entry look at.
struct InAir {
    double speed_mps = 0.0;
    double altitude_m = 0.0;
    double descent_rate_mps = 0.0;
};
/// From ground's solution: the speed to wait for, and the altitude down to which that is allowed.
struct ParachuteBounds {
    double speed_mps = 0.0;
    double altitude_min_m = 0.0;
};

/// `deceleration_mps2`: of the speed, drag less what gravity adds; nil or less tells nothing and never fires.
///
/// Two ways: the parachute's speed is near, or its lowest altitude is. The second leaves time for the balance masses.
Conditions sufr_start(const InAir& at, double deceleration_mps2, const ParachuteBounds& bounds);

/// Slow enough; or so low that waiting to be slower is over: better too fast than too low.
bool parachute_due(const InAir& at, const ParachuteBounds& bounds);
Conditions parachute(const InAir& at, const ParachuteBounds& bounds, std::uint32_t cycles_held);
Conditions heatshield(double speed_mps, double heatshield_speed_mps, double since_parachute_s);

/// From ground's solution: an altitude, and the descent rate that it belongs to.
struct BackshellBounds {
    double altitude_m = 0.0;
    double descent_rate_mps = 0.0;
};

/// Altitude at which the backshell must go at a descent rate so that the same powered approach fits below: at the rate
/// of ground's solution its altitude; faster, higher by what free fall and the approach then need more.
double backshell_altitude_needed_m(const BackshellBounds& bounds, double descent_rate_mps);

/// Time is counted to the altitude of ground's solution: by then the descent rate is near its design value.
Conditions engine_priming(double altitude_m, double descent_rate_mps, double backshell_altitude_m);
Conditions backshell(double altitude_m, double descent_rate_mps, const BackshellBounds& bounds,
                     std::uint32_t cycles_held);

}  // namespace aeolis::flight::gnc::triggers
