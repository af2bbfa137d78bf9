// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/attitude/steering.hpp"

namespace aeolis::flight::gnc {

void Steering::cycle(const Parameters& parameters, const AttitudeCommand& wanted, const AttitudeState& state,
                     const Inertia& inertia, Steers steers, ThrusterCommand& thrusters, EngineCommand& engines) {
    torque_B_Nm_ = control_torque(parameters, wanted, state, inertia);
    if (steers == Steers::thrusters)
        thrusters = thruster_selection_.select(torque_B_Nm_);
    else
        torque_allocation_.add(parameters, torque_B_Nm_, steers == Steers::eight_engines ? 8 : 4, engine_max_thrust_N_,
                               engines.throttle);
}

}  // namespace aeolis::flight::gnc
