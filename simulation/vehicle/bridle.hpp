// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/vectors.hpp"

#include <optional>

namespace aeolis::simulation {

/// The bridle that lowers the rover from the descent stage: a damped spring that can only pull.
///
/// Its three legs meet in one point of the stage and act as one, between that point and the rover's centre of mass. 7.5
/// m in 5 s. [facts]
/// Our assumptions: the speed of pay-out rises for 0.6 s, is steady, and falls for 0.6 s; the confluence is 0.2 m below
/// the stage's centre of mass, and the stowed rover's centre 0.2 m below that; the rover's weight stretches it by 15
/// mm, so that the rover bobs at 16 rad/s under a motionless stage, with damping of three tenths of the critical.
class Bridle {
  public:
    static constexpr double length_m = 7.5;
    static constexpr double pay_out_s = 5.0;
    static constexpr double confluence_m = 0.2;  ///< station: along z of B from the stage's centre of mass

    void start(double now_s);
    bool started() const { return started_; }
    std::optional<double> started_s() const { return started_ ? std::optional{start_s_} : std::nullopt; }

    double payed_out_m(double now_s) const;
    double speed_mps(double now_s) const;  ///< of the rover away from the stage

    /// Force on the rover at `offset` from the confluence, moving away from it with `rate`. [N], [m], [m/s], all in one
    /// frame
    Vector3 pull_N(double now_s, double rover_kg, const Vector3& offset, const Vector3& rate) const;

  private:
    bool started_ = false;
    double start_s_ = 0.0;
};

}  // namespace aeolis::simulation
