// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/edl_gnc.hpp"
#include "flight/gnc/mars.hpp"
#include "tests/support/catch.hpp"

#include <cstring>

namespace flight_edl_gnc_test {

using namespace aeolis;
using namespace aeolis::flight;
using namespace aeolis::flight::gnc;

namespace {

Solution above_gale() {
    Solution solution;
    solution.epoch = {1000.0};
    solution.p_MoB_M_m = to_array(Vector3(3391148.0 + 150000.0, 0.0, 0.0));
    solution.v_MB_M_mps = {-1600.0, 5600.0, 0.0};
    solution.target_longitude_rad = 0.18;
    solution.target_radius_m = 3391148.0;
    return solution;
}

DeviceInputs inputs_at(Sclk now, std::uint32_t& count, const Vector3& force_B) {
    DeviceInputs in;
    in.now = now;
    const auto until = static_cast<std::uint32_t>((now.seconds - 1000.0) * 200.0);
    while (count < until) in.imu.push_back({++count, to_array(Vector3(force_B * imu_period_s)), {}});
    return in;
}

}  // namespace

TEST_CASE("without a solution nothing is decided and nothing commanded", "[gnc][R27]") {
    EdlGnc gnc(Load{});
    Output out;
    Configuration configuration;
    configuration.enabled = configuration.guidance_armed = true;
    std::uint32_t count = 0;
    gnc.cycle(inputs_at({1000.015625}, count, Vector3::Zero()), configuration, out);
    CHECK(out.mode == Mode::off);
    CHECK(out.triggers.empty());
    CHECK(out.attitude.mode == AttitudeCommand::Mode::idle);
    CHECK_FALSE(out.engines.ignited);
}

TEST_CASE("an old solution is brought up to now", "[gnc][R23]") {
    EdlGnc gnc(Load{});
    Output out;
    gnc.set_solution(above_gale(), {1020.0});
    DeviceInputs in;
    in.now = {1020.0};
    gnc.cycle(in, {}, out);
    NavigatedState state;
    state.p_MoB_M = to_vector(above_gale().p_MoB_M_m);
    state.v_MB_M = to_vector(above_gale().v_MB_M_mps);
    CHECK((to_vector(out.p_MoB_M_m) - propagate(state, 20.0).p_MoB_M).norm() < 1e-6);
}

namespace {

/// The attitude at tick 34 of a vehicle that spins at 2 rpm, told its attitude at tick 32 with the cycle of
/// `told_tick`.
Quaternion attitude_when_told(int told_tick) {
    EdlGnc gnc(Load{});
    gnc.set_solution(above_gale(), {1000.0});
    Output out;
    std::uint32_t count = 0;
    const CruiseAttitude attitude{{1, 0, 0, 0}, Sclk{1000.0} + 32 * seconds_per_tick};
    for (int tick = 1; tick <= 34; ++tick) {
        auto in = inputs_at(Sclk{1000.0} + tick * seconds_per_tick, count, Vector3::Zero());
        for (auto& sample : in.imu) sample.delta_angle_rad = {0.0, 0.0, 0.2094 * imu_period_s};
        if (tick == told_tick) gnc.on(attitude);
        gnc.cycle(in, {}, out);
    }
    return to_quaternion(out.q_MB);
}

}  // namespace

TEST_CASE("a cruise attitude is as of its own tick, whether it comes before that tick's increments or after",
          "[gnc][R27]") {
    const double turned = 2.0 * seconds_per_tick * 0.2094;
    for (const int told_tick : {31, 32, 33, 34}) {
        INFO("told with tick " << told_tick);
        const Quaternion q = attitude_when_told(told_tick);
        CHECK(2.0 * std::atan2(q.z(), q.w()) ==
              Approx(turned).margin(0.2094 * imu_period_s));  // one of the IMU's samples
    }
}

TEST_CASE("drag starts entry guidance once, and explains it", "[gnc][R17][R38]") {
    EdlGnc gnc(Load{});
    Solution solution = above_gale();
    solution.p_MoB_M_m = to_array(Vector3(3391148.0 + 65000.0, 0.0, 0.0));
    gnc.set_solution(solution, {1000.0});
    Configuration configuration;
    configuration.enabled = configuration.cruise_stage_gone = configuration.guidance_armed = true;
    Output out;
    std::uint32_t count = 0;
    int started = 0;
    for (int tick = 1; tick <= 640; ++tick) {
        const double drag = 0.3 * tick / 64.0;
        gnc.cycle(inputs_at(Sclk{1000.0} + tick / 64.0, count, drag * Vector3(1600, -5600, 0).normalized()),
                  configuration, out);
        for (const auto& [trigger, conditions] : out.triggers) {
            if (trigger != Trigger::guidance_start) continue;
            ++started;
            REQUIRE(conditions.size() == 1);
            CHECK(conditions[0].quantity == Quantity::drag_mps2);
            CHECK(conditions[0].value >= 1.96);
            CHECK(drag > 1.96);  // filtered: later than the raw drag
            CHECK(drag < 2.3);
        }
    }
    CHECK(started == 1);
    CHECK(gnc.mode() == Mode::range_control);
}

TEST_CASE("before guidance starts the lift is held sideways", "[gnc][R27]") {
    EdlGnc gnc(Load{});
    gnc.set_solution(above_gale(), {1000.0});
    Configuration configuration;
    configuration.enabled = true;
    Output out;
    std::uint32_t count = 0;
    gnc.cycle(inputs_at({1000.015625}, count, Vector3::Zero()), configuration, out);
    CHECK(out.mode == Mode::approach);
    CHECK(out.attitude.mode == AttitudeCommand::Mode::detumble);
    configuration.turning_to_entry = true;
    gnc.cycle(inputs_at({1000.03125}, count, Vector3::Zero()), configuration, out);
    CHECK(out.attitude.mode == AttitudeCommand::Mode::entry_bank);
    CHECK(out.bank_command_deg >= 72.0);  // [facts]: +74 … 80
    CHECK(out.bank_command_deg <= 80.0);
}

TEST_CASE("the configuration selects what navigation takes: the star scanner with the cruise stage, the radar once on",
          "[gnc][R26]") {
    for (const bool gone : {false, true}) {
        INFO("cruise stage gone: " << gone);
        EdlGnc gnc(Load{});
        gnc.set_solution(above_gale(), {1000.0});
        Configuration configuration;
        configuration.cruise_stage_gone = gone;
        Output out;
        std::uint32_t count = 0;
        const Sclk told = Sclk{1000.0} + seconds_per_tick;
        gnc.cycle(inputs_at(told, count, Vector3::Zero()), configuration, out);
        gnc.on(CruiseAttitude{{0, 1, 0, 0}, told});
        gnc.cycle(inputs_at(told + seconds_per_tick, count, Vector3::Zero()), configuration, out);
        CHECK(std::abs(to_quaternion(out.q_MB).x()) == Approx(gone ? 0.0 : 1.0).margin(1e-3));
    }
    for (const bool processed : {false, true}) {
        INFO("radar processed: " << processed);
        EdlGnc gnc(Load{});
        Solution solution = above_gale();
        solution.p_MoB_M_m[0] = solution.target_radius_m + 7000.0;
        solution.v_MB_M_mps = {-80.0, 0.0, 0.0};
        gnc.set_solution(solution, {1000.0});
        Configuration configuration;
        configuration.radar_on = processed;
        Output out;
        std::uint32_t count = 0;
        for (int tick = 1; tick <= 64 * 6; ++tick)
            gnc.cycle(inputs_at(Sclk{1000.0} + tick / 64.0, count, Vector3::Zero()), configuration, out);
        gnc.on(RadarSolution{Sclk{1003.5}, 5.0, out.altitude_m + 200.0, {-80.0, 0.0, 0.0}, 600});
        gnc.cycle(inputs_at(Sclk{1006.0} + seconds_per_tick, count, Vector3::Zero()), configuration, out);
        CHECK(out.radar_locked == processed);
    }
}

TEST_CASE("a copy given the same inputs goes on the same, bit for bit", "[gnc][R27]") {
    EdlGnc one(Load{});
    one.set_solution(above_gale(), {1000.0});
    Configuration configuration;
    configuration.enabled = configuration.guidance_armed = true;
    Output out_one, out_two;
    std::uint32_t count = 0;
    for (int tick = 1; tick <= 64; ++tick)
        one.cycle(inputs_at(Sclk{1000.0} + tick / 64.0, count, Vector3(0.1, 0.2, 0.3)), configuration, out_one);
    EdlGnc two = one;
    std::uint32_t count_two = count;
    for (int tick = 65; tick <= 256; ++tick) {
        one.cycle(inputs_at(Sclk{1000.0} + tick / 64.0, count, Vector3(0.3, 0.2, 0.1)), configuration, out_one);
        two.cycle(inputs_at(Sclk{1000.0} + tick / 64.0, count_two, Vector3(0.3, 0.2, 0.1)), configuration, out_two);
    }
    CHECK(out_one.p_MoB_M_m == out_two.p_MoB_M_m);
    CHECK(out_one.v_MB_M_mps == out_two.v_MB_M_mps);
    CHECK(out_one.q_MB == out_two.q_MB);
}

TEST_CASE("in the air a new solution changes bounds, not the navigated state", "[gnc][R23]") {
    EdlGnc gnc(Load{});
    Solution solution = above_gale();
    solution.p_MoB_M_m = to_array(Vector3(3391148.0 + 60000.0, 0.0, 0.0));
    gnc.set_solution(solution, {1000.0});
    Configuration configuration;
    configuration.enabled = configuration.cruise_stage_gone = configuration.guidance_armed = true;
    Output out;
    std::uint32_t count = 0;
    for (int tick = 1; tick <= 320; ++tick)
        gnc.cycle(inputs_at(Sclk{1000.0} + tick / 64.0, count, 5.0 * Vector3(1600, -5600, 0).normalized()),
                  configuration, out);
    REQUIRE(gnc.mode() == Mode::range_control);
    const auto before = out.p_MoB_M_m;
    solution.p_MoB_M_m[0] += 1.0e6;
    gnc.set_solution(solution, {1005.0});
    gnc.cycle(inputs_at({1005.015625}, count, Vector3::Zero()), configuration, out);
    CHECK((to_vector(out.p_MoB_M_m) - to_vector(before)).norm() < 200.0);
}

}  // namespace flight_edl_gnc_test
