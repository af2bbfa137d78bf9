// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/devices/device_messages.hpp"
#include "generated/owners.hpp"

#include <tuple>

namespace aeolis::flight {

/// Calls `visit(DeviceLine, part)` for each part of a computer's outputs, device by device.
/// A member of DeviceOutputs that is missing here, or that has no owner in owners.csv, does not compile. R5
template <typename Outputs, typename Visit>
void each_device(Outputs& outputs, Visit&& visit) {
    auto& [units, pyros, switches, telecom, thrusters_enabled, attitude, engines, pay_out_bridle, tone, nvm, uhf,
           cross_string, restart_record, designate_b_prime, in_command, wants_restart_record] = outputs;
    static_cast<void>(units);  // not a line by itself: each manager sets the unit of its own device
    const std::tuple parts{
        std::pair{DeviceLine::pyros, &pyros},
        std::pair{DeviceLine::switches, &switches},
        std::pair{DeviceLine::telecom, &telecom},
        std::pair{DeviceLine::thrusters_enabled, &thrusters_enabled},
        std::pair{DeviceLine::attitude, &attitude},
        std::pair{DeviceLine::engines, &engines},
        std::pair{DeviceLine::pay_out_bridle, &pay_out_bridle},
        std::pair{DeviceLine::tone, &tone},
        std::pair{DeviceLine::nvm, &nvm},
        std::pair{DeviceLine::uhf, &uhf},
        std::pair{DeviceLine::cross_string, &cross_string},
        std::pair{DeviceLine::restart_record, &restart_record},
        std::pair{DeviceLine::designate_b_prime, &designate_b_prime},
        std::pair{DeviceLine::in_command, &in_command},
        std::pair{DeviceLine::wants_restart_record, &wants_restart_record},
    };
    static_assert(std::tuple_size_v<decltype(parts)> == device_line_count, "owners.csv names a device that is none");
    std::apply([&](const auto&... part) { (visit(part.first, *part.second), ...); }, parts);
}

}  // namespace aeolis::flight
