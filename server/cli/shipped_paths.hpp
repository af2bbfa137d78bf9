// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"
#include "simulation/scenario.hpp"

#include <filesystem>
#include <optional>
#include <string>

namespace aeolis::server {

/// The path of a shipped folder ("dictionaries/msl"): the first that exists of: beside the program, two folders above
/// it (build/release/aeolis in a checkout), ../share/aeolis from there (where the package installs it), the source tree
/// of the build. If none exists, the last.
std::filesystem::path shipped(const std::string& folder);

/// The dictionary and scenarios of a subcommand; by default those that ship.
struct SharedOptions {
    std::filesystem::path dictionary = shipped("dictionaries/msl"), scenarios = shipped("simulation/scenarios");
};

/// Loads a dictionary. None when a rule is broken; every broken rule is printed to stderr, one per line.
std::optional<dictionary::Dictionary> loaded_dictionary(const std::filesystem::path& directory);

/// Loads a dictionary. An Error too when flight was built from another: its packets could not be read.
Result<dictionary::Dictionary> dictionary_of_flight(const std::filesystem::path& directory);

/// Loads a scenario. `given` is a file, or the name of a shipped scenario.
Result<simulation::Scenario> scenario_given(const std::string& given, const std::filesystem::path& scenarios);

/// The inputs of a flight: flight's own dictionary, and a scenario whose commands are in it.
struct FlightInputs {
    dictionary::Dictionary dictionary;
    simulation::Scenario scenario;
};
Result<FlightInputs> flight_inputs(const SharedOptions& shared, const std::string& scenario);

/// Prints one line to stderr, "aeolis: …" (print_line); returns the exit code.
int failed(const std::string& message, int exit_code = 1);

}  // namespace aeolis::server
