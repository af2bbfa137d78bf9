// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/cli/recorded_octets.hpp"
#include "server/cli/shipped_paths.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace aeolis::server {

/// A recording of our own mission's radio links that becomes a run of the archive.
struct IngestRadioOptions {
    SharedOptions shared;
    std::vector<std::filesystem::path> files;  ///< in the order of reception: one recording
    std::filesystem::path archive;
    std::vector<std::string> links;  ///< "uhf_live"; of a capture of several "uhf_live=4200", "relay=4201"
    std::optional<std::string> scenario;
    RecordedOctetsOptions octets{};
    double pace = 0.0;  ///< seconds of reception a second; 0: at once
};

/// Receives the recording as a landing's station does: packets, files of the recording on board, counts and raw octets
/// are those of a run. Returns the exit code: 1 when anything was lost, not decoded or not used, or nothing was found.
int ingest_radio(IngestRadioOptions options);

}  // namespace aeolis::server
