// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/kernel/message.hpp"
#include "flight/kernel/state_parts.hpp"

#include <algorithm>
#include <array>

namespace aeolis::flight {

/// Modules that receive the clock's tick itself; those of the rate group get their turn from sync.
inline constexpr std::array clock_subscribers{ModuleId::sync,   ModuleId::units, ModuleId::cross_string,
                                              ModuleId::edl_bg, ModuleId::mfsk,  ModuleId::edl_comm};

/// Delivers all inputs of one tick as messages, each to the one module that manages its device. R10
template <typename Deliver>
void post_interrupts(const DeviceInputs& in, Deliver&& deliver) {
    if (!in.imu.empty()) deliver(ModuleId::imu, ImuReadings{in.now, in.imu});
    if (in.rover_imu) deliver(ModuleId::imu, *in.rover_imu);
    if (!in.radar.empty()) deliver(ModuleId::radar, RadarReturns{in.now, in.radar});
    for (const auto& reply : in.pyro_replies) deliver(ModuleId::pyro, reply);
    for (const auto& reply : in.switch_replies)
        deliver(is_telecom(reply.id) ? ModuleId::telecom : ModuleId::power, reply);
    if (in.engines) deliver(ModuleId::descent_engines, *in.engines);
    if (in.bridle) deliver(ModuleId::descent_engines, *in.bridle);
    if (in.thrusters) deliver(ModuleId::thrusters, *in.thrusters);
    if (in.cruise_attitude) deliver(ModuleId::cruise_attitude, *in.cruise_attitude);
    if (in.system_fault) deliver(ModuleId::system_fault_protection, *in.system_fault);
    state_parts(in.cross_string.span(), in.now, [&](const StatePart& part) { deliver(ModuleId::cross_string, part); });
    state_parts(in.restart_record.span(), in.now,
                [&](const StatePart& part) { deliver(ModuleId::cross_string, StoredStatePart{part}); });
    if (in.other_runs_buses) deliver(ModuleId::cross_string, OtherRunsBuses{in.now});
    for (const auto& uplink : in.uplink) {
        UplinkReceived received;
        received.size = uplink.size;
        std::copy_n(uplink.octets.begin(), std::min<std::size_t>(uplink.size, uplink_octets_max),
                    received.octets.begin());
        deliver(ModuleId::command_dispatcher, received);
    }
    deliver(ModuleId::edl_comm, NvmStatus{in.nvm_used_octets, in.nvm_capacity_octets});
    for (const ModuleId subscriber : clock_subscribers) deliver(subscriber, ClockTick{in.now});
}

}  // namespace aeolis::flight
