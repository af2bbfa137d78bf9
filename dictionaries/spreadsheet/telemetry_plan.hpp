// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/findings.hpp"

#include <optional>
#include <string_view>
#include <vector>

namespace aeolis::dictionary {

inline constexpr std::size_t telemetry_plan_rows_max = 1000;  ///< ours: fifty times the landing's
inline constexpr std::int64_t telemetry_every_max = 4096;     ///< ours: of a packet at 64 Hz, about one a minute

/// In the order of the file. Each plan says once what becomes of each packet, in its own rows or in those of "all"; a
/// packet that goes first is never thinned. `packets` null: unknown because their file could not be read, so references
/// and completeness are not checked. R30
std::optional<std::vector<TelemetryPlanRow>>
read_telemetry_plan(std::string_view text, const std::vector<Packet>* packets, Findings& findings);

}  // namespace aeolis::dictionary
