// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "common/time_table.hpp"
#include "simulation/links/tone_waveform.hpp"

#include <filesystem>
#include <vector>

namespace aeolis::server {

/// Reads Doppler against time from a CSV file. The first column is time [s]; the first column whose name contains
/// "doppler_hz" is the Doppler. Fails with the file's name and the line.
Result<TimeTable> read_doppler(const std::filesystem::path& file);

/// Writes such a file, four rows a second, and reads it back: a signal with the returned Doppler removed matches the
/// file exactly.
Result<TimeTable> write_doppler(const std::filesystem::path& file, const TimeTable& doppler_hz, double from_s,
                                double to_s);

/// Reads tones to send from a CSV file with the columns start_s,tone: in order, each at least one symbol after the
/// last.
Result<std::vector<simulation::SentTone>> read_tones_to_send(const std::filesystem::path& file, double symbol_s);

}  // namespace aeolis::server
