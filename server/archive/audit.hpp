// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "server/archive/sqlite.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

// Who did what, in a table whose entries hang together by hash: none can be changed, taken out or put in between
// without all that follow being made anew. Newest entries that were cut off can be told only by a hash that was kept
// elsewhere.
namespace aeolis::archive {

struct AuditRecord {
    std::string at;      ///< wall clock, ISO 8601
    std::string who;     ///< user, "token NAME", or empty: a server without accounts
    std::string from;    ///< address of the peer; of a program that was started and not asked, "command line"
    std::string action;  ///< one word
    std::string detail;
    std::string outcome;
};
struct AuditEntry : AuditRecord {
    std::uint64_t entry = 0;  ///< from 1, without a gap
    std::string hash;         ///< hexadecimal
};

/// SHA-256 over the hash before (empty for the first) and each part of the entry, every one as LENGTH:OCTETS,
/// hexadecimal.
std::string audit_hash(const std::string& before, const AuditEntry& entry);

/// Within a transaction of the caller.
Result<void> append_audit(sqlite::Database& database, std::span<const AuditRecord> records);
/// In order, of those after `after`.
Result<std::vector<AuditEntry>> audit_entries(sqlite::Database& database, std::uint64_t after, std::size_t limit);

struct AuditCheck {
    std::uint64_t entries = 0;
    std::string last_hash;            ///< to be compared with one that was kept elsewhere
    std::vector<std::string> faults;  ///< the first that is wrong, by number: those after it hang on it
};
Result<AuditCheck> check_audit(sqlite::Database& database);

}  // namespace aeolis::archive
