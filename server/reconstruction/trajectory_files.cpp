// SPDX-License-Identifier: Apache-2.0
#include "server/reconstruction/trajectory_files.hpp"

#include "common/ck.hpp"
#include "common/mars_orientation.hpp"
#include "common/navigation_message.hpp"
#include "common/spk.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <set>

namespace aeolis::reconstruction {
namespace {

using flight::gnc::NavigatedState;
using flight::gnc::Vector3;

constexpr double metres_per_km = 1000.0;
constexpr std::int32_t msl_frame = -76000;  // SPICE's number of the structure whose attitude it is
constexpr std::size_t states_min = 4;
constexpr std::string_view written_by = "Aeolis";

EphemerisTime time_of(Sclk at, const ClockCorrelation& clock) {
    return ephemeris_time_of(clock.scet_of(at));
}

Eigen::Matrix3d matrix_of(EphemerisTime time) {
    const aeolis::Matrix3 rows = mars_from_j2000(time);
    Eigen::Matrix3d matrix;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            matrix(row, column) = rows.at(static_cast<std::size_t>(row)).at(static_cast<std::size_t>(column));
    return matrix;
}

std::array<double, 3> kilometres(const Vector3& metres) {
    return {metres.x() / metres_per_km, metres.y() / metres_per_km, metres.z() / metres_per_km};
}

Ephemeris ephemeris_of(std::span<const TimedState> path, const ClockCorrelation& clock) {
    Ephemeris ephemeris;
    ephemeris.object = "MSL";
    ephemeris.object_id = "2011-070A";
    ephemeris.centre = "MARS";
    ephemeris.frame = "EME2000";
    constexpr std::size_t cubic = 3;  // forces jump within the path: parachute, engines
    ephemeris.degree = cubic;
    for (const TimedState& point : path) {
        const EphemerisTime time = time_of(point.at, clock);
        const auto [position, velocity] =
            to_j2000({kilometres(point.state.p_MoB_M), kilometres(point.state.v_MB_M)}, time);
        ephemeris.states.push_back({time, position, velocity});
    }
    ephemeris.start = ephemeris.states.front().time;
    ephemeris.stop = ephemeris.states.back().time;
    return ephemeris;
}

/// The quaternion that turns components in J2000 into the vehicle's.
std::array<double, 4> attitude_of(const TimedState& point, EphemerisTime time) {
    const flight::gnc::Quaternion q(point.state.q_MB.toRotationMatrix().transpose() * matrix_of(time));
    return {q.w(), q.x(), q.y(), q.z()};
}

std::string text_of(const std::vector<std::uint8_t>& octets) {
    return {octets.begin(), octets.end()};
}

}  // namespace

std::optional<TrajectoryFormat> trajectory_format_of(std::string_view file_name) {
    using Ending = std::pair<std::string_view, TrajectoryFormat>;
    for (const auto& [ending, format] : {Ending{".oem", TrajectoryFormat::oem}, Ending{".aem", TrajectoryFormat::aem},
                                         Ending{".bsp", TrajectoryFormat::spk}, Ending{".bc", TrajectoryFormat::ck},
                                         Ending{".tsc", TrajectoryFormat::sclk}})
        if (file_name.ends_with(ending)) return format;
    return std::nullopt;
}

Result<std::string> trajectory_file(TrajectoryFormat format, std::span<const TimedState> path,
                                    const ClockCorrelation& clock, Scet created) {
    if (path.size() < states_min)
        return Error{"the path has " + std::to_string(path.size()) + " states, a file of it needs four"};
    const MessageHeader header{ephemeris_time_of(created), "AEOLIS", ""};
    switch (format) {
    case TrajectoryFormat::oem: return orbit_message({ephemeris_of(path, clock)}, header);
    case TrajectoryFormat::aem: {
        AttitudeHistory history{"MSL", "2011-070A", "MARS", "EME2000", "SC_BODY_1", {}, {}, {}};
        for (const TimedState& point : path) {
            const EphemerisTime time = time_of(point.at, clock);
            history.states.push_back({time, attitude_of(point, time), std::nullopt});
        }
        return attitude_message({history}, header);
    }
    case TrajectoryFormat::spk: {
        const auto file =
            write_spk({{"flown path", spice_msl, spice_mars, spice_j2000, 0, ephemeris_of(path, clock)}}, written_by);
        if (!file) return file.error();
        return text_of(*file);
    }
    case TrajectoryFormat::ck: {
        CkSegment segment;
        segment.name = "flown attitude";
        segment.structure = msl_frame;
        segment.frame = spice_j2000;
        for (const TimedState& point : path)
            segment.pointings.push_back(
                {point.at.seconds * ck_ticks_per_s, attitude_of(point, time_of(point.at, clock)), std::nullopt});
        segment.start_ticks = segment.pointings.front().sclk_ticks;
        segment.stop_ticks = segment.pointings.back().sclk_ticks;
        segment.intervals_at_ticks = {segment.start_ticks};
        const auto file = write_ck({segment}, written_by);
        if (!file) return file.error();
        return text_of(*file);
    }
    case TrajectoryFormat::sclk:
        return clock_kernel(spice_msl, ephemeris_time_of(clock.scet), clock.sclk.seconds, clock.rate);
    }
    return Error{"no such format"};
}

Result<ForeignTrajectory> ForeignTrajectory::read(std::span<const std::uint8_t> octets) {
    ForeignTrajectory read;
    std::set<std::string> passed_over;
    const std::string_view text{reinterpret_cast<const char*>(octets.data()), octets.size()};
    if (text.starts_with("DAF/")) {
        const auto segments = read_spk(octets);
        if (!segments) return segments.error();
        for (const SpkSegment& segment : *segments) {
            const bool known = segment.frame == spice_j2000 || segment.frame == spice_iau_mars;
            if (segment.body < 0 && segment.centre == spice_mars && known && !segment.ephemeris.states.empty())
                read.segments_.push_back({segment.ephemeris, segment.frame == spice_iau_mars});
            else
                passed_over.insert("body " + std::to_string(segment.body) + " about " + std::to_string(segment.centre) +
                                   " in frame " + std::to_string(segment.frame) + ", type " +
                                   std::to_string(segment.type));
        }
    } else {
        const auto segments = read_orbit_message(text);
        if (!segments) return segments.error();
        for (const Ephemeris& segment : *segments) {
            const bool fixed = segment.frame == "IAU_MARS" || segment.frame == "IAU-MARS";
            const bool inertial = segment.frame == "EME2000" || segment.frame == "J2000" || segment.frame == "ICRF";
            if (segment.centre == "MARS" && (fixed || inertial))
                read.segments_.push_back({segment, fixed});
            else
                passed_over.insert(segment.object + " about " + segment.centre + " in " + segment.frame);
        }
    }
    if (read.segments_.empty()) {
        std::string there;
        for (const std::string& each : passed_over) there += (there.empty() ? "" : "; ") + each;
        return Error{"holds no trajectory of a spacecraft about Mars in J2000 or Mars's own frame, but: " + there};
    }
    return read;
}

std::optional<ForeignTrajectory::State> ForeignTrajectory::at(EphemerisTime time) const {
    // Of segments that overlap the last one counts, as SPICE has it.
    for (auto segment = segments_.rbegin(); segment != segments_.rend(); ++segment) {
        const auto state = state_at(segment->ephemeris, time);
        if (!state) continue;
        PositionAndVelocity found{state->position_km, state->velocity_kmps};
        if (!segment->mars_fixed) found = to_mars_fixed(found, time);
        State result;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            result.p_MoB_M_m.at(axis) = found.position.at(axis) * metres_per_km;
            result.v_MB_M_mps.at(axis) = found.velocity.at(axis) * metres_per_km;
        }
        return result;
    }
    return std::nullopt;
}

EphemerisTime ForeignTrajectory::start() const {
    return std::ranges::min(segments_, {}, [](const auto& each) { return each.ephemeris.start; }).ephemeris.start;
}
EphemerisTime ForeignTrajectory::stop() const {
    return std::ranges::max(segments_, {}, [](const auto& each) { return each.ephemeris.stop; }).ephemeris.stop;
}

std::optional<EphemerisTime> ForeignTrajectory::reaches(double radius_m) const {
    const auto height_m = [&](EphemerisTime time) -> std::optional<double> {
        const auto state = at(time);
        if (!state) return std::nullopt;
        const auto& [x, y, z] = state->p_MoB_M_m;
        return std::sqrt(x * x + y * y + z * z) - radius_m;
    };
    // A second at a time, then halved: a descent has no second crossing within one.
    for (EphemerisTime time = start(); time < stop(); time = time + 1.0) {
        EphemerisTime low = time, high = std::min(time + 1.0, stop());
        const auto before = height_m(low), behind = height_m(high);
        if (!before || !behind || *before < 0.0 || *behind >= 0.0) continue;
        constexpr int halvings = 40;
        for (int i = 0; i < halvings; ++i) {
            const EphemerisTime middle{(low.seconds + high.seconds) / 2.0};
            const auto there = height_m(middle);
            (there && *there >= 0.0 ? low : high) = middle;
        }
        return high;
    }
    return std::nullopt;
}

Residual residual_of(const NavigatedState& flown, const ForeignTrajectory::State& other) {
    const Vector3 p(other.p_MoB_M_m[0], other.p_MoB_M_m[1], other.p_MoB_M_m[2]);
    const Vector3 v(other.v_MB_M_mps[0], other.v_MB_M_mps[1], other.v_MB_M_mps[2]);
    const Vector3 up = p.normalized(), off = flown.p_MoB_M - p;
    // Straight down there is no track: then along is north.
    const Vector3 level = v - up * up.dot(v);
    constexpr double level_min_mps = 0.1;
    const Vector3 north = Vector3::UnitZ() - up * up.z();
    const Vector3 along = (level.norm() > level_min_mps ? level : north).normalized();
    return {up.dot(off), along.dot(off), along.cross(up).dot(off), flown.v_MB_M.norm() - v.norm()};
}

}  // namespace aeolis::reconstruction
