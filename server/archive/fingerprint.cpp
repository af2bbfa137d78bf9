// SPDX-License-Identifier: Apache-2.0
#include "server/archive/fingerprint.hpp"

#include "server/archive/item_rows.hpp"
#include "server/archive/schema.hpp"
#include "server/base/digest.hpp"
#include "server/base/wall_clock.hpp"

#include <algorithm>
#include <charconv>
#include <map>
#include <sstream>

namespace aeolis::archive {
namespace {

constexpr char action[] = "fingerprint";
constexpr std::size_t kept_digits = 32;  ///< chosen: 128 bits of SHA-256 suffice against a second row of the same hash

/// The number and hash of the rows, by the name of their table; tables without rows are left out.
using Prints = std::map<std::string, std::string>;

/// Rows to be hashed: by keys ?1 to ?2, at most ?3, or by run ?1.
struct Rows {
    std::string name, sql;
    bool of_run = false;
};

const std::vector<Rows>& rows_of_items() {
    static const std::vector<Rows> all = [] {
        std::vector<Rows> rows{
            {"packets", "SELECT key, ert_us, (SELECT word FROM words WHERE kind = 'link' AND number = link), source,"
                        " octets FROM packets WHERE key BETWEEN ?1 AND ?2 ORDER BY key LIMIT ?3"}};
        for_item_kinds([&]<typename Record>(ItemKind<Record>) {
            if constexpr (!ItemTable<Record>::derived) {
                rows.push_back({ItemTable<Record>::name, rows_sql<Record>()});
                if constexpr (HasParts<Record>) {
                    using Parts = PartTable<PartOf<Record>>;
                    rows.push_back({Parts::name, std::string("SELECT * FROM ") + Parts::name +
                                                     " WHERE key BETWEEN ?1 AND ?2 ORDER BY key, position LIMIT ?3"});
                }
            }
        });
        return rows;
    }();
    return all;
}

const std::vector<Rows>& rows_of_run() {
    static const std::vector<Rows> all = [] {
        std::vector<Rows> rows;
        for (const std::string name : {"requests", "run_solution", "run_anchors"})
            rows.push_back({name, "SELECT * FROM " + name + " WHERE run = ?1 ORDER BY 2", true});
        rows.push_back({"link_totals", "SELECT * FROM link_totals WHERE run = ?1 ORDER BY link", true});
        rows.push_back(
            {"sequence_totals", "SELECT * FROM sequence_totals WHERE run = ?1 ORDER BY link, packets, name", true});
        for (const std::string column : {"outcome", "outcome_reason", "seed", "digest", "scenario_text"})
            rows.push_back({"runs." + column, "SELECT " + column + " FROM runs WHERE run = ?1", true});
        rows.push_back(
            {"runs",
             "SELECT scenario, title, venue, case_number, pace, started, ended, start_sclk, entry_sclk,"
             " correlation_sclk, correlation_scet_us, clock_version, clock_rate, leap_seconds, light_time_s,"
             " tone_model, dictionary, forked_run, forked_cycle, forked_e_s, forked_seed FROM runs WHERE run = ?1",
             true});
        return rows;
    }();
    return all;
}

Result<void> add(sqlite::Database& database, const Rows& rows, RunId run, Sequence first, Sequence last,
                 Prints& prints) {
    auto selected = database.prepare(rows.sql.c_str());
    if (!selected) return selected.error();
    if (rows.of_run)
        selected->bind(1, std::int64_t{run.value});
    else
        selected->bind(1, item_key(run, first)).bind(2, item_key(run, last)).bind(3, std::int64_t{-1});
    server::Digest digest;
    std::uint64_t count = 0;
    std::vector<std::uint8_t> exact;
    for (;; ++count) {
        auto found = selected->step();
        if (!found) return found.error();
        if (!*found) break;
        exact.clear();
        for (int column = 0; column < selected->columns(); ++column) selected->append_exact(column, exact);
        digest.add(exact);
    }
    if (count > 0) prints[rows.name] = std::to_string(count) + ':' + digest.text().substr(0, kept_digits);
    return {};
}

Result<Prints> prints_of(sqlite::Database& database, RunId run, Sequence first, Sequence last) {
    Prints prints;
    for (const auto& rows : rows_of_items())
        if (auto done = add(database, rows, run, first, last, prints); !done) return done.error();
    if (first == 1)
        for (const auto& rows : rows_of_run())
            if (auto done = add(database, rows, run, first, last, prints); !done) return done.error();
    return prints;
}

struct Fingerprint {
    RunId run;
    Sequence first = 0, last = 0;
    Prints prints;
};

std::string text_of(const Fingerprint& print) {
    auto text = "run " + std::to_string(print.run.value) + " items " + std::to_string(print.first) + ' ' +
                std::to_string(print.last);
    for (const auto& [name, of_rows] : print.prints) text.append(" ").append(name).append("=").append(of_rows);
    return text;
}

std::optional<Fingerprint> fingerprint_of(const std::string& text) {
    std::istringstream words{text};
    Fingerprint print;
    std::string run, items, word;
    if (!(words >> run >> print.run.value >> items >> print.first >> print.last)) return std::nullopt;
    while (words >> word) {
        const auto equals = word.find('=');
        if (equals == std::string::npos) return std::nullopt;
        print.prints[word.substr(0, equals)] = word.substr(equals + 1);
    }
    return print;
}

/// What the audit says of runs.
struct Audited {
    std::map<std::uint32_t, std::vector<Fingerprint>> prints;  ///< by run: the one from item 1 on, then later items
    std::vector<std::uint32_t> again;                          ///< runs with another one of items that had one
    std::vector<std::uint32_t> pruned;
};

/// The numbers in "runs 1, 3".
void add_numbers(const std::string& text, std::vector<std::uint32_t>& numbers) {
    for (std::size_t at = text.find_first_of("0123456789"); at != std::string::npos;) {
        std::uint32_t number = 0;
        const auto* const end = std::from_chars(text.data() + at, text.data() + text.size(), number).ptr;
        numbers.push_back(number);
        at = text.find_first_of("0123456789", static_cast<std::size_t>(end - text.data()));
    }
}

Result<Audited> audited(sqlite::Database& database) {
    Audited all;
    auto rows = database.prepare("SELECT action, detail FROM audit WHERE action IN ('fingerprint', 'prune')"
                                 " AND outcome = 'done' ORDER BY entry");
    if (!rows) return rows.error();
    for (;;) {
        auto found = rows->step();
        if (!found) return found.error();
        if (!*found) return all;
        const std::string detail{rows->text(1)};
        if (rows->text(0) == "prune") {
            add_numbers(detail, all.pruned);
        } else if (auto print = fingerprint_of(detail)) {
            auto& of_run = all.prints[print->run.value];
            // Items get a fingerprint once, each behind those before: another one is not the program's.
            if (!of_run.empty() && print->first <= of_run.back().last)
                all.again.push_back(print->run.value);
            else
                of_run.push_back(std::move(*print));
        }
    }
}

struct StoredRun {
    std::string state;
    Sequence last = 0;
};

Result<std::map<std::uint32_t, StoredRun>> stored_runs(sqlite::Database& database) {
    std::map<std::uint32_t, StoredRun> runs;
    auto rows = database.prepare("SELECT run, state FROM runs ORDER BY run");
    if (!rows) return rows.error();
    auto last = database.prepare(last_key_sql());
    if (!last) return last.error();
    for (;;) {
        auto found = rows->step();
        if (!found) return found.error();
        if (!*found) return runs;
        const RunId run{static_cast<std::uint32_t>(rows->integer(0))};
        last->bind(1, item_key(run, 0)).bind(2, item_key(run, sequence_max));
        if (auto key = last->step(); !key) return key.error();
        runs[run.value] = {std::string(rows->text(1)), last->is_null(0) ? 0 : sequence_of(last->integer(0))};
        last->reset();
    }
}

std::string rows_in(const Prints& prints, const std::string& name) {
    const auto found = prints.find(name);
    return found == prints.end() ? "0" : found->second.substr(0, found->second.find(':'));
}

void compare(const Fingerprint& kept, const Prints& now, std::vector<std::string>& faults) {
    const auto of_run = "run " + std::to_string(kept.run.value) + ": ";
    const auto name_it = [&](const std::string& name) {
        const auto before = rows_in(kept.prints, name), after = rows_in(now, name);
        faults.push_back(of_run + name + ": not what its fingerprint in the audit says" +
                         (before == after ? "" : " (" + before + " rows then, " + after + " now)"));
    };
    for (const auto& [name, of_rows] : kept.prints) {
        const auto found = now.find(name);
        if (found == now.end() || found->second != of_rows) name_it(name);
    }
    for (const auto& [name, of_rows] : now)
        if (!kept.prints.contains(name)) name_it(name);
}

}  // namespace

Result<AuditRecord> fingerprint(sqlite::Database& database, RunId run, Sequence first, Sequence last) {
    auto prints = prints_of(database, run, first, last);
    if (!prints) return prints.error();
    AuditRecord record;
    record.at = server::wall_clock_text();
    record.from = "server";
    record.action = action;
    record.detail = text_of({run, first, last, std::move(*prints)});
    record.outcome = "done";
    return record;
}

std::optional<ItemRange> fingerprint_range(const std::string& detail) {
    const auto print = fingerprint_of(detail);
    if (!print) return std::nullopt;
    return ItemRange{print->first, print->last};
}

Result<FingerprintCheck> check_fingerprints(sqlite::Database& database, std::optional<RunId> only) {
    const auto kept = audited(database);
    if (!kept) return kept.error();
    const auto stored = stored_runs(database);
    if (!stored) return stored.error();
    FingerprintCheck check;
    const auto wanted = [&](std::uint32_t run) { return !only || only->value == run; };
    for (const auto& [number, prints] : kept->prints) {
        const auto of_run = "run " + std::to_string(number) + ": ";
        const auto run = stored->find(number);
        if (!wanted(number)) continue;
        if (std::ranges::find(kept->again, number) != kept->again.end())
            check.faults.push_back(of_run +
                                   "the audit has another fingerprint of items that had one: the first counts");
        if (run == stored->end()) {
            if (std::ranges::find(kept->pruned, number) == kept->pruned.end())
                check.faults.push_back(of_run + "the audit has its fingerprint, and it is gone without a prune");
            continue;
        }
        for (const auto& print : prints) {
            auto now = prints_of(database, print.run, print.first, print.last);
            if (!now) return now.error();
            compare(print, *now, check.faults);
        }
        if (prints.back().last < run->second.last)
            check.faults.push_back(of_run + "items after " + std::to_string(prints.back().last) +
                                   " have no fingerprint in the audit");
    }
    for (const auto& [number, run] : *stored) {
        if (!wanted(number) || kept->prints.contains(number)) continue;
        const auto of_run = "run " + std::to_string(number);
        if (run.state == "finished")  // its end and its fingerprint are one transaction
            check.faults.push_back(of_run + ": it has ended, and its fingerprint is not in the audit");
        else
            check.notes.push_back("audit: " + of_run + " has no fingerprint (" +
                                  (run.state == "running" ? "it goes on" : "it was cut off") +
                                  "): its commands, notes, tones and outcome are not compared");
    }
    return check;
}

}  // namespace aeolis::archive
