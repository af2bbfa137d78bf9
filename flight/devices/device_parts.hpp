#pragma once

#include "flight/devices/device_messages.hpp"
#include "generated/owners.hpp"

#include <tuple>

namespace aeolis::flight {

/// What leaves the computer, device by device: calls `visit(Device, part)` for each. A part that DeviceOutputs gets and
/// this does not name, or that owners.csv gives no owner, does not compile. R5
template <typename Outputs, typename Visit>
void each_device(Outputs& outputs, Visit&& visit) {
    auto& [pyros, switches, thrusters_enabled, attitude, engines, pay_out_bridle, tone, nvm, uhf, cross_string,
           restart_record, designate_b_prime, in_command, wants_restart_record] = outputs;
    const std::tuple parts{
        std::pair{Device::pyros, &pyros},
        std::pair{Device::switches, &switches},
        std::pair{Device::thrusters_enabled, &thrusters_enabled},
        std::pair{Device::attitude, &attitude},
        std::pair{Device::engines, &engines},
        std::pair{Device::pay_out_bridle, &pay_out_bridle},
        std::pair{Device::tone, &tone},
        std::pair{Device::nvm, &nvm},
        std::pair{Device::uhf, &uhf},
        std::pair{Device::cross_string, &cross_string},
        std::pair{Device::restart_record, &restart_record},
        std::pair{Device::designate_b_prime, &designate_b_prime},
        std::pair{Device::in_command, &in_command},
        std::pair{Device::wants_restart_record, &wants_restart_record},
    };
    static_assert(std::tuple_size_v<decltype(parts)> == device_count, "owners.csv names a device that is none");
    std::apply([&](const auto&... part) { (visit(part.first, *part.second), ...); }, parts);
}

}  // namespace aeolis::flight
