// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/devices/device_messages.hpp"
#include "flight/gnc/vector.hpp"
#include "generated/parameters.hpp"

// Direction of thrust and throttles of eight or four engines, for a wanted acceleration.
//
//   T = m |a|, direction a/|a| kept within 60° of up;  throttle = T / (n · T_max), within what an engine can give
//   the torque is spread as T_i = T/n + (E⁺ [torque; 0])_i, E the engines' torques and their sum: of least Σ ΔT²,
//   without changing the total. Where an engine would leave its range, the total changes instead
//
// Frame    a: specific force wanted, in M [m/s²]          Units   N, kg
// Source   [facts] Vehicle: each engine 400 … 3060 N used; the tilt limit is our assumption
namespace aeolis::flight::gnc::powered_descent {

struct Thrust {
    Vector3 direction_M = Vector3::UnitX();  ///< unit
    double magnitude_N = 0.0;                ///< given by the throttles
    std::array<double, 8> throttle{};
};

/// Allocates thrust. With four engines every other one runs; the rest are shut (throttle 0).
Thrust allocate(const Parameters& parameters, const Vector3& specific_force_M, const Vector3& up_M, double mass_kg,
                int engines, double engine_max_thrust_N);

/// Throttles for a total thrust; `given_N` receives the total that they give.
std::array<double, 8> throttles_for(const Parameters& parameters, double thrust_N, int engines,
                                    double engine_max_thrust_N, double& given_N);

/// Varies the equal throttles of eight or four engines so that they also turn the vehicle. [N m] in B
class TorqueAllocation {
  public:
    TorqueAllocation();
    void add(const Parameters& parameters, const Vector3& torque_B_Nm, int engines, double engine_max_thrust_N,
             std::array<double, 8>& throttle) const;

  private:
    Eigen::Matrix<double, 8, 3> of_eight_;
    Eigen::Matrix<double, 4, 3> of_four_;
};

}  // namespace aeolis::flight::gnc::powered_descent
