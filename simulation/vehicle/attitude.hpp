#pragma once

#include "flight/devices/device_messages.hpp"
#include "simulation/random.hpp"
#include "simulation/vectors.hpp"

namespace aeolis::simulation {

/// The vehicle's attitude, without moments of force: it turns toward what is asked of it, or toward what air and
/// parachute make of it, within limits of rate and acceleration. (Issue C replaces it by six degrees of freedom.)
///
/// spinning, holding   fixed to inertial space, spinning at 2 rpm until the cruise stage is gone and thrusters take the
///                     spin out
/// in the wind         trim attitude: z of B at the trim angle from the velocity through the air, leaning away from the
///                     lift vector; the bank angle is turned at most at 20°/s and 5°/s² [facts]. Also without being
///                     asked wherever the air is dense enough to turn the vehicle by itself (ours: 20 Pa)
/// hanging             under the open parachute: z of B along the velocity through the air, with a damped swing (ours)
/// thrusting           z of B opposes the asked direction of thrust
/// Turning into the wind from another attitude takes the vehicle at most 5°/s, 1°/s² (ours); hanging and thrusting
/// at most 40°/s, 80°/s² (ours).
class Attitude {
  public:
    /// What the vehicle is in, for the end of the next step.
    struct Surroundings {
        Vector3 p_MoB_M;
        Vector3 v_AB_M; ///< through the air
        double dynamic_pressure_Pa = 0.0;
        double trim_angle_rad = 0.0; ///< where air and centre of mass would hold it now
        bool spin_stabilised = true; ///< the cruise stage is there
        bool thrusters = true;       ///< enabled: they can turn it
        bool aeroshell = true;       ///< the backshell is there
        bool parachute_open = false;
    };

    Attitude(const Quaternion& q_MB, double spin_rps, Random random);

    /// It will swing under the parachute as `other` would.
    void swing_as(const Attitude& other) { swing_direction_rad_ = other.swing_direction_rad_; }

    void advance(double step_s, const flight::AttitudeCommand& command, const Surroundings& next);

    const Quaternion& q_MB() const { return q_MB_; }
    Vector3 z_B_M() const { return q_MB_ * Vector3::UnitZ(); }

  private:
    enum class Kind : std::uint8_t { inertial, wind, hanging, thrusting };
    Kind kind_for(const flight::AttitudeCommand& command, const Surroundings& next) const;
    void keep_inertial(double step_s, const Surroundings& next);
    void turn_with_wind(double step_s, const flight::AttitudeCommand& command, const Surroundings& next, bool entering);
    void turn_z_toward(const Vector3& wanted_M, double step_s);
    Quaternion in_wind(const Surroundings& next) const;

    Quaternion q_MB_;
    Kind kind_ = Kind::inertial;
    double spin_rps_;
    double bank_rad_ = 0.0, bank_rate_rps_ = 0.0;
    double trim_rad_ = 0.0;
    // What is left of the turn into the wind: a rotation about a fixed axis of B that shrinks to nothing.
    Vector3 turn_axis_B_ = Vector3::UnitX();
    double turn_rad_ = 0.0, turn_rate_rps_ = 0.0;
    double z_rate_rps_ = 0.0;
    double swing_age_s_ = 0.0, swing_direction_rad_;
};

} // namespace aeolis::simulation
