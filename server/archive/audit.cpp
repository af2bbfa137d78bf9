// SPDX-License-Identifier: Apache-2.0
#include "server/archive/audit.hpp"

#include "common/check.hpp"

#include <array>
#include <openssl/evp.h>

namespace aeolis::archive {
namespace {

constexpr char entry_columns[] = "SELECT entry, at, who, peer, action, detail, outcome, hash FROM audit ";

AuditEntry entry_of(const sqlite::Statement& row) {
    AuditEntry entry;
    entry.entry = static_cast<std::uint64_t>(row.integer(0));
    entry.at = row.text(1);
    entry.who = row.text(2);
    entry.from = row.text(3);
    entry.action = row.text(4);
    entry.detail = row.text(5);
    entry.outcome = row.text(6);
    entry.hash = row.text(7);
    return entry;
}

void add_part(std::string& text, const std::string& part) {
    text += std::to_string(part.size()) + ':' + part;
}

}  // namespace

std::string audit_hash(const std::string& before, const AuditEntry& entry) {
    std::string text;
    for (const auto& part : {before, std::to_string(entry.entry), entry.at, entry.who, entry.from, entry.action,
                             entry.detail, entry.outcome})
        add_part(text, part);
    std::array<unsigned char, 32> hash{};
    AEOLIS_CHECK(EVP_Digest(text.data(), text.size(), hash.data(), nullptr, EVP_sha256(), nullptr) == 1);
    constexpr char digits[] = "0123456789abcdef";
    std::string hex;
    for (const auto octet : hash) {
        hex += digits[octet >> 4U];
        hex += digits[octet & 15U];
    }
    return hex;
}

Result<void> append_audit(sqlite::Database& database, std::span<const AuditRecord> records) {
    AuditEntry entry;
    std::string before;
    auto last = database.prepare((std::string{entry_columns} + "ORDER BY entry DESC LIMIT 1").c_str());
    auto row = database.prepare("INSERT INTO audit VALUES (?,?,?,?,?,?,?,?)");
    if (!last) return last.error();
    if (!row) return row.error();
    auto found = last->step();
    if (!found) return found.error();
    if (*found) entry = entry_of(*last);
    last->reset();
    for (const auto& record : records) {
        before = entry.hash;
        static_cast<AuditRecord&>(entry) = record;
        ++entry.entry;
        entry.hash = audit_hash(before, entry);
        row->bind(1, static_cast<std::int64_t>(entry.entry));
        int column = 2;
        for (const auto* text :
             {&entry.at, &entry.who, &entry.from, &entry.action, &entry.detail, &entry.outcome, &entry.hash})
            row->bind(column++, std::string_view{*text});
        if (auto done = row->run(); !done) return done;
    }
    return {};
}

Result<std::vector<AuditEntry>> audit_entries(sqlite::Database& database, std::uint64_t after, std::size_t limit,
                                              Order order) {
    const char* const page = order == Order::oldest_first ? "WHERE entry > ?1 ORDER BY entry LIMIT ?2"
                                                          : "WHERE entry < ?1 OR ?1 = 0 ORDER BY entry DESC LIMIT ?2";
    auto rows = database.prepare((std::string{entry_columns} + page).c_str());
    if (!rows) return rows.error();
    rows->bind(1, static_cast<std::int64_t>(after)).bind(2, static_cast<std::int64_t>(limit));
    std::vector<AuditEntry> entries;
    for (;;) {
        auto found = rows->step();
        if (!found) return found.error();
        if (!*found) return entries;
        entries.push_back(entry_of(*rows));
    }
}

Result<AuditCheck> check_audit(sqlite::Database& database) {
    AuditCheck check;
    auto rows = database.prepare((std::string{entry_columns} + "ORDER BY entry").c_str());
    if (!rows) return rows.error();
    for (;;) {
        auto found = rows->step();
        if (!found) return found.error();
        if (!*found) return check;
        const auto entry = entry_of(*rows);
        if (entry.entry != check.entries + 1)
            check.faults.push_back("audit: entry " + std::to_string(check.entries + 1) + " is missing");
        else if (audit_hash(check.last_hash, entry) != entry.hash)
            check.faults.push_back("audit: entry " + std::to_string(entry.entry) + " was changed, or one before it");
        if (!check.faults.empty()) return check;
        check.entries = entry.entry;
        check.last_hash = entry.hash;
    }
}

}  // namespace aeolis::archive
