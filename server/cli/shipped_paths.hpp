// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"
#include "simulation/scenario.hpp"

#include <filesystem>
#include <optional>
#include <string>

namespace aeolis::server {

/// A folder that ships ("dictionaries/msl"): beside the program, two folders above it (build/release/aeolis in a
/// checkout), or where the program was built from; the first that exists.
std::filesystem::path shipped(const std::string& folder);

/// The dictionary and the scenarios of a subcommand: those that ship, unless others are given.
struct SharedOptions {
    std::filesystem::path dictionary = shipped("dictionaries/msl"), scenarios = shipped("simulation/scenarios");
};

/// Prints every broken rule, a line each, to stderr and gives none when there are any.
std::optional<dictionary::Dictionary> loaded_dictionary(const std::filesystem::path& directory);

/// The same, and an Error when flight was built from other words: its packets could not be read.
Result<dictionary::Dictionary> dictionary_of_flight(const std::filesystem::path& directory);

/// `given` is a file, or the name of a scenario that ships.
Result<simulation::Scenario> scenario_given(const std::string& given, const std::filesystem::path& scenarios);

/// What it takes to fly: flight's own dictionary, and a scenario whose commands that dictionary knows.
struct Flyable {
    dictionary::Dictionary dictionary;
    simulation::Scenario scenario;
};
Result<Flyable> flyable(const SharedOptions& shared, const std::string& scenario);

/// One line to stderr, "aeolis: …"; returns the exit code.
int failed(const std::string& message, int exit_code = 1);

}  // namespace aeolis::server
