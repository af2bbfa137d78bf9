// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/support/any_message.hpp"

#include <array>
#include <random>

namespace aeolis::test {

/// A message of the variant's type at `type`, with every field random.
inline flight::Message random_message_of(std::size_t type, std::mt19937& random) {
    std::array<std::uint8_t, 2 * sizeof(flight::Message)> octets{};
    for (std::uint8_t& octet : octets) octet = static_cast<std::uint8_t>(random());
    Source from{octets};
    return message_of(type, from);
}

/// A message of any type: half of them wholly random, the others plausible, so that they are not refused at once.
inline flight::Message random_message(std::mt19937& random) {
    const std::size_t type = random() % std::variant_size_v<flight::Message>;
    if (random() % 2 == 0) return random_message_of(type, random);
    Source nothing{{}};
    flight::Message message = message_of(type, nothing);
    const auto any = [&] { return static_cast<std::uint8_t>(random()); };
    using namespace flight;
    if (auto* fire = std::get_if<FirePyro>(&message)) fire->pyro = static_cast<PyroId>(random() % pyro_count);
    if (auto* set = std::get_if<SetSwitch>(&message)) set->on = random() % 2 == 0;
    if (auto* enable = std::get_if<EnableThrusters>(&message)) enable->enabled = random() % 2 == 0;
    if (auto* run = std::get_if<RunEngines>(&message)) run->engines.ignited = random() % 2 == 0;
    if (auto* pulse = std::get_if<FireThrusters>(&message)) pulse->thrusters.on_s[random() % 8] = 0.01;
    if (auto* part = std::get_if<StatePart>(&message)) {
        part->index = any() % 8;
        part->count = any() % 8;
        part->size = any();
        for (auto& octet : part->octets) octet = any();
    }
    if (auto* resume = std::get_if<Resume>(&message)) resume->reason = static_cast<ResumeReason>(random() % 3);
    if (auto* enable = std::get_if<EnableSecondChanceCommand>(&message)) enable->enabled = true;
    if (auto* tick = std::get_if<ClockTick>(&message)) tick->now = Sclk::from_ticks(64000 + random() % 100000);
    if (auto* tick = std::get_if<Tick>(&message)) tick->now = Sclk::from_ticks(64000 + random() % 100000);
    return message;
}

}  // namespace aeolis::test
