#pragma once

#include "flight/gnc/quantities.hpp"

#include <cstdint>

// When GNC says "now": each trigger is a short list of conditions on navigated quantities, all of which must hold.
// The list itself is what explains the decision afterwards. R17, R38
//
// In       navigated speed (relative to Mars), altitude (above ground once the radar locked), descent rate, and times
// Rate     64 Hz        Memory   none; whoever asks keeps count of cycles held
// Source   [facts] Timeline; bounds that ground may change come with its solution
namespace aeolis::flight::gnc::triggers {

inline constexpr double guidance_start_drag_mps2 = 1.96; ///< 0.2 g, filtered [facts]
/// From the start of SUFR to the parachute: 16.9 s [facts], and a second because drag grows as it straightens up
/// (ours).
inline constexpr double sufr_lead_s = 18.0;
inline constexpr std::uint32_t parachute_cycles = 3; ///< persistence; ours
inline constexpr std::uint32_t backshell_cycles = 3; ///< persistence; ours
inline constexpr double heatshield_delay_s = 20.0;   ///< after the mortar [facts]
inline constexpr double priming_lead_s = 15.5;       ///< before backshell separation: 15 … 16 s [facts]
inline constexpr double radar_patience_s = 60.0;     ///< after heatshield separation, without a lock; ours
inline constexpr double sky_crane_settling_s = 2.5;  ///< from throttle-down to rover separation [facts]

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

Conditions guidance_start(double filtered_drag_mps2);
Conditions heading_alignment(double speed_mps);

/// `deceleration_mps2`: of the speed, drag less what gravity adds; nil or less tells nothing and never fires.
Conditions sufr_start(double speed_mps, double deceleration_mps2, double parachute_speed_mps);

Conditions parachute(double speed_mps, double parachute_speed_mps, std::uint32_t cycles_held);
Conditions heatshield(double speed_mps, double heatshield_speed_mps, double since_parachute_s);

/// Altitude at which the backshell must go at a descent rate so that the same powered approach fits below: at 79.1 m/s
/// the altitude of ground's solution; faster, higher by what free fall and the approach then need more.
double backshell_altitude_needed_m(double backshell_altitude_m, double descent_rate_mps);

/// Time is counted to the altitude of ground's solution: by then the descent rate is near its design value.
Conditions engine_priming(double altitude_m, double descent_rate_mps, double backshell_altitude_m);
Conditions backshell(double altitude_m, double descent_rate_mps, double backshell_altitude_m,
                     std::uint32_t cycles_held);

} // namespace aeolis::flight::gnc::triggers
