// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/shadow/forecast.hpp"
#include "server/shadow/prospect.hpp"

#include <string>
#include <vector>

namespace aeolis::server::shadow {

/// How a forecast was asked for.
struct ForecastCall {
    std::string scenario;
    std::uint64_t landing_seed = 1;
    ForecastOrder order;
    std::vector<std::string> assumed;  ///< commands and faults, in words
};

/// A forecast as `aeolis forecast` prints it: one JSON object on one line, or a table for people. Both say from
/// what it is flown.
std::string forecast_json(const FlownForecast& forecast, const simulation::Limits& limits, const ForecastCall& call);
std::string forecast_table(const FlownForecast& forecast, const simulation::Limits& limits, const ForecastCall& call);

/// The progress line: "12/64 flown, 6 of 6 landed within limits without, 5 of 6 with".
std::string progress_line(const ForecastProgress& progress);

/// "E+3:10.5", "E-600": seconds from entry as people say them here.
std::string entry_time_text(double e_s);

}  // namespace aeolis::server::shadow
