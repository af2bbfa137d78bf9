// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "common/time_table.hpp"
#include "simulation/links/tone_waveform.hpp"

#include <filesystem>
#include <vector>

namespace aeolis::server {

/// Doppler against time from a CSV file: the first column is time in seconds, the first whose name has "doppler_hz" in
/// it the Doppler. Fails with the file's name and the line.
Result<TimeTable> read_doppler(const std::filesystem::path& file);

/// Writes such a file, four rows a second, and reads it back: who removes what is returned has removed what the file
/// says.
Result<TimeTable> write_doppler(const std::filesystem::path& file, const TimeTable& doppler_hz, double from_s,
                                double to_s);

/// Tones to send from a CSV file with the columns start_s,tone: in order, each at least a symbol after the one before.
Result<std::vector<simulation::SentTone>> read_tones_to_send(const std::filesystem::path& file, double symbol_s);

}  // namespace aeolis::server
