// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <fmt/chrono.h>
#include <string>

namespace aeolis::server {

/// UTC, ISO 8601, to the second.
inline std::string utc_text(std::chrono::system_clock::time_point time) {
    return fmt::format("{:%Y-%m-%dT%H:%M:%S}Z", fmt::gmtime(std::chrono::floor<std::chrono::seconds>(time)));
}

/// The machine's clock as text: only for a run's start and end, never for events in it (EarthClock).
inline std::string wall_clock_text() {
    return utc_text(std::chrono::system_clock::now());
}

}  // namespace aeolis::server
