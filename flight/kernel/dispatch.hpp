// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/computer_state.hpp"

#include <concepts>

namespace aeolis::flight {

/// Requirements on a module: constructed from the load alone, copied as a snapshot. R9
template <typename M>
concept FlightModule =
    std::constructible_from<M, const Load&> && std::copy_constructible<M> && std::is_trivially_destructible_v<M>;

/// Whether a module has a handler of its own for a type of message.
template <typename Module, typename Content>
concept Handles = requires(Module& module, const Content& content, Outbox& out) { module.on(content, out); };

/// Calls `visit(module)` with the module of that id; the one place that maps ids to modules.
template <typename State, typename Visit>
decltype(auto) with_module(State& state, ModuleId id, Visit&& visit) {
    const auto checked = [&](auto& module) -> decltype(auto) {
        static_assert(FlightModule<std::remove_cvref_t<decltype(module)>>);
        return visit(module);
    };
    switch (id) {
    case ModuleId::sync: return checked(state.sync);
    case ModuleId::radar: return checked(state.radar);
    case ModuleId::imu: return checked(state.imu);
    case ModuleId::edl: return checked(state.edl);
    case ModuleId::pyro: return checked(state.pyro);
    case ModuleId::descent_engines: return checked(state.descent_engines);
    case ModuleId::thrusters: return checked(state.thrusters);
    case ModuleId::power: return checked(state.power);
    case ModuleId::telecom: return checked(state.telecom);
    case ModuleId::units: return checked(state.units);
    case ModuleId::cruise_attitude: return checked(state.cruise_attitude);
    case ModuleId::system_fault_protection: return checked(state.system_fault_protection);
    case ModuleId::cross_string: return checked(state.cross_string);
    case ModuleId::command_dispatcher: return checked(state.command_dispatcher);
    case ModuleId::edl_bg: return checked(state.edl_bg);
    case ModuleId::mfsk: return checked(state.mfsk);
    case ModuleId::edl_comm: return checked(state.edl_comm);
    }
    AEOLIS_CHECK(false);
}

/// Passes a message to a module; false when the module has no handler for it.
/// Any module accepts any message at any time: an unexpected one is reported. R4
template <typename Module>
bool handle(Module& module, const Message& message, Outbox& out) {
    return std::visit(
        [&](const auto& content) {
            if constexpr (Handles<Module, std::remove_cvref_t<decltype(content)>>) {
                module.on(content, out);
                return true;
            } else {
                out.event(evr::UNEXPECTED_MESSAGE{.module_number = static_cast<std::uint8_t>(out.from()),
                                                  .message_type = static_cast<std::uint8_t>(message.index())});
                return false;
            }
        },
        message);
}

}  // namespace aeolis::flight
