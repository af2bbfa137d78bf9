// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/archive/audit.hpp"
#include "server/archive/records.hpp"
#include "server/archive/sqlite.hpp"

#include <optional>
#include <string>
#include <vector>

// Fingerprints of what was received or decided once and follows from nothing else: raw packets, tones, stages of
// commands, links, notes, requests, outcome, seed, digest. An entry of the audit holds them; the first one of
// an item counts (docs/decisions/0035).
namespace aeolis::archive {

/// An audit entry with the number and the hash of the rows of each table, for the items `first` to `last` of a run;
/// from item 1 on also for the tables without items.
Result<AuditRecord> fingerprint(sqlite::Database& database, RunId run, Sequence first, Sequence last);

/// The items that a fingerprint is of, by the audit entry's detail; none: it is no fingerprint.
struct ItemRange {
    Sequence first = 0, last = 0;
};
std::optional<ItemRange> fingerprint_range(const std::string& detail);

struct FingerprintCheck {
    std::vector<std::string> faults;  ///< each names run and table
    std::vector<std::string> notes;   ///< runs that have no fingerprint yet, and why
};
/// Compares the archive with all fingerprints in its audit. @param only  none: all runs
Result<FingerprintCheck> check_fingerprints(sqlite::Database& database, std::optional<RunId> only);

}  // namespace aeolis::archive
