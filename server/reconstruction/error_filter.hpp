// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/gnc/vector.hpp"

#include <cstdint>
#include <vector>

// Estimates the error of an inertial path from radar readings along it: a Kalman filter forward, and a smoother back
// (Rauch, Tung and Striebel), so that the radar of the last two minutes improves the entry too.
//
//   truth = path ⊕ error:  p + δp,  v + δv,  Exp(ψ) · R_MB
//   δṗ = δv        δv̇ = ψ × R f − R (b + s ∘ f) + G δp − 2 ω × δv        ψ̇ = −ω × ψ
//   range rate = −d·v + beam's bias          range = (1 + κ) · distance along d to a sphere of radius R + h
//
// Frame    M for δp, δv and ψ; B for the accelerometers' bias b and scale error s
// Left out gyro bias (4e-5 rad over a landing)
// Source   [savage-1998] for the error's propagation; the smoother is the textbook's
namespace aeolis::reconstruction {

using flight::gnc::Matrix3;
using flight::gnc::Quaternion;
using flight::gnc::Vector3;

/// One standard deviation of each error of ground's solution and of the sensors, on each axis.
/// [facts] Dispersed landings gives three of them; those marked (A) are our assumptions.
struct SensorErrors {
    double position_m = 930.0;     ///< of navigation as it begins
    double velocity_mps = 0.67;    ///< the same
    double attitude_rad = 1.5e-3;  ///< the same
    double accelerometer_bias_mps2 = 3.3e-4;
    double accelerometer_scale = 1.0e-4;      ///< (A)
    double accelerometer_noise_mps = 5.0e-5;  ///< of each reading (A)
    double gyro_noise_rad = 2.0e-6;           ///< of each reading (A)
    double imu_misalignment_rad = 1.0e-4;     ///< of the gyros' axes: added for each radian that is turned (A)
    /// What the filter does not model, per √s: the centre of mass jumps when a part leaves. (A), from landings without
    /// any other error.
    double unmodelled_mps_per_root_s = 0.01;
    double radar_range_fraction = 0.0067;  ///< as scale error, and as noise of each reading
    double radar_velocity_mps = 0.033;     ///< as bias of each beam, and as noise of each reading
    double ground_height_m = 10.0;         ///< of the map, where the radar first sees the ground (A)
    double ground_relief_m = 1.0;          ///< of the ground below, per √s: a slope of some degrees (A)
    double over_site_m = 3.0;  ///< of the stage's place over the rover as touchdown is declared, on each axis (A)
};

/// What moved the vehicle over one step of the path.
struct Motion {
    double seconds = 0.0;
    std::uint32_t readings = 0;
    Vector3 p_MoB_M = Vector3::Zero();        ///< [m] at its end
    Vector3 sensed_M_mps = Vector3::Zero();   ///< Σ R_MB Δv
    Matrix3 turned = Matrix3::Zero();         ///< [s] Σ R_MB Δt
    Matrix3 turned_sensed = Matrix3::Zero();  ///< [m/s] Σ R_MB diag(Δv)
    double turned_rad = 0.0;                  ///< Σ |Δθ|
};

/// A time without readings, after which the path goes on from the state that flight navigated.
struct Gap {
    double seconds = 0.0;
    Vector3 p_MoB_M = Vector3::Zero();       ///< [m] at its end
    Vector3 sensed_M_mps = Vector3::Zero();  ///< as flight navigated over it
    /// Path less navigated state, before the gap: the error grows by this when the path continues from that state.
    Vector3 p_M_m = Vector3::Zero(), v_M_mps = Vector3::Zero(), angle_M_rad = Vector3::Zero();
    bool radar = false;  ///< may have corrected the navigated state meanwhile: the difference is then uncertain too
    /// Flight's own estimate of its error due to silences of the IMU.
    double attitude_rad = 0.0, velocity_mps = 0.0, altitude_m = 0.0;
};

/// One beam's reading, with the inertial path at its tick.
struct Sighting {
    std::uint8_t beam = 0;          ///< 0 … 5
    Vector3 d_M = Vector3::Zero();  ///< direction by the path's attitude
    double range_m = 0.0, range_rate_mps = 0.0;
    Vector3 p_MoB_M = Vector3::Zero(), v_MB_M = Vector3::Zero();
    double before_end_s = 0.0;  ///< from the reading to the end of the step
};

/// The path's error at the end of a step, and one standard deviation of what is left of it on each axis.
struct PathError {
    Vector3 p_M_m = Vector3::Zero(), v_M_mps = Vector3::Zero(), angle_M_rad = Vector3::Zero();
    Vector3 sigma_p_m = Vector3::Zero(), sigma_v_mps = Vector3::Zero(), sigma_angle_rad = Vector3::Zero();
    double sigma_height_m = 0.0;  ///< along up: the axes are correlated
};

class ErrorFilter {
  public:
    static constexpr int beams = 6;
    /// Chosen: none of a landing's good readings deviates as much.
    static constexpr double gate_sigmas = 6.0;

    ErrorFilter(const SensorErrors& errors, double accelerometer_bias_sigma_mps2, double target_radius_m);

    /// Propagates the error over a step, then applies the readings of that time. `whole`: smoothed() gives the error at
    /// its end.
    void step(const Motion& motion, const std::vector<Sighting>& sightings, bool whole = true);
    /// Continues with the error of the navigated state: that of the path before the gap, plus their difference. It is
    /// known no better than before, and less well by flight's own estimate.
    void pass(const Gap& gap);

    /// Ends the path at a known place: `off_M_m` from where the path ends without its error. Returns how far that is
    /// from the error as estimated so far, in standard deviations of the worst axis; beyond the gate it takes nothing.
    double end_at(const Vector3& off_M_m, double sigma_m);

    /// The smoothed error at the end of each whole step.
    std::vector<PathError> smoothed() const;

    std::uint64_t taken() const { return taken_; }
    std::uint64_t refused() const { return refused_; }  ///< beyond the gate

  private:
    enum Place : int { p = 0, v = 3, angle = 6, bias = 9, scale = 12, range_scale = 15, ground = 16, beam_bias = 17 };
    static constexpr int states = beam_bias + beams;
    using State = Eigen::Matrix<double, states, 1>;
    using Covariance = Eigen::Matrix<double, states, states>;
    struct Step {
        Covariance transition, predicted, filtered;
        State predicted_error, filtered_error;
        Vector3 up_M = Vector3::Zero();
        bool whole = true;
    };

    Covariance transition(const Motion& motion) const;
    void add_noise(const Motion& motion, bool sees_ground);
    void take(const Sighting& sighting);
    void observe(const State& row, double residual, double sigma);
    void correct(const State& row, double residual, double sigma);

    SensorErrors errors_;
    double target_radius_m_;
    State error_ = State::Zero();
    Covariance covariance_ = Covariance::Zero();
    /// Whether the radar no longer corrects the attitude, whose uncertainty still counts (Schmidt's filter). After a
    /// silence of the IMU the radar would make it seem better known than it is, because of what this filter does not
    /// model.
    bool attitude_considered_ = false;
    std::vector<Step> steps_;
    std::uint64_t taken_ = 0, refused_ = 0;
};

}  // namespace aeolis::reconstruction
