// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/gnc/vector.hpp"
#include "generated/parameters.hpp"

#include <algorithm>

// Drag and lift as sensed by the accelerometers, smoothed.
//
//   D = −f·v̂        L = |f − (f·v̂) v̂|        τ ẋ + x = D, L
//
// Frame    any; f and v̂ in the same          In   specific force [m/s²], 64 Hz      Out   [m/s²]
// Source   [apollo-entry-guidance] flies on sensed drag; the time constants are our assumption: small against the 6 s
//          in which drag grows e-fold on MSL's trajectory in [od137], large against the IMU's noise
// Valid    where the air moves with Mars: wind of 20 m/s against 400 m/s turns v̂ by 3°
namespace aeolis::flight::gnc {

class ForceFilter {
  public:
    void on(const Parameters& parameters, const Vector3& force_mps2, const Vector3& direction_of_flight, double dt_s) {
        const double lift_time_s = parameters.lift_filter_time_s;
        const double along = force_mps2.dot(direction_of_flight);
        const double across = (force_mps2 - along * direction_of_flight).norm();
        drag_mps2_ += dt_s / (parameters.drag_filter_time_s + dt_s) * (-along - drag_mps2_);
        lift_mps2_ += dt_s / (lift_time_s + dt_s) * (across - lift_mps2_);
        slow_drag_mps2_ += dt_s / (lift_time_s + dt_s) * (-along - slow_drag_mps2_);
    }

    double drag_mps2() const { return drag_mps2_; }

    /// Lift over drag; `otherwise` while drag is too weak to measure it.
    /// Limited to bounds wider than any value flown.
    double lift_to_drag(const Parameters& parameters, double otherwise) const {
        if (slow_drag_mps2_ < parameters.lift_to_drag_felt_mps2) return otherwise;
        const double ratio = lift_mps2_ / slow_drag_mps2_;
        return std::clamp(ratio, parameters.lift_to_drag_min, parameters.lift_to_drag_max);
    }

    template <typename Exchange>
    void carry(Exchange& exchange) {
        exchange(drag_mps2_, lift_mps2_, slow_drag_mps2_);
    }

  private:
    double drag_mps2_ = 0.0;
    double lift_mps2_ = 0.0;
    double slow_drag_mps2_ = 0.0;  ///< smoothed as slowly as lift, so that their ratio does not lag
};

}  // namespace aeolis::flight::gnc
