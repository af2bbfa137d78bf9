// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/autocoder/state_diagram.hpp"
#include "dictionaries/mission_files.hpp"
#include "flight/timeline/actions.hpp"
#include "server/cli/commands.hpp"
#include "server/cli/options.hpp"
#include "server/cli/shipped_paths.hpp"

#include <algorithm>
#include <cstdio>
#include <fmt/format.h>
#include <fstream>
#include <memory>

namespace aeolis::server {
namespace {

struct DictionaryOptions {
    std::filesystem::path directory = SharedOptions{}.dictionary;
    MissionXtce xtce;           ///< of another mission, instead of the directory
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
        return failed(fmt::format("dictionary check: {} is neither a directory nor a file", directory.string()), 2);
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

/// What of a model the packets reach.
struct Used {
    std::vector<bool> containers, parameters;

    explicit Used(const dictionary::xtce::PacketModel& model)
        : containers(model.containers.size()), parameters(model.parameters.size()), model_(model) {
        if (!model.root) return;
        // A container derived from one that is used is used; in files that follow from each other, in some rounds.
        take(*model.root);
        for (bool more = true; more;) {
            more = false;
            for (std::size_t i = 0; i < model.containers.size(); ++i) {
                const auto& base = model.containers[i].base;
                if (containers[i] || !base || !containers[*base]) continue;
                take(i);
                more = true;
            }
        }
    }

  private:
    void take(std::size_t container) {
        std::vector<std::size_t> open{container};
        while (!open.empty()) {
            const std::size_t at = open.back();
            open.pop_back();
            if (containers[at]) continue;
            containers[at] = true;
            for (const auto& entry : model_.containers[at].entries) {
                if (entry.what == dictionary::xtce::PacketEntry::What::parameter) parameters[entry.index] = true;
                if (entry.what == dictionary::xtce::PacketEntry::What::container) open.push_back(entry.index);
            }
        }
    }
    const dictionary::xtce::PacketModel& model_;
};

/// Prints what of any mission's XTCE is used, unused and not understood. @return 1 when something is not understood
int xtce_check(const MissionXtce& files) {
    const auto xtce = read_xtce(files);
    if (!xtce) return xtce.exit_code;
    const auto& model = *xtce.model;
    const Used used{model};
    const auto unused = [&](const char* what, const auto& all, const std::vector<bool>& is_used) {
        for (std::size_t i = 0; i < all.size(); ++i)
            if (!is_used[i]) fmt::print("unused {} {} (line {})\n", what, all[i].path, all[i].line);
    };
    unused("container", model.containers, used.containers);
    unused("parameter", model.parameters, used.parameters);
    fmt::print("{}: packets begin with {}; {} of {} containers and {} of {} parameters are used; {}\n", model.name,
               model.containers[*model.root].path, std::ranges::count(used.containers, true), used.containers.size(),
               std::ranges::count(used.parameters, true), used.parameters.size(),
               xtce.findings == 0 ? "all is understood"
                                  : fmt::format("not understood, as said above: {}", xtce.findings));
    return xtce.findings == 0 ? 0 : 1;
}

/// Whether a path is an XTCE file without the sheets of a mission of ours.
bool is_other_mission(const std::filesystem::path& path) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) return false;
    std::vector<dictionary::Finding> ignored;
    const auto files = dictionary::read_mission_files(path, ignored);
    return std::ranges::none_of(files.sheets, [](const auto& sheet) { return sheet.text.has_value(); });
}

/// Writes the whole dictionary as one XTCE file to `out`, or to standard output when it is empty.
int dictionary_export(const std::filesystem::path& directory, const std::filesystem::path& out) {
    std::error_code error;
    if (!std::filesystem::exists(directory, error))
        return failed(fmt::format("dictionary export: {} is neither a directory nor a file", directory.string()), 2);
    // A dictionary that breaks a rule is not exported.
    if (!loaded_dictionary(directory)) return 1;
    std::vector<dictionary::Finding> findings;
    const auto text = dictionary::one_file_of(dictionary::read_mission_files(directory, findings));
    if (!text) return failed("dictionary export: " + text.error().message);
    if (out.empty()) {
        std::fwrite(text->data(), 1, text->size(), stdout);
        return std::fflush(stdout) == 0 ? 0 : failed("dictionary export: standard output cannot be written");
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
    add_directory(check, "the dictionary's directory, a file that export wrote, or another mission's XTCE file");
    add_mission_xtce(check, options->xtce,
                     "another mission's XTCE file; prints what of it is used, unused and not understood; may be given "
                     "several times");
    check.callback([options, &exit_code] {
        if (options->xtce.empty() && is_other_mission(options->directory)) options->xtce.files = {options->directory};
        exit_code = options->xtce.empty() ? dictionary_check(options->directory) : xtce_check(options->xtce);
    });

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
