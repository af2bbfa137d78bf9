// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/devices/device_messages.hpp"
#include "simulation/draws.hpp"
#include "simulation/mars/atmosphere.hpp"
#include "simulation/mars/point_mass.hpp"
#include "simulation/mars/terrain.hpp"
#include "simulation/mars/wind.hpp"
#include "simulation/placed_state.hpp"
#include "simulation/scenario.hpp"
#include "simulation/vehicle/aeroshell.hpp"
#include "simulation/vehicle/bridle.hpp"
#include "simulation/vehicle/configuration.hpp"
#include "simulation/vehicle/engines.hpp"
#include "simulation/vehicle/parachute.hpp"
#include "simulation/vehicle/rigid_body.hpp"
#include "simulation/vehicle/separated_bodies.hpp"
#include "simulation/vehicle/stage_and_rover.hpp"
#include "simulation/vehicle/thrusters.hpp"

#include <bitset>
#include <optional>

namespace aeolis::simulation {

/// The flying vehicle: a rigid body with a configuration, moved by air, parachute, thrusters and engines.
///
/// After the bridle pays out, the rover is a second body, which swings and comes to rest. The state is that of the
/// rigid body's centre of mass: each jettison moves it to the centre of what flies on, with the velocity there.
/// Thrusters and engines push at their mounts, with arms from that centre. Time is in seconds since the start of the
/// world.
class Vehicle {
  public:
    Vehicle(const Scenario& scenario, const PointMass& start, const Quaternion& q_MB, std::uint64_t seed,
            std::uint64_t case_number);

    /// Starts a campaign case: draws masses, drag, parachute, air and wind anew, and sets the true position.
    void disperse(const Scenario& scenario, const PointMass& at, std::uint64_t seed, std::uint64_t case_number);

    /// Draws anew what lies ahead of a flight under way: air, wind, gusts, aerodynamics, and the parachute and the
    /// ground until they act. `all`: those too, and the masses.
    void redraw(const Scenario& scenario, std::uint64_t seed, std::uint64_t case_number, bool all);
    /// Moves the true state, and with it a rover that hangs on the bridle; `turn`: in B, after the attitude.
    void shift(const Vector3& by_M_m, const Vector3& by_M_mps, const Quaternion& turn);
    /// Sets the state. `start`: the Sclk of second zero. Bodies that are jettisoned already fly on.
    void place(const Scenario& scenario, const PlacedState& state, Sclk start);
    void add_to(PlacedState& state, Sclk start) const;

    /// Applies the effect of a pyro. A second firing does nothing.
    void fire(flight::PyroId pyro, double now_s);
    /// Sets what the drivers of thrusters, engines and bridle do from now on.
    void command(const flight::ThrusterCommand& thrusters, bool thrusters_enabled, const flight::EngineCommand& engines,
                 bool pay_out_bridle, double now_s);
    /// From now on added to the wind at all heights.
    void shift_wind(double east_mps, double north_mps) { wind_.shift(east_mps, north_mps); }
    void shift_air(double factor) { atmosphere_.shift(factor); }
    /// Integrates one step of at most 5 ms.
    void step(double now_s, double step_s);
    /// Advances the jettisoned bodies by a tick of 1/64 s. Call after the vehicle has flown it.
    void fly_separated();

    PointMass at() const { return {body_.p_MoB_M, body_.v_MB_M}; }
    const RigidBody& body() const { return body_; }
    const Quaternion& q_MB() const { return body_.q_MB; }
    const Vector3& specific_force_M() const { return specific_force_M_; }     ///< [m/s²] mean over the last step
    double altitude_m() const { return terrain_.altitude_m(body_.p_MoB_M); }  ///< above the landing radius
    double height_m() const { return terrain_.height_m(body_.p_MoB_M); }      ///< above the ground below

    const Configuration& configuration() const { return configuration_; }
    const Engines& engines() const { return engines_; }
    const Bridle& bridle() const { return bridle_; }
    const SeparatedBodies& separated() const { return separated_; }
    const Terrain& terrain() const { return terrain_; }

    /// Errors of this case. `scenario` has the values without them.
    void add_draws(const Scenario& scenario, std::vector<Draw>& draws) const;

    /// Present aerodynamic quantities.
    struct Flow {
        double density_kgm3 = 0.0, mach = 0.0, dynamic_pressure_Pa = 0.0;
        double angle_of_attack_rad = 0.0, bank_rad = 0.0;
    };
    Flow flow() const;
    bool parachute_open(double now_s) const;

    /// State of the rover's centre of mass while it hangs below the stage on the bridle.
    std::optional<PointMass> rover() const { return rover_hangs() ? std::optional{rover_} : std::nullopt; }
    /// What the rover's own IMU is exposed to, along axes that turn with the rover: mean specific force over the last
    /// step, and rate relative to inertial space.
    ///
    /// Our assumptions: on the stage it feels what the centre of mass does; on the bridle it turns with it, without
    /// twist; on its wheels it turns with the ground. Cut loose above ground it falls.
    struct RoverMotion {
        Vector3 force_mps2, rate_rps;
    };
    RoverMotion rover_motion() const;
    /// Height of the rover's wheels above ground. [m]
    double wheels_height_m() const;
    /// Angle of the bridle from the vertical. [rad]
    double swing_rad() const;

  private:
    /// Inputs over a step, each constant or linear over it.
    struct Step {
        double start_s = 0.0, length_s = 0.0;
        Thrusters::Push thrusters;
        Vector3 engines_start_B_N, engines_end_B_N, engines_start_B_Nm, engines_end_B_Nm;
        std::optional<Trim> trim;  ///< by the Mach number at the step's start, since it changes slowly
    };
    /// Releases a jettisoned body from its station.
    void let_go(SeparatedBody& body, double station_m, double mass_kg, double drag_area_m2,
                const std::optional<ParachuteLift>& lift = {}) const;
    /// State of a point of the body at `from_centre_B` from its centre of mass.
    PointMass point_at(const RigidBody& body, const Vector3& from_centre_B) const;
    /// Moves the state to the new centre of mass after the attached parts have changed.
    void recentre();
    bool rover_hangs() const { return !configuration_.rover_on_stage && configuration_.bridle; }
    /// Vector from the bridle's mount on the stage to the rover, and its rate. [m, m/s] in M
    PointMass on_bridle(const RigidBody& stage, const PointMass& rover) const;
    StageAndRoverLoads loads(Step& step, double fraction, const StageAndRover& both) const;
    Wrench wrench(Step& step, double fraction, const RigidBody& body) const;
    double aeroshell_factor(double mach) const;
    void add_air(double now_s, Step& step, const RigidBody& body, Wrench& wrench) const;

    Terrain terrain_;
    double parachute_area_m2_;    ///< with this case's drag
    double parachute_plane_rad_;  ///< this case's angle from up of the plane of its first lift
    ParachuteOscillation parachute_oscillation_;
    double parachute_lift_to_drag_, wrist_damping_Nms_;
    std::vector<AeroScale> aero_scale_;
    std::array<double, 2> aeroshell_factors_;  ///< this case's drag and lift, at high and at low Mach numbers
    Atmosphere atmosphere_;
    Wind wind_;

    RigidBody body_;
    PointMass rover_;      ///< while it hangs
    Quaternion q_MRover_;  ///< that of the stage, until the bridle is cut
    Vector3 specific_force_M_ = Vector3::Zero(), rover_specific_force_M_ = Vector3::Zero();
    Thrusters thrusters_;
    Configuration configuration_;
    std::bitset<32> fired_;  ///< by PyroId
    Vector3 centre_B_m_;     ///< reference point of body_, from the stage's own centre of mass
    /// Origins of effectors.hpp for thrusters and engines, on the axis, also from the stage's centre of mass.
    Vector3 thrusters_from_B_m_, engines_from_B_m_;
    Engines engines_;
    Bridle bridle_;
    std::optional<double> mortar_s_;
    Vector3 right_at_mortar_M_ = Vector3::UnitZ();  ///< horizontal, to the right of its flight
    SeparatedBodies separated_;
};

}  // namespace aeolis::simulation
