// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"
#include "server/cli/xtce_file.hpp"
#include "telemetry/other_mission.hpp"

#include <filesystem>
#include <memory>
#include <optional>

namespace aeolis::server {

/// The dictionary that runs of an archive were recorded with.
struct RecordedDictionary {
    std::unique_ptr<telemetry::OtherMission> other;  ///< null: our own mission
    dictionary::Dictionary dictionary;
};
/// Loads the dictionary; with `xtce`, another mission's. None: the fault was printed;
/// end with `exit_code`.
std::optional<RecordedDictionary> recorded_dictionary(const std::filesystem::path& dictionary, const MissionXtce& xtce,
                                                      int& exit_code);

}  // namespace aeolis::server
