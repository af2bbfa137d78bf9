// SPDX-License-Identifier: Apache-2.0
#include "server/archive/forecasts.hpp"

namespace aeolis::archive {
namespace {

constexpr char all_columns[] = "SELECT number, asked, asked_by, at_e_s, request, state, reason, ended, ";

ForecastRecord record_of(const sqlite::Statement& row, RunId run) {
    ForecastRecord forecast;
    forecast.run = run;
    forecast.number = static_cast<std::uint64_t>(row.integer(0));
    forecast.truth = forecast.number % 2 == 1;
    forecast.asked = row.text(1);
    forecast.asked_by = row.text(2);
    forecast.at_e_s = row.real(3);
    forecast.request = row.text(4);
    forecast.state = row.text(5);
    forecast.reason = row.text(6);
    forecast.ended = row.text(7);
    forecast.result = row.text(8);
    return forecast;
}

}  // namespace

Result<std::uint64_t> keep_forecast(sqlite::Database& database, const ForecastRecord& forecast) {
    auto run = database.prepare("SELECT count(*) FROM runs WHERE run = ?1");
    if (!run) return run.error();
    auto known = run->bind(1, std::int64_t{forecast.run.value}).step();
    if (!known) return known.error();
    if (run->integer(0) == 0)
        return Error{"run " + std::to_string(forecast.run.value) + " is not in the archive any more"};
    auto number = forecast.number;
    if (number == 0) {
        const std::int64_t parity = forecast.truth ? 1 : 0;
        auto newest = database.prepare("SELECT coalesce(max(number), -?2) FROM forecasts"
                                       " WHERE run = ?1 AND number % 2 = ?2");
        if (!newest) return newest.error();
        auto found = newest->bind(1, std::int64_t{forecast.run.value}).bind(2, parity).step();
        if (!found) return found.error();
        number = static_cast<std::uint64_t>(newest->integer(0) + 2);
    }
    auto row =
        database.prepare("INSERT OR REPLACE INTO forecasts (run, number, asked, asked_by, at_e_s, request, state,"
                         " reason, ended, result) VALUES (?,?,?,?,?,?,?,?,?,?)");
    if (!row) return row.error();
    row->bind(1, std::int64_t{forecast.run.value})
        .bind(2, sqlite::number(number))
        .bind(3, std::string_view(forecast.asked))
        .bind(4, std::string_view(forecast.asked_by))
        .bind(5, forecast.at_e_s)
        .bind(6, std::string_view(forecast.request))
        .bind(7, std::string_view(forecast.state))
        .bind(8, std::string_view(forecast.reason))
        .bind(9, std::string_view(forecast.ended))
        .bind(10, std::string_view(forecast.result));
    if (auto done = row->run(); !done) return done.error();
    return number;
}

Result<std::optional<ForecastRecord>> forecast_of(sqlite::Database& database, RunId run, std::uint64_t number) {
    auto row =
        database.prepare((std::string{all_columns} + "result FROM forecasts WHERE run = ?1 AND number = ?2").c_str());
    if (!row) return row.error();
    auto found = row->bind(1, std::int64_t{run.value}).bind(2, sqlite::number(number)).step();
    if (!found) return found.error();
    return *found ? std::optional{record_of(*row, run)} : std::nullopt;
}

Result<std::vector<ForecastRecord>> forecasts_of(sqlite::Database& database, RunId run, bool truths,
                                                 std::uint64_t after, std::size_t limit, Order order) {
    const bool newest_first = order == Order::newest_first;
    const std::string page =
        newest_first ? "(?2 = 0 OR number < ?2) ORDER BY number DESC" : "number > ?2 ORDER BY number";
    auto rows =
        database.prepare((std::string{all_columns} +
                          "'' FROM forecasts WHERE run = ?1 AND (?4 OR number % 2 = 0) AND " + page + " LIMIT ?3")
                             .c_str());
    if (!rows) return rows.error();
    rows->bind(1, std::int64_t{run.value})
        .bind(2, sqlite::number(after))
        .bind(3, sqlite::number(limit))
        .bind(4, std::int64_t{truths ? 1 : 0});
    std::vector<ForecastRecord> forecasts;
    for (;;) {
        auto found = rows->step();
        if (!found) return found.error();
        if (!*found) return forecasts;
        forecasts.push_back(record_of(*rows, run));
    }
}

}  // namespace aeolis::archive
