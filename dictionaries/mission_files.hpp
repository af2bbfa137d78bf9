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

/// The file texts from which a mission's dictionary is read.
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

/// Reads a folder's files (one *.xml and the sheets), or those inside one file made by one_file_of().
MissionFiles read_mission_files(const std::filesystem::path& path, std::vector<Finding>& all);

/// Combines all files into one XTCE file.
/// The XTCE text stays unchanged; each sheet is added as ancillary data of the SpaceSystem, under the sheet's name. Any
/// XTCE reader finds the packets and commands in the file. load() finds the whole mission in it, every text identical
/// octet for octet. Fails where a text is missing, the SpaceSystem has ancillary data of its own, or a sheet holds a
/// character that XML cannot.
Result<std::string> one_file_of(const MissionFiles& files);

}  // namespace aeolis::dictionary
