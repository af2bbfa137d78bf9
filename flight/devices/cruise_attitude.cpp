// SPDX-License-Identifier: Apache-2.0
#include "flight/devices/cruise_attitude.hpp"

#include <cmath>

namespace aeolis::flight {
namespace {

constexpr double norm_tolerance = 1e-6;  // chosen: far above rounding, far below the scanner's error

}  // namespace

void CruiseAttitudeControl::on(const CruiseAttitude& attitude, Outbox& out) {
    double square = 0.0;
    for (const double component : attitude.q_MB) square += component * component;
    // Written as "not within" rather than "outside", so that a NaN is refused as well.
    if (!(std::abs(square - 1.0) <= norm_tolerance)) return out.event(evr::CRUISE_ATTITUDE_UNUSABLE{});
    out.send(ModuleId::edl, attitude);
}

}  // namespace aeolis::flight
