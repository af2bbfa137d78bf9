#include "server/venue/message_flow.hpp"

#include "flight/kernel/deadlines.hpp"
#include "flight/kernel/dispatch.hpp"
#include "flight/kernel/interrupts.hpp"

#include <fmt/format.h>
#include <type_traits>

namespace aeolis::server {
namespace {

using flight::ModuleId;

/// Whether a module of that name has a handler for a message of that type.
bool handles(ModuleId id, std::size_t type) {
    // Nothing is called: the module's type alone answers.
    return [&]<std::size_t... I>(std::index_sequence<I...>) {
        bool found = false;
        const auto look = [&](auto& module) {
            using Module = std::remove_cvref_t<decltype(module)>;
            ((found = found || (I == type && flight::Handles<Module, std::variant_alternative_t<I, flight::Message>>)), ...);
        };
        static flight::ComputerState state{flight::Load{}, Sclk{}};
        flight::with_module(state, id, look);
        return found;
    }(std::make_index_sequence<message_type_count>{});
}

std::string handled_by(ModuleId id) {
    std::string text;
    for (std::size_t type = 0; type < message_type_count; ++type)
        if (handles(id, type)) text += fmt::format("{}{}", text.empty() ? "" : ", ", message_names[type]);
    return text;
}

constexpr ModuleId module_at(std::size_t place) {
    return static_cast<ModuleId>(place);
}

} // namespace

void MessageFlow::cycle(flight::ComputerState& state, const flight::DeviceInputs& in, flight::DeviceOutputs& out) {
    ++cycles_;
    flight::post_interrupts(in, [&](ModuleId to, const flight::Message& message) {
        ++counts_[place(outside, to, message.index())];
    });
    flight::Executive{state, this}.cycle(in, out);
}

void MessageFlow::sent(ModuleId from, ModuleId to, const flight::Message& message) {
    ++counts_[place(static_cast<std::size_t>(from), to, message.index())];
}

std::string MessageFlow::document(const std::string& landing) const {
    const double flown_s = static_cast<double>(cycles_) * seconds_per_tick;
    std::string text = "# The flight software: modules, messages, rates, priorities\n\n"
                       "Made by `aeolis modules`. What a module handles is what the compiler finds in it; rates are counted over "
                       "a landing.\n\n## Modules\n\n"
                       "| priority | module | rate group | deadline after the tick | budget a cycle | handles |\n"
                       "|---|---|---|---|---|---|\n";
    for (std::size_t i = 0; i < flight::module_count; ++i) {
        const auto limits = flight::limits_of(module_at(i));
        text += fmt::format("| {} | `{}` | {} | {:.1f} ms | {:.0f} us | {} |\n", i + 1, module_names[i],
                            flight::in_rate_group(module_at(i)) ? "yes" : "", limits.deadline_s * 1.0e3,
                            limits.budget_us, handled_by(module_at(i)));
    }

    text += "\n## Who talks to whom\n\nSolid: 64 times a second and more. Dotted: less often. Records to `edl_comm`, which every "
            "module sends, are left out.\n\n```mermaid\nflowchart LR\n";
    std::string rates;
    for (std::size_t from = 0; from <= flight::module_count; ++from) {
        for (std::size_t to = 0; to < flight::module_count; ++to) {
            std::uint64_t all = 0, most = 0;
            for (std::size_t type = 0; type < message_type_count; ++type) {
                const std::uint64_t count = counts_[place(from, module_at(to), type)];
                if (count == 0) continue;
                const bool record = message_names[type] == "Record";
                all += record ? 0 : count;
                most = std::max(most, record ? 0 : count);
                rates += fmt::format("| `{}` | `{}` | {} | {} | {:.3f} |\n",
                                     from == outside ? std::string_view{"tick"} : module_names[from], module_names[to],
                                     message_names[type], count, static_cast<double>(count) / flown_s);
            }
            if (all == 0) continue;
            text += fmt::format("    {} {} {}\n", from == outside ? std::string_view{"tick"} : module_names[from],
                                most * 2 > cycles_ ? "-->" : "-.->", module_names[to]);
        }
    }
    return text + fmt::format("```\n\n## Messages\n\nPrime over {}: {} cycles, {:.0f} s of flight. `tick`: came with the clock's "
                              "tick, from the clock or a device.\n\n| from | to | message | times | mean rate, Hz |\n"
                              "|---|---|---|---|---|\n{}",
                              landing, cycles_, flown_s, rates);
}

} // namespace aeolis::server
