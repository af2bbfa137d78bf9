// SPDX-License-Identifier: Apache-2.0
#include "server/campaign/campaign_store.hpp"

#include <fmt/format.h>
#include <sstream>

namespace aeolis::server::campaign {
namespace {

using archive::sqlite::Database;
using archive::sqlite::Mode;
using archive::sqlite::Transaction;

const char* const pragmas = "PRAGMA journal_mode = WAL;"
                            "PRAGMA synchronous = FULL;";

const char* const schema =
    "CREATE TABLE campaign (schema_version INTEGER NOT NULL, scenario TEXT NOT NULL, scenario_text TEXT NOT NULL,"
    " seed INTEGER NOT NULL, dictionary TEXT NOT NULL, program TEXT NOT NULL, cases INTEGER NOT NULL,"
    " queue TEXT NOT NULL) STRICT;"
    "CREATE TABLE cases (number INTEGER PRIMARY KEY, outcome TEXT NOT NULL, reason TEXT NOT NULL,"
    " end_cycle INTEGER NOT NULL, vertical_mps REAL, horizontal_mps REAL, miss_m REAL, latitude_deg REAL,"
    " longitude_deg REAL, east_m REAL, north_m REAL, peak_deceleration_mps2 REAL, parachute_mach REAL,"
    " parachute_pressure_Pa REAL, propellant_kg REAL,"
    " heatshield_least_m REAL, backshell_least_m REAL, struck_by TEXT,"
    " tilt_deg REAL, limits_exceeded INTEGER NOT NULL) STRICT;"
    "CREATE TABLE arrivals (place INTEGER PRIMARY KEY, case_number INTEGER NOT NULL REFERENCES cases(number)) STRICT;"
    "CREATE TABLE events (case_number INTEGER NOT NULL REFERENCES cases(number), place INTEGER NOT NULL,"
    " name TEXT NOT NULL, e_s REAL, altitude_m REAL, speed_mps REAL, east_m REAL, north_m REAL,"
    " PRIMARY KEY (case_number, place)) STRICT, WITHOUT ROWID;"
    "CREATE INDEX events_by_name ON events (name);"
    "CREATE TABLE margins (case_number INTEGER NOT NULL REFERENCES cases(number), place INTEGER NOT NULL,"
    " timepoint TEXT NOT NULL, margin_s REAL NOT NULL, PRIMARY KEY (case_number, place)) STRICT, WITHOUT ROWID;"
    "CREATE INDEX margins_by_timepoint ON margins (timepoint);"
    "CREATE TABLE draws (case_number INTEGER NOT NULL REFERENCES cases(number), name TEXT NOT NULL,"
    " value REAL NOT NULL, PRIMARY KEY (case_number, name)) STRICT, WITHOUT ROWID;";

/// The first line in which two texts differ, in both versions.
std::string difference(const std::string& before, const std::string& now) {
    std::istringstream left{before}, right{now};
    for (std::string a, b;;) {
        const bool more_left = static_cast<bool>(std::getline(left, a));
        const bool more_right = static_cast<bool>(std::getline(right, b));
        if (!more_left) a = "nothing";
        if (!more_right) b = "nothing";
        if (a != b || !(more_left && more_right)) return fmt::format("'{}' there, '{}' here", a, b);
    }
}

}  // namespace

Result<CampaignStore> CampaignStore::open(const std::filesystem::path& file, const Identity& identity) {
    std::error_code ignored;
    if (std::filesystem::is_directory(file, ignored))
        return Error{file.string() + ": is a directory, not a campaign's results"};
    if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), ignored);
    auto lock = archive::WriterLock::take(file);
    if (!lock) return lock.error();
    auto database = Database::open(file.string(), Mode::read_write_create);
    if (!database) return database.error();
    CampaignStore store{std::move(*lock), std::move(*database)};
    // Checked before writing: the file may belong to another program.
    const auto id = store.database_.integer_of("PRAGMA application_id");
    if (!id) return id.error();
    const auto tables = store.database_.integer_of("SELECT count(*) FROM sqlite_schema");
    if (!tables) return tables.error();
    if (*tables != 0 && *id != campaign_application_id)
        return Error{file.string() + ": campaign: the file holds something else than a campaign's results"};
    if (const auto set = store.database_.execute(pragmas); !set) return set.error();
    if (const auto known = *tables == 0 ? store.make(identity) : store.check(identity); !known) return known.error();
    if (const auto prepared = store.prepare(); !prepared) return prepared.error();
    return store;
}

Result<void> CampaignStore::make(const Identity& identity) {
    auto transaction = Transaction::begin_write(database_);
    if (!transaction) return transaction.error();
    if (const auto made = database_.execute(schema); !made) return made.error();
    const auto mark = fmt::format("PRAGMA application_id = {}", campaign_application_id);
    if (const auto marked = database_.execute(mark.c_str()); !marked) return marked.error();
    auto insert = database_.prepare("INSERT INTO campaign VALUES (?, ?, ?, ?, ?, ?, 0, lower(hex(randomblob(8))))");
    if (!insert) return insert.error();
    insert->bind(1, campaign_schema_version)
        .bind(2, std::string_view{identity.scenario})
        .bind(3, std::string_view{identity.scenario_text})
        .bind(4, static_cast<std::int64_t>(identity.seed))
        .bind(5, std::string_view{identity.dictionary})
        .bind(6, std::string_view{identity.program});
    if (const auto inserted = insert->run(); !inserted) return inserted.error();
    return transaction->commit();
}

Result<void> CampaignStore::check(const Identity& identity) {
    const auto refused = [&](const char* field, const std::string& why) {
        return Error{fmt::format("{}: {}: {}", database_.file(), field, why)};
    };
    const auto version = database_.integer_of("SELECT schema_version FROM campaign");
    if (!version) return version.error();
    if (*version != campaign_schema_version)
        return refused("schema_version", fmt::format("{} there, {} here", *version, campaign_schema_version));
    auto select = database_.prepare("SELECT scenario, scenario_text, seed, dictionary, program FROM campaign");
    if (!select) return select.error();
    const auto row = select->step();
    if (!row) return row.error();
    if (!*row) return refused("campaign", "the file says of no campaign that it is its own");
    const auto text = [&](int column) { return std::string{select->text(column)}; };
    if (text(0) != identity.scenario)
        return refused("scenario", fmt::format("'{}' there, '{}' here", text(0), identity.scenario));
    if (text(1) != identity.scenario_text) return refused("scenario", difference(text(1), identity.scenario_text));
    if (select->integer(2) != static_cast<std::int64_t>(identity.seed))
        return refused("seed", fmt::format("{} there, {} here", select->integer(2), identity.seed));
    if (text(3) != identity.dictionary)
        return refused("dictionary", fmt::format("id {} there, {} here", text(3), identity.dictionary));
    if (text(4) != identity.program)
        return refused("program", fmt::format("{:.16} flew these cases, {:.16} is another", text(4), identity.program));
    return {};
}

Result<void> CampaignStore::prepare() {
    auto has = database_.prepare("SELECT 1 FROM cases WHERE number = ?");
    if (!has) return has.error();
    auto add_case =
        database_.prepare("INSERT INTO cases VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
    if (!add_case) return add_case.error();
    auto add_arrival = database_.prepare("INSERT INTO arrivals (case_number) VALUES (?)");
    if (!add_arrival) return add_arrival.error();
    auto add_event = database_.prepare("INSERT INTO events VALUES (?, ?, ?, ?, ?, ?, ?, ?)");
    if (!add_event) return add_event.error();
    auto add_margin = database_.prepare("INSERT INTO margins VALUES (?, ?, ?, ?)");
    if (!add_margin) return add_margin.error();
    auto add_draw = database_.prepare("INSERT INTO draws VALUES (?, ?, ?)");
    if (!add_draw) return add_draw.error();
    has_ = std::move(*has);
    add_case_ = std::move(*add_case);
    add_arrival_ = std::move(*add_arrival);
    add_event_ = std::move(*add_event);
    add_margin_ = std::move(*add_margin);
    add_draw_ = std::move(*add_draw);
    return {};
}

Result<std::string> CampaignStore::queue() {
    auto select = database_.prepare("SELECT queue FROM campaign");
    if (!select) return select.error();
    if (const auto row = select->step(); !row) return row.error();
    return std::string{select->text(0)};
}

Result<void> CampaignStore::want(std::uint64_t cases) {
    auto update = database_.prepare("UPDATE campaign SET cases = ?");
    if (!update) return update.error();
    return update->bind(1, static_cast<std::int64_t>(cases)).run();
}

Result<bool> CampaignStore::has(std::uint64_t case_number) {
    auto row = has_.bind(1, static_cast<std::int64_t>(case_number)).step();
    has_.reset();
    return row;
}

Result<void> CampaignStore::add(std::span<const CaseResult> results) {
    auto transaction = Transaction::begin_write(database_);
    if (!transaction) return transaction.error();
    for (const CaseResult& result : results) {
        const auto number = static_cast<std::int64_t>(result.number);
        add_case_.bind(1, number)
            .bind(2, std::string_view{result.outcome})
            .bind(3, std::string_view{result.reason})
            .bind(4, static_cast<std::int64_t>(result.end_cycle));
        for (int column = 5; column <= 11; ++column) add_case_.bind_null(column);
        if (const auto& touchdown = result.touchdown)
            add_case_.bind(5, touchdown->vertical_mps)
                .bind(6, touchdown->horizontal_mps)
                .bind(7, touchdown->miss_m)
                .bind(8, touchdown->latitude_deg)
                .bind(9, touchdown->longitude_deg)
                .bind(10, result.east_m)
                .bind(11, result.north_m);
        add_case_.bind(12, result.peak_deceleration_mps2).bind_null(13).bind_null(14).bind(15, result.propellant_kg);
        if (result.parachute)
            add_case_.bind(13, result.parachute->mach).bind(14, result.parachute->dynamic_pressure_Pa);
        add_case_.bind_null(16).bind_null(17).bind_null(18);
        const auto& [heatshield_least_m, backshell_least_m, struck] = result.separation;
        if (heatshield_least_m) add_case_.bind(16, *heatshield_least_m);
        if (backshell_least_m) add_case_.bind(17, *backshell_least_m);
        if (struck != nullptr) add_case_.bind(18, std::string_view{struck});
        add_case_.bind_null(19).bind(20, static_cast<std::int64_t>(result.limits_exceeded));
        if (result.touchdown) add_case_.bind(19, result.touchdown->tilt_deg);
        if (const auto added = add_case_.run(); !added) return added.error();
        if (const auto added = add_arrival_.bind(1, number).run(); !added) return added.error();
        std::int64_t place = 0;
        for (const CaseEvent& event : result.events) {
            add_event_.bind(1, number)
                .bind(2, place++)
                .bind(3, std::string_view{event.name})
                .bind(4, event.e_s)
                .bind(5, event.altitude_m)
                .bind(6, event.speed_mps)
                .bind(7, event.east_m)
                .bind(8, event.north_m);
            if (const auto added = add_event_.run(); !added) return added.error();
        }
        place = 0;
        for (const TimelineMargin& margin : result.margins) {
            add_margin_.bind(1, number)
                .bind(2, place++)
                .bind(3, std::string_view{margin.timepoint})
                .bind(4, margin.margin_s);
            if (const auto added = add_margin_.run(); !added) return added.error();
        }
        for (const simulation::Draw& draw : result.draws) {
            add_draw_.bind(1, number).bind(2, std::string_view{draw.name}).bind(3, draw.value);
            if (const auto added = add_draw_.run(); !added) return added.error();
        }
    }
    return transaction->commit();
}

}  // namespace aeolis::server::campaign
