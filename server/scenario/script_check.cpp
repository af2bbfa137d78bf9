// SPDX-License-Identifier: Apache-2.0
#include "server/scenario/script_check.hpp"

#include "commands/encoder.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace aeolis::server {

Result<void> check_script(const simulation::Scenario& scenario, const dictionary::Dictionary& dictionary) {
    for (const auto& name : scenario.second_person)
        if (dictionary.command(name) == nullptr)
            return Error{fmt::format("second_person: '{}' is no command of the dictionary", name)};
    for (std::size_t i = 0; i < scenario.commands.size(); ++i) {
        const auto& scripted = scenario.commands[i];
        const auto* command = dictionary.command(scripted.command);
        if (command == nullptr)
            return Error{
                fmt::format("commands[{}].command: '{}' is no command of the dictionary", i, scripted.command)};
        if (std::ranges::find(scenario.second_person, scripted.command) != scenario.second_person.end())
            return Error{fmt::format("commands[{}].command: {} needs a second person, and a script has none", i,
                                     scripted.command)};
        for (const auto& [name, value] : scripted.arguments)
            if (std::ranges::none_of(command->arguments, [&](const auto& known) { return known.name == name; }))
                return Error{fmt::format("commands[{}].arguments: {} has no argument '{}'", i, scripted.command, name)};
        if (scripted.from_solution) continue;  // absent arguments come from a solution that is known only at the start
        std::vector<commands::NamedValue> arguments;
        arguments.reserve(scripted.arguments.size());
        for (const auto& [name, value] : scripted.arguments) arguments.push_back({name, value});
        if (const auto encoded = commands::encode(*command, arguments, 0); !encoded)
            return Error{fmt::format("commands[{}]: {}", i, encoded.error().message)};
    }
    return {};
}

}  // namespace aeolis::server
