// SPDX-License-Identifier: Apache-2.0
#include "flight/devices/thrusters.hpp"

#include <cmath>
#include <utility>

namespace aeolis::flight {
namespace {

constexpr auto thrusters_device = static_cast<DeviceName>(Device::thrusters);
constexpr double microseconds_per_second = 1.0e6;

}  // namespace

void Thrusters::on(const FireThrusters& command, Outbox&) {
    thrusters_ = command.thrusters;
}

void Thrusters::on(const EnableThrusters& command, Outbox&) {
    ++replies_due_;
    enable_ = awaited_ = command.enabled;
}

void Thrusters::on(const ThrusterReply& reply, Outbox& out) {
    if (replies_due_ == 0 || reply.unit != unit_) return out.event(evr::REPLY_UNEXPECTED{.device = thrusters_device});
    enabled_ = reply.enabled;
    const bool as_commanded = !reply.refused && reply.enabled == awaited_;
    if (reply.refused)
        out.event(evr::DEVICE_REFUSED{.device = thrusters_device});
    else if (!as_commanded && replies_due_ == 1)
        out.event(evr::REPLY_CONTRADICTS{.device = thrusters_device});
    --replies_due_;
    // This reply answers an older command; the reply to the newer one is still due.
    if (!as_commanded && replies_due_ > 0) return;
    replies_due_ = 0;
    out.send(ModuleId::edl,
             ActionReply{ReplyKind::thrusters, 0, as_commanded ? Evidence::verified : Evidence::refused, awaited_});
}

void Thrusters::record(const ThrusterCommand& pulses, Outbox& out) {
    const auto us = [](double on_s) { return static_cast<std::uint16_t>(std::lround(on_s * microseconds_per_second)); };
    const auto& [t1, t2, t3, t4, t5, t6, t7, t8] = pulses.on_s;
    const packet::ThrusterPulses now{.thruster_1_on_us = us(t1),
                                     .thruster_2_on_us = us(t2),
                                     .thruster_3_on_us = us(t3),
                                     .thruster_4_on_us = us(t4),
                                     .thruster_5_on_us = us(t5),
                                     .thruster_6_on_us = us(t6),
                                     .thruster_7_on_us = us(t7),
                                     .thruster_8_on_us = us(t8),
                                     .thrusters_enabled = enabled_};
    if (now != recorded_ || pulses != ThrusterCommand{}) out.record(now);
    recorded_ = now;
}

void Thrusters::on(const UnitsSelected& selected, Outbox&) {
    unit_ = selected.units[Device::thrusters];
}

void Thrusters::on(const Tick&, Outbox& out) {
    out.bus().units[Device::thrusters] = unit_;
    record(thrusters_, out);
    out.bus().thrusters = std::exchange(thrusters_, {});
    if (enable_) out.bus().thrusters_enabled = enable_;
    enable_.reset();
    out.send(ModuleId::sync, Confirm{ModuleId::thrusters});
}

}  // namespace aeolis::flight
