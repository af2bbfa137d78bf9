#include "dictionaries/autocoder/state_diagram.hpp"
#include "server/cli/commands.hpp"
#include "server/cli/shipped_paths.hpp"

#include <fmt/format.h>

namespace aeolis::server {

int dictionary_check(const std::filesystem::path& directory) {
    std::error_code error;
    if (!std::filesystem::is_directory(directory, error))
        return failed(fmt::format("dictionary check: {} is no directory", directory.string()), 2);
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

int dictionary_diagram(const std::filesystem::path& directory) {
    const auto dictionary = loaded_dictionary(directory);
    if (!dictionary) return 1;
    fmt::print("{}", dictionary::autocoder::state_diagrams(*dictionary));
    return 0;
}

} // namespace aeolis::server
