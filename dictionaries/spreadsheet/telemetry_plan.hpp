// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/findings.hpp"

#include <optional>
#include <string_view>
#include <vector>

namespace aeolis::dictionary {

inline constexpr std::size_t telemetry_plan_rows_max = 1000;  ///< chosen: fifty times the rows of the landing
inline constexpr std::int64_t telemetry_every_max = 4096;     ///< chosen: about one packet a minute at 64 Hz
inline constexpr std::int64_t recorded_hz_max = 200;          ///< the IMU's

/// Reads telemetry_plan.csv, in the order of the file. R30
/// Each plan states once what happens to each packet, in its own rows or in those of "all". A packet of priority
/// `first` is never thinned. `packets` null: their file could not be read, so references and completeness are not
/// checked.
std::optional<std::vector<TelemetryPlanRow>>
read_telemetry_plan(std::string_view text, const std::vector<Packet>* packets, Findings& findings);

}  // namespace aeolis::dictionary
