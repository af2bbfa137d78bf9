// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <fmt/chrono.h>
#include <string>

namespace aeolis::server {

/// The machine's clock (UTC, ISO 8601): only for a run's start and end, never for what happened in it.
inline std::string wall_clock_text() {
    return fmt::format("{:%Y-%m-%dT%H:%M:%S}Z",
                       fmt::gmtime(std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now())));
}

}  // namespace aeolis::server
