// SPDX-License-Identifier: Apache-2.0
#include "server/cli/recorded_words.hpp"

#include "server/cli/shipped_paths.hpp"
#include "server/cli/xtce_file.hpp"

namespace aeolis::server {

std::optional<RecordedWords> recorded_words(const std::filesystem::path& dictionary, const std::filesystem::path& xtce,
                                            int& exit_code) {
    RecordedWords words;
    if (!xtce.empty()) {
        auto file = read_xtce_file(xtce);
        if (!file) {
            exit_code = file.exit_code;
            return {};
        }
        words.other = std::make_unique<telemetry::OtherMission>(std::move(*file.model), file.id);
        words.dictionary = words.other->dictionary();
        return words;
    }
    auto ours = dictionary_of_flight(dictionary);
    if (!ours) {
        exit_code = failed(ours.error().message);
        return {};
    }
    words.dictionary = std::move(*ours);
    return words;
}

}  // namespace aeolis::server
