// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/autocoder/state_diagram.hpp"
#include "dictionaries/mission_files.hpp"
#include "flight/timeline/actions.hpp"
#include "server/cli/commands.hpp"
#include "server/cli/options.hpp"
#include "server/cli/shipped_paths.hpp"

#include <cstdio>
#include <fmt/format.h>
#include <fstream>
#include <memory>

namespace aeolis::server {
namespace {

struct DictionaryOptions {
    std::filesystem::path directory = SharedOptions{}.dictionary;
    std::filesystem::path out;  ///< empty: standard output
};

/// The rows of the timeline whose action the flight software of this program does not have. R40
std::vector<dictionary::Finding> unknown_actions(const dictionary::Dictionary& dictionary) {
    std::vector<dictionary::Finding> findings;
    for (const auto& row : dictionary.timeline)
        if (const auto like = nearest(row.action, flight::actions, &flight::Action::name);
            !row.action.empty() && like != row.action)
            findings.push_back({"timeline.csv", row.line,
                                fmt::format("timepoint '{}', column action: the flight software has no action '{}'; "
                                            "the nearest name is '{}'",
                                            row.name, row.action, like)});
    return findings;
}

int dictionary_check(const std::filesystem::path& directory) {
    std::error_code error;
    if (!std::filesystem::exists(directory, error))
        return failed(fmt::format("dictionary check: {} is no directory and no file", directory.string()), 2);
    const auto dictionary = loaded_dictionary(directory);
    if (!dictionary) return 1;
    if (const auto unknown = unknown_actions(*dictionary); !unknown.empty()) {
        for (const auto& finding : unknown) fmt::print(stderr, "{}\n", finding.text());
        return 1;
    }
    fmt::print("{}: no rule is broken: {} channels, {} packets, {} events, {} commands, {} timepoints, {} anchors, {} "
               "tones, {} parameters, {} constraints, {} state machines; id {}, timeline version {}\n",
               dictionary->mission, dictionary->channels.size(), dictionary->packets.size(), dictionary->events.size(),
               dictionary->commands.size(), dictionary->timeline.size(), dictionary->anchors.size(),
               dictionary->tones.size(), dictionary->parameters.size(), dictionary->constraints.size(),
               dictionary->state_machines.size(), dictionary->id, dictionary->timeline_version);
    return 0;
}

/// Writes the whole dictionary as one XTCE file to `out`, or to standard output when it is empty.
int dictionary_export(const std::filesystem::path& directory, const std::filesystem::path& out) {
    std::error_code error;
    if (!std::filesystem::exists(directory, error))
        return failed(fmt::format("dictionary export: {} is no directory and no file", directory.string()), 2);
    // A dictionary that breaks a rule is not exported.
    if (!loaded_dictionary(directory)) return 1;
    std::vector<dictionary::Finding> findings;
    const auto text = dictionary::one_file_of(dictionary::read_mission_files(directory, findings));
    if (!text) return failed("dictionary export: " + text.error().message);
    if (out.empty()) {
        std::fwrite(text->data(), 1, text->size(), stdout);
        return std::fflush(stdout) == 0 ? 0 : failed("dictionary export: the standard output takes no more");
    }
    std::ofstream file{out, std::ios::binary};
    file << *text << std::flush;
    return file ? 0 : failed("dictionary export: " + out.string() + " cannot be written");
}

/// Prints the dictionary's state machines as diagrams.
int dictionary_diagram(const std::filesystem::path& directory) {
    const auto dictionary = loaded_dictionary(directory);
    if (!dictionary) return 1;
    fmt::print("{}", dictionary::autocoder::state_diagrams(*dictionary));
    return 0;
}

}  // namespace

void add_dictionary_command(CLI::App& program, int& exit_code) {
    const auto options = std::make_shared<DictionaryOptions>();
    auto& command = *program.add_subcommand("dictionary", "checks and exports a mission's dictionary");
    command.require_subcommand(1);
    const auto add_directory = [&](CLI::App& subcommand, const char* description) {
        subcommand.add_option("DIR", options->directory, description)->capture_default_str();
    };
    auto& check = *command.add_subcommand("check", "checks every rule, and names each error with file and line");
    add_directory(check, "the dictionary's directory, or a file that export wrote");
    check.callback([options, &exit_code] { exit_code = dictionary_check(options->directory); });

    auto& diagram = *command.add_subcommand("diagram", "prints the state machines as diagrams (Mermaid)");
    add_directory(diagram, "the dictionary's directory");
    diagram.callback([options, &exit_code] { exit_code = dictionary_diagram(options->directory); });

    auto& exported = *command.add_subcommand(
        "export",
        "writes the whole dictionary as one XTCE 1.2 file, the spreadsheets as ancillary data; it can be given "
        "wherever a dictionary's directory can");
    add_directory(exported, "the dictionary's directory, or such a file");
    exported.add_option("--out", options->out, "file to write; standard output if left out");
    exported.callback([options, &exit_code] { exit_code = dictionary_export(options->directory, options->out); });
}

}  // namespace aeolis::server
