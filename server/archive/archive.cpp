// SPDX-License-Identifier: Apache-2.0
#include "server/archive/archive.hpp"

#include "server/archive/cluster_facts.hpp"
#include "server/archive/fingerprint.hpp"
#include "server/archive/pruning.hpp"
#include "server/archive/row_writer.hpp"
#include "server/archive/schema.hpp"
#include "server/archive/sqlite.hpp"
#include "server/archive/upkeep.hpp"
#include "server/archive/writer_lock.hpp"

#include <array>
#include <sys/stat.h>

namespace aeolis::archive {

namespace {

// WAL size at which it is checkpointed into the file, and to which it is truncated after a long reader let it grow:
// fewer, longer writes than SQLite's default. Chosen by measurement (bench/archive_bench.cpp).
constexpr std::int64_t log_octets = 16'384'000;

Result<void> set_up_writer(sqlite::Database& database) {
    const auto page = database.integer_of("PRAGMA page_size");
    if (!page) return page.error();
    return database.execute(("PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL; PRAGMA cache_size = -16000; PRAGMA "
                             "wal_autocheckpoint = " +
                             std::to_string(log_octets / *page) +
                             "; PRAGMA journal_size_limit = " + std::to_string(log_octets))
                                .c_str());
}

std::filesystem::path beside(std::filesystem::path file, const char* suffix) {
    return file += suffix;
}

}  // namespace

struct Archive::State {
    State(std::filesystem::path file_in, WriterLock lock_in) : file(std::move(file_in)), lock(std::move(lock_in)) {}

    /// Device and inode behind a name. An open file outlives its name; SQLite would then keep writing where nobody
    /// finds it.
    using Identity = std::optional<std::pair<dev_t, ino_t>>;
    using Identities = std::array<Identity, 3>;  ///< of the file, its WAL and its shared memory
    static Identity identity_of(const std::filesystem::path& file);
    Identities identities() const {
        return {identity_of(file), identity_of(beside(file, "-wal")), identity_of(beside(file, "-shm"))};
    }

    Result<void> connect();
    /// Checks before every write that all three files still have their names.
    Result<void> in_place();
    Result<void> put_back();
    Result<void> mark_interrupted();
    Result<RunId> add_run(const RunStart& start, const dictionary::Dictionary& dictionary);
    Result<void> end_run(RunId run, const RunEnd& end, Sequence last_seq);
    Result<void> add_fingerprint(RunId run, Sequence first, Sequence last);

    std::filesystem::path file;
    WriterLock lock;  // released last
    sqlite::Database database;
    RowWriter rows;
    sqlite::Statement last_key;
    Pruning pruning{database};
    Identities opened;
    bool told_removed = false;
    std::vector<RunId> interrupted;
};

Archive::Archive(std::unique_ptr<State> state) : state_(std::move(state)) {}
Archive::Archive(Archive&&) noexcept = default;
Archive& Archive::operator=(Archive&&) noexcept = default;
Archive::~Archive() = default;

const std::vector<RunId>& Archive::interrupted() const {
    return state_->interrupted;
}
const std::filesystem::path& Archive::file() const {
    return state_->file;
}

Result<Archive> Archive::open(const std::filesystem::path& file) {
    if (std::error_code ignored; std::filesystem::is_directory(file, ignored))
        return Error{file.string() + " is a directory, not an Aeolis archive"};
    auto lock = WriterLock::take(file);
    if (!lock) return lock.error();
    auto state = std::make_unique<State>(file, std::move(lock).value());
    if (auto done = state->connect(); !done) return done.error();
    if (auto done = state->mark_interrupted(); !done) return done.error();
    return Archive(std::move(state));
}

Archive::State::Identity Archive::State::identity_of(const std::filesystem::path& file) {
    struct stat found{};
    if (::stat(file.c_str(), &found) != 0) return std::nullopt;
    return std::pair{found.st_dev, found.st_ino};
}

Result<void> Archive::State::connect() {
    auto fresh = sqlite::Database::open(file.string(), sqlite::Mode::read_write_create);
    if (!fresh) return fresh.error();
    if (auto done = prepare_for_writing(*fresh); !done) return done;
    if (auto done = set_up_writer(*fresh); !done) return done;
    auto row_writer = RowWriter::open(*fresh);
    if (!row_writer) return row_writer.error();
    auto key = fresh->prepare(last_key_sql());
    if (!key) return key.error();
    // The first query creates the WAL and its shared memory.
    if (auto asked = fresh->integer_of("SELECT max(run) FROM runs"); !asked) return asked.error();
    // Statements of an earlier connection must be destroyed before it.
    rows = std::move(*row_writer);
    last_key = std::move(*key);
    database = std::move(*fresh);
    opened = identities();
    return {};
}

Result<void> Archive::State::in_place() {
    const auto now = identities();
    if (now == opened) return {};
    if (now[0] && now[0] != opened[0])
        return Error{
            file.string() +
            " was replaced by another file while it was being written: move that away, and the archive is put back"};
    if (!std::exchange(told_removed, true))
        return Error{(now[0] ? beside(file, now[1] == opened[1] ? "-shm" : "-wal") : file).string() +
                     " was removed while it was being written: the archive is put back from what is open"};
    auto done = put_back();
    if (done) told_removed = false;
    return done;
}

Result<void> Archive::State::put_back() {
    const auto copy = beside(file, "-restored");
    if (auto done = copy_whole(database, copy); !done) return done;
    // A WAL that belongs to another file must not be beside this one.
    std::error_code why;
    for (const char* suffix : {"-wal", "-shm"}) std::filesystem::remove(beside(file, suffix), why);
    std::filesystem::rename(copy, file, why);
    if (why) return Error{file.string() + ": " + why.message()};
    opened = {identity_of(file), std::nullopt, std::nullopt};  // ours, even if the following must be retried
    if (auto done = make_durable(file); !done) return done;
    return connect();
}

Result<void> Archive::State::mark_interrupted() {
    const auto follows = cluster_fact(database, fact_origin);
    if (!follows) return follows.error();
    if (!follows->empty()) return {};  // its runs go on elsewhere
    auto cut_off = database.prepare("SELECT run FROM runs WHERE state = 'running' ORDER BY run");
    if (!cut_off) return cut_off.error();
    for (;;) {
        auto row = cut_off->step();
        if (!row) return row.error();
        if (!*row) break;
        interrupted.push_back({static_cast<std::uint32_t>(cut_off->integer(0))});
    }
    if (interrupted.empty()) return {};
    auto transaction = sqlite::Transaction::begin_write(database);
    if (!transaction) return transaction.error();
    auto mark = database.prepare("UPDATE runs SET state = 'interrupted', last_seq = ?2 WHERE run = ?1");
    if (!mark) return mark.error();
    for (const RunId run : interrupted) {
        last_key.bind(1, item_key(run, 0)).bind(2, item_key(run, sequence_max));
        auto row = last_key.step();
        if (!row) return row.error();
        const Sequence last = last_key.is_null(0) ? 0 : sequence_of(last_key.integer(0));
        last_key.reset();
        mark->bind(1, std::int64_t{run.value}).bind(2, sqlite::number(last));
        if (auto done = mark->run(); !done) return done;
    }
    return transaction->commit();
}

Result<RunId> Archive::begin_run(const RunStart& start, const dictionary::Dictionary& dictionary) {
    if (auto done = state_->in_place(); !done) return done.error();
    auto transaction = sqlite::Transaction::begin_write(state_->database);
    if (!transaction) return transaction.error();
    if (auto done = add_dictionary(state_->database, dictionary); !done) return done.error();
    auto run = state_->add_run(start, dictionary);
    if (!run) return run.error();
    if (auto done = transaction->commit(); !done) return done.error();
    return run;
}

Result<std::map<std::string, std::uint64_t>> Archive::raw_ends(RunId run) {
    auto rows = state_->database.prepare(
        "SELECT link, max(first + length(octets)) FROM raw_octets WHERE run = ? GROUP BY link");
    if (!rows) return rows.error();
    rows->bind(1, std::int64_t{run.value});
    std::map<std::string, std::uint64_t> ends;
    for (;;) {
        auto found = rows->step();
        if (!found) return found.error();
        if (!*found) return ends;
        ends.emplace(rows->text(0), static_cast<std::uint64_t>(rows->integer(1)));
    }
}

Result<void> Archive::continue_run(RunId run) {
    if (auto done = state_->in_place(); !done) return done;
    auto transaction = sqlite::Transaction::begin_write(state_->database);
    if (!transaction) return transaction.error();
    auto row = state_->database.prepare(
        "UPDATE runs SET state = 'running', last_seq = NULL WHERE run = ? AND state = 'interrupted'");
    if (!row) return row.error();
    row->bind(1, std::int64_t{run.value});
    if (auto done = row->run(); !done) return done;
    auto changed = state_->database.integer_of("SELECT changes()");
    if (!changed) return changed.error();
    if (*changed != 1) return Error{"run " + std::to_string(run.value) + " was not cut off"};
    return transaction->commit();
}

Result<RunId> Archive::State::add_run(const RunStart& start, const dictionary::Dictionary& dictionary) {
    auto next = database.integer_of("SELECT max(coalesce((SELECT max(run) FROM runs), 0),"
                                    " coalesce((SELECT max(run) FROM pruned_runs), 0)) + 1");
    if (!next) return next.error();
    const RunId run{static_cast<std::uint32_t>(*next)};
    auto row = database.prepare(
        "INSERT INTO runs (run, scenario, title, venue, seed, case_number, pace, state, outcome, started, start_sclk,"
        " entry_sclk, correlation_sclk, correlation_scet_us, light_time_s, tone_model, dictionary, scenario_text,"
        " clock_version, clock_rate, leap_seconds, forked_run, forked_cycle, forked_e_s, forked_seed)"
        " VALUES (?,?,?,?,?,?,?,'running','running',?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)");
    if (!row) return row.error();
    row->bind(1, *next)
        .bind(2, std::string_view(start.scenario))
        .bind(3, std::string_view(start.title))
        .bind(4, std::string_view(start.venue))
        .bind(5, sqlite::number(start.seed))
        .bind(6, sqlite::number(start.case_number))
        .bind(7, start.pace)
        .bind(8, std::string_view(start.started))
        .bind(9, start.start.seconds)
        .bind(10, start.entry.seconds)
        .bind(11, start.correlation.sclk.seconds)
        .bind(12, start.correlation.scet.microseconds)
        .bind(13, start.light_time_s)
        .bind(14, std::string_view(start.tone_model))
        .bind(15, std::int64_t{dictionary.id})
        .bind(16, std::string_view(start.scenario_text))
        .bind(17, std::int64_t{start.correlation.version})
        .bind(18, start.correlation.rate)
        .bind(19, std::int64_t{start.correlation.leap_seconds});
    if (const auto& fork = start.forked_from)
        row->bind(20, std::int64_t{fork->run.value})
            .bind(21, sqlite::number(fork->cycle))
            .bind(22, fork->e_s)
            .bind(23, sqlite::number(fork->seed));
    if (auto done = row->run(); !done) return done.error();
    auto anchor = database.prepare("INSERT INTO run_anchors VALUES (?,?,?,?)");
    if (!anchor) return anchor.error();
    for (std::size_t i = 0; i < dictionary.anchors.size(); ++i) {
        anchor->bind(1, *next).bind(2, sqlite::number(i)).bind(3, std::string_view(dictionary.anchors[i].name));
        if (const auto predicted =
                i < dictionary.predicted_anchor_e_s.size() ? dictionary.predicted_anchor_e_s[i] : std::nullopt)
            anchor->bind(4, *predicted);
        else
            anchor->bind_null(4);
        if (auto done = anchor->run(); !done) return done.error();
    }
    auto solution = database.prepare("INSERT INTO run_solution VALUES (?,?,?,?)");
    if (!solution) return solution.error();
    std::int64_t position = 0;
    for (const auto& [name, value] : start.solution) {
        solution->bind(1, *next).bind(2, position++).bind(3, std::string_view(name)).bind(4, value);
        if (auto done = solution->run(); !done) return done.error();
    }
    return run;
}

Result<void> Archive::append(RunId run, const Batch& batch) {
    AEOLIS_CHECK(batch.last_seq <= sequence_max);
    if (auto done = state_->in_place(); !done) return done;
    auto transaction = sqlite::Transaction::begin_write(state_->database);
    if (!transaction) return transaction.error();
    if (auto done = state_->rows.write(run, batch); !done) return done;
    if (batch.end)
        if (auto done = state_->end_run(run, *batch.end, batch.last_seq); !done) return done;
    return transaction->commit();
}

Result<void> Archive::append_audit(std::span<const AuditRecord> records) {
    if (auto done = state_->in_place(); !done) return done;
    auto transaction = sqlite::Transaction::begin_write(state_->database);
    if (!transaction) return transaction.error();
    if (auto done = archive::append_audit(state_->database, records); !done) return done;
    return transaction->commit();
}

Result<AuditHead> Archive::audit_head() {
    return archive::audit_head(state_->database);
}

Result<void> Archive::prune(RunId run, AuditRecord by) {
    if (auto done = state_->in_place(); !done) return done;
    auto transaction = sqlite::Transaction::begin_write(state_->database);
    if (!transaction) return transaction.error();
    if (auto done = mark_pruned(state_->database, {&run, 1}, std::move(by)); !done) return done;
    state_->pruning = Pruning{state_->database};  // it looks again which runs are marked
    return transaction->commit();
}

Result<bool> Archive::remove_pruned() {
    if (state_->identities() != state_->opened) return true;  // the next batch tells of it, and puts the file back
    return state_->pruning.step();
}

Result<std::uint64_t> Archive::keep_forecast(const ForecastRecord& forecast) {
    if (auto done = state_->in_place(); !done) return done.error();
    auto transaction = sqlite::Transaction::begin_write(state_->database);
    if (!transaction) return transaction.error();
    auto number = archive::keep_forecast(state_->database, forecast);
    if (!number) return number;
    if (auto done = transaction->commit(); !done) return done.error();
    return number;
}

Result<LayoutOutcome> Archive::change_layout(const LayoutChange& change) {
    if (auto done = state_->in_place(); !done) return done.error();
    auto transaction = sqlite::Transaction::begin_write(state_->database);
    if (!transaction) return transaction.error();
    auto outcome = archive::change_layout(state_->database, change);
    if (!outcome) return outcome;
    if (auto done = transaction->commit(); !done) return done.error();
    return outcome;
}

Result<Annotation> Archive::annotate(RunId run, Annotation annotation) {
    if (auto done = state_->in_place(); !done) return done.error();
    auto transaction = sqlite::Transaction::begin_write(state_->database);
    if (!transaction) return transaction.error();
    auto& last_key = state_->last_key;
    last_key.bind(1, item_key(run, 0)).bind(2, item_key(run, sequence_max));
    auto found = last_key.step();
    if (!found) return found.error();
    const Sequence seq = last_key.is_null(0) ? 1 : sequence_of(last_key.integer(0)) + 1;
    last_key.reset();
    std::visit([seq](auto& record) { record.seq = seq; }, annotation);
    Batch batch;
    batch.first_seq = batch.last_seq = seq;
    batch.add(annotation);
    if (auto done = state_->rows.write(run, batch); !done) return done.error();
    auto row =
        state_->database.prepare("UPDATE runs SET last_seq = ?2 WHERE run = ?1 AND state <> 'running' RETURNING state");
    if (!row) return row.error();
    row->bind(1, std::int64_t{run.value}).bind(2, sqlite::number(seq));
    auto updated = row->step();
    if (!updated) return updated.error();
    if (!*updated) return Error{"run " + std::to_string(run.value) + ": there is none that is over"};
    const bool ended = row->text(0) == "finished";
    row->reset();
    if (ended)  // else it gets its fingerprint when it has been continued and ends
        if (auto done = state_->add_fingerprint(run, seq, seq); !done) return done.error();
    if (auto done = transaction->commit(); !done) return done.error();
    return annotation;
}

Result<void> Archive::State::end_run(RunId run, const RunEnd& end, Sequence last_seq) {
    last_key.bind(1, item_key(run, 0)).bind(2, item_key(run, sequence_max));
    auto found = last_key.step();
    if (!found) return found.error();
    const Sequence stored = last_key.is_null(0) ? 0 : sequence_of(last_key.integer(0));
    last_key.reset();
    auto row = database.prepare("UPDATE runs SET state = 'finished', outcome = ?2, outcome_reason = ?3, digest = ?4,"
                                " ended = ?5, last_seq = ?6 WHERE run = ?1");
    if (!row) return row.error();
    row->bind(1, std::int64_t{run.value})
        .bind(2, std::string_view(name_of(end.outcome)))
        .bind(3, std::string_view(end.reason))
        .bind(4, std::string_view(end.digest))
        .bind(5, std::string_view(end.ended))
        .bind(6, sqlite::number(std::max(stored, last_seq)));
    if (auto done = row->run(); !done) return done;
    return add_fingerprint(run, 1, std::max(stored, last_seq));
}

Result<void> Archive::State::add_fingerprint(RunId run, Sequence first, Sequence last) {
    const auto record = fingerprint(database, run, first, last);
    if (!record) return record.error();
    return archive::append_audit(database, {&*record, 1});
}

}  // namespace aeolis::archive
