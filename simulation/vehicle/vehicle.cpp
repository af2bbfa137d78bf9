#include "simulation/vehicle/vehicle.hpp"

#include "simulation/entry_flight.hpp"
#include "simulation/vehicle/aeroshell.hpp"
#include "simulation/vehicle/parachute.hpp"

namespace aeolis::simulation {
namespace {

constexpr double spin_rps = 2.0 * 2.0 * std::numbers::pi / 60.0; // [od137] 2 rpm
constexpr double powered_drag_area_m2 = 5.0;                     // ours: what free fall at backshell separation shows
constexpr double air_ends_m = 250000.0;

double dispersed(double fraction, Random random) {
    return 1.0 + fraction * random.normal();
}

} // namespace

Vehicle::Vehicle(const Scenario& scenario, const PointMass& start, const Quaternion& q_MB, std::uint64_t seed,
                 std::uint64_t case_number)
    : ground_radius_m_(scenario.target.radius_m),
      parachute_area_m2_(scenario.parachute_drag_area_m2 * dispersed(scenario.dispersions.parachute_drag_fraction,
                                                                     Random{seed, case_number, Stream::parachute})),
      aeroshell_factor_(dispersed(scenario.dispersions.drag_fraction, Random{seed, case_number, Stream::drag})),
      atmosphere_(scenario.density_scale, scenario.dispersions.density_fraction,
                  Random{seed, case_number, Stream::density}),
      wind_(scenario.steady_wind_east_mps, scenario.steady_wind_north_mps, scenario.dispersions.wind_mps,
            Random{seed, case_number, Stream::wind}),
      at_(start), attitude_(q_MB, spin_rps, Random{seed, case_number, Stream::swing}), configuration_(scenario.masses) {
}

void Vehicle::disperse(const Scenario& scenario, const PointMass& at, std::uint64_t seed, std::uint64_t case_number) {
    const Vehicle drawn{scenario, at, q_MB(), seed, case_number};
    parachute_area_m2_ = drawn.parachute_area_m2_;
    aeroshell_factor_ = drawn.aeroshell_factor_;
    atmosphere_ = drawn.atmosphere_;
    wind_ = drawn.wind_;
    at_ = drawn.at_;
    attitude_.swing_as(drawn.attitude_);
}

void Vehicle::fire(flight::PyroId pyro, double now_s) {
    using flight::PyroId;
    switch (pyro) {
    case PyroId::cruise_stage_separation:
        configuration_.cruise_stage = false;
        break;
    case PyroId::cruise_balance_1:
    case PyroId::cruise_balance_2:
        --configuration_.cruise_balances;
        break;
    case PyroId::entry_balance_1:
    case PyroId::entry_balance_2:
    case PyroId::entry_balance_3:
        --configuration_.entry_balance_pairs;
        break;
    case PyroId::parachute_mortar:
        mortar_s_ = now_s;
        break;
    case PyroId::heatshield_separation:
        configuration_.heatshield = false;
        break;
    case PyroId::engine_valves:
        engines_.open_valves(now_s);
        break;
    case PyroId::backshell_separation:
        configuration_.backshell = false;
        break;
    case PyroId::rover_separation:
        configuration_.rover_on_stage = false;
        break;
    case PyroId::bridle_cutter:
        configuration_.bridle = false;
        break;
    // Neither moves the vehicle in this model: coolant's push is small, the cables only join cruise stage and
    // aeroshell.
    case PyroId::cruise_cable_cutter:
    case PyroId::coolant_vent:
        break;
    }
}

void Vehicle::command(const flight::AttitudeCommand& attitude, bool thrusters_enabled,
                      const flight::EngineCommand& engines, bool pay_out_bridle, double now_s) {
    attitude_command_ = attitude;
    thrusters_enabled_ = thrusters_enabled;
    engines_.command(engines, now_s);
    if (pay_out_bridle && !configuration_.rover_on_stage) bridle_.start(now_s);
}

bool Vehicle::parachute_open(double now_s) const {
    return configuration_.backshell && mortar_s_ && now_s - *mortar_s_ > line_stretch_s;
}

Attitude::Surroundings Vehicle::surroundings(double end_s, double step_s) const {
    Attitude::Surroundings next;
    next.p_MoB_M = at_.p_MoB_M + step_s * at_.v_MB_M;
    const Vector3 v_M = at_.v_MB_M + step_s * (free_fall(at_.p_MoB_M, at_.v_MB_M) + specific_force_M_);
    const double altitude = next.p_MoB_M.norm() - ground_radius_m_;
    next.v_AB_M = v_M;
    next.spin_stabilised = configuration_.cruise_stage;
    next.thrusters = thrusters_enabled_;
    next.aeroshell = configuration_.backshell;
    next.parachute_open = parachute_open(end_s);
    double mach = 30.0;
    if (altitude < air_ends_m) {
        const Air air = atmosphere_.at(altitude);
        next.v_AB_M -= wind_.at(next.p_MoB_M, altitude);
        next.dynamic_pressure_Pa = 0.5 * air.density_kgm3 * next.v_AB_M.squaredNorm();
        mach = next.v_AB_M.norm() / air.speed_of_sound_mps;
    }
    const double offset = configuration_.offset();
    next.trim_angle_rad = offset * trim_angle_rad(mach) + (1.0 - offset) * balanced_trim_angle_rad;
    return next;
}

void Vehicle::step(double now_s, double step_s) {
    const Step step = [&] {
        Step s;
        s.start_s = now_s;
        s.length_s = step_s;
        s.z_start_M = attitude_.z_B_M();
        s.thrust_start_N = engines_.thrust_N();
        attitude_.advance(step_s, attitude_command_, surroundings(now_s + step_s, step_s));
        const double burnt_kg = engines_.advance(now_s, step_s, configuration_.propellant_kg());
        s.z_end_M = attitude_.z_B_M();
        s.thrust_end_N = engines_.thrust_N();
        s.mass_kg = configuration_.total_kg() - 0.5 * burnt_kg;
        configuration_.burn(burnt_kg);
        return s;
    }();
    at_ = runge_kutta_step(
        at_, step_s,
        [&](double fraction, const Vector3& p, const Vector3& v) -> Vector3 {
            return specific_force(step, fraction, p, v);
        },
        &specific_force_M_);
}

Vector3 Vehicle::specific_force(const Step& step, double fraction, const Vector3& p, const Vector3& v) const {
    const double now_s = step.start_s + fraction * step.length_s;
    const Vector3 z_M = step.z_start_M + fraction * (step.z_end_M - step.z_start_M);
    Vector3 force_N = air_force_N(now_s, z_M, p, v);
    const double thrust_N = step.thrust_start_N + fraction * (step.thrust_end_N - step.thrust_start_N);
    if (thrust_N > 0.0) force_N -= thrust_N * z_M;

    const bool hanging = !configuration_.rover_on_stage && configuration_.bridle;
    if (!hanging) return force_N / step.mass_kg;
    const double radius_m = p.norm();
    const double rover_kg = configuration_.rover_kg();
    const double load = bridle_.load(now_s, radius_m - ground_radius_m_);
    const Vector3 up = p / radius_m;
    // In the air, stage and rover fall together, and the rover that is let down pulls less than its weight.
    if (load >= 1.0) return (force_N + rover_kg * bridle_.acceleration_mps2(now_s) * up) / step.mass_kg;
    // On the ground, soil bears what the bridle no longer does.
    const double tension_N = load * rover_kg * gravity(p).norm();
    return (force_N - tension_N * up) / (step.mass_kg - rover_kg);
}

Vector3 Vehicle::air_force_N(double now_s, const Vector3& z_M, const Vector3& p, const Vector3& v) const {
    const double altitude = p.norm() - ground_radius_m_;
    if (altitude > air_ends_m) return Vector3::Zero();
    const Air air = atmosphere_.at(altitude);
    const Vector3 through_air = v - wind_.at(p, altitude);
    const double speed_mps = through_air.norm();
    if (speed_mps < 1e-3) return Vector3::Zero();
    const Vector3 forward = through_air / speed_mps;
    const double pressure_Pa = 0.5 * air.density_kgm3 * speed_mps * speed_mps;
    if (!configuration_.backshell) return -pressure_Pa * powered_drag_area_m2 * forward;

    const double mach = speed_mps / air.speed_of_sound_mps;
    const double inflation = mortar_s_ ? parachute_inflation(now_s - *mortar_s_) : 0.0;
    Vector3 force_N = Vector3::Zero();
    if (inflation > 0.0)
        force_N -= pressure_Pa * parachute_area_m2_ * inflation * parachute_mach_factor(mach) * forward;
    // The parachute's drag area is told with the vehicle in its wake: the vehicle's own fades as it opens.
    if (inflation < 1.0) {
        const double cosine = std::clamp(z_M.dot(forward), -1.0, 1.0);
        const AeroCoefficients coefficients = aeroshell_coefficients(mach, std::acos(cosine));
        const double area_N = pressure_Pa * aeroshell_area_m2 * aeroshell_factor_ * (1.0 - inflation);
        force_N -= area_N * coefficients.drag * forward;
        const Vector3 lean = z_M - cosine * forward;
        const double sine = lean.norm();
        if (sine > 1e-6) force_N -= (area_N * coefficients.lift / sine) * lean;
    }
    return force_N;
}

Vehicle::Flow Vehicle::flow() const {
    Flow flow;
    const double altitude = altitude_m();
    if (altitude > air_ends_m) return flow;
    const Air air = atmosphere_.at(altitude);
    const Vector3 through_air = at_.v_MB_M - wind_.at(at_.p_MoB_M, altitude);
    const double speed_mps = through_air.norm();
    flow.density_kgm3 = air.density_kgm3;
    flow.mach = speed_mps / air.speed_of_sound_mps;
    flow.dynamic_pressure_Pa = 0.5 * air.density_kgm3 * speed_mps * speed_mps;
    if (speed_mps < 1e-3) return flow;
    const Vector3 forward = through_air / speed_mps;
    const Vector3 z_M = attitude_.z_B_M();
    flow.angle_of_attack_rad = std::acos(std::clamp(z_M.dot(forward), -1.0, 1.0));
    const Vector3 right = forward.cross(at_.p_MoB_M).normalized();
    flow.bank_rad = std::atan2(-z_M.dot(right), -z_M.dot(right.cross(forward)));
    return flow;
}

std::optional<double> Vehicle::wheels_height_m(double now_s) const {
    if (configuration_.rover_on_stage || !configuration_.bridle) return {};
    return altitude_m() - bridle_.standing_height_m(now_s);
}

double Vehicle::rover_descent_mps(double now_s) const {
    return -at_.v_MB_M.dot(at_.p_MoB_M.normalized()) + bridle_.speed_mps(now_s);
}

} // namespace aeolis::simulation
