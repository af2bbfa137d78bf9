// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"
#include "telemetry/other_mission.hpp"

#include <filesystem>
#include <memory>
#include <optional>

namespace aeolis::server {

/// What runs of an archive were recorded with.
struct RecordedWords {
    std::unique_ptr<telemetry::OtherMission> other;  ///< none: our own
    dictionary::Dictionary dictionary;
};
/// With `xtce` another mission's. None: what is wrong was said, and `exit_code` is what to end with.
std::optional<RecordedWords> recorded_words(const std::filesystem::path& dictionary, const std::filesystem::path& xtce,
                                            int& exit_code);

}  // namespace aeolis::server
