// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/autocoder/state_diagram.hpp"
#include "dictionaries/mission_files.hpp"
#include "server/cli/commands.hpp"
#include "server/cli/shipped_paths.hpp"

#include <cstdio>
#include <fmt/format.h>
#include <fstream>

namespace aeolis::server {

int dictionary_check(const std::filesystem::path& directory) {
    std::error_code error;
    if (!std::filesystem::exists(directory, error))
        return failed(fmt::format("dictionary check: {} is no directory and no file", directory.string()), 2);
    const auto dictionary = loaded_dictionary(directory);
    if (!dictionary) return 1;
    fmt::print("{}: no rule is broken: {} channels, {} packets, {} events, {} commands, {} timepoints, {} anchors, {} "
               "tones, {} parameters, {} constraints, {} state machines; id {}, timeline version {}\n",
               dictionary->mission, dictionary->channels.size(), dictionary->packets.size(), dictionary->events.size(),
               dictionary->commands.size(), dictionary->timeline.size(), dictionary->anchors.size(),
               dictionary->tones.size(), dictionary->parameters.size(), dictionary->constraints.size(),
               dictionary->state_machines.size(), dictionary->id, dictionary->timeline_version);
    return 0;
}

int dictionary_export(const std::filesystem::path& directory, const std::filesystem::path& out) {
    std::error_code error;
    if (!std::filesystem::exists(directory, error))
        return failed(fmt::format("dictionary export: {} is no directory and no file", directory.string()), 2);
    // Only what breaks no rule leaves the house.
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

int dictionary_diagram(const std::filesystem::path& directory) {
    const auto dictionary = loaded_dictionary(directory);
    if (!dictionary) return 1;
    fmt::print("{}", dictionary::autocoder::state_diagrams(*dictionary));
    return 0;
}

}  // namespace aeolis::server
