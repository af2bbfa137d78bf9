// SPDX-License-Identifier: Apache-2.0
#include "server/reconstruction/recorded_landing.hpp"

#include "generated/dictionary_flight.hpp"
#include "telemetry/product_assembler.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>

namespace aeolis::reconstruction {

using flight::gnc::imu_period_s;

Result<RecordedLanding> RecordedLanding::with(const dictionary::Dictionary& dictionary) {
    RecordedLanding made{dictionary};
    std::string missing;
    const auto find = [&](Fields& into, const char* name, std::initializer_list<const char*> fields) {
        const auto packet = std::ranges::find(dictionary.packets, name, &dictionary::Packet::name);
        if (packet == dictionary.packets.end()) {
            missing += missing.empty() ? name : std::string(", ") + name;
            return;
        }
        into.packet = static_cast<std::size_t>(packet - dictionary.packets.begin());
        for (const char* field : fields) {
            const auto place = telemetry::field_index(*packet, field);
            if (!place) missing += (missing.empty() ? "" : ", ") + std::string(name) + "." + field;
            into.places.push_back(place.value_or(0));
        }
    };
    find(made.imu_table_, "ImuTable", {});
    find(made.radar_table_, "RadarTable", {});
    find(made.imu_row_, "ImuIncrements",
         {"imu_count", "delta_v_x_mps", "delta_v_y_mps", "delta_v_z_mps", "delta_angle_x_rad", "delta_angle_y_rad",
          "delta_angle_z_rad"});
    find(made.beam_row_, "BeamReading",
         {"beam_sclk", "beam", "beam_valid", "beam_range_m", "beam_range_rate_mps", "beam_direction_x",
          "beam_direction_y", "beam_direction_z"});
    find(made.navigation_, "GncNavigation",
         {"nav_position_x_m", "nav_position_y_m", "nav_position_z_m", "nav_velocity_x_mps", "nav_velocity_y_mps",
          "nav_velocity_z_mps", "nav_attitude_w", "nav_attitude_x", "nav_attitude_y", "nav_attitude_z"});
    find(made.belief_, "GncBelief", {"attitude_uncertainty_deg", "velocity_uncertainty_mps", "altitude_uncertainty_m"});
    find(made.solution_, "ParametersHeld", {"entry_sclk", "target_radius_m"});
    find(made.pyros_, "PyroStatus", {"pyro_entry_balance_1", "pyro_entry_balance_2", "pyro_entry_balance_3"});
    if (!missing.empty()) return Error{"the dictionary lacks what a path is made of: " + missing};
    return made;
}

void RecordedLanding::add(std::span<const std::uint8_t> packet) {
    if (decommutator_.decode(packet, decoded_)) {
        ++not_decoded_;
        return;
    }
    const Sclk at = decoded_.header.time;
    const dictionary::Packet& kind = dictionary_->packets[decoded_.packet];
    Recorded& recorded = packets_[kind.event ? "events" : kind.name];
    ++recorded.packets;
    recorded.octets += packet.size();
    recorded.octets_in[static_cast<std::int64_t>(std::floor(at.seconds))] += packet.size();
    if (kind.event) {
        const auto first = reported_.emplace(kind.name, at).first;
        first->second = std::min(first->second, at);
        return;
    }
    if (decoded_.packet == imu_table_.packet || decoded_.packet == radar_table_.packet) return add_rows(packet);
    if (decoded_.packet == navigation_.packet) return add_navigated();
    if (decoded_.packet == belief_.packet) return add_belief();
    if (decoded_.packet == pyros_.packet) return add_balances(at);
    if (decoded_.packet == solution_.packet) add_solution();
}

void RecordedLanding::add_balances(Sclk at) {
    const auto fired = static_cast<double>(flight::PyroState::fired);
    for (std::size_t pair = 0; pair < balances_.size(); ++pair)
        if (value(pyros_, pair) == fired) balances_.at(pair) = std::min(balances_.at(pair).value_or(at), at);
}

std::vector<Sclk> RecordedLanding::balance_pairs_gone() const {
    std::vector<Sclk> gone;
    for (const auto& pair : balances_)
        if (pair) gone.push_back(*pair);
    std::ranges::sort(gone);
    return gone;
}

std::optional<Sclk> RecordedLanding::reported(const std::string& event) const {
    const auto found = reported_.find(event);
    if (found == reported_.end()) return std::nullopt;
    return found->second;
}

void RecordedLanding::add_rows(std::span<const std::uint8_t> packet) {
    const Sclk at = decoded_.header.time;
    const auto rows = telemetry::rows_in(*dictionary_, decoded_, packet);
    if (!rows) return;
    for (const auto& row : *rows) {
        if (decommutator_.decode(row, decoded_)) continue;
        if (decoded_.packet == imu_row_.packet) add_imu_row(at);
        if (decoded_.packet == beam_row_.packet) add_beam();
    }
}

void RecordedLanding::add_imu_row(Sclk packet_time) {
    flight::ImuSample sample;
    sample.count = static_cast<std::uint32_t>(value(imu_row_, 0));
    for (std::size_t axis = 0; axis < 3; ++axis) {
        sample.delta_v_mps[axis] = value(imu_row_, 1 + axis);
        sample.delta_angle_rad[axis] = value(imu_row_, 4 + axis);
    }
    const Sclk latest = packet_time + -imu_period_s * sample.count;  // time at which reading 0 can have ended
    imu_began_ = imu_.empty() ? latest : std::min(imu_began_, latest);
    imu_.emplace(sample.count, sample);
}

void RecordedLanding::add_beam() {
    flight::RadarBeam beam;
    beam.beam = static_cast<std::uint8_t>(value(beam_row_, 1));
    beam.valid = value(beam_row_, 2) != 0.0;
    beam.range_m = value(beam_row_, 3);
    beam.range_rate_mps = value(beam_row_, 4);
    for (std::size_t axis = 0; axis < 3; ++axis) beam.direction_B[axis] = value(beam_row_, 5 + axis);
    beams_[Sclk{value(beam_row_, 0)}.ticks()].emplace(beam.beam, beam);
}

void RecordedLanding::add_navigated() {
    const auto number = [&](std::size_t which) { return value(navigation_, which); };
    flight::gnc::NavigatedState state;
    state.p_MoB_M = {number(0), number(1), number(2)};
    state.v_MB_M = {number(3), number(4), number(5)};
    state.q_MB = flight::gnc::to_quaternion({number(6), number(7), number(8), number(9)});
    navigated_.emplace(decoded_.header.time.ticks(), state);
}

void RecordedLanding::add_belief() {
    constexpr double degree = std::numbers::pi / 180.0;
    const Sclk at = decoded_.header.time;
    beliefs_.emplace(at.ticks(), Believed{at, degree * value(belief_, 0), value(belief_, 1), value(belief_, 2)});
}

std::optional<Believed> RecordedLanding::believed(Sclk time) const {
    if (beliefs_.empty()) return std::nullopt;
    const auto from_then = beliefs_.lower_bound(time.ticks());
    return from_then != beliefs_.end() ? from_then->second : std::prev(from_then)->second;
}

void RecordedLanding::add_solution() {
    if (entry_ && decoded_.header.time < solution_at_) return;
    solution_at_ = decoded_.header.time;
    entry_ = Sclk{value(solution_, 0)};
    target_radius_m_ = value(solution_, 1);
}

std::vector<BeamsAt> RecordedLanding::beams() const {
    std::vector<BeamsAt> all;
    for (const auto& [ticks, readings] : beams_) {
        BeamsAt at{Sclk::from_ticks(ticks), {}};
        for (const auto& [beam, reading] : readings) at.beams.push_back(reading);
        all.push_back(std::move(at));
    }
    return all;
}

std::vector<Navigated> RecordedLanding::navigated() const {
    std::vector<Navigated> all;
    all.reserve(navigated_.size());
    for (const auto& [ticks, state] : navigated_) all.push_back({Sclk::from_ticks(ticks), state});
    return all;
}

}  // namespace aeolis::reconstruction
