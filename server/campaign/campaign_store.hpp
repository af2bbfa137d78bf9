// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "server/archive/sqlite.hpp"
#include "server/archive/writer_lock.hpp"
#include "server/campaign/case_result.hpp"

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace aeolis::server::campaign {

inline constexpr std::int64_t campaign_schema_version = 2;
inline constexpr std::int64_t campaign_application_id = 0x4165436d;  ///< "AeCm" in the file's header

/// The properties common to all cases of a file. Cases of two identities never share a file.
struct Identity {
    std::string scenario;       ///< its name
    std::string scenario_text;  ///< complete
    std::uint64_t seed = 1;
    std::string dictionary;  ///< id of the dictionary on board
    std::string program;     ///< digest of the program that flies
};

/// The results of a campaign in an SQLite file. Rows are only ever added, and each case once.
///
///  campaign   one row: schema version, scenario, seed, dictionary, program, cases requested by the last call, queue
///  cases      number, outcome, reason, end_cycle, touchdown, parachute, …; NULL when there was none
///  arrivals   place (from 1, in the order in which cases were stored), case_number
///  events     case_number, place (in the order of time), name, e_s, altitude_m, speed_mps, east_m, north_m
///  margins    case_number, place, timepoint, margin_s
///  draws      case_number, name, value: the seeded errors
///
/// One thread owns it, and one process at a time writes.
class CampaignStore {
  public:
    /// Opens or creates the file. The Error names the field in which the file belongs to another campaign.
    static Result<CampaignStore> open(const std::filesystem::path& file, const Identity& identity);

    /// The name of its queue where workers fly the cases: drawn when the file was made.
    Result<std::string> queue();
    /// Writes the number of cases requested into the file.
    Result<void> want(std::uint64_t cases);
    Result<bool> has(std::uint64_t case_number);
    /// Stores all of `results` or none; durable when it returns.
    Result<void> add(std::span<const CaseResult> results);

  private:
    CampaignStore(archive::WriterLock lock, archive::sqlite::Database database)
        : lock_(std::move(lock)), database_(std::move(database)) {}
    Result<void> check(const Identity& identity);
    Result<void> make(const Identity& identity);
    Result<void> prepare();

    archive::WriterLock lock_;  // released last
    archive::sqlite::Database database_;
    archive::sqlite::Statement has_, add_case_, add_arrival_, add_event_, add_margin_, add_draw_;
};

}  // namespace aeolis::server::campaign
