// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/attitude/thruster_answer.hpp"

#include "flight/devices/effectors.hpp"

#include <algorithm>
#include <utility>

namespace aeolis::flight::gnc {

std::optional<double> ThrusterAnswer::feel(const Parameters& parameters, const std::optional<Vector3>& rate_B_rps) {
    const auto [last, before] = rates_B_rps_;
    rates_B_rps_ = {rate_B_rps, last};
    if (!rate_B_rps || !last || !before) return std::nullopt;
    Vector3 expected = 0.5 * (turns_[1] - turns_[3]);
    Vector3 changed = *rate_B_rps - 2.0 * *last + *before;
    expected.z() = 0.5 * (turns_[1].z() + turns_[2].z());
    changed.z() = rate_B_rps->z() - last->z();
    commanded_ += expected.squaredNorm();
    felt_ += expected.dot(changed);
    const double enough_rps = parameters.thrusters_judged_by_dps * degree;
    if (commanded_ < enough_rps * enough_rps) return std::nullopt;
    return std::exchange(felt_, 0.0) / std::exchange(commanded_, 0.0);
}

void ThrusterAnswer::command(const ThrusterCommand& pulses, const Inertia& inertia) {
    constexpr auto thrusters = entry_thrusters();
    Vector3 impulse_Nms = Vector3::Zero();
    for (std::size_t i = 0; i < thrusters.size(); ++i)
        impulse_Nms += thruster_force_N * pulses.on_s[i] *
                       to_vector(thrusters[i].position_B_m).cross(to_vector(thrusters[i].direction_B));
    std::rotate(turns_.begin(), turns_.end() - 1, turns_.end());
    turns_[0] = {impulse_Nms.x() / inertia.across, impulse_Nms.y() / inertia.across, impulse_Nms.z() / inertia.along_z};
}

}  // namespace aeolis::flight::gnc
