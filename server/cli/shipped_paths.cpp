// SPDX-License-Identifier: Apache-2.0
#include "server/cli/shipped_paths.hpp"

#include "generated/dictionary_flight.hpp"
#include "server/base/log_line.hpp"
#include "server/scenario/scenario_library.hpp"
#include "server/scenario/scenario_text.hpp"
#include "server/scenario/script_check.hpp"

#include <fmt/format.h>

namespace aeolis::server {

std::filesystem::path shipped(const std::string& folder) {
    std::error_code error;
    const auto program = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
    // Beside the program, above build/release, where the package installs it, and the source tree of the build.
    for (const auto& root :
         {program, program / "../..", program / "../share/aeolis", std::filesystem::path{AEOLIS_SOURCE_DIRECTORY}})
        if (std::filesystem::is_directory(root / folder, error)) return (root / folder).lexically_normal();
    return std::filesystem::path{AEOLIS_SOURCE_DIRECTORY} / folder;
}

std::optional<dictionary::Dictionary> loaded_dictionary(const std::filesystem::path& directory) {
    auto loaded = dictionary::load(directory);
    for (const auto& finding : loaded.findings) print_line(stderr, finding.text());
    return std::move(loaded.dictionary);
}

Result<dictionary::Dictionary> dictionary_of_flight(const std::filesystem::path& directory) {
    auto dictionary = loaded_dictionary(directory);
    if (!dictionary) return Error{directory.string() + ": the dictionary breaks the rules above"};
    if (dictionary->id != flight::dictionary_id)
        return Error{
            fmt::format("{}: the dictionary (id {}) is not the one that flight was built from (id {}): build again",
                        directory.string(), dictionary->id, flight::dictionary_id)};
    return std::move(*dictionary);
}

Result<simulation::Scenario> scenario_given(const std::string& given, const std::filesystem::path& scenarios) {
    std::error_code error;
    const bool is_name = given.find_first_of("/.") == std::string::npos && !std::filesystem::exists(given, error);
    return is_name ? ScenarioLibrary{scenarios}.scenario(given) : scenario_from_file(given, scenarios);
}

Result<FlightInputs> flight_inputs(const SharedOptions& shared, const std::string& scenario) {
    auto dictionary = dictionary_of_flight(shared.dictionary);
    if (!dictionary) return dictionary.error();
    auto read = scenario_given(scenario, shared.scenarios);
    if (!read) return read.error();
    if (const auto script = check_script(*read, *dictionary); !script)
        return Error{scenario + ": " + script.error().message};
    return FlightInputs{std::move(*dictionary), std::move(*read)};
}

int failed(const std::string& message, int exit_code) {
    print_line(stderr, "aeolis: " + message);
    return exit_code;
}

}  // namespace aeolis::server
