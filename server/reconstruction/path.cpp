// SPDX-License-Identifier: Apache-2.0
#include "server/reconstruction/path.hpp"

#include "flight/gnc/mars.hpp"
#include "flight/gnc/navigation/strapdown.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace aeolis::reconstruction {
namespace {

using flight::ImuSample;
using flight::gnc::gap_max;
using flight::gnc::imu_period_s;
using flight::gnc::NavigatedState;
using flight::gnc::Strapdown;
using flight::gnc::to_vector;

constexpr double before_entry_s = 30.0;        // chosen: still in free fall, and shortly before entry
constexpr std::uint32_t readings_a_step = 25;  // of 1/200 s: path_step_s
constexpr double tick_part = 0.01;             // tolerance for rounding, in ticks
constexpr double median_deviation = 1.2533;  // standard deviation of a median over that of a mean, normal noise: √(π/2)

struct Reading {
    Sclk end;
    ImuSample sample;
};

std::vector<Reading> readings_of(const RecordedLanding& recorded) {
    std::vector<Reading> all;
    all.reserve(recorded.imu().size());
    for (const auto& [count, sample] : recorded.imu())
        all.push_back({recorded.imu_began() + imu_period_s * count, sample});
    return all;
}

struct Bias {
    Vector3 mean_mps2 = Vector3::Zero();
    double sigma_mps2 = 0.0;
};

/// What the accelerometers read in free fall. Their median is blind to the few readings in which a thruster pushes.
Bias bias_in_free_fall(std::span<const Reading> readings, const SensorErrors& errors) {
    if (readings.empty()) return {Vector3::Zero(), errors.accelerometer_bias_mps2};
    Bias bias;
    std::vector<double> axis(readings.size());
    for (std::size_t i = 0; i < 3; ++i) {
        std::ranges::transform(readings, axis.begin(), [&](const Reading& r) { return r.sample.delta_v_mps[i]; });
        const auto middle = axis.begin() + static_cast<std::ptrdiff_t>(axis.size() / 2);
        std::ranges::nth_element(axis, middle);
        bias.mean_mps2[static_cast<Eigen::Index>(i)] = *middle / imu_period_s;
    }
    bias.sigma_mps2 = median_deviation * errors.accelerometer_noise_mps / imu_period_s /
                      std::sqrt(static_cast<double>(readings.size()));
    return bias;
}

NavigatedState between(const NavigatedState& a, const NavigatedState& b, double part) {
    return {a.p_MoB_M + part * (b.p_MoB_M - a.p_MoB_M), a.v_MB_M + part * (b.v_MB_M - a.v_MB_M),
            a.q_MB.slerp(part, b.q_MB)};
}

/// Integrates readings, and gathers what the error filter needs of each step.
class Integration {
  public:
    Integration(const NavigatedState& start, const Vector3& bias_mps2, ErrorFilter& filter)
        : bias_mps2_(bias_mps2), filter_(filter) {
        strapdown_.start(start);
    }

    void on(const ImuSample& reading) {
        before_ = strapdown_.state();
        const Vector3 delta_v = to_vector(reading.delta_v_mps) - imu_period_s * bias_mps2_;
        ImuSample sample = reading;
        sample.delta_v_mps = flight::gnc::to_array(delta_v);
        const std::uint32_t filled = strapdown_.filled();
        strapdown_.on(parameters_, sample, true);
        const std::uint32_t count = 1 + strapdown_.filled() - filled;
        filled_ += count - 1;
        const Matrix3 R_MB = before_.q_MB.toRotationMatrix();
        motion_.readings += count;
        motion_.seconds += count * imu_period_s;
        motion_.sensed_M_mps += count * (R_MB * delta_v);
        motion_.turned += count * imu_period_s * R_MB;
        motion_.turned_sensed += count * (R_MB * delta_v.asDiagonal());
        motion_.turned_rad += count * to_vector(sample.delta_angle_rad).norm();
    }
    /// Goes over a gap, on to the state that flight navigated at its end.
    void go_on(const NavigatedState& state, const Gap& gap) {
        if (motion_.readings > 0) end_step(false);
        strapdown_ = {};
        strapdown_.start(state);
        filter_.pass(gap);
    }
    /// Takes the beams of a tick that lies `before_end_s` before the end of the last reading.
    void see(const BeamsAt& at, double before_end_s) {
        const double part = std::clamp(1.0 - before_end_s / imu_period_s, 0.0, 1.0);
        const NavigatedState then = between(before_, strapdown_.state(), part);
        for (const auto& beam : at.beams)
            if (beam.valid && beam.beam < ErrorFilter::beams)
                sightings_.push_back({beam.beam, then.q_MB * to_vector(beam.direction_B).normalized(), beam.range_m,
                                      beam.range_rate_mps, then.p_MoB_M, then.v_MB_M, before_end_s - motion_.seconds});
    }
    bool step_is_full() const { return motion_.readings >= readings_a_step; }
    void end_step(bool whole = true) {
        motion_.p_MoB_M = strapdown_.state().p_MoB_M;
        for (Sighting& sighting : sightings_) sighting.before_end_s += motion_.seconds;
        filter_.step(motion_, sightings_, whole);
        motion_ = {};
        sightings_.clear();
    }
    const NavigatedState& state() const { return strapdown_.state(); }
    /// Mean specific force over the step so far, by the path's attitude.
    Vector3 felt_M_mps2() const { return motion_.sensed_M_mps / motion_.seconds; }
    std::uint32_t filled() const { return filled_; }

  private:
    flight::Parameters parameters_;  ///< as built. Only learning a bias would use them, and none is learned here
    Strapdown strapdown_;
    Vector3 bias_mps2_;
    ErrorFilter& filter_;
    NavigatedState before_;
    Motion motion_;
    std::vector<Sighting> sightings_;  ///< before_end_s counts from the step's start, negative, until the step ends
    std::uint32_t filled_ = 0;
};

/// The navigated state of a reading: that of the tick with which it arrived.
std::optional<NavigatedState> navigated_at(std::span<const Navigated> navigated, Sclk reading_end) {
    const Sclk tick = Sclk::from_ticks(static_cast<std::int64_t>(std::ceil(reading_end.seconds * 64.0 - tick_part)));
    const auto found = std::ranges::lower_bound(navigated, tick, {}, &Navigated::at);
    if (found == navigated.end() || found->at != tick) return std::nullopt;
    return found->state;
}

/// The gap from the last point of the path that flight's navigation can be held against, to `again`.
Gap gap_to(const Navigated& again, Sclk last_reading, const Path& path, const RecordedLanding& recorded) {
    Gap gap;
    gap.seconds = again.at - last_reading;
    gap.p_MoB_M = again.state.p_MoB_M;
    const auto last = std::ranges::find_if(path.points.rbegin(), path.points.rend(),
                                           [](const PathPoint& point) { return point.navigated.has_value(); });
    if (last != path.points.rend()) {
        const NavigatedState& said = *last->navigated;
        const double radius_m = gap.p_MoB_M.norm();
        const Vector3 gravity_mps2 = -flight::gnc::mars_gm_m3ps2 / (radius_m * radius_m * radius_m) * gap.p_MoB_M;
        gap.sensed_M_mps = again.state.v_MB_M - said.v_MB_M - (again.at - last->at) * gravity_mps2;
        gap.p_M_m = last->state.p_MoB_M - said.p_MoB_M;
        gap.v_M_mps = last->state.v_MB_M - said.v_MB_M;
        const Eigen::AngleAxisd turn{last->state.q_MB * said.q_MB.conjugate()};
        gap.angle_M_rad = turn.angle() * turn.axis();
    }
    if (const auto belief = recorded.believed(again.at)) {
        gap.attitude_rad = belief->attitude_rad;
        gap.velocity_mps = belief->velocity_mps;
        gap.altitude_m = belief->altitude_m;
    }
    return gap;
}

/// Adds the estimated error, truth less path, to the path.
void correct(Path& path, std::span<const PathError> errors) {
    for (std::size_t i = 0; i < path.points.size(); ++i) {
        PathPoint& point = path.points[i];
        const PathError& error = errors[i];
        point.state.p_MoB_M += error.p_M_m;
        point.state.v_MB_M += error.v_M_mps;
        const double turn_rad = error.angle_M_rad.norm();
        if (turn_rad > 0.0)
            point.state.q_MB =
                (Quaternion{Eigen::AngleAxisd{turn_rad, error.angle_M_rad / turn_rad}} * point.state.q_MB).normalized();
        point.sigma_p_m = error.sigma_p_m;
        point.sigma_v_mps = error.sigma_v_mps;
        point.sigma_angle_rad = error.sigma_angle_rad;
        point.sigma_height_m = error.sigma_height_m;
    }
}

/// The stage as touchdown is declared: over the site by the bridle and what is below it. It has sunk by a metre since
/// the wheels touched.
Vector3 stage_over(const LandingSite& site) {
    constexpr double degree = std::numbers::pi / 180.0, sunk_m = 1.0;
    const flight::Parameters built;
    const double radius_m = site.radius_m + built.bridle_length_m + built.stage_above_bridle_m - sunk_m;
    const double latitude_rad = site.latitude_deg * degree, longitude_rad = site.longitude_deg * degree;
    return radius_m * Vector3{std::cos(latitude_rad) * std::cos(longitude_rad),
                              std::cos(latitude_rad) * std::sin(longitude_rad), std::sin(latitude_rad)};
}

}  // namespace

Result<Path> reconstruct(const RecordedLanding& recorded, const SensorErrors& errors,
                         const std::optional<LandingSite>& site) {
    const std::vector<Reading> readings = readings_of(recorded);
    const std::vector<Navigated> navigated = recorded.navigated();
    if (!recorded.target_radius_m() || !recorded.entry()) return Error{"the recording holds no parameters"};
    if (readings.empty()) return Error{"the recording holds no readings of the IMU"};
    Path path;
    path.entry = *recorded.entry();
    path.target_radius_m = *recorded.target_radius_m();
    const Sclk begin = path.entry + -before_entry_s;
    const Sclk end = recorded.reported("TOUCHDOWN").value_or(readings.back().end);
    const auto start = std::ranges::find_if(
        navigated, [&](const Navigated& at) { return at.at >= begin && at.at >= readings.front().end; });
    if (start == navigated.end() || start->at >= end)
        return Error{
            fmt::format("the recording holds no navigated state from {:.0f} s before entry on", before_entry_s)};

    const auto after = [&](Sclk time) {
        return std::ranges::upper_bound(readings, time + tick_part * seconds_per_tick, {}, &Reading::end);
    };
    auto next = after(start->at);
    const Bias bias = bias_in_free_fall({readings.begin(), next}, errors);
    path.accelerometer_bias_mps2 = bias.mean_mps2;
    ErrorFilter filter{errors, bias.sigma_mps2, path.target_radius_m};
    Integration integration{start->state, bias.mean_mps2, filter};
    const std::vector<BeamsAt> beams = recorded.beams();
    auto beam = std::ranges::lower_bound(beams, start->at, {}, &BeamsAt::at);
    std::uint32_t last_count = next == readings.begin() ? next->sample.count : std::prev(next)->sample.count;
    while (next != readings.end() && next->end <= end) {
        if (next->sample.count - last_count > gap_max) {
            const auto again = std::ranges::lower_bound(navigated, next->end, {}, &Navigated::at);
            if (again == navigated.end()) break;
            const Sclk last_reading = next == readings.begin() ? start->at : std::prev(next)->end;
            Gap gap = gap_to(*again, last_reading, path, recorded);
            gap.radar = !beams.empty() && beams.front().at < again->at;
            integration.go_on(again->state, gap);
            ++path.breaks;
            next = after(again->at);
            if (next == readings.end()) break;
            last_count = std::prev(next)->sample.count;
            while (beam != beams.end() && beam->at < next->end) ++beam;
            continue;
        }
        integration.on(next->sample);
        ++path.readings;
        last_count = next->sample.count;
        for (; beam != beams.end() && beam->at <= next->end; ++beam) integration.see(*beam, next->end - beam->at);
        if (integration.step_is_full()) {
            PathPoint& point = path.points.emplace_back();
            point.felt_M_mps2 = integration.felt_M_mps2();
            integration.end_step();
            point.at = next->end;
            point.state = integration.state();
            point.navigated = navigated_at(navigated, next->end);
        }
        ++next;
    }
    if (path.points.empty()) return Error{"the recording holds too few readings of the IMU for a path"};
    if (site) {
        if (!recorded.reported("TOUCHDOWN"))
            return Error{"no touchdown was reported: a landing site says nothing of this path"};
        const Vector3 off_M_m = stage_over(*site) - path.points.back().state.p_MoB_M;
        const double sigmas = filter.end_at(off_M_m, std::hypot(site->sigma_m, errors.over_site_m));
        if (sigmas > ErrorFilter::gate_sigmas)
            return Error{
                fmt::format("the landing site is {:.1f} km from where the path ends, {:.0f} standard deviations",
                            off_M_m.norm() / 1000.0, sigmas)};
    }
    path.readings_filled = integration.filled();
    path.beams_taken = filter.taken();
    path.beams_refused = filter.refused();
    correct(path, filter.smoothed());
    return path;
}

}  // namespace aeolis::reconstruction
