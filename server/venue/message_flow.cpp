// SPDX-License-Identifier: Apache-2.0
#include "server/venue/message_flow.hpp"

#include "flight/kernel/deadlines.hpp"
#include "flight/kernel/dispatch.hpp"
#include "flight/kernel/interrupts.hpp"

#include <fmt/format.h>
#include <type_traits>

namespace aeolis::server {
namespace {

using flight::ModuleId;

template <typename Module, std::size_t... I>
constexpr std::array<bool, message_type_count> handled_by(std::index_sequence<I...>) {
    return {flight::Handles<Module, std::variant_alternative_t<I, flight::Message>>...};
}

constexpr ModuleId module_at(std::size_t place) {
    return static_cast<ModuleId>(place);
}

}  // namespace

void MessageFlow::cycle(flight::ComputerState& state, const flight::DeviceInputs& in, flight::DeviceOutputs& out) {
    if (cycles_ == 0) look_at(state);
    second_ = static_cast<std::uint32_t>(cycles_ / 64) + 1;
    ++cycles_;
    flight::post_interrupts(in, [&](ModuleId to, const flight::Message& message) { count(outside, to, message); });
    flight::Executive{state, this}.cycle(in, out);
}

// Reads only the types of the modules.
void MessageFlow::look_at(flight::ComputerState& state) {
    for (std::size_t i = 0; i < flight::module_count; ++i)
        handled_[i] = flight::with_module(state, module_at(i), []<typename Module>(Module&) {
            return handled_by<Module>(std::make_index_sequence<message_type_count>{});
        });
}

void MessageFlow::count(std::size_t from, ModuleId to, const flight::Message& message) {
    Counted& counted = counts_[place(from, to, message.index())];
    ++counted.messages;
    if (counted.last_second == second_) return;
    counted.last_second = second_;
    ++counted.seconds;
}

void MessageFlow::sent(ModuleId from, ModuleId to, const flight::Message& message) {
    count(static_cast<std::size_t>(from), to, message);
}

std::string MessageFlow::handled_text(std::size_t module) const {
    std::string text;
    for (std::size_t type = 0; type < message_type_count; ++type)
        if (handled_[module][type]) text += fmt::format("{}{}", text.empty() ? "" : ", ", message_names[type]);
    return text;
}

std::string MessageFlow::document(const std::string& landing) const {
    const double flown_s = static_cast<double>(cycles_) * seconds_per_tick;
    std::string text =
        "# The flight software: modules, messages, rates, priorities\n\n"
        "Made by `aeolis modules`. What a module handles is what the compiler finds in it; messages are counted over "
        "a landing.\n\n## Modules\n\n"
        "| priority | module | rate group | deadline after the tick | budget a cycle | handles |\n"
        "|---|---|---|---|---|---|\n";
    for (std::size_t i = 0; i < flight::module_count; ++i) {
        const auto limits = flight::limits_of(module_at(i));
        text += fmt::format("| {} | `{}` | {} | {:.1f} ms | {:.0f} us | {} |\n", i + 1, module_names[i],
                            flight::in_rate_group(module_at(i)) ? "yes" : "", limits.deadline_s * 1.0e3,
                            limits.budget_us, handled_text(i));
    }

    text += "\n## Who talks to whom\n\nSolid: a type of message in every second cycle or more often, in the seconds in "
            "which there "
            "is one. Dotted: less often. Records to `edl_comm`, which every module sends, are left "
            "out.\n\n```mermaid\nflowchart LR\n";
    std::string rates;
    for (std::size_t from = 0; from <= flight::module_count; ++from) {
        for (std::size_t to = 0; to < flight::module_count; ++to) {
            bool any = false;
            double most_hz = 0.0;
            for (std::size_t type = 0; type < message_type_count; ++type) {
                const Counted& counted = counts_[place(from, module_at(to), type)];
                if (counted.messages == 0) continue;
                if (message_names[type] != "Record") {
                    any = true;
                    most_hz = std::max(most_hz, counted.rate_hz());
                }
                rates += fmt::format("| `{}` | `{}` | {} | {} | {} | {:.1f} |\n",
                                     from == outside ? std::string_view{"tick"} : module_names[from], module_names[to],
                                     message_names[type], counted.messages, counted.seconds, counted.rate_hz());
            }
            if (!any) continue;
            text += fmt::format("    {} {} {}\n", from == outside ? std::string_view{"tick"} : module_names[from],
                                most_hz >= 32.0 ? "-->" : "-.->", module_names[to]);
        }
    }
    return text +
           fmt::format(
               "```\n\n## Messages\n\nPrime over {}: {} cycles, {:.0f} s of flight. `tick`: came with the clock's "
               "tick, from the clock or a device. The rate is the mean over the seconds in which there was at "
               "least one.\n\n| from | to | message | messages | in so many seconds | rate, Hz |\n"
               "|---|---|---|---|---|---|\n{}",
               landing, cycles_, flown_s, rates);
}

}  // namespace aeolis::server
