// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/cli/shipped_paths.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace aeolis::server {

/// A recording of X-band samples that becomes a run of the archive.
struct IngestTonesOptions {
    std::filesystem::path dictionary = shipped("dictionaries/msl");
    std::filesystem::path samples, archive;
    std::optional<std::string> start;  ///< UTC at which the first sample was received; none: as the file says, or now
    std::optional<std::filesystem::path> predict, expected;  ///< as of `aeolis tones decode`
    double at_s = 0.0;                                       ///< the first sample's time on the predict's scale
    std::vector<double> excluded_hz;
    double pace = 0.0;  ///< seconds of reception a second; 0: at once
};

/// Whether a file is SigMF or WAV, in which `aeolis ingest` finds samples of tones.
bool holds_samples(const std::filesystem::path& file);

/// Decodes the recording as a station does: tones, carrier, spectrum and the link's state are those of a run. Returns
/// the exit code: 1 for what check_reception() calls a fault, or when the samples contradict the file's metadata.
int ingest_tones(const IngestTonesOptions& options);

}  // namespace aeolis::server
