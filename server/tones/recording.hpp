// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/tones/sample_format.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace aeolis::server {

/// Where a recording's samples are, and what its file says about them.
struct SampleRecording {
    std::filesystem::path samples;        ///< the file that has them
    std::uint64_t first_octet = 0;        ///< of the first sample
    std::optional<std::uint64_t> octets;  ///< of all samples; none: to the end of the file
    std::optional<SampleFormat> format;   ///< none: the file does not say
    std::optional<double> rate_hz;        ///< the same
    std::optional<double> frequency_hz;   ///< of the middle of the band
    std::string datetime;                 ///< of the first sample, as the file has it
    std::string kind = "raw samples";     ///< SigMF, WAV
    std::vector<std::string> told;        ///< deviations from the format, a line each
};

/// Recognises the format of a file: SigMF (by either of its two files), WAV (RIFF and RF64), otherwise raw samples,
/// without metadata.
///
/// Fails with one line for a file without complex samples: mono audio, real samples, other kinds of files that are
/// known by their first octets, metadata that cannot be read. Sources: [sigmf], [wave], [rf64].
Result<SampleRecording> look_at_recording(const std::filesystem::path& file);

/// The metadata of a SigMF recording.
std::string sigmf_meta(const SampleFormat& format, double rate_hz, double frequency_hz, const std::string& description);

}  // namespace aeolis::server
