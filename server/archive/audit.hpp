// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "server/archive/records.hpp"
#include "server/archive/sqlite.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

// The audit: who did what. Entries are chained by hash: none can be changed, removed or inserted unless all that follow
// are recomputed. Removal of the newest entries, or of all, shows against a head kept outside the archive.
namespace aeolis::archive {

struct AuditRecord {
    std::string at;      ///< wall clock, ISO 8601
    std::string who;     ///< user, "token NAME", or empty: a server without accounts
    std::string from;    ///< address of the peer; "command line" for a program that was started there
    std::string action;  ///< one word
    std::string detail;
    std::string outcome;
};
struct AuditEntry : AuditRecord {
    std::uint64_t entry = 0;  ///< from 1, without a gap
    std::string hash;         ///< hexadecimal
};

/// The hash of an entry: SHA-256, hexadecimal. It covers the previous hash (empty for the first) and each part of the
/// entry, each written as LENGTH:OCTETS.
std::string audit_hash(const std::string& before, const AuditEntry& entry);

/// Appends entries. Call within a transaction.
Result<void> append_audit(sqlite::Database& database, std::span<const AuditRecord> records);
/// The entries after `after` in that order; 0: from its beginning.
Result<std::vector<AuditEntry>> audit_entries(sqlite::Database& database, std::uint64_t after, std::size_t limit,
                                              Order order = {});

/// The newest entry, which stands for all before it.
struct AuditHead {
    std::uint64_t entry = 0;  ///< 0: there is none
    std::string hash;
    bool operator==(const AuditHead&) const = default;
};
Result<AuditHead> audit_head(sqlite::Database& database);
/// Converts a head to the text "ENTRY:HASH", and back; none for any other text.
std::string text_of(const AuditHead& head);
std::optional<AuditHead> head_from_text(std::string_view text);
/// Checks that the chain still has the entry that was once its head. Returns the fault as a sentence; none: it has.
Result<std::optional<std::string>> head_fault(sqlite::Database& database, const AuditHead& known);

/// Writes a head as a line into a file, readable by its owner only, all of it or nothing; or reads it. None: there is
/// no such file.
Result<void> write_head(const std::filesystem::path& file, const AuditHead& head);
Result<std::optional<AuditHead>> read_head(const std::filesystem::path& file);
/// The file of an archive's head, in `folder`.
std::filesystem::path head_file(const std::filesystem::path& archive, const std::filesystem::path& folder);

struct AuditCheck {
    std::uint64_t entries = 0;
    std::string last_hash;            ///< for comparison with one kept elsewhere
    std::vector<std::string> faults;  ///< only the first wrong entry, by number: later ones depend on it
};
Result<AuditCheck> check_audit(sqlite::Database& database);

}  // namespace aeolis::archive
