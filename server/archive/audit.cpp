// SPDX-License-Identifier: Apache-2.0
#include "server/archive/audit.hpp"

#include "server/base/digest.hpp"

#include <cerrno>
#include <charconv>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <unistd.h>

namespace aeolis::archive {
namespace {

constexpr std::size_t hash_digits = 64;
constexpr mode_t owner_only = 0600;
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
    server::Digest digest;
    digest.add({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
    return digest.text();
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

Result<AuditHead> audit_head(sqlite::Database& database) {
    auto last = database.prepare("SELECT entry, hash FROM audit ORDER BY entry DESC LIMIT 1");
    if (!last) return last.error();
    auto found = last->step();
    if (!found) return found.error();
    if (!*found) return AuditHead{};
    return AuditHead{static_cast<std::uint64_t>(last->integer(0)), std::string(last->text(1))};
}

std::string text_of(const AuditHead& head) {
    return std::to_string(head.entry) + ':' + head.hash;
}

std::optional<AuditHead> head_from_text(std::string_view text) {
    AuditHead head;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), head.entry);
    const auto rest = text.substr(static_cast<std::size_t>(end - text.data()));
    if (error != std::errc{} || head.entry == 0 || !rest.starts_with(':')) return std::nullopt;
    head.hash = rest.substr(1);
    if (head.hash.size() != hash_digits || head.hash.find_first_not_of("0123456789abcdef") != std::string::npos)
        return std::nullopt;
    return head;
}

Result<std::optional<std::string>> head_fault(sqlite::Database& database, const AuditHead& known) {
    if (known.entry == 0) return std::optional<std::string>{};
    auto entry = database.prepare("SELECT hash FROM audit WHERE entry = ?1");
    if (!entry) return entry.error();
    entry->bind(1, static_cast<std::int64_t>(known.entry));
    auto found = entry->step();
    if (!found) return found.error();
    if (*found && entry->text(0) == known.hash) return std::optional<std::string>{};
    const auto named = "audit: entry " + std::to_string(known.entry);
    if (*found) return std::optional{named + " is not the one that was known to be there"};
    const auto last = audit_head(database);
    if (!last) return last.error();
    return std::optional{named + " was known to be there, and is gone: " +
                         (last->entry == 0 ? "the audit is empty" : "the last is " + std::to_string(last->entry))};
}

Result<void> write_head(const std::filesystem::path& file, const AuditHead& head) {
    auto partial = file;
    partial += "-partial";
    const auto text = text_of(head) + "\n";
    const auto failed = [&] { return Error{file.string() + ": " + std::strerror(errno)}; };
    const int out = ::open(partial.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, owner_only);
    if (out < 0) return failed();
    const bool written = ::write(out, text.data(), text.size()) == static_cast<ssize_t>(text.size());
    const auto why = failed();
    ::close(out);
    if (!written) return why;
    return ::rename(partial.c_str(), file.c_str()) == 0 ? Result<void>{} : failed();
}

Result<std::optional<AuditHead>> read_head(const std::filesystem::path& file) {
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) return std::optional<AuditHead>{};
    std::ifstream in{file};
    std::string line;
    std::getline(in, line);
    const auto head = head_from_text(line);
    if (!head) return Error{file.string() + ": not the head of an audit, ENTRY:HASH"};
    return head;
}

std::filesystem::path head_file(const std::filesystem::path& archive, const std::filesystem::path& folder) {
    auto name = archive.filename();
    name += "-audit";
    return folder / name;
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
