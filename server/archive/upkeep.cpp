// SPDX-License-Identifier: Apache-2.0
#include "server/archive/upkeep.hpp"

#include "server/archive/archive.hpp"
#include "server/archive/item_keys.hpp"
#include "server/archive/pruning.hpp"
#include "server/archive/schema.hpp"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <unistd.h>

namespace aeolis::archive {

std::optional<std::string> open_to_others(const std::filesystem::path& file) {
    using std::filesystem::perms;
    std::error_code error;
    const auto mode = std::filesystem::status(file, error).permissions();
    if (error || (mode & (perms::group_all | perms::others_all)) == perms::none) return std::nullopt;
    return file.string() + " may be read or written by others than its owner: chmod 600 " + file.string() +
           "*, unless that is wanted";
}

Result<void> make_durable(const std::filesystem::path& file) {
    const auto folder = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
    for (const auto& each : {file, folder}) {
        const int descriptor = ::open(each.c_str(), O_RDONLY | O_CLOEXEC);
        const bool done = descriptor >= 0 && ::fsync(descriptor) == 0;
        const int why = errno;
        if (descriptor >= 0) ::close(descriptor);
        if (!done) return Error{each.string() + ": " + std::strerror(why)};
    }
    return {};
}

Result<Maintenance> Maintenance::open(const std::filesystem::path& file) {
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) return Error{file.string() + ": there is no such file"};
    // Opened as a writer first: that refuses other files and marks runs that were cut off.
    if (auto opened = Archive::open(file); !opened) return opened.error();
    auto lock = WriterLock::take(file);
    if (!lock) return lock.error();
    auto database = sqlite::Database::open(file.string(), sqlite::Mode::read_write_create);
    if (!database) return database.error();
    if (auto done = database->execute("PRAGMA synchronous = FULL"); !done) return done.error();
    return Maintenance(std::move(lock).value(), std::move(database).value());
}

Result<std::vector<RunLine>> run_lines(sqlite::Database& database) {
    auto rows =
        database.prepare("SELECT run, scenario, state, outcome, started, (SELECT count(*) FROM packets u"
                         " WHERE u.key BETWEEN r.run << 40 AND r.run << 40 | 0xFFFFFFFFFF) FROM runs r ORDER BY run");
    if (!rows) return rows.error();
    std::vector<RunLine> lines;
    for (;;) {
        auto found = rows->step();
        if (!found) return found.error();
        if (!*found) return lines;
        lines.push_back({RunId{static_cast<std::uint32_t>(rows->integer(0))}, std::string(rows->text(1)),
                         std::string(rows->text(2)), std::string(rows->text(3)), std::string(rows->text(4)),
                         static_cast<std::uint64_t>(rows->integer(5))});
    }
}

Result<void> prune(Maintenance& archive, const std::vector<RunId>& runs, AuditRecord by) {
    auto& database = archive.database();
    auto transaction = sqlite::Transaction::begin_write(database);
    if (!transaction) return transaction.error();
    if (auto done = mark_pruned(database, runs, std::move(by)); !done) return done;
    if (auto done = transaction->commit(); !done) return done;
    Pruning pruning{database};
    for (;;) {
        auto more = pruning.step();
        if (!more) return more.error();
        if (!*more) return database.execute("PRAGMA wal_checkpoint(TRUNCATE)");
    }
}

Result<void> vacuum(Maintenance& archive) {
    if (auto done = archive.database().execute("VACUUM"); !done) return done;
    return archive.database().execute("PRAGMA wal_checkpoint(TRUNCATE)");
}

Result<void> backup(const std::filesystem::path& file, const std::filesystem::path& copy) {
    std::error_code ignored;
    if (std::filesystem::exists(copy, ignored))
        return Error{copy.string() + " is there already: nothing is overwritten"};
    auto source = sqlite::Database::open(file.string(), sqlite::Mode::read_only);
    if (!source) return source.error();
    if (auto ours = check_for_reading(*source); !ours) return ours;
    auto partial = copy;
    partial += "-partial";
    auto done = copy_whole(*source, partial);
    if (done) {
        std::error_code why;
        std::filesystem::rename(partial, copy, why);
        done = why ? Result<void>(Error{copy.string() + ": " + why.message()}) : make_durable(copy);
    }
    if (!done) std::filesystem::remove(partial, ignored);
    return done;
}

Result<void> copy_whole(const sqlite::Database& source, const std::filesystem::path& into) {
    std::error_code ignored;
    std::filesystem::remove(into, ignored);
    const auto copied = [&]() -> Result<void> {
        auto target = sqlite::Database::open(into.string(), sqlite::Mode::read_write_create);
        if (!target) return target.error();
        if (auto done = source.copy_to(*target); !done) return done;
        // No WAL: the copy is a single file that can be moved.
        return target->execute("PRAGMA journal_mode = DELETE");
    }();
    auto done = copied ? make_durable(into) : copied;
    if (!done) std::filesystem::remove(into, ignored);
    return done;
}

Result<std::vector<std::string>> integrity_faults(sqlite::Database& database) {
    auto rows = database.prepare("PRAGMA integrity_check(20)");
    if (!rows) return rows.error();
    std::vector<std::string> faults;
    for (;;) {
        auto found = rows->step();
        if (!found) return found.error();
        if (!*found) return faults;
        if (rows->text(0) != "ok") faults.emplace_back(rows->text(0));
    }
}

Result<std::vector<std::string>> sequence_faults(sqlite::Database& database, RunId run, const std::string& schema,
                                                 std::size_t most) {
    const std::string sql =
        "SELECT before, key FROM (SELECT lag(key, 1, ?1) OVER (ORDER BY key) AS before, key FROM (" +
        item_keys_sql(schema) + ")) WHERE key <> before + 1 LIMIT ?3";
    auto rows = database.prepare(sql.c_str());
    if (!rows) return rows.error();
    rows->bind(1, item_key(run, 0)).bind(2, item_key(run, sequence_max)).bind(3, static_cast<std::int64_t>(most));
    std::vector<std::string> faults;
    const auto of_run = "run " + std::to_string(run.value) + ": ";
    for (;;) {
        auto found = rows->step();
        if (!found) return found.error();
        if (!*found) break;
        const Sequence before = sequence_of(rows->integer(0)), next = sequence_of(rows->integer(1));
        if (before == next)
            faults.push_back(of_run + "two items have the number " + std::to_string(next));
        else
            faults.push_back(of_run + "no item has the number" + (next == before + 2 ? " " : "s ") +
                             std::to_string(before + 1) +
                             (next == before + 2 ? "" : " to " + std::to_string(next - 1)));
    }
    auto last = database.prepare(("SELECT last_seq, (SELECT max(key) FROM (" + item_keys_sql(schema) + ")) FROM " +
                                  schema + "runs WHERE run = ?3 AND last_seq IS NOT NULL")
                                     .c_str());
    if (!last) return last.error();
    last->bind(1, item_key(run, 0)).bind(2, item_key(run, sequence_max)).bind(3, std::int64_t{run.value});
    auto found = last->step();
    if (!found) return found.error();
    if (*found) {
        const auto noted = static_cast<Sequence>(last->integer(0)),
                   stored = last->is_null(1) ? 0 : sequence_of(last->integer(1));
        if (noted != stored)
            faults.push_back(of_run + "its last item should be " + std::to_string(noted) + ", and is " +
                             std::to_string(stored));
    }
    return faults;
}

}  // namespace aeolis::archive
