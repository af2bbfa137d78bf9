// SPDX-License-Identifier: Apache-2.0
#include "flight/devices/imu.hpp"

#include <cmath>

namespace aeolis::flight {
namespace {

constexpr std::uint16_t samples_per_second = 200;  // [facts] IMU

}  // namespace

void ImuManager::on(const ImuReadings& readings, Outbox&) {
    latest_ = readings;
}

void ImuManager::on(const RoverImuReading& reading, Outbox& out) {
    const Sclk second = at_resolution(out.now(), 1);
    if (rover_told_ == second) return;
    rover_told_ = second;
    const auto magnitude = [](const std::array<double, 3>& v) { return single(std::hypot(v[0], v[1], v[2])); };
    out.record(packet::RoverImu{.rover_imu_rate_rps = magnitude(reading.rate_rps),
                                .rover_imu_force_mps2 = magnitude(reading.force_mps2)});
}

void ImuManager::on(const UnitsSelected& selected, Outbox&) {
    if (selected.units[Device::imu] == unit_) return;
    unit_ = selected.units[Device::imu];
    whole_second_ = false;
}

void ImuManager::on(const Tick& tick, Outbox& out) {
    out.bus().units[Device::imu] = unit_;
    watch_rate(tick.now, out);
    out.send(ModuleId::edl, latest_);
    if (!latest_.samples.empty()) out.send(ModuleId::edl_comm, latest_);
    latest_.samples.clear();
    out.send(ModuleId::sync, Confirm{ModuleId::imu});
}

// Samples delivered with a tick ended before it: at the tick of a whole second they belong to the past second.
void ImuManager::watch_rate(Sclk now, Outbox& out) {
    samples_in_second_ = static_cast<std::uint16_t>(samples_in_second_ + latest_.samples.size());
    if (at_resolution(now, 1) != now) return;
    if (whole_second_ && samples_in_second_ < samples_per_second)
        out.event(
            evr::IMU_SAMPLES_MISSING{.count = static_cast<std::uint16_t>(samples_per_second - samples_in_second_)});
    whole_second_ = true;
    samples_in_second_ = 0;
}

}  // namespace aeolis::flight
