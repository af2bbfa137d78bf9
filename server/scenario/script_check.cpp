// SPDX-License-Identifier: Apache-2.0
#include "server/scenario/script_check.hpp"

#include "commands/encoder.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace aeolis::server {
namespace {

/// What of ground's solution the scenario says itself, whatever the flight; the rest is known only at the start.
std::vector<commands::NamedValue> known_of_solution(const simulation::Scenario& scenario) {
    return {{"target_latitude_deg", scenario.target.latitude_deg},
            {"target_longitude_deg", scenario.target.longitude_deg},
            {"target_radius_m", scenario.target.radius_m},
            {"parachute_speed_mps", scenario.parachute_speed_mps},
            {"heatshield_speed_mps", scenario.heatshield_speed_mps},
            {"backshell_altitude_m", scenario.backshell_altitude_m}};
}

}  // namespace

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
        std::vector<commands::NamedValue> arguments;
        arguments.reserve(scripted.arguments.size());
        for (const auto& [name, value] : scripted.arguments) arguments.push_back({name, value});
        dictionary::Command known = *command;
        if (scripted.from_solution) {
            arguments = commands::fill_from_solution(*command, arguments, known_of_solution(scenario));
            std::erase_if(known.arguments, [&](const auto& one) {
                return std::ranges::find(arguments, one.name, &commands::NamedValue::name) == arguments.end();
            });
        }
        if (const auto encoded = commands::encode(known, arguments, 0); !encoded)
            return Error{fmt::format("commands[{}]: {}", i, encoded.error().message)};
    }
    return {};
}

}  // namespace aeolis::server
