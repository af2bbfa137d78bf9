// SPDX-License-Identifier: Apache-2.0
#include "flight/timeline/actions.hpp"

namespace aeolis::flight {

void ActionContext::fire(PyroId pyro, gnc::Fact fact) {
    command(ModuleId::pyro, FirePyro{pyro, now() + reply_timeout_s_});
    await({ReplyKind::pyro, static_cast<std::uint8_t>(pyro)});
    fact_ = fact;
}

void ActionContext::arm_pyros(bool armed) {
    command(ModuleId::pyro, ArmPyros{armed});
    await({ReplyKind::arming, static_cast<std::uint8_t>(armed)});
    fact_ = armed ? gnc::Fact::pyros_armed : gnc::Fact::pyros_safe;
}

void ActionContext::set_switch(SwitchId id, bool on) {
    command(is_telecom(id) ? ModuleId::telecom : ModuleId::power, SetSwitch{id, on});
    await({ReplyKind::device_switch, static_cast<std::uint8_t>(id), Evidence::none, on});
}

void ActionContext::enable_thrusters(bool enabled) {
    command(ModuleId::thrusters, EnableThrusters{enabled});
    await({ReplyKind::thrusters, 0, Evidence::none, enabled});
    if (enabled) fact_ = gnc::Fact::thrusters_on;
}

void ActionContext::pay_out_bridle() {
    command(ModuleId::descent_engines, PayOutBridle{});
    await({ReplyKind::bridle, 0});
}

void ActionContext::close_recording() {
    command(ModuleId::edl_comm, CloseRecording{});
    await({ReplyKind::recording, 0});
}

void ActionContext::request_tone(ToneId tone) {
    out_.send(ModuleId::mfsk, ToneRequest{tone, now()});
}

void ActionContext::announce(const TimepointSpec& row) {
    if (row.event) row.event(*this);
    if (row.tone) request_tone(*row.tone);
}

}  // namespace aeolis::flight
