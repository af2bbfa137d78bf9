// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "server/archive/records.hpp"
#include "server/archive/sqlite.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

// Forecasts of runs, by run and number. Like layouts they are no part of what a run recorded: some hold the truth of a
// rehearsal, so they are no items, and do not travel to followers. Those have odd numbers and the others even ones, so
// that the numbers that all may see do not tell how many there are of which only instructors may know.
namespace aeolis::archive {

struct ForecastRecord {
    RunId run;
    std::uint64_t number = 0;  ///< in its run: odd from the truth, even from telemetry
    bool truth = true;         ///< from the truth
    std::string asked, asked_by;
    double at_e_s = 0.0;
    std::string request;  ///< JSON of v1::ForecastRequest
    std::string state;    ///< name of a v1::Forecast::State
    std::string reason;
    std::string result;  ///< JSON; empty: not ready
    std::string ended;
};

/// Stores a forecast under its number, or with the number 0 as the next one of its run and kind. Call within a
/// transaction.
/// @return its number
Result<std::uint64_t> keep_forecast(sqlite::Database& database, const ForecastRecord& forecast);
Result<std::optional<ForecastRecord>> forecast_of(sqlite::Database& database, RunId run, std::uint64_t number);
/// A page of a run's forecasts without their results. @param after  the last of the page before; 0: the first page
/// @param truths  with those from the truth
Result<std::vector<ForecastRecord>> forecasts_of(sqlite::Database& database, RunId run, bool truths,
                                                 std::uint64_t after, std::size_t limit, Order order);

}  // namespace aeolis::archive
