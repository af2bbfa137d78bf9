// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"
#include "server/archive/audit.hpp"
#include "server/archive/records.hpp"
#include "telemetry/other_mission.hpp"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

// Derives the rows of a run again from its packets with the code that made them (PacketIntake), to compare them with
// the stored rows or to replace those.
namespace aeolis::pipeline {

/// Progress, reported every few thousand packets. A callback that returns false ends the work; completed runs stay.
struct Progress {
    archive::RunId run;
    std::size_t packets = 0, of_packets = 0;  ///< of this run
};
using ProgressCallback = std::function<bool(const Progress&)>;

struct Verification {
    std::size_t runs = 0, packets = 0;
    std::vector<std::string> faults;  ///< one per line, naming run, table and item
    std::vector<std::string> notes;   ///< what could not be compared, and why
    bool stopped = false;             ///< before all was compared
};

/// Checks the file's structure, the audit, the tables, views, words and names by which other programs read it, the
/// sequence numbers, every derived row against the packets, and all other rows of a run against its fingerprint in the
/// audit. It only reads the archive, at one instant; a writer may proceed.
/// @param run      none: all
/// @param scratch  a folder with room for the derived rows of one run
/// @param other    the mission of the dictionary; null: our own
/// @param on_progress  empty: runs to the end
/// @param known    a head of the audit that was kept outside the archive
Result<Verification> verify(const std::filesystem::path& archive, std::optional<archive::RunId> run,
                            const dictionary::Dictionary& dictionary, const telemetry::OtherMission* other,
                            const std::filesystem::path& scratch, const ProgressCallback& on_progress = {},
                            const std::optional<archive::AuditHead>& known = {});

struct Rebuilt {
    std::vector<archive::RunId> runs;
    std::vector<std::string> left;  ///< runs left unchanged, and why
    bool stopped = false;           ///< before all runs were visited
};

/// Derives the rows of each run again and replaces the old ones, one transaction per run. A run whose items would get
/// other numbers is left unchanged. Needs room beside the archive for the derived rows of one run.
/// @param by  time, user and address for each run's audit entry; the action is filled in here
Result<Rebuilt> rebuild(const std::filesystem::path& archive, std::optional<archive::RunId> run,
                        const dictionary::Dictionary& dictionary, const telemetry::OtherMission* other,
                        archive::AuditRecord by, const ProgressCallback& on_progress = {});

}  // namespace aeolis::pipeline
