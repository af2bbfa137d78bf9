// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/gnc/vector.hpp"
#include "generated/parameters.hpp"

// Holds the descent rate and nulls the drift on four engines, with the rover on the bridle.
//
//   a_up = k_p e + k_i ∫e,  e = rate − wanted;   a_level = −k v_level;   both within limits
//
// Frame    M; rate positive down, a positive up         Units   m/s, m/s²
// The integral compensates for the error of the mass: once the rover stands, thrust settles at the stage's own weight.
// Source   [facts] Timeline: 0.75 m/s; gains are our assumption
namespace aeolis::flight::gnc::sky_crane {

class RateControl {
  public:
    void start() { integral_mps2_ = 0.0; }

    /// Acceleration to command, in M. Free fall is compensated elsewhere.
    Vector3 command_M(const Parameters& parameters, const Vector3& v_MB_M, const Vector3& up_M,
                      double wanted_descent_rate_mps, double dt_s);

    template <typename Exchange>
    void carry(Exchange& exchange) {
        exchange(integral_mps2_);
    }

  private:
    double integral_mps2_ = 0.0;
};

}  // namespace aeolis::flight::gnc::sky_crane
