// SPDX-License-Identifier: Apache-2.0
#include "simulation/vehicle/vehicle.hpp"

#include "simulation/entry_flight.hpp"
#include "simulation/vehicle/parachute.hpp"
#include "simulation/vehicle/rover_wheels.hpp"

#include <utility>

namespace aeolis::simulation {
namespace {

constexpr double spin_rps = 2.0 * 2.0 * std::numbers::pi / 60.0;  // [od137] 2 rpm
constexpr double powered_drag_area_m2 = 5.0;  // our assumption, from the free fall at backshell separation
constexpr double air_ends_m = 250000.0;

Vector3 on_axis(const Vector3& station_B) {
    return {0.0, 0.0, station_B.z()};
}

double dispersed(double fraction, Random random) {
    return 1.0 + fraction * random.normal();
}

ParachuteOscillation oscillation_of(const Scenario& scenario, Random random) {
    const double fraction = scenario.dispersions.parachute_oscillation_fraction * random.normal();
    return {fraction, 2.0 * std::numbers::pi * random.uniform()};
}

}  // namespace

Vehicle::Vehicle(const Scenario& scenario, const PointMass& start, const Quaternion& q_MB, std::uint64_t seed,
                 std::uint64_t case_number)
    : terrain_(scenario, Random{seed, case_number, Stream::terrain}),
      parachute_area_m2_(scenario.parachute_drag_area_m2 * dispersed(scenario.dispersions.parachute_drag_fraction,
                                                                     Random{seed, case_number, Stream::parachute})),
      parachute_plane_rad_(scenario.dispersions.parachute_plane_deg * degree_rad *
                           Random{seed, case_number, Stream::swing}.normal()),
      parachute_oscillation_(oscillation_of(scenario, Random{seed, case_number, Stream::parachute_oscillation})),
      parachute_lift_to_drag_(scenario.parachute_lift_to_drag), wrist_damping_Nms_(scenario.wrist_damping_Nms),
      aero_scale_(scenario.aero_scale),
      aeroshell_factors_{
          dispersed(scenario.dispersions.drag_fraction, Random{seed, case_number, Stream::drag}),
          dispersed(scenario.dispersions.slow_drag_fraction, Random{seed, case_number, Stream::slow_drag})},
      atmosphere_(scenario.density_scale, scenario.air, scenario.dispersions,
                  Random{seed, case_number, Stream::density}),
      wind_(scenario.steady_wind_east_mps, scenario.steady_wind_north_mps, scenario.dispersions.wind_mps,
            Random{seed, case_number, Stream::wind},
            Gusts{scenario.dispersions.gust_mps, Random{seed, case_number, Stream::gust}}, scenario.winds),
      body_{start.p_MoB_M, start.v_MB_M, q_MB, {0.0, 0.0, spin_rps}}, q_MRover_(q_MB), configuration_(scenario),
      thrusters_from_B_m_(on_axis(Configuration::at_entry(scenario).centre_B_m())),
      engines_from_B_m_(on_axis(Configuration::at_powered_descent(scenario).centre_B_m())), engines_(scenario.engines) {
    configuration_.weigh(scenario.masses,
                         dispersed(scenario.dispersions.mass_fraction, Random{seed, case_number, Stream::mass}));
    centre_B_m_ = configuration_.centre_B_m();
}

void Vehicle::disperse(const Scenario& scenario, const PointMass& at, std::uint64_t seed, std::uint64_t case_number) {
    const Vehicle drawn{scenario, at, q_MB(), seed, case_number};
    terrain_ = drawn.terrain_;
    parachute_area_m2_ = drawn.parachute_area_m2_;
    parachute_plane_rad_ = drawn.parachute_plane_rad_;
    parachute_oscillation_ = drawn.parachute_oscillation_;
    aeroshell_factors_ = drawn.aeroshell_factors_;
    configuration_.weigh(drawn.configuration_.masses(), 1.0);
    atmosphere_ = drawn.atmosphere_;
    wind_ = drawn.wind_;
    body_.p_MoB_M = at.p_MoB_M;
    body_.v_MB_M = at.v_MB_M;
}

void Vehicle::redraw(const Scenario& scenario, std::uint64_t seed, std::uint64_t case_number, bool all) {
    const Vehicle drawn{scenario, at(), q_MB(), seed, case_number};
    atmosphere_ = drawn.atmosphere_;
    wind_ = drawn.wind_;
    aeroshell_factors_ = drawn.aeroshell_factors_;
    if (all || !mortar_s_) {
        parachute_area_m2_ = drawn.parachute_area_m2_;
        parachute_plane_rad_ = drawn.parachute_plane_rad_;
        parachute_oscillation_ = drawn.parachute_oscillation_;
    }
    if (all || configuration_.heatshield) terrain_ = drawn.terrain_;  // later the radar may have seen it
    if (all) configuration_.weigh(drawn.configuration_.masses(), 1.0);
}

void Vehicle::shift(const Vector3& by_M_m, const Vector3& by_M_mps, const Quaternion& turn) {
    body_.p_MoB_M += by_M_m;
    body_.v_MB_M += by_M_mps;
    body_.q_MB = (body_.q_MB * turn).normalized();
    rover_.p_MoB_M += by_M_m;
    rover_.v_MB_M += by_M_mps;
}

void Vehicle::place(const Scenario& scenario, const PlacedState& state, Sclk start) {
    using flight::PyroId;
    const Masses masses = configuration_.masses();  // this case's
    configuration_ = Configuration{scenario};
    configuration_.weigh(masses, 1.0);
    fired_.reset();
    const SeparatedBodies separated = std::exchange(separated_, {});
    const double now_s = state.sclk - start;
    for (std::size_t pyro = 0; pyro < state.fired.size(); ++pyro)
        if (state.fired[pyro]) fire(static_cast<PyroId>(pyro), now_s);
    configuration_.fill(state.propellant_kg);
    separated_ = separated;
    const auto seconds = [&](const std::optional<Sclk>& at) { return at ? std::optional{*at - start} : std::nullopt; };
    mortar_s_ = seconds(state.mortar);
    right_at_mortar_M_ = vector3(state.right_at_mortar_M);
    engines_.place(state.engines, seconds(state.valves));
    bridle_ = {};
    if (state.bridle) bridle_.start(*state.bridle - start);
    thrusters_ = {};
    const auto& [w, x, y, z] = state.q_MB;
    body_ = {vector3(state.p_MoB_M_m), vector3(state.v_MB_M_mps), Quaternion{w, x, y, z}.normalized(),
             vector3(state.rate_B_rps)};
    rover_ = {vector3(state.p_MoRover_M_m), vector3(state.v_MRover_M_mps)};
    q_MRover_ = body_.q_MB;
    centre_B_m_ = configuration_.centre_B_m();
}

void Vehicle::add_to(PlacedState& state, Sclk start) const {
    state.p_MoB_M_m = array3(body_.p_MoB_M);
    state.v_MB_M_mps = array3(body_.v_MB_M);
    state.q_MB = array4(body_.q_MB);
    state.rate_B_rps = array3(body_.rate_B_rps);
    state.propellant_kg = configuration_.propellant_kg();
    const auto sclk = [&](const std::optional<double>& at_s) {
        return at_s ? std::optional{start + *at_s} : std::nullopt;
    };
    state.mortar = sclk(mortar_s_);
    state.right_at_mortar_M = array3(right_at_mortar_M_);
    state.valves = sclk(engines_.valves_open_since_s());
    state.bridle = sclk(bridle_.started_s());
    state.p_MoRover_M_m = array3(rover_.p_MoB_M);
    state.v_MRover_M_mps = array3(rover_.v_MB_M);
}

void Vehicle::add_draws(const Scenario& scenario, std::vector<Draw>& draws) const {
    if (const auto sigmas = atmosphere_.drawn_sigmas()) draws.push_back({"density_sigmas", *sigmas});
    draws.push_back({"density_fraction", atmosphere_.departure_fraction()});
    if (atmosphere_.departure_fraction() == 0.0 && atmosphere_.aloft_departure() != 0.0)  // else one draw makes both
        draws.push_back({"density_aloft_fraction", atmosphere_.aloft_departure()});
    if (atmosphere_.departure_fraction() != 0.0 || atmosphere_.aloft_departure() != 0.0 ||
        atmosphere_.drawn_sigmas())  // else there is no wave either
        draws.push_back({"density_wave_phase_rad", atmosphere_.wave_phase_rad()});
    draws.push_back({"drag_fraction", aeroshell_factors_[0] - 1.0});
    draws.push_back({"slow_drag_fraction", aeroshell_factors_[1] - 1.0});
    draws.push_back({"mass_fraction", configuration_.masses().entry_kg / scenario.masses.entry_kg - 1.0});
    draws.push_back({"wind_east_mps", wind_.east_mps()});
    draws.push_back({"wind_north_mps", wind_.north_mps()});
    draws.push_back({"parachute_drag_fraction", parachute_area_m2_ / scenario.parachute_drag_area_m2 - 1.0});
    draws.push_back({"parachute_plane_deg", parachute_plane_rad_ / degree_rad});
    if (parachute_oscillation_.fraction != 0.0)
        draws.push_back({"parachute_oscillation_fraction", parachute_oscillation_.fraction});
    draws.push_back({"terrain_height_m", terrain_.height_at_target_m()});
    draws.push_back({"terrain_slope_deg", std::atan(terrain_.rise_M().norm()) / degree_rad});
}

void Vehicle::fire(flight::PyroId pyro, double now_s) {
    using flight::PyroId;
    const auto bit = static_cast<std::size_t>(pyro);
    if (fired_.test(bit)) return;
    fired_.set(bit);
    const Masses& masses = configuration_.masses();
    const Stations& stations = configuration_.stations();
    switch (pyro) {
    case PyroId::cruise_stage_separation: configuration_.cruise_stage = false; break;
    case PyroId::cruise_balance_1:
    case PyroId::cruise_balance_2: --configuration_.cruise_balances; break;
    case PyroId::entry_balance_1:
    case PyroId::entry_balance_2:
    case PyroId::entry_balance_3: --configuration_.entry_balance_pairs; break;
    case PyroId::parachute_mortar:
        mortar_s_ = now_s;
        right_at_mortar_M_ = level_right(body_.p_MoB_M, body_.v_MB_M);
        break;
    case PyroId::heatshield_separation:
        let_go(separated_.heatshield, stations.heatshield_m, masses.heatshield_kg, heatshield_drag_area_m2);
        configuration_.heatshield = false;
        break;
    case PyroId::engine_valves: engines_.open_valves(now_s); break;
    case PyroId::backshell_separation:
        if (parachute_open(now_s))
            let_go(
                separated_.backshell, stations.backshell_m, masses.backshell_and_parachute_kg, parachute_area_m2_,
                ParachuteLift{right_at_mortar_M_, now_s - *mortar_s_, parachute_plane_rad_, parachute_lift_to_drag_});
        else
            let_go(separated_.backshell, stations.backshell_m, masses.backshell_and_parachute_kg, aeroshell_area_m2);
        configuration_.backshell = false;
        break;
    case PyroId::rover_separation:
        rover_ = point_at(body_, Vector3{0.0, 0.0, stations.rover_m} - centre_B_m_);
        configuration_.rover_on_stage = false;
        break;
    case PyroId::bridle_cutter: configuration_.bridle = false; break;
    // None of them moves the vehicle in this model: the coolant's push is small, the cables only join cruise stage and
    // aeroshell, and propellant has pressure and devices have power whatever becomes of valves and batteries (ours).
    case PyroId::cruise_cable_cutter:
    case PyroId::coolant_vent:
    case PyroId::pressurant_valve_1:
    case PyroId::pressurant_valve_2:
    case PyroId::thermal_batteries: break;
    }
    recentre();
}

void Vehicle::command(const flight::ThrusterCommand& thrusters, bool thrusters_enabled,
                      const flight::EngineCommand& engines, bool pay_out_bridle, double now_s) {
    // The spin-stabilised cruise stage has thrusters of its own and covers those of the entry vehicle.
    thrusters_.command(thrusters, thrusters_enabled && !configuration_.cruise_stage, now_s);
    engines_.command(engines, now_s);
    if (pay_out_bridle && !configuration_.rover_on_stage) bridle_.start(now_s);
}

void Vehicle::let_go(SeparatedBody& body, double station_m, double mass_kg, double drag_area_m2,
                     const std::optional<ParachuteLift>& lift) const {
    body.release(point_at(body_, Vector3{0.0, 0.0, station_m} - centre_B_m_), mass_kg, drag_area_m2, lift);
}

PointMass Vehicle::point_at(const RigidBody& body, const Vector3& from_centre_B) const {
    const Vector3 rate_B = body.rate_B_rps - body.q_MB.conjugate() * Vector3{0.0, 0.0, mars_spin_rps};
    return {body.p_MoB_M + body.q_MB * from_centre_B, body.v_MB_M + body.q_MB * rate_B.cross(from_centre_B)};
}

void Vehicle::recentre() {
    const Vector3 centre_B_m = configuration_.centre_B_m();
    const PointMass moved = point_at(body_, centre_B_m - centre_B_m_);
    body_.p_MoB_M = moved.p_MoB_M;
    body_.v_MB_M = moved.v_MB_M;
    centre_B_m_ = centre_B_m;
}

void Vehicle::fly_separated() {
    for (SeparatedBody* body : {&separated_.heatshield, &separated_.backshell})
        body->tick(body_.p_MoB_M, rover(), atmosphere_, wind_, terrain_);
}

double Vehicle::aeroshell_factor(double mach) const {
    constexpr double slow_below_mach = 3.0, fast_above_mach = 8.0;  // our assumption
    const double fast = std::clamp((mach - slow_below_mach) / (fast_above_mach - slow_below_mach), 0.0, 1.0);
    return aeroshell_factors_[1] + fast * (aeroshell_factors_[0] - aeroshell_factors_[1]);
}

bool Vehicle::parachute_open(double now_s) const {
    return configuration_.backshell && mortar_s_ && now_s - *mortar_s_ > line_stretch_s;
}

// Half of what a world takes is here: inlined whole, rotations and slopes stay in registers.
[[gnu::flatten]] void Vehicle::step(double now_s, double step_s) {
    wind_.advance(body_.p_MoB_M, body_.v_MB_M, altitude_m(), step_s);
    Step step;
    step.start_s = now_s;
    step.length_s = step_s;
    step.thrusters = thrusters_.mean(now_s, step_s);
    step.thrusters.torque_B += (thrusters_from_B_m_ - centre_B_m_).cross(step.thrusters.force_B);
    const Vector3 engines_arm_B_m = engines_from_B_m_ - centre_B_m_;
    step.engines_start_B_N = engines_.force_B_N();
    step.engines_start_B_Nm = engines_.torque_B_Nm() + engines_arm_B_m.cross(step.engines_start_B_N);
    const double burnt_kg =
        step.thrusters.propellant_kg + engines_.advance(now_s, step_s, configuration_.propellant_kg());
    step.engines_end_B_N = engines_.force_B_N();
    step.engines_end_B_Nm = engines_.torque_B_Nm() + engines_arm_B_m.cross(step.engines_end_B_N);
    configuration_.burn(0.5 * burnt_kg);  // mass at the middle of the step
    const double mass_kg = configuration_.rigid_kg();
    Vector3 force_M;
    if (rover_hangs()) {
        const StageAndRover both = runge_kutta_step(
            StageAndRover{body_, rover_}, step_s, mass_kg, configuration_.inertia(), configuration_.rover_kg(),
            [&](double fraction, const StageAndRover& at) { return loads(step, fraction, at); }, &force_M);
        rover_specific_force_M_ =
            (both.rover.v_MB_M - rover_.v_MB_M) / step_s - free_fall(rover_.p_MoB_M, rover_.v_MB_M);
        body_ = both.stage;
        rover_ = both.rover;
    } else {
        body_ = runge_kutta_step(
            body_, step_s, mass_kg, configuration_.inertia(),
            [&](double fraction, const RigidBody& body) { return wrench(step, fraction, body); }, &force_M);
    }
    if (configuration_.bridle) q_MRover_ = body_.q_MB;
    specific_force_M_ = force_M / mass_kg;
    configuration_.burn(0.5 * burnt_kg);
}

PointMass Vehicle::on_bridle(const RigidBody& stage, const PointMass& rover) const {
    const PointMass confluence = point_at(stage, Vector3{0.0, 0.0, Bridle::confluence_m} - centre_B_m_);
    return {rover.p_MoB_M - confluence.p_MoB_M, rover.v_MB_M - confluence.v_MB_M};
}

StageAndRoverLoads Vehicle::loads(Step& step, double fraction, const StageAndRover& both) const {
    StageAndRoverLoads loads{wrench(step, fraction, both.stage)};
    const double rover_kg = configuration_.rover_kg();
    const PointMass offset = on_bridle(both.stage, both.rover);
    const Vector3 pull_M =
        bridle_.pull_N(step.start_s + fraction * step.length_s, rover_kg, offset.p_MoB_M, offset.v_MB_M);
    const Vector3 arm_B = Vector3{0.0, 0.0, Bridle::confluence_m} - centre_B_m_;
    loads.on_stage.force_M -= pull_M;
    loads.on_stage.torque_B -= arm_B.cross(both.stage.q_MB.conjugate() * pull_M);
    loads.on_rover_M = pull_M;
    const Vector3& p = both.rover.p_MoB_M;
    const double sunk_m = wheels_below_rover_m - terrain_.height_m(p);
    if (sunk_m > 0.0) loads.on_rover_M += ground_reaction_N(rover_kg, sunk_m, terrain_.normal(p), both.rover.v_MB_M);
    return loads;
}

Wrench Vehicle::wrench(Step& step, double fraction, const RigidBody& body) const {
    const double now_s = step.start_s + fraction * step.length_s;
    const Vector3 push_B =
        step.thrusters.force_B + step.engines_start_B_N + fraction * (step.engines_end_B_N - step.engines_start_B_N);
    Wrench wrench{body.q_MB * push_B, step.thrusters.torque_B + step.engines_start_B_Nm +
                                          fraction * (step.engines_end_B_Nm - step.engines_start_B_Nm)};
    add_air(now_s, step, body, wrench);
    return wrench;
}

void Vehicle::add_air(double now_s, Step& step, const RigidBody& body, Wrench& wrench) const {
    const double altitude = terrain_.altitude_m(body.p_MoB_M);
    if (altitude > air_ends_m) return;
    const Air air = atmosphere_.at(altitude);
    const Vector3 through_air = body.v_MB_M - wind_.at(body.p_MoB_M, altitude);
    const double speed_mps = through_air.norm();
    if (speed_mps < 1e-3) return;
    const Vector3 forward = through_air / speed_mps;
    const double pressure_Pa = 0.5 * air.density_kgm3 * speed_mps * speed_mps;
    if (!configuration_.backshell) {
        wrench.force_M -= pressure_Pa * powered_drag_area_m2 * forward;
        return;
    }

    const double mach = speed_mps / air.speed_of_sound_mps;
    const double since_mortar_s = mortar_s_ ? now_s - *mortar_s_ : 0.0;
    const double inflation = mortar_s_ ? parachute_inflation(since_mortar_s) : 0.0;
    if (inflation > 0.0) {
        const Vector3 lift =
            parachute_lift_direction(forward, right_at_mortar_M_, since_mortar_s, parachute_plane_rad_);
        double drag_N = pressure_Pa * parachute_area_m2_ * inflation * parachute_mach_factor(mach);
        if (parachute_oscillation_.fraction != 0.0) drag_N *= parachute_oscillation_.factor(mach, since_mortar_s);
        const Vector3 pull_M = drag_N * (parachute_lift_to_drag_ * lift - forward);
        const Vector3 confluence_B = Vector3{0.0, 0.0, riser_station_m} - centre_B_m_;
        wrench.force_M += pull_M;
        wrench.torque_B += confluence_B.cross(body.q_MB.conjugate() * pull_M) - wrist_damping_Nms_ * body.rate_B_rps;
    }
    // The parachute's drag area includes the vehicle in its wake, so the vehicle's own drag fades as it opens.
    if (inflation >= 1.0) return;
    const Vector3 z_M = body.q_MB * Vector3::UnitZ();
    const double cosine = std::clamp(z_M.dot(forward), -1.0, 1.0);
    const AeroCoefficients coefficients = scaled(aeroshell_coefficients(mach, std::acos(cosine)), aero_scale_, mach);
    const double area_N = pressure_Pa * aeroshell_area_m2 * aeroshell_factor(mach) * (1.0 - inflation);
    wrench.force_M -= area_N * coefficients.drag * forward;
    const Vector3 lean = z_M - cosine * forward;
    const double sine = lean.norm();
    if (sine > 1e-6) wrench.force_M -= (area_N * coefficients.lift / sine) * lean;

    // Restoring moment to trim, where the wind's part along x matches the centre of mass's offset.
    const Vector3 wind_B = body.q_MB.conjugate() * forward;
    const double offset = configuration_.offset();
    if (!step.trim) step.trim = trim_at(mach);
    const double trim = offset * step.trim->sine + (1.0 - offset) * std::sin(balanced_trim_angle_rad);
    const double stiffness_Nm = area_N * aeroshell_diameter_m * step.trim->moment_slope;
    const double damping_Nms = area_N * aeroshell_diameter_m * aeroshell_diameter_m / (2.0 * speed_mps);
    const Vector3& w = body.rate_B_rps;
    wrench.torque_B += Vector3{-stiffness_Nm * wind_B.y() - damping_Nms * pitch_damping * w.x(),
                               stiffness_Nm * (wind_B.x() - trim) - damping_Nms * pitch_damping * w.y(),
                               -damping_Nms * roll_damping * w.z()};
}

Vehicle::Flow Vehicle::flow() const {
    Flow flow;
    const double altitude = altitude_m();
    if (altitude > air_ends_m) return flow;
    const Air air = atmosphere_.at(altitude);
    const Vector3 through_air = body_.v_MB_M - wind_.at(body_.p_MoB_M, altitude);
    const double speed_mps = through_air.norm();
    flow.density_kgm3 = air.density_kgm3;
    flow.mach = speed_mps / air.speed_of_sound_mps;
    flow.dynamic_pressure_Pa = 0.5 * air.density_kgm3 * speed_mps * speed_mps;
    if (speed_mps < 1e-3) return flow;
    const Vector3 forward = through_air / speed_mps;
    const Vector3 z_M = body_.q_MB * Vector3::UnitZ();
    flow.angle_of_attack_rad = std::acos(std::clamp(z_M.dot(forward), -1.0, 1.0));
    const Vector3 right = forward.cross(body_.p_MoB_M).normalized();
    flow.bank_rad = std::atan2(-z_M.dot(right), -z_M.dot(right.cross(forward)));
    return flow;
}

Vehicle::RoverMotion Vehicle::rover_motion() const {
    if (configuration_.rover_on_stage) return {q_MB().conjugate() * specific_force_M_, body_.rate_B_rps};
    Vector3 rate_M{0.0, 0.0, mars_spin_rps};
    if (rover_hangs() && wheels_height_m() > 0.0) {
        const PointMass along = on_bridle(body_, rover_);
        rate_M += along.p_MoB_M.cross(along.v_MB_M) / along.p_MoB_M.squaredNorm();
    }
    Vector3 force_M = -free_fall(rover_.p_MoB_M, Vector3::Zero());
    if (rover_hangs())
        force_M = rover_specific_force_M_;
    else if (wheels_height_m() > 0.0)
        force_M = Vector3::Zero();  // it was cut loose above ground
    return {q_MRover_.conjugate() * force_M, q_MRover_.conjugate() * rate_M};
}

double Vehicle::wheels_height_m() const {
    return terrain_.height_m(rover_.p_MoB_M) - wheels_below_rover_m;
}

double Vehicle::swing_rad() const {
    if (!rover_hangs()) return 0.0;
    const Vector3 offset = on_bridle(body_, rover_).p_MoB_M;
    const Vector3 down = -body_.p_MoB_M.normalized();
    return std::atan2(down.cross(offset).norm(), down.dot(offset));
}

}  // namespace aeolis::simulation
