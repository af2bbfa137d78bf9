// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "dictionaries/findings.hpp"

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace aeolis::dictionary {

struct MissionFile {
    std::string name;                 ///< "timeline.csv"
    std::optional<std::string> text;  ///< none: a finding says why
    bool operator==(const MissionFile&) const = default;
};

/// The texts that a mission's dictionary is read from.
struct MissionFiles {
    static constexpr std::array<std::string_view, 11> sheet_names{
        "anchors.csv",    "clock_correlation.csv", "constraints.csv", "mfsk.csv",           "owners.csv",
        "parameters.csv", "predicted_anchors.csv", "timeline.csv",    "state_machines.csv", "telemetry_plan.csv",
        "tones.csv"};

    MissionFile xtce;
    std::vector<MissionFile> sheets;  ///< one for each of sheet_names, in their order

    const MissionFile& sheet(std::string_view name) const;
    bool operator==(const MissionFiles&) const = default;
};

/// Those of a folder (one *.xml and the sheets), or those that stand in one file that one_file_of() made.
MissionFiles read_mission_files(const std::filesystem::path& path, std::vector<Finding>& all);

/// One XTCE file: the XTCE text as it stands, and each sheet as ancillary data of its SpaceSystem, under the sheet's
/// name. What reads XTCE finds packets and commands in it, load() the whole mission again: octet for octet the same
/// texts. Fails where a text is missing, the SpaceSystem has ancillary data of its own, or a sheet holds what XML
/// cannot.
Result<std::string> one_file_of(const MissionFiles& files);

}  // namespace aeolis::dictionary
