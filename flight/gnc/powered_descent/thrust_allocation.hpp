// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/devices/device_messages.hpp"
#include "flight/gnc/vector.hpp"
#include "generated/dictionary_flight.hpp"

// From a wanted acceleration to a direction of thrust and the throttles of eight engines, or of four.
//
//   T = m |a|, direction a/|a| kept within 60° of up;  throttle = T / (n · T_max), within what an engine can give the
//   torque is spread as T_i = T/n + (E⁺ [torque; 0])_i, E the engines' torques and their sum: of least Σ ΔT², without
//   changing the total; where an engine would leave its range it is the total that gives way
//
// Frame    a: specific force wanted, in M [m/s²]          Units   N, kg
// Source   [facts] Vehicle: each engine 400 … 3060 N used; the tilt limit is ours
namespace aeolis::flight::gnc::powered_descent {

inline constexpr double engine_used_min_N = parameters.engine_used_min_N;
inline constexpr double engine_used_max_N = parameters.engine_used_max_N;
inline constexpr double tilt_max_rad = parameters.tilt_max_deg * degree;

struct Thrust {
    Vector3 direction_M = Vector3::UnitX();  ///< unit
    double magnitude_N = 0.0;                ///< that the throttles give
    std::array<double, 8> throttle{};
};

/// With four engines every other one runs; the rest are shut (throttle 0).
Thrust allocate(const Vector3& specific_force_M, const Vector3& up_M, double mass_kg, int engines,
                double engine_max_thrust_N);

/// Throttles for a total thrust; the total they give is returned in `given_N`.
std::array<double, 8> throttles_for(double thrust_N, int engines, double engine_max_thrust_N, double& given_N);

/// Makes throttles that are all alike, of eight engines or of four, turn the vehicle as well. [N m] in B
class TorqueAllocation {
  public:
    TorqueAllocation();
    void add(const Vector3& torque_B_Nm, int engines, double engine_max_thrust_N,
             std::array<double, 8>& throttle) const;

  private:
    Eigen::Matrix<double, 8, 3> of_eight_;
    Eigen::Matrix<double, 4, 3> of_four_;
};

}  // namespace aeolis::flight::gnc::powered_descent
