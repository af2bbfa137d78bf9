// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/kernel/message.hpp"
#include "flight/load.hpp"

#include <array>

namespace aeolis::flight {

/// Second Chance has a reduced load of its own, to avoid the cause of prime's failure. R33
///
/// Left out: cruise attitude control, which ends with the cruise stage and is of no use after a later take-over; system
/// fault protection, which has no effect after pre-EDL. Science and surface modules of the mission are in neither load,
/// because Aeolis flies EDL only.
///
/// Modified by role: edl (essential actions only, starts from prime's state), mfsk (its own tones), cross_string
/// (listens instead of sending), command dispatcher (until it is in control, accepts only the command that enables it).
inline constexpr std::array left_out_of_second_chance{ModuleId::cruise_attitude, ModuleId::system_fault_protection};

constexpr std::uint32_t left_out_bits() {
    std::uint32_t bits = 0;
    for (const ModuleId id : left_out_of_second_chance) bits |= bit_of(id);
    return bits;
}

constexpr bool is_loaded(Role role, ModuleId id) {
    constexpr std::uint32_t left_out = left_out_bits();
    return role == Role::prime || (left_out & bit_of(id)) == 0;
}

}  // namespace aeolis::flight
