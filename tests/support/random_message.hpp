#pragma once

#include "flight/kernel/message.hpp"

#include <cstring>
#include <random>

namespace aeolis::test {

/// A message of the type that stands at `Index` of the variant, all of its numbers random: any octets are a number, but
/// for truth values and for what says that an optional is there, which stay as they are made.
template <std::size_t Index = 0>
flight::Message message_of_type(std::size_t type) {
    if constexpr (Index < std::variant_size_v<flight::Message>) {
        if (type == Index) return std::variant_alternative_t<Index, flight::Message>{};
        return message_of_type<Index + 1>(type);
    } else {
        return flight::ClockTick{};
    }
}

inline flight::Message random_message(std::mt19937& random) {
    flight::Message message = message_of_type(random() % std::variant_size_v<flight::Message>);
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
    if (auto* resume = std::get_if<Resume>(&message))
        resume->reason = random() % 2 == 0 ? ResumeReason::restart : ResumeReason::take_over;
    if (auto* enable = std::get_if<EnableSecondChanceCommand>(&message)) enable->enabled = true;
    if (auto* tick = std::get_if<ClockTick>(&message)) tick->now = Sclk::from_ticks(64000 + random() % 100000);
    if (auto* tick = std::get_if<Tick>(&message)) tick->now = Sclk::from_ticks(64000 + random() % 100000);
    return message;
}

}  // namespace aeolis::test
