// SPDX-License-Identifier: Apache-2.0
#include "server/cli/recorded_dictionary.hpp"

#include "server/cli/shipped_paths.hpp"

namespace aeolis::server {

std::optional<RecordedDictionary> recorded_dictionary(const std::filesystem::path& dictionary, const MissionXtce& xtce,
                                                      int& exit_code) {
    RecordedDictionary recorded;
    if (!xtce.empty()) {
        auto file = read_xtce(xtce);
        if (!file) {
            exit_code = file.exit_code;
            return {};
        }
        recorded.other =
            std::make_unique<telemetry::OtherMission>(std::move(*file.model), file.id, std::move(file.time));
        recorded.dictionary = recorded.other->dictionary();
        return recorded;
    }
    auto ours = dictionary_of_flight(dictionary);
    if (!ours) {
        exit_code = failed(ours.error().message);
        return {};
    }
    recorded.dictionary = std::move(*ours);
    return recorded;
}

}  // namespace aeolis::server
