#pragma once

#include "flight/kernel/message.hpp"
#include "flight/load.hpp"

#include <algorithm>
#include <array>

namespace aeolis::flight {

/// Second Chance is a load of its own: what it can do without is not in it, so that what ended prime may be avoided. R33
///
/// Left out: cruise attitude control, which ends with the cruise stage and is no use to who takes over later; system fault
/// protection, which after pre-EDL can do nothing any more. Science and surface modules of the
/// mission are in neither load, because Aeolis flies EDL only.
/// Modified by role: edl (essential actions only, starts from prime's state), mfsk (tones of its own), cross_string
/// (listens instead of telling), command dispatcher (deaf but for its enabling until it is in control).
inline constexpr std::array left_out_of_second_chance{ModuleId::cruise_attitude, ModuleId::system_fault_protection};

constexpr bool is_loaded(Role role, ModuleId id) {
    if (role == Role::prime) return true;
    return std::find(left_out_of_second_chance.begin(), left_out_of_second_chance.end(), id) ==
           left_out_of_second_chance.end();
}

}  // namespace aeolis::flight
