// SPDX-License-Identifier: Apache-2.0
#include "simulation/devices/relay_radio.hpp"

#include "common/proximity_frame.hpp"
#include "common/time.hpp"

#include <array>

namespace aeolis::simulation {

std::int64_t RelayRadio::cycles_for_answer(double light_time_s) {
    return static_cast<std::int64_t>((2.0 * light_time_s + 10.0) / seconds_per_tick);
}

std::span<const std::uint8_t> RelayRadio::cycle(const flight::RecordingDelivery::Recording& recording,
                                                double rate_bps) {
    sent_.clear();
    const bool begins = rate_bps > 0.0 && !in_pass_;
    in_pass_ = rate_bps > 0.0;
    if (!in_pass_) return sent_;
    if (begins || ++silent_cycles_ > answer_cycles_) {
        delivery_.repeat();
        silent_cycles_ = 0;
    }
    credit_octets_ += rate_bps / 8.0 * seconds_per_tick;
    std::array<std::uint8_t, pltu_octets_max> pltu;
    // A PLTU that exceeds the credit reduces that of the next cycles.
    while (credit_octets_ > 0.0) {
        const std::size_t octets = delivery_.next(recording, pltu);
        if (octets == 0) {
            credit_octets_ = 0.0;  // idle time is not saved up
            break;
        }
        sent_.insert(sent_.end(), pltu.begin(), pltu.begin() + static_cast<std::ptrdiff_t>(octets));
        credit_octets_ -= static_cast<double>(octets);
        silent_cycles_ = 0;
    }
    return sent_;
}

}  // namespace aeolis::simulation
