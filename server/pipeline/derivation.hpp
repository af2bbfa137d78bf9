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

// Everything of a run that follows from its raw units, made again by what made it the first time (PacketIntake): to
// compare it with what is stored, or to replace that.
namespace aeolis::pipeline {

/// How far it is. Asked for every few thousand units; false ends the work, and what is whole stays.
struct Work {
    archive::RunId run;
    std::size_t units = 0, of_units = 0;  ///< of this run
};
using GoesOn = std::function<bool(const Work&)>;

struct Verification {
    std::size_t runs = 0, units = 0;
    std::vector<std::string> faults;  ///< a line each, naming run, table and item
    std::vector<std::string> notes;   ///< what could not be compared, and why
    bool stopped = false;             ///< before all was compared
};

/// The file's structure, the sequence numbers, and every derived row against the raw units. The archive is only read,
/// as it is at one moment; a writer may go on.
/// @param run      none: all
/// @param scratch  a folder with room for the derived rows of one run
/// @param other    the mission whose dictionary that is, where it is not ours
/// @param goes_on  none: to its end
Result<Verification> verify(const std::filesystem::path& archive, std::optional<archive::RunId> run,
                            const dictionary::Dictionary& dictionary, const telemetry::OtherMission* other,
                            const std::filesystem::path& scratch, const GoesOn& goes_on = {});

struct Rebuilt {
    std::vector<archive::RunId> runs;
    std::vector<std::string> left;  ///< runs that were left as they are, and why
    bool stopped = false;           ///< before all of them were looked at
};

/// Makes the derived rows of each run again and puts them in place of the old ones, a run a transaction. A run
/// whose items would get other numbers is left as it is. Needs room beside the archive for the derived rows of one run.
/// @param by  when, who and from where, of an entry in the audit for each run; what was done is added here
Result<Rebuilt> rebuild(const std::filesystem::path& archive, std::optional<archive::RunId> run,
                        const dictionary::Dictionary& dictionary, const telemetry::OtherMission* other,
                        archive::AuditRecord by, const GoesOn& goes_on = {});

}  // namespace aeolis::pipeline
