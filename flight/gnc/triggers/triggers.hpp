// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/gnc/quantities.hpp"
#include "generated/parameters.hpp"

#include <cstdint>

// GNC's triggers ("now"): each a short list of conditions on navigated quantities that must all hold.
// The same list explains the decision afterwards. R17, R38
//
// In       navigated speed (relative to Mars), altitude (above ground once the radar locked), descent rate, and times
// Rate     64 Hz        Memory   none; the caller counts the cycles for which a condition has held
// Source   [facts] Timeline; bounds that ground may change are part of its solution
namespace aeolis::flight::gnc::triggers {

/// Counts the consecutive cycles for which a condition has held.
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

/// Whether a decision that is held is near enough to be reported with the conditions that hold it.
/// Either its first condition, the subject, holds, or one that does not hold is within a part of its bound
/// (held_near_fraction). A timer alone is never near. A decision that has alternatives lists all of them while none
/// holds.
bool near(const Parameters& parameters, const Conditions& conditions);

/// The conditions without a cycle count of zero, which only repeats the condition that it counts.
Conditions worth_telling(const Conditions& conditions);

Conditions guidance_start(const Parameters& parameters, double filtered_drag_mps2);
Conditions heading_alignment(const Parameters& parameters, double speed_mps);

/// Quantities that the triggers of the entry use.
struct InAir {
    double speed_mps = 0.0;
    double altitude_m = 0.0;
    double descent_rate_mps = 0.0;
    double dynamic_pressure_Pa = 0.0;  ///< estimated from drag
    double mach = 0.0;                 ///< estimated
    double range_to_go_m = 0.0;        ///< along the ground to where guidance aims
};
/// From ground's solution: the speed to wait for, and the lowest altitude at which to wait. A vehicle that fires by
/// range (`parachute_range_m`) waits for it down to this speed.
struct ParachuteBounds {
    double speed_mps = 0.0;
    double altitude_min_m = 0.0;
};

/// Conditions for straighten-up (SUFR): the parachute's speed is near, or its range, or its lowest altitude.
/// The last way leaves time for the balance masses. A vehicle that would still be too fast for the parachute keeps
/// the lift that straightening up costs, down to a last altitude. `deceleration_mps2`: of the speed, drag less the
/// effect of gravity; at zero or less the speed alone never fires.
Conditions sufr_start(const Parameters& parameters, const InAir& at, double deceleration_mps2,
                      const ParachuteBounds& bounds);

/// Whether the vehicle is slow enough, near enough to the target or too low to wait any longer, and within the
/// parachute's Mach number and pressure. Below a last altitude the parachute is due at any speed.
bool parachute_due(const Parameters& parameters, const InAir& at, const ParachuteBounds& bounds);
Conditions parachute(const Parameters& parameters, const InAir& at, const ParachuteBounds& bounds,
                     std::uint32_t cycles_true);
/// Conditions for heatshield separation: slow enough; or so low, or so long after the mortar, that the radar must see
/// the ground at last.
Conditions heatshield(const Parameters& parameters, const InAir& at, double heatshield_speed_mps,
                      double since_parachute_s);

/// From ground's solution: an altitude, and the descent rate to which it belongs.
struct BackshellBounds {
    double altitude_m = 0.0;
    double descent_rate_mps = 0.0;
};

/// Altitude at which the backshell must go for the same powered approach to fit below it.
/// At the descent rate of ground's solution, that solution's altitude; at a higher rate, higher by the additional
/// altitude that free fall and approach need.
double backshell_altitude_needed_m(const Parameters& parameters, const BackshellBounds& bounds,
                                   double descent_rate_mps);

/// Conditions for the end of the powered approach: slow enough, or at its lowest altitude.
Conditions constant_velocity(const Parameters& parameters, double altitude_m, double descent_rate_mps);

/// Conditions for priming.
/// The time is measured to the solution's altitude: by then the descent rate is near its design.
Conditions engine_priming(const Parameters& parameters, double altitude_m, double descent_rate_mps,
                          double backshell_altitude_m);
Conditions backshell(const Parameters& parameters, double altitude_m, double descent_rate_mps,
                     const BackshellBounds& bounds, std::uint32_t cycles_true);

}  // namespace aeolis::flight::gnc::triggers
