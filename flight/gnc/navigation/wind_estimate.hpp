// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/gnc/vector.hpp"
#include "generated/parameters.hpp"

#include <cstdint>
#include <optional>

// The wind, from how the parachute pulls while the vehicle glides under it.
//
//   y = v + s f / f_up = w + s c l,   |y − w| = s c:   y² = 2 w·y + k by least squares
//
// In steep flight the parachute pulls to where the air comes from, but for its lift along l, c times its drag. So y,
// the horizontal velocity v corrected by the slope of the pull f at the descent rate s, lies on a circle about the wind
// w and goes round it as the plane of lift turns. v itself follows 20 s later, and does not tell.
//
// Frame    M; horizontal vectors are held by their parts to the east and north of the present position
// In       v [m/s] and f [m/s²], 64 Hz; a sample is the mean over 1 s          Out   w [m/s]
// Memory   sums over the samples
// Source   [kasa-1976] for the fit of a circle, [od137] for the lift and that its plane turns
// Valid    in steep flight through the air, by navigation that the radar corrects. Of wind that changes with height it is
//          the mean over the samples
namespace aeolis::flight::gnc {

class WindEstimate {
  public:
    /// Takes a cycle under the parachute.
    /// @param up_M     unit vector
    /// @param v_M      [m/s] velocity relative to rotating Mars
    /// @param force_M  [m/s²] specific force
    void on(const Parameters& parameters, const Vector3& up_M, const Vector3& v_M, const Vector3& force_M);

    /// Horizontal wind [m/s] in M; none where the samples are few, or show no circle, or too little of one.
    std::optional<Vector3> wind_M(const Parameters& parameters, const Vector3& up_M) const;

    template <typename Exchange>
    void carry(Exchange& exchange) {
        exchange(v_sum_, force_sum_, cycles_, samples_, y_, yy_, yr_, r_, rr_);
    }

  private:
    using Level = Eigen::Vector2d;  ///< to the east, to the north

    Vector3 v_sum_ = Vector3::Zero(), force_sum_ = Vector3::Zero();  ///< of this sample: east, north, up
    std::uint32_t cycles_ = 0;                                       ///< of this sample
    std::uint32_t samples_ = 0;
    // Sums over the samples, with r = y².
    Level y_ = Level::Zero();
    Eigen::Matrix2d yy_ = Eigen::Matrix2d::Zero();
    Level yr_ = Level::Zero();
    double r_ = 0.0, rr_ = 0.0;
};

}  // namespace aeolis::flight::gnc
