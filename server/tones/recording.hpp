// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "common/time.hpp"
#include "server/tones/sample_format.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace aeolis::server {

/// From which sample on the file states a time of its own.
struct CaptureTime {
    std::uint64_t first_sample = 0;  ///< counted from the recording's first
    Ert time;
    int number = 1;  ///< of the capture in the file, from 1
};

/// Samples that are missing in the midst of a recording.
struct MissingSamples {
    std::uint64_t before_sample = 0;  ///< of those that are there
    std::uint64_t count = 0;
};

/// Where a recording's samples are, and what its file says about them.
struct SampleRecording {
    std::filesystem::path samples;        ///< the file that has them
    std::uint64_t first_octet = 0;        ///< of the first sample
    std::optional<std::uint64_t> octets;  ///< of all samples; none: to the end of the file
    std::optional<SampleFormat> format;   ///< none: the file does not say
    std::optional<double> rate_hz;        ///< the same
    std::optional<double> frequency_hz;   ///< of the middle of the band
    std::string datetime;                 ///< of the first sample, as the file has it
    std::vector<CaptureTime> captures;    ///< those with a time, in order
    std::filesystem::path said_by;        ///< the file that states them
    std::string kind = "raw samples";     ///< SigMF, WAV
    std::vector<std::string> told;        ///< deviations from the format, a line each
};

/// Recognises the format of a file: SigMF (by either of its two files), WAV (RIFF and RF64), otherwise raw samples,
/// without metadata.
///
/// Fails with one line for a file without complex samples: mono audio, real samples, other kinds of files that are
/// known by their first octets, metadata that cannot be read. Sources: [sigmf], [wave], [rf64].
Result<SampleRecording> look_at_recording(const std::filesystem::path& file);

/// The samples that are missing between captures, by their times and the recording's rate. What the clock, or a time in
/// whole seconds, explains is no gap. Fails with one line for times that go back, and for a gap of more than a day.
Result<std::vector<MissingSamples>> missing_samples(const SampleRecording& recording);

/// The metadata of a SigMF recording.
std::string sigmf_meta(const SampleFormat& format, double rate_hz, double frequency_hz, const std::string& description);

}  // namespace aeolis::server
