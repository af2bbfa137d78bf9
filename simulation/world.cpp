// SPDX-License-Identifier: Apache-2.0
#include "simulation/world.hpp"

#include "simulation/buses/buses.hpp"
#include "simulation/initial_state.hpp"
#include "simulation/links/x_band_antenna.hpp"
#include "simulation/mars/earth.hpp"
#include "simulation/moments.hpp"
#include "simulation/sensors/imu.hpp"
#include "simulation/sensors/radar.hpp"
#include "simulation/sensors/rover_imu.hpp"
#include "simulation/sensors/star_scanner.hpp"
#include "simulation/vehicle/vehicle.hpp"

#include <algorithm>
#include <cstdio>
#include <limits>

namespace aeolis::simulation {
namespace {

// All time is on a grid of 1/1600 s, which divides both the IMU's 1/200 s and the computer's 1/64 s.
constexpr std::int64_t grid_hz = 1600;
constexpr std::int64_t grid_per_tick = 25;
constexpr std::int64_t grid_per_reading = 8;

constexpr double entry_margin_m = 1.0;  // from propagation back and forth: far below a tick's 25 m
constexpr double burns_up_m = 80000.0;  // our assumption: a cruise stage still attached below this ends the run
constexpr double wheels_break_vertical_mps = 2.0;    // our assumption
constexpr double wheels_break_horizontal_mps = 1.5;  // our assumption
constexpr double stage_clear_m = 50.0;               // our assumption: a stage that falls nearer has hit the rover
constexpr double waits_for_cutting_s = 20.0;         // our assumption

Imu imu(const Scenario& scenario, std::uint64_t seed, std::uint64_t case_number, flight::Unit unit) {
    const bool a = unit == flight::Unit::a;
    return {scenario.dispersions, Random{seed, case_number, a ? Stream::imu : Stream::imu_b},
            Random{seed, case_number, a ? Stream::imu_mounting : Stream::imu_b_mounting}};
}

Radar radar(const Scenario& scenario, std::uint64_t seed, std::uint64_t case_number, flight::Unit unit) {
    const bool a = unit == flight::Unit::a;
    return {scenario.dispersions, Random{seed, case_number, a ? Stream::radar : Stream::radar_b},
            Random{seed, case_number, a ? Stream::radar_dropout : Stream::radar_b_dropout},
            Random{seed, case_number, a ? Stream::radar_sand : Stream::radar_b_sand}};
}

bool on_four_engines(const flight::EngineCommand& engines) {
    const auto& throttle = engines.throttle;
    const auto idle = std::count_if(throttle.begin(), throttle.end(), [](double t) { return t < 0.05; });
    const auto pushing = std::count_if(throttle.begin(), throttle.end(), [](double t) { return t > 0.1; });
    return engines.ignited && idle == 4 && pushing == 4;
}

std::string seconds_text(double seconds) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.2f s", seconds);
    return text.data();
}

}  // namespace

struct World::State {
    Scenario scenario;
    InitialState initial;
    Vehicle vehicle;
    Buses buses;
    std::array<Imu, 2> imus;  ///< units A and B
    std::array<Radar, 2> radars;
    StarScanner star_scanner;
    RoverImu rover_imu;

    std::int64_t ticks = 0;                   ///< since the start
    flight::Unit imu_unit = flight::Unit::a;  ///< the unit whose link the computer listens to
    flight::DeviceInputs in;
    FixedVector<flight::ImuSample, 4> imu_samples;
    FixedVector<flight::UplinkPacket, 8> received;
    bool separation_commanded = false;  ///< of the cruise stage
    std::uint32_t nvm_used_octets = 0, nvm_capacity_octets = 0;

    BankReversals reversals;
    PeakDeceleration peak;
    std::vector<TruthEvent> events;
    bool system_fault_told = false;
    bool entered = false, engines_commanded = false, sky_crane_started = false, flown_away = false;
    std::optional<Sclk> contact, bridle_cut, stage_down;
    Vector3 p_MoRover_M = Vector3::Zero();
    std::optional<TouchdownReport> touchdown;
    Outcome outcome = Outcome::running;
    std::string reason;

    State(const Scenario& s, std::uint64_t seed, std::uint64_t case_number)
        : scenario(s), initial(initial_state(s, seed, case_number)),
          vehicle(s, initial.truth, cruise_attitude(s.start_before_entry_s), seed, case_number),
          buses(s, seed, case_number),
          imus{imu(s, seed, case_number, flight::Unit::a), imu(s, seed, case_number, flight::Unit::b)},
          radars{radar(s, seed, case_number, flight::Unit::a), radar(s, seed, case_number, flight::Unit::b)},
          star_scanner(s, Random{seed, case_number, Stream::star_scanner}),
          rover_imu(s.dispersions, Random{seed, case_number, Stream::rover_imu}) {
        events.reserve(8);
    }

    std::int64_t grid() const { return ticks * grid_per_tick; }
    static double seconds(std::int64_t grid) { return static_cast<double>(grid) / grid_hz; }
    double now_s() const { return seconds(grid()); }
    Sclk sclk() const { return initial.start + static_cast<double>(ticks) * seconds_per_tick; }

    std::optional<flight::SystemFaultReport> system_fault_report() {
        const double to_entry_s = scenario.entry_sclk - sclk();
        const bool present = std::ranges::any_of(scenario.system_faults, [&](const SystemFault& fault) {
            return to_entry_s <= fault.begin_before_entry_s &&
                   to_entry_s > fault.begin_before_entry_s - fault.duration_s;
        });
        const bool is_over = system_fault_told && !present;
        if (!is_over && !(present && sclk().ticks() % 64 == 0)) return {};
        system_fault_told = present;
        return flight::SystemFaultReport{present};
    }

    std::optional<flight::RoverImuReading> rover_imu_reading() {
        if (!buses.rover_imu_was_read()) return {};
        const Vehicle::RoverMotion motion = vehicle.rover_motion();
        const flight::RoverImuReading reading = rover_imu.measure(motion.force_mps2, motion.rate_rps);
        if (!buses.faults().has(DeviceFault::Kind::dropout, flight::Device::rover_imu, flight::Unit::a)) return reading;
        constexpr double fails = std::numeric_limits<double>::quiet_NaN();
        return flight::RoverImuReading{{fails, fails, fails}, {fails, fails, fails}};
    }

    TruthState truth() const {
        TruthState truth;
        truth.sclk = sclk();
        truth.e_s = truth.sclk - scenario.entry_sclk;
        truth.p_MoB_M_m = array3(vehicle.at().p_MoB_M);
        truth.v_MB_M_mps = array3(vehicle.at().v_MB_M);
        truth.altitude_m = vehicle.altitude_m();
        truth.speed_mps = vehicle.at().v_MB_M.norm();
        truth.sensed_mps2 = vehicle.specific_force_M().norm();
        return truth;
    }

    SeparationReport separation() const {
        const auto& [heatshield, backshell] = vehicle.separated();
        return {heatshield.least_m(), backshell.least_m(),
                heatshield.struck()  ? "heatshield"
                : backshell.struck() ? "backshell"
                                     : nullptr};
    }

    bool heatshield_hides(const flight::RadarBeam& beam) const {
        if (vehicle.configuration().heatshield) return true;
        if (!vehicle.separated().heatshield.released()) return false;  // gone before the vehicle was placed
        return Radar::hides(vehicle.separated().heatshield.from(vehicle.at().p_MoB_M),
                            vehicle.q_MB() * vector3(beam.direction_B));
    }

    bool sand_moves() const {
        constexpr double from_m = 30.0;  // our assumption: the plume reaches the ground
        return vehicle.engines().running() && vehicle.height_m() < from_m;
    }

    void tell(const char* name) { events.push_back(moment(name, truth())); }
    void end(Outcome how, std::string why) {
        if (outcome != Outcome::running) return;
        outcome = how;
        reason = std::move(why);
    }

    void obey();
    void listen_to_imu(flight::Unit unit);
    void take_pyro(flight::PyroId pyro);
    void fly_on() {
        events.clear();
        shift_wind();
        shift_air();
        fly_one_tick();
        buses.frame(sclk());
        obey();
        watch();
    }
    void shift_wind();
    void shift_air();
    /// By how much a unit measures wrongly now, beside what was drawn.
    double sensor_off_by(flight::Device device, flight::Unit unit) const;
    void fly_one_tick();
    void measure_last_tick();
    void touch_ground(const std::optional<PointMass>& rover);
    void watch();
};

void World::State::take_pyro(flight::PyroId pyro) {
    using flight::PyroId;
    switch (pyro) {
    case PyroId::cruise_stage_separation: tell("cruise_stage_separation"); break;
    case PyroId::entry_balance_1: tell("sufr_start"); break;
    case PyroId::parachute_mortar: tell("parachute_deploy"); break;
    case PyroId::heatshield_separation: tell("heatshield_separation"); break;
    case PyroId::engine_valves: tell("engine_priming"); break;
    case PyroId::backshell_separation: tell("backshell_separation"); break;
    case PyroId::rover_separation: tell("rover_separation"); break;
    case PyroId::bridle_cutter:
        tell("bridle_cut");
        bridle_cut = sclk();
        if (!contact) end(Outcome::impact, "the bridle was cut before the rover stood");
        break;
    default: break;
    }
    vehicle.fire(pyro, now_s());
}

// Applies the commands that reached the devices with this tick's frames.
void World::State::obey() {
    for (const flight::PyroId pyro : buses.fired()) take_pyro(pyro);
    const flight::EngineCommand& engines = buses.engines();
    vehicle.command(buses.thrusters(), buses.devices().thrusters_enabled(), engines, buses.pay_out_bridle(), now_s());

    if (!sky_crane_started && on_four_engines(engines)) {
        sky_crane_started = true;
        tell("sky_crane_start");
    }
    if (engines_commanded && !engines.ignited && bridle_cut && !flown_away) {
        flown_away = true;
        tell("flyaway_end");
    }
    engines_commanded = engines.ignited;
}

// Integrates only the unit in use: the other would cost time without effect.
void World::State::listen_to_imu(flight::Unit unit) {
    if (unit == imu_unit) return;
    imu_unit = unit;
    imus[static_cast<std::size_t>(unit)].begin_reading();
}

void World::State::shift_wind() {
    double east_mps = 0.0, north_mps = 0.0;
    for (const WindShift& shift : scenario.wind_shifts)
        if (goes_on(shift, scenario.entry_sclk - sclk())) east_mps += shift.east_mps, north_mps += shift.north_mps;
    vehicle.shift_wind(east_mps, north_mps);
}

void World::State::shift_air() {
    double factor = 1.0;
    for (const AirShift& shift : scenario.air_shifts)
        if (goes_on(shift, scenario.entry_sclk - sclk())) factor *= 1.0 + shift.fraction;
    vehicle.shift_air(std::clamp(factor, 0.1, 10.0));  // our assumption: of several at once
}

double World::State::sensor_off_by(flight::Device device, flight::Unit unit) const {
    double off_by = 0.0;
    for (const SensorError& error : scenario.sensor_errors)
        if (error.device == device && error.unit == unit && goes_on(error, scenario.entry_sclk - sclk()))
            off_by += error.now(scenario.entry_sclk - sclk());
    return off_by;
}

// What a copy measures that flies ahead is, but for the change of two ticks, what the vehicle has measured.
void World::State::measure_last_tick() {
    State ahead{*this};
    ahead.ticks -= 2;
    ahead.imus[static_cast<std::size_t>(imu_unit)].begin_reading();
    for (int tick = 0; tick < 2; ++tick) ahead.fly_one_tick();  // a reading is under way at the end of the first
    imus = ahead.imus;
    imu_samples = ahead.imu_samples;
}

void World::State::fly_one_tick() {
    imu_samples.clear();
    Imu& imu = imus[static_cast<std::size_t>(imu_unit)];
    const std::int64_t end_grid = grid() + grid_per_tick;
    for (std::int64_t at = grid(); at < end_grid;) {
        const std::int64_t next = std::min(end_grid, (at / grid_per_reading + 1) * grid_per_reading);
        const double step_s = seconds(next - at);
        const Quaternion before = vehicle.q_MB();
        const bool stands = stage_down.has_value();
        if (!stands) {
            const std::optional<PointMass> rover = vehicle.rover();
            vehicle.step(seconds(at), step_s);
            touch_ground(rover);
        }
        const Vector3 felt =
            stands ? Vector3{-free_fall(vehicle.at().p_MoB_M, Vector3::Zero())} : vehicle.specific_force_M();
        imu.integrate(felt, before, vehicle.q_MB(), step_s);
        if (next % grid_per_reading == 0) {
            flight::ImuSample sample = imu.read(static_cast<std::uint32_t>(next / grid_per_reading));
            if (const double off_mps2 = sensor_off_by(flight::Device::imu, imu_unit); off_mps2 != 0.0)
                for (double& axis_mps : sample.delta_v_mps) axis_mps += off_mps2 * Imu::reading_s;
            if (buses.imu_sample_arrives()) imu_samples.push_back(sample);
        }
        at = next;
    }
    ++ticks;
    if (!stage_down) vehicle.fly_separated();
}

// `rover`: its state a step ago, because the ground has slowed it since its wheels touched.
void World::State::touch_ground(const std::optional<PointMass>& rover) {
    if (rover && !contact && vehicle.wheels_height_m() <= 0.0) {
        const Vector3& p = rover->p_MoB_M;
        const Horizon local = horizon(p);
        const double vertical_mps = -rover->v_MB_M.dot(local.up);
        const double horizontal_mps = std::hypot(rover->v_MB_M.dot(local.east), rover->v_MB_M.dot(local.north));
        const Vector3 target = simulation::place(scenario.target.latitude_deg * degree_rad,
                                                 scenario.target.longitude_deg * degree_rad, 1.0);
        const double miss_m =
            scenario.target.radius_m * std::atan2(target.cross(local.up).norm(), target.dot(local.up));
        contact = sclk() + seconds_per_tick;
        p_MoRover_M = p;
        const Vector3 stage_down_M = vehicle.q_MB() * Vector3::UnitZ();
        touchdown = TouchdownReport{vertical_mps,
                                    horizontal_mps,
                                    miss_m,
                                    latitude_rad(p) / degree_rad,
                                    longitude_rad(p) / degree_rad,
                                    std::acos(std::clamp(-stage_down_M.dot(local.up), -1.0, 1.0)) / degree_rad};
        if (vertical_mps > wheels_break_vertical_mps || horizontal_mps > wheels_break_horizontal_mps)
            end(Outcome::impact, "the rover touched the ground too fast");
    }
    if (vehicle.height_m() <= 0.0) stage_down = sclk() + seconds_per_tick;
}

void World::State::watch() {
    const TruthState now = truth();
    if (!std::isfinite(now.altitude_m) || !std::isfinite(now.speed_mps)) {
        end(Outcome::lost, "the state of the vehicle is no longer a number");
        stage_down = now.sclk;
        return;
    }
    if (!entered && vehicle.at().p_MoB_M.norm() <= scenario.entry.radius_m + entry_margin_m) {
        entered = true;
        tell("entry_interface");
    }
    if (auto event = peak.observe(now)) events.push_back(*event);
    if (vehicle.configuration().backshell && now.e_s > 0.0 && !buses.devices().fired(flight::PyroId::parachute_mortar))
        if (auto event = reversals.observe(now, vehicle.flow().bank_rad)) events.push_back(*event);

    if (outcome != Outcome::running) return;
    if (now.altitude_m < burns_up_m && vehicle.configuration().cruise_stage)
        return separation_commanded
                   ? end(Outcome::lost,
                         "entered with the cruise stage attached: it was commanded to separate, and did not")
                   : end(Outcome::not_commanded,
                         "entered with the cruise stage attached: its separation was not commanded");
    if (const char* body = separation().struck)
        return end(Outcome::lost,
                   std::string{"the vehicle was struck by its "} + body + " at E+" + seconds_text(now.e_s));
    if (!contact && stage_down) return end(Outcome::impact, "the vehicle hit the ground");
    if (now.e_s > scenario.timeout_after_entry_s) return end(Outcome::timeout, "not on the ground in time");
    if (!contact) return;
    const double since_contact_s = now.sclk - *contact;
    if (!bridle_cut) {
        if (stage_down) return end(Outcome::lost, "the descent stage sank onto the rover");
        if (since_contact_s > waits_for_cutting_s) return end(Outcome::lost, "the bridle was not cut");
        return;
    }
    if (!stage_down && since_contact_s < scenario.end_after_touchdown_s) return;
    if ((vehicle.at().p_MoB_M - p_MoRover_M).norm() < stage_clear_m)
        return end(Outcome::lost, "the descent stage fell onto the rover");
    end(Outcome::touchdown, vehicle.terrain().is_known(p_MoRover_M)
                                ? "the rover stands, the descent stage is away"
                                : "the rover stands beyond the grid of the ground, on heights of its edge");
}

World::World(const Scenario& scenario, std::uint64_t seed, std::uint64_t case_number)
    : state_(disperses_later(scenario) ? std::make_unique<State>(undispersed(scenario), seed, 0)
                                       : std::make_unique<State>(scenario, seed, case_number)) {
    state_->scenario = scenario;  // from which a later dispersion draws
}
World::World(const World& other) : state_(std::make_unique<State>(*other.state_)) {}
World& World::operator=(const World& other) {
    if (this != &other) state_ = std::make_unique<State>(*other.state_);
    return *this;
}
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;
World::~World() = default;

flight::NavigationShift World::disperse(std::uint64_t seed, std::uint64_t case_number) {
    State& s = *state_;
    const double before_entry_s = s.scenario.entry_sclk - s.sclk();
    const auto solved = [](const InitialState& at) {
        return PointMass{vector3(at.solution.p_MoB_M_m), vector3(at.solution.v_MB_M_mps)};
    };
    const InitialState nominal = state_before_entry(undispersed(s.scenario), before_entry_s, seed, 0);
    const InitialState drawn = state_before_entry(s.scenario, before_entry_s, seed, case_number);
    const auto shift = [](const PointMass& to, const PointMass& from) {
        return PointMass{to.p_MoB_M - from.p_MoB_M, to.v_MB_M - from.v_MB_M};
    };
    // Keeps the flight's departure from free fall so far.
    const PointMass flown = shift(s.vehicle.at(), nominal.truth);
    const PointMass believed = solved(drawn);
    const PointMass learnt = shift(believed, solved(nominal));
    s.vehicle.disperse(s.scenario, {drawn.truth.p_MoB_M + flown.p_MoB_M, drawn.truth.v_MB_M + flown.v_MB_M}, seed,
                       case_number);
    s.initial.solution = drawn.solution;
    s.initial.draws = drawn.draws;
    s.initial.solution.p_MoB_M_m = array3(believed.p_MoB_M + flown.p_MoB_M);
    s.initial.solution.v_MB_M_mps = array3(believed.v_MB_M + flown.v_MB_M);

    const Dispersions& errors = s.scenario.dispersions;
    s.imus[0].disperse(errors, {seed, case_number, Stream::imu}, {seed, case_number, Stream::imu_mounting});
    s.imus[1].disperse(errors, {seed, case_number, Stream::imu_b}, {seed, case_number, Stream::imu_b_mounting});
    s.radars = {radar(s.scenario, seed, case_number, flight::Unit::a),
                radar(s.scenario, seed, case_number, flight::Unit::b)};
    const Quaternion error_before = s.star_scanner.error();
    s.star_scanner = {s.scenario, {seed, case_number, Stream::star_scanner}};
    s.rover_imu = {errors, {seed, case_number, Stream::rover_imu}};
    s.buses.disperse(seed, case_number);
    return {array3(learnt.p_MoB_M), array3(learnt.v_MB_M), array4(error_before.conjugate() * s.star_scanner.error()),
            array3(s.imus[static_cast<std::size_t>(s.imu_unit)].accelerometer_bias_mps2())};
}

void World::redraw(std::uint64_t seed, std::uint64_t case_number, const std::optional<StateKnowledge>& knowledge) {
    State& s = *state_;
    const Dispersions& errors = s.scenario.dispersions;
    s.vehicle.redraw(s.scenario, seed, case_number, knowledge.has_value());
    s.buses.disperse(seed, case_number);
    if (knowledge || s.vehicle.configuration().heatshield)  // later it may have navigated by them
        s.radars = {radar(s.scenario, seed, case_number, flight::Unit::a),
                    radar(s.scenario, seed, case_number, flight::Unit::b)};
    if (!knowledge) return;
    s.imus[0].disperse(errors, {seed, case_number, Stream::imu}, {seed, case_number, Stream::imu_mounting});
    s.imus[1].disperse(errors, {seed, case_number, Stream::imu_b}, {seed, case_number, Stream::imu_b_mounting});
    s.rover_imu = {errors, {seed, case_number, Stream::rover_imu}};
    Random random{seed, case_number, Stream::placing};
    const double by_axis = 1.0 / std::numbers::sqrt3;
    Vector3 by_M_m = knowledge->position_m * by_axis * vector3(random.normal3());
    if (knowledge->height_m) {
        const Vector3 up_M = s.vehicle.at().p_MoB_M.normalized();
        by_M_m += (*knowledge->height_m * random.normal3()[2] - up_M.dot(by_M_m)) * up_M;
    }
    const Vector3 by_M_mps = knowledge->velocity_mps * by_axis * vector3(random.normal3());
    s.vehicle.shift(by_M_m, by_M_mps, rotation(knowledge->attitude_rad * vector3(random.normal3())));
}

void World::shift(const flight::NavigationShift& by) {
    const auto& [w, x, y, z] = by.q_BB;
    state_->vehicle.shift(vector3(by.p_MoB_M_m), vector3(by.v_MB_M_mps), Quaternion{w, x, y, z});
}

PlacedState World::placed_state() const {
    const State& s = *state_;
    PlacedState state;
    state.sclk = s.sclk();
    s.vehicle.add_to(state, s.initial.start);
    s.buses.add_to(state);
    state.peak_deceleration_mps2 = s.peak.mps2();
    state.peak_passed = s.peak.passed();
    state.bank_reversals = s.reversals.count();
    return state;
}

void World::place(const PlacedState& state) {
    State& s = *state_;
    const std::int64_t ticks = std::llround((state.sclk - s.initial.start) / seconds_per_tick);
    const bool elsewhen = ticks != s.ticks;
    s.ticks = ticks;
    s.vehicle.place(s.scenario, state, s.initial.start);
    s.buses.place(state);
    if (elsewhen) s.measure_last_tick();
    s.events.clear();
    s.entered = s.vehicle.at().p_MoB_M.norm() <= s.scenario.entry.radius_m + entry_margin_m;
    s.separation_commanded = true;
    s.reversals = BankReversals{state.bank_reversals};
    s.peak = {moment("peak_deceleration", s.truth()), state.peak_deceleration_mps2, state.peak_passed};
    s.engines_commanded = state.engines.ignited;
    s.sky_crane_started = state.bridle.has_value() || on_four_engines(state.engines);
}

flight::DeviceInputs& World::sense() {
    State& s = *state_;
    flight::DeviceInputs& in = s.in;
    in.now = s.sclk();
    in.imu = s.imu_samples;
    in.cruise_attitude.reset();
    in.radar.clear();
    in.rover_imu = s.rover_imu_reading();
    in.pyro_replies.clear();
    in.switch_replies.clear();
    in.engines.reset();
    in.thrusters.reset();
    in.bridle.reset();
    in.uplink.clear();
    if (s.vehicle.configuration().cruise_stage && in.now.ticks() % 64 == 0)
        in.cruise_attitude = s.star_scanner.measure(s.vehicle.q_MB(), in.now);
    if (s.buses.radar_was_read()) {
        const flight::Unit unit = s.buses.unit(flight::Device::radar);
        const bool blind = s.buses.faults().has(DeviceFault::Kind::dropout, flight::Device::radar, unit);
        for (std::uint32_t beam = 0; beam < Radar::beams; ++beam) {
            if (!Radar::due(beam, s.grid() - grid_per_tick, s.grid())) continue;
            flight::RadarBeam reading = s.radars[static_cast<std::size_t>(unit)].measure(
                beam, s.vehicle.at(), s.vehicle.q_MB(), s.vehicle.terrain(), s.sand_moves());
            if (reading.valid) reading.range_rate_mps += s.sensor_off_by(flight::Device::radar, unit);
            if (blind || s.heatshield_hides(reading)) reading = {reading.beam, reading.direction_B, false, 0.0, 0.0};
            in.radar.push_back(reading);
        }
    }
    s.buses.reply(in);
    const Engines& engines = s.vehicle.engines();
    const bool read = s.buses.engines_were_read();
    if (read && engines.valves_open()) in.engines = flight::EngineReply{engines.running(), engines.thrust_N()};
    if (read && !s.vehicle.configuration().rover_on_stage)
        in.bridle = flight::BridleReply{s.vehicle.bridle().payed_out_m(s.now_s())};
    in.system_fault = s.system_fault_report();
    while (!s.received.empty() && !in.uplink.full()) {
        in.uplink.push_back(s.received[0]);
        s.received.erase_at(0);
    }
    in.nvm_used_octets = s.nvm_used_octets;
    in.nvm_capacity_octets = s.nvm_capacity_octets;
    return in;
}

void World::advance(const flight::DeviceOutputs& out) {
    state_->separation_commanded |= std::ranges::any_of(
        out.pyros, [](const flight::PyroCommand& pyro) { return pyro.id == flight::PyroId::cruise_stage_separation; });
    state_->buses.take(out);
    state_->listen_to_imu(out.units[flight::Device::imu]);
    state_->fly_on();
}

void World::advance_uncommanded() {
    state_->buses.leave_alone();
    state_->fly_on();
}

bool World::receive(std::span<const std::uint8_t> cltu) {
    flight::UplinkPacket packet;
    if (cltu.size() > packet.octets.size()) return false;
    std::copy(cltu.begin(), cltu.end(), packet.octets.begin());
    packet.size = static_cast<std::uint16_t>(cltu.size());
    return state_->received.try_push_back(packet);
}

void World::inject(const DeviceFault& fault) {
    state_->buses.inject(fault, state_->sclk());
}

void World::inject(const SystemFault& fault) {
    state_->scenario.system_faults.push_back(fault);
}

void World::inject(const WindShift& shift) {
    state_->scenario.wind_shifts.push_back(shift);
}

void World::inject(const AirShift& shift) {
    state_->scenario.air_shifts.push_back(shift);
}

void World::inject(const SensorError& error) {
    state_->scenario.sensor_errors.push_back(error);
}

void World::set_nvm(std::uint32_t used_octets, std::uint32_t capacity_octets) {
    state_->nvm_used_octets = used_octets;
    state_->nvm_capacity_octets = capacity_octets;
}

Sclk World::sclk() const {
    return state_->sclk();
}
TruthState World::truth() const {
    return state_->truth();
}
std::span<const TruthEvent> World::events() const {
    return state_->events;
}
Outcome World::outcome() const {
    return state_->outcome;
}
const std::string& World::outcome_reason() const {
    return state_->reason;
}
const std::optional<TouchdownReport>& World::touchdown() const {
    return state_->touchdown;
}
std::optional<Sclk> World::contact() const {
    return state_->contact;
}
double World::peak_deceleration_mps2() const {
    return state_->peak.mps2();
}
SeparationReport World::separation() const {
    return state_->separation();
}
const NavigationSolution& World::solution() const {
    return state_->initial.solution;
}

std::vector<Draw> World::draws() const {
    const State& s = *state_;
    std::vector<Draw> all = s.initial.draws;
    s.vehicle.add_draws(s.scenario, all);
    add_axes(all, "attitude", "rad", rotation_vector(s.star_scanner.error()));
    s.imus.front().add_draws(all);
    s.radars.front().add_draws(all);
    return all;
}

bool World::uhf_on() const {
    return state_->buses.uhf_radiates();
}
bool World::parachute_antenna_on() const {
    return state_->buses.parachute_antenna_on();
}
bool World::x_band_sends_tones() const {
    return state_->buses.x_band_sends_tones();
}
bool World::cruise_stage_on() const {
    return state_->vehicle.configuration().cruise_stage;
}
World::EarthView World::earth_view() const {
    const State& s = *state_;
    const double e_s = s.sclk() - s.scenario.entry_sclk;
    EarthView view;
    view.up = earth_is_up(s.vehicle.at().p_MoB_M, e_s, s.scenario.target.radius_m);
    if (const auto antenna = s.buses.x_band_antenna())
        view.gain = x_band_gain(*antenna, s.vehicle.q_MB().conjugate() * earth_direction_M(e_s));
    return view;
}
const Bus::Counters& World::bus_64_hz() const {
    return state_->buses.counters_64_hz();
}
const Bus::Counters& World::bus_8_hz() const {
    return state_->buses.counters_8_hz();
}

World::Inspection World::inspect() const {
    const State& s = *state_;
    const Vehicle::Flow flow = s.vehicle.flow();
    return {.mass_kg = s.vehicle.configuration().total_kg(),
            .propellant_kg = s.vehicle.configuration().propellant_kg(),
            .mach = flow.mach,
            .dynamic_pressure_Pa = flow.dynamic_pressure_Pa,
            .angle_of_attack_deg = flow.angle_of_attack_rad / degree_rad,
            .bank_deg = flow.bank_rad / degree_rad,
            .density_kgm3 = flow.density_kgm3,
            .thrust_N = s.vehicle.engines().thrust_N(),
            .bridle_m = s.vehicle.bridle().payed_out_m(s.now_s()),
            .swing_deg = s.vehicle.swing_rad() / degree_rad,
            .q_MB = array4(s.vehicle.q_MB()),
            .rate_B_rps = array3(s.vehicle.body().rate_B_rps),
            .uhf_on = uhf_on(),
            .parachute_open = s.vehicle.parachute_open(s.now_s())};
}

}  // namespace aeolis::simulation
