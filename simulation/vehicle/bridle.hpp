#pragma once

namespace aeolis::simulation {

/// The bridle that lets the rover down from the descent stage, in one dimension along the vertical.
///
/// 7.5 m in 5 s. [facts] Ours: the speed of pay-out rises for 0.6 s, is steady, and falls for 0.6 s; the rover's wheels
/// are 1.0 m below the stage's reference point while it is stowed; once the wheels stand, the load on the bridle fades
/// within 0.15 m of slack, which stands for the give of bridle, wheels and soil.
class Bridle {
  public:
    static constexpr double length_m = 7.5;
    static constexpr double pay_out_s = 5.0;
    static constexpr double wheels_below_stage_m = 1.0;
    static constexpr double slack_to_unload_m = 0.15;

    void start(double now_s);
    bool started() const { return started_; }

    double payed_out_m(double now_s) const;
    double speed_mps(double now_s) const; ///< of the rover away from the stage
    double acceleration_mps2(double now_s) const;

    /// Height of the stage's reference point at which the wheels touch. [m]
    double standing_height_m(double now_s) const { return payed_out_m(now_s) + wheels_below_stage_m; }
    /// Part of the rover's weight that still hangs on the bridle when the stage is at `height_m` above ground.
    double load(double now_s, double height_m) const;

  private:
    bool started_ = false;
    double start_s_ = 0.0;
};

} // namespace aeolis::simulation
