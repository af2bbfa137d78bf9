// SPDX-License-Identifier: Apache-2.0
#include "commands/request_form.hpp"

#include "commands/encoder.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <string_view>

namespace aeolis::commands {

Result<const dictionary::Command*> command_named(const dictionary::Dictionary& dictionary, const std::string& name) {
    if (const auto* command = dictionary.command(name)) return command;
    return Error{
        fmt::format("unknown command '{}': the dictionary of {} has none of this name", name, dictionary.mission)};
}

Result<std::optional<Fop::Service>> service_named(const std::string& name) {
    using Service = Fop::Service;
    if (name.empty()) return std::optional<Service>{};
    if (name == "AD") return std::optional{Service::sequence_controlled};
    if (name == "BD") return std::optional{Service::expedited};
    return Error{fmt::format("unknown service '{}': AD, BD, or none for what suits", name)};
}

Result<void> check_controller(const std::string& name) {
    if (name.size() > controller_name_max)
        return Error{fmt::format("controller: a name of at most {} octets is wanted", controller_name_max)};
    if (name.find('\0') != std::string::npos) return Error{"controller: a NUL character is no text"};
    return {};
}

Result<void> check_form(const Request& request, const dictionary::Dictionary& dictionary) {
    if (!request.action.empty()) return check_action(request);
    const auto named = command_named(dictionary, request.command);
    if (!named) return named.error();
    auto command = **named;
    if (request.from_solution)
        std::erase_if(command.arguments, [&](const dictionary::Argument& argument) {
            return std::ranges::find(request.arguments, argument.name, &NamedValue::name) == request.arguments.end();
        });
    if (const auto encoded = encode(command, request.arguments, 0); !encoded) return encoded.error();
    if (const auto service = service_named(request.service); !service) return service.error();
    return check_controller(request.controller);
}

Result<void> check_action(const Request& request) {
    constexpr std::array<std::string_view, 4> actions{"release", "hold", "cancel", "approve"};
    if (std::ranges::find(actions, request.action) == actions.end())
        return Error{fmt::format("unknown action '{}': release, hold, cancel or approve", request.action)};
    if (request.dry_run) return Error{"dry_run: what is done about a waiting command cannot be tried out"};
    if (request.number == 0) return Error{"number: that of the waiting command is wanted, from 1"};
    return check_controller(request.controller);
}

}  // namespace aeolis::commands
