// SPDX-License-Identifier: Apache-2.0
#include "server/archive/run_rows.hpp"

#include "server/archive/cluster_facts.hpp"
#include "server/archive/item_keys.hpp"
#include "server/archive/item_rows.hpp"
#include "server/archive/row_codec.hpp"
#include "server/archive/schema.hpp"
#include "server/base/digest.hpp"

#include <algorithm>
#include <zstd.h>

namespace aeolis::archive {
namespace {

/// By what the first column of a table tells that a row is the step's own.
enum class KnownBy : std::uint8_t {
    item,        ///< item_key()
    segment,     ///< number of a segment
    of_segment,  ///< column_key() of a segment
    of_block,    ///< column_key() of a block
    run,
    dictionary,
    word  ///< a word of the archive, not of a run
};
enum class Again : std::uint8_t { kept, replaced };  ///< what becomes of a row that is there already

struct CopiedTable {
    std::string name;
    KnownBy by{};
    Again again{};
};

/// All that a step may hold, in the order in which it is written.
const std::vector<CopiedTable>& copied_tables() {
    static const std::vector<CopiedTable> all = [] {
        std::vector<CopiedTable> tables{{"words", KnownBy::word, Again::kept},
                                        {"dictionaries", KnownBy::dictionary, Again::kept},
                                        {"dictionary_channels", KnownBy::dictionary, Again::kept},
                                        {"dictionary_packets", KnownBy::dictionary, Again::kept},
                                        {"runs", KnownBy::run, Again::replaced},
                                        {"run_solution", KnownBy::run, Again::kept},
                                        {"run_anchors", KnownBy::run, Again::kept}};
        for_item_kinds([&]<typename Record>(ItemKind<Record>) {
            tables.push_back({ItemTable<Record>::name, KnownBy::item, Again::kept});
            if constexpr (HasParts<Record>)
                tables.push_back({PartTable<PartOf<Record>>::name, KnownBy::item, Again::kept});
        });
        for (const auto& table :
             {CopiedTable{"segments", KnownBy::segment, Again::kept},
              CopiedTable{"segment_columns", KnownBy::of_segment, Again::kept},
              CopiedTable{"pyramid", KnownBy::run, Again::kept},
              CopiedTable{"pyramid_columns", KnownBy::of_block, Again::kept},
              CopiedTable{"requests", KnownBy::run, Again::kept}, CopiedTable{"raw_octets", KnownBy::run, Again::kept},
              CopiedTable{"recordings", KnownBy::run, Again::replaced},
              CopiedTable{"link_totals", KnownBy::run, Again::replaced},
              CopiedTable{"sequence_totals", KnownBy::run, Again::replaced}})
            tables.push_back(table);
        return tables;
    }();
    return all;
}

Result<std::optional<std::int64_t>> single_integer(sqlite::Statement& row) {
    auto found = row.step();
    if (!found) return found.error();
    if (!*found || row.is_null(0)) {
        row.reset();
        return std::optional<std::int64_t>{};
    }
    const auto value = row.integer(0);
    row.reset();
    return std::optional{value};
}

std::uint64_t count_of(std::optional<std::int64_t> last) {
    return last ? static_cast<std::uint64_t>(*last) + 1 : 0;
}

constexpr char end_of_segments_sql[] = "SELECT max(segment) - ?1 FROM segments WHERE segment BETWEEN ?1 AND ?2";
constexpr char end_of_blocks_sql[] =
    "SELECT max(key) / 65536 - ?1 FROM pyramid_columns WHERE key BETWEEN ?1 * 65536 AND ?2 * 65536 + 65535";
constexpr char last_request_sql[] = "SELECT max(position) FROM requests WHERE run = ?1";
constexpr char next_link_sql[] = "SELECT min(link) FROM raw_octets WHERE run = ?1 AND link > ?2";
constexpr char raw_end_sql[] = "SELECT first + length(octets) FROM raw_octets WHERE run = ?1 AND link = ?2"
                               " ORDER BY first DESC LIMIT 1";
constexpr char raw_begin_sql[] = "SELECT min(first) FROM raw_octets WHERE run = ?1 AND link = ?2";

/// The links of which octets are kept, by seeks: their rows are large.
Result<std::vector<std::string>> links_with_octets(sqlite::Statement& next_link, RunId run) {
    std::vector<std::string> links;
    for (std::string last;; last = links.back()) {
        next_link.bind(1, std::int64_t{run.value}).bind(2, std::string_view{last});
        auto found = next_link.step();
        if (!found) return found.error();
        const bool more = *found && !next_link.is_null(0);
        if (more) links.emplace_back(next_link.text(0));
        next_link.reset();
        if (!more) return links;
    }
}

}  // namespace

bool within(const v1::RunPosition& part, const v1::RunPosition& whole) {
    return part.seq() <= whole.seq() && part.segments() <= whole.segments() && part.blocks() <= whole.blocks() &&
           part.requests() <= whole.requests() && std::ranges::all_of(part.raw(), [&](const auto& link) {
               const auto found = whole.raw().find(link.first);
               return found != whole.raw().end() && link.second <= found->second;
           });
}

bool equal(const v1::RunPosition& one, const v1::RunPosition& other) {
    return within(one, other) && within(other, one);
}

v1::RunPosition merged(const v1::RunPosition& one, const v1::RunPosition& other) {
    v1::RunPosition both = one;
    both.set_seq(std::max(one.seq(), other.seq()));
    both.set_segments(std::max(one.segments(), other.segments()));
    both.set_blocks(std::max(one.blocks(), other.blocks()));
    both.set_requests(std::max(one.requests(), other.requests()));
    for (const auto& [link, end] : other.raw()) {
        auto& known = (*both.mutable_raw())[link];
        known = std::max(known, end);
    }
    return both;
}

Result<v1::RunPosition> position_of(sqlite::Database& database, RunId run) {
    v1::RunPosition position;
    const auto last = [&](const char* sql, std::int64_t first,
                          std::int64_t end) -> Result<std::optional<std::int64_t>> {
        auto row = database.prepare(sql);
        if (!row) return row.error();
        return single_integer(row->bind(1, first).bind(2, end));
    };
    const auto key = last(last_key_sql(), item_key(run, 0), item_key(run, sequence_max));
    if (!key) return key.error();
    position.set_seq(*key ? sequence_of(**key) : 0);
    const auto first_number = segment_key(run, 0), last_number = segment_key(run, segments_max - 1);
    const auto segment = last(end_of_segments_sql, first_number, last_number);
    if (!segment) return segment.error();
    position.set_segments(count_of(*segment));
    const auto block = last(end_of_blocks_sql, first_number, last_number);
    if (!block) return block.error();
    position.set_blocks(count_of(*block));
    auto requests = database.prepare(last_request_sql);
    auto next_link = database.prepare(next_link_sql);
    auto raw_end = database.prepare(raw_end_sql);
    for (const auto* statement : {&requests, &next_link, &raw_end})
        if (!*statement) return statement->error();
    const auto request = single_integer(requests->bind(1, std::int64_t{run.value}));
    if (!request) return request.error();
    position.set_requests(static_cast<std::uint64_t>(request->value_or(0)));
    const auto links = links_with_octets(*next_link, run);
    if (!links) return links.error();
    for (const auto& link : *links) {
        const auto end = single_integer(raw_end->bind(1, std::int64_t{run.value}).bind(2, std::string_view{link}));
        if (!end) return end.error();
        (*position.mutable_raw())[link] = static_cast<std::uint64_t>(end->value_or(0));
    }
    return position;
}

Result<std::string> tables_digest(sqlite::Database& database) {
    auto row = database.prepare("SELECT sql FROM sqlite_schema WHERE type = 'table' AND name = ?");
    if (!row) return row.error();
    server::Digest digest;
    for (const auto& table : copied_tables()) {
        row->bind(1, std::string_view{table.name});
        auto found = row->step();
        if (!found) return found.error();
        const std::string sql = *found ? std::string{row->text(0)} : "";
        row->reset();
        digest.add({reinterpret_cast<const std::uint8_t*>(sql.data()), sql.size()});
    }
    constexpr std::size_t digits = 16;
    return digest.text().substr(0, digits);
}

std::string packed(const v1::RowSet& rows) {
    constexpr int level = 1;  // measured, decision 0042: higher ones cost more processor time than they save octets
    const auto octets = rows.SerializeAsString();
    std::string packed(ZSTD_compressBound(octets.size()), '\0');
    const std::size_t size = ZSTD_compress(packed.data(), packed.size(), octets.data(), octets.size(), level);
    AEOLIS_CHECK(ZSTD_isError(size) == 0);  // the buffer suffices
    packed.resize(size);
    return packed;
}

Result<v1::RowSet> unpacked(const std::string& octets) {
    const auto size = ZSTD_getFrameContentSize(octets.data(), octets.size());
    if (size == ZSTD_CONTENTSIZE_ERROR || size == ZSTD_CONTENTSIZE_UNKNOWN || size > row_set_octets_max)
        return Error{"these are no rows of a run"};
    std::string whole(static_cast<std::size_t>(size), '\0');
    v1::RowSet rows;
    if (ZSTD_decompress(whole.data(), whole.size(), octets.data(), octets.size()) != whole.size() ||
        !rows.ParseFromString(whole))
        return Error{"these are no rows of a run"};
    return rows;
}

struct RunRowsReader::State {
    sqlite::Database database;
    std::string tables;
    std::int64_t version = -1;
    std::map<std::string, sqlite::Statement> statements;
    std::map<std::uint32_t, std::string> replaced;  // rows that change, as the run's last step had them

    Result<sqlite::Statement*> statement(const std::string& sql) {
        auto found = statements.find(sql);
        if (found == statements.end()) {
            auto prepared = database.prepare(sql.c_str());
            if (!prepared) return prepared.error();
            found = statements.emplace(sql, std::move(*prepared)).first;
        }
        return &found->second;
    }

    /// Adds all rows of a statement that is bound, until `last` says of one that it is the last.
    template <typename Last>
    Result<std::uint32_t> add(sqlite::Statement& row, const std::string& table, v1::RowSet& rows, Last last) {
        v1::TableRows added;
        for (;;) {
            auto found = row.step();
            if (!found) return found.error();
            if (!*found) break;
            append_row(row, *added.mutable_values());
            added.set_rows(added.rows() + 1);
            if (!last(row)) continue;
            row.reset();
            break;
        }
        const auto count = added.rows();
        if (count > 0) {
            added.set_table(table);
            *rows.add_tables() = std::move(added);
        }
        return count;
    }
    using Values = std::initializer_list<std::int64_t>;  ///< of a statement's parameters
    Result<sqlite::Statement*> bound(const std::string& sql, Values values) {
        auto row = statement(sql);
        if (!row) return row.error();
        int parameter = 1;
        for (const auto value : values) (*row)->bind(parameter++, value);
        return row;
    }
    Result<std::uint32_t> add(const std::string& sql, const std::string& table, Values values, v1::RowSet& rows) {
        auto row = bound(sql, values);
        if (!row) return row.error();
        return add(**row, table, rows, [](const auto&) { return false; });
    }
    Result<std::optional<std::int64_t>> integer(const std::string& sql, Values values) {
        auto row = bound(sql, values);
        if (!row) return row.error();
        return single_integer(**row);
    }

    Result<Sequence> add_packets(RunId run, Sequence first, Sequence last, v1::RowSet& rows);
    Result<void> add_items(RunId run, RunStep& step, Sequence last);
    Result<bool> add_segments(RunId run, RunStep& step, bool all_items);
    Result<bool> add_blocks(RunId run, RunStep& step);
    Result<void> add_requests(RunId run, RunStep& step);
    Result<bool> add_raw(RunId run, RunStep& step);
    Result<void> add_replaced(RunId run, bool counters, RunStep& step);
};

RunRowsReader::RunRowsReader(std::unique_ptr<State> state) : state_(std::move(state)) {}
RunRowsReader::RunRowsReader(RunRowsReader&&) noexcept = default;
RunRowsReader& RunRowsReader::operator=(RunRowsReader&&) noexcept = default;
RunRowsReader::~RunRowsReader() = default;

Result<RunRowsReader> RunRowsReader::open(const std::filesystem::path& file) {
    auto state = std::make_unique<State>();
    auto database = sqlite::Database::open(file.string(), sqlite::Mode::read_only);
    if (!database) return database.error();
    if (auto ours = check_for_reading(*database); !ours) return ours.error();
    auto tables = tables_digest(*database);
    if (!tables) return tables.error();
    state->database = std::move(*database);
    state->tables = std::move(*tables);
    return RunRowsReader{std::move(state)};
}

const std::string& RunRowsReader::tables() const {
    return state_->tables;
}

Result<std::string> RunRowsReader::origin() {
    return origin_of_runs(state_->database);
}

Result<bool> RunRowsReader::changed() {
    auto row = state_->statement("PRAGMA data_version");
    if (!row) return row.error();
    const auto version = single_integer(**row);
    if (!version) return version.error();
    const auto before = std::exchange(state_->version, version->value_or(0));
    return before != state_->version;
}

Result<std::uint32_t> RunRowsReader::newest_run() {
    auto row = state_->statement("SELECT max(run) FROM runs");
    if (!row) return row.error();
    const auto run = single_integer(**row);
    if (!run) return run.error();
    return static_cast<std::uint32_t>(run->value_or(0));
}

Result<std::vector<RunHead>> RunRowsReader::runs() {
    auto rows = state_->statement("SELECT run, state, coalesce(last_seq, 0), dictionary FROM runs ORDER BY run DESC");
    if (!rows) return rows.error();
    std::vector<RunHead> runs;
    for (auto& row = **rows;;) {
        auto found = row.step();
        if (!found) return found.error();
        if (!*found) return runs;
        runs.push_back({RunId{static_cast<std::uint32_t>(row.integer(0))}, std::string(row.text(1)),
                        static_cast<Sequence>(row.integer(2)), static_cast<std::uint16_t>(row.integer(3))});
    }
}

Result<std::optional<RunHead>> RunRowsReader::run(RunId run) {
    auto rows = state_->statement("SELECT state, dictionary FROM runs WHERE run = ?");
    if (!rows) return rows.error();
    auto& row = **rows;
    row.bind(1, std::int64_t{run.value});
    auto found = row.step();
    if (!found) return found.error();
    if (!*found) return std::optional<RunHead>{};
    RunHead stored{run, std::string(row.text(0)), 0, static_cast<std::uint16_t>(row.integer(1))};
    row.reset();
    const auto key = state_->integer(last_key_sql(), {item_key(run, 0), item_key(run, sequence_max)});
    if (!key) return key.error();
    stored.last_seq = *key ? sequence_of(**key) : 0;
    return std::optional{std::move(stored)};
}

/// Packets from `first` on, to `last` or until they fill a step. @return the last item up to which all can be added
Result<Sequence> RunRowsReader::State::add_packets(RunId run, Sequence first, Sequence last, v1::RowSet& rows) {
    static const std::string sql = "SELECT * FROM packets WHERE key BETWEEN ?1 AND ?2 ORDER BY key";
    static const int sampled_column = [] {
        const auto columns = columns_of<ItemTable, PacketRecord>();
        const auto found = std::ranges::find(columns, "sampled", &ColumnText::name);
        return 2 + static_cast<int>(found - columns.begin());
    }();
    auto row = statement(sql);
    if (!row) return row.error();
    (*row)->bind(1, item_key(run, first)).bind(2, item_key(run, last));
    Sequence end = last, newest = 0;
    std::size_t octets = 0;
    const auto added = add(**row, "packets", rows, [&](const sqlite::Statement& unit) {
        newest = sequence_of(unit.integer(0)) + (unit.integer(sampled_column) != 0 ? 1 : 0);
        octets += unit.octets(unit.columns() - 1).size();
        if (octets < octets_max) return false;
        end = newest;
        return true;
    });
    if (!added) return added.error();
    return std::max(end, newest);  // the sample of the last packet goes with it
}

Result<void> RunRowsReader::State::add_items(RunId run, RunStep& step, Sequence last) {
    const Sequence first = step.before.seq() + 1;
    if (first > last) return {};
    const auto end = add_packets(run, first, std::min(last, first + items_max - 1), step.rows);
    if (!end) return end.error();
    const auto first_key = item_key(run, first), last_key = item_key(run, *end);
    auto done = try_item_kinds([&]<typename Record>(ItemKind<Record>) -> Result<void> {
        if constexpr (!std::is_same_v<Record, PacketRecord>) {
            static const std::string sql =
                std::string("SELECT * FROM ") + ItemTable<Record>::name + " WHERE key BETWEEN ?1 AND ?2 ORDER BY key";
            if (auto added = add(sql, ItemTable<Record>::name, {first_key, last_key}, step.rows); !added)
                return added.error();
        }
        if constexpr (HasParts<Record>) {
            using Parts = PartTable<PartOf<Record>>;
            static const std::string sql =
                std::string("SELECT * FROM ") + Parts::name + " WHERE key BETWEEN ?1 AND ?2 ORDER BY key, position";
            if (auto added = add(sql, Parts::name, {first_key, last_key}, step.rows); !added) return added.error();
        }
        return {};
    });
    if (done) step.after.set_seq(*end);
    return done;
}

/// Segments of packets that have been added. True: all that there are.
Result<bool> RunRowsReader::State::add_segments(RunId run, RunStep& step, bool all_items) {
    static const std::string next = "SELECT last_packet FROM segments WHERE segment = ?1";
    static const std::string segment_sql = "SELECT * FROM segments WHERE segment = ?1";
    static const std::string columns_sql = "SELECT * FROM segment_columns WHERE key BETWEEN ?1 AND ?2 ORDER BY key";
    for (auto number = step.before.segments();; ++number) {
        const auto key = segment_key(run, static_cast<std::int64_t>(number));
        const auto last_packet = integer(next, {key});
        if (!last_packet) return last_packet.error();
        if (!*last_packet) return true;
        if (!all_items && static_cast<Sequence>(**last_packet) > step.after.seq()) return false;
        if (step.rows.ByteSizeLong() > octets_max) return false;
        if (auto added = add(segment_sql, "segments", {key}, step.rows); !added) return added.error();
        if (auto added = add(columns_sql, "segment_columns", {key * 65'536, key * 65'536 + 65'535}, step.rows); !added)
            return added.error();
        step.after.set_segments(number + 1);
    }
}

/// Blocks of the pyramid, once all segments below them are there. True: all that there are.
Result<bool> RunRowsReader::State::add_blocks(RunId run, RunStep& step) {
    static const std::string block_sql = "SELECT * FROM pyramid WHERE run = ?1 AND block = ?2";
    static const std::string columns_sql = "SELECT * FROM pyramid_columns WHERE key BETWEEN ?1 AND ?2 ORDER BY key";
    const auto last = integer(end_of_blocks_sql, {segment_key(run, 0), segment_key(run, segments_max - 1)});
    if (!last) return last.error();
    for (auto number = step.before.blocks(); number < count_of(*last); ++number) {
        if (step.rows.ByteSizeLong() > octets_max) return false;
        const auto key = segment_key(run, static_cast<std::int64_t>(number));
        if (auto added = add(block_sql, "pyramid", {run.value, key}, step.rows); !added) return added.error();
        if (auto added = add(columns_sql, "pyramid_columns", {key * 65'536, key * 65'536 + 65'535}, step.rows); !added)
            return added.error();
        step.after.set_blocks(number + 1);
    }
    return true;
}

Result<void> RunRowsReader::State::add_requests(RunId run, RunStep& step) {
    static const std::string sql = "SELECT * FROM requests WHERE run = ?1 AND position > ?2 ORDER BY position";
    const auto added = add(sql, "requests", {run.value, static_cast<std::int64_t>(step.before.requests())}, step.rows);
    if (!added) return added.error();
    step.after.set_requests(step.before.requests() + *added);
    return {};
}

/// Octets of links as they came. True: all that there are.
Result<bool> RunRowsReader::State::add_raw(RunId run, RunStep& step) {
    static const std::string sql = "SELECT * FROM raw_octets WHERE run = ?1 AND link = ?2 AND first >= ?3";
    auto next_link = statement(next_link_sql);
    auto rows = statement(sql);
    auto begin = statement(raw_begin_sql);
    for (const auto* each : {&next_link, &rows, &begin})
        if (!*each) return each->error();
    const auto links = links_with_octets(**next_link, run);
    if (!links) return links.error();
    constexpr int first_column = 2, octets_column = 4;
    std::size_t octets = 0;
    for (const auto& link : *links) {
        if (octets + step.rows.ByteSizeLong() > octets_max) return false;
        auto& end = (*step.after.mutable_raw())[link];
        const auto from = end;
        (*rows)->bind(1, std::int64_t{run.value}).bind(2, std::string_view{link}).bind(3, sqlite::number(from));
        const auto added = add(**rows, "raw_octets", step.rows, [&](const sqlite::Statement& row) {
            const auto size = row.octets(octets_column).size();
            end = static_cast<std::uint64_t>(row.integer(first_column)) + size;
            octets += size;
            return octets > octets_max;
        });
        if (!added) return added.error();
        if (octets > octets_max) return false;
        const auto kept = single_integer((*begin)->bind(1, std::int64_t{run.value}).bind(2, std::string_view{link}));
        if (!kept) return kept.error();
        if (kept->value_or(0) > 0)
            (*step.rows.mutable_raw_kept())[link] = static_cast<std::uint64_t>(kept->value_or(0));
    }
    return true;
}

/// The rows that change: the run's own and, with `counters`, those of its links; unless they are what they were.
Result<void> RunRowsReader::State::add_replaced(RunId run, bool counters, RunStep& step) {
    v1::RowSet rows;
    const std::string of_run = " WHERE run = ?1";
    for (const std::string table : {"runs", "recordings", "link_totals", "sequence_totals"}) {
        if (!counters && table != "runs") continue;
        if (auto added = add("SELECT * FROM " + table + of_run, table, {run.value}, rows); !added) return added.error();
    }
    auto octets = rows.SerializeAsString();
    auto& before = replaced[run.value];
    if (octets == before) return {};
    before = std::move(octets);
    for (auto& table : *rows.mutable_tables()) *step.rows.add_tables() = std::move(table);
    return {};
}

Result<std::optional<RunStep>> RunRowsReader::next(RunId run, const v1::RunPosition& before, bool counters) {
    using Step = std::optional<RunStep>;
    auto& state = *state_;
    auto snapshot = sqlite::Transaction::begin_read(state.database);
    if (!snapshot) return snapshot.error();
    const auto stored = this->run(run);
    if (!stored) return stored.error();
    if (!*stored) return Error{"run " + std::to_string(run.value) + ": there is none"};
    RunStep step{(*stored)->dictionary, before, before, {}};
    const Sequence last = (*stored)->last_seq;
    if (before.seq() > last)
        return Error{"run " + std::to_string(run.value) + ": the engine has items up to " +
                     std::to_string(before.seq()) + ", this archive up to " + std::to_string(last) +
                     ": it was put back from an older copy"};
    static const std::string links_sql =
        "SELECT * FROM words WHERE kind = 'link' AND number > 3 OR kind LIKE 'octets of %'";
    static const std::string begun_sql = "SELECT * FROM runs WHERE run = ?1";
    const bool begins = before.seq() == 0 && before.segments() == 0 && before.requests() == 0;
    if (auto done = state.add_items(run, step, last); !done) return done.error();
    const bool all_items = step.after.seq() >= last;
    const auto all_segments = state.add_segments(run, step, all_items);
    if (!all_segments) return all_segments.error();
    bool whole = all_items && *all_segments;
    if (whole) {
        const auto all_blocks = state.add_blocks(run, step);
        if (!all_blocks) return all_blocks.error();
        whole = *all_blocks;
    }
    if (whole) {
        if (auto done = state.add_requests(run, step); !done) return done.error();
        const auto all_raw = state.add_raw(run, step);
        if (!all_raw) return all_raw.error();
        whole = *all_raw;
    }
    step.rows.set_whole(whole);
    const bool ended = (*stored)->state == "finished";
    if (whole)
        if (auto done = state.add_replaced(run, counters || (*stored)->state != "running", step); !done)
            return done.error();
    if (!whole) forget(run);  // whoever takes this step holds the run for one that goes on
    if (step.rows.tables().empty()) return Step{};
    if (begins) {
        if (!whole)
            if (auto added = state.add(begun_sql, "runs", {run.value}, step.rows); !added) return added.error();
        for (const std::string table : {"run_solution", "run_anchors"})
            if (auto added = state.add("SELECT * FROM " + table + " WHERE run = ?1", table, {run.value}, step.rows);
                !added)
                return added.error();
        for (const std::string table : {"dictionaries", "dictionary_channels", "dictionary_packets"})
            if (auto added =
                    state.add("SELECT * FROM " + table + " WHERE dictionary = ?1", table, {step.dictionary}, step.rows);
                !added)
                return added.error();
    }
    if (auto added = state.add(links_sql, "words", {}, step.rows); !added) return added.error();
    if (whole && ended) {
        static const std::string print_sql =
            "SELECT detail FROM audit WHERE action = 'fingerprint' AND outcome = 'done' AND detail LIKE"
            " 'run ' || ?1 || ' items 1 %' ORDER BY entry LIMIT 1";
        auto print = state.statement(print_sql);
        if (!print) return print.error();
        (*print)->bind(1, std::int64_t{run.value});
        auto found = (*print)->step();
        if (!found) return found.error();
        if (*found) step.rows.set_fingerprint(std::string{(*print)->text(0)});
        (*print)->reset();
    }
    return Step{std::move(step)};
}

void RunRowsReader::forget(RunId run) {
    state_->replaced.erase(run.value);
}

Result<sqlite::Statement*> RunRowsWriter::statement(const std::string& sql) {
    auto found = statements_.find(sql);
    if (found == statements_.end()) {
        auto prepared = database_->prepare(sql.c_str());
        if (!prepared) return prepared.error();
        found = statements_.emplace(sql, std::move(*prepared)).first;
    }
    return &found->second;
}

Result<void> RunRowsWriter::write(RunId run, const RunStep& step, const v1::TableRows& rows) {
    const auto table = std::ranges::find(copied_tables(), rows.table(), &CopiedTable::name);
    const auto refused = [&](const char* why) {
        return Error{"run " + std::to_string(run.value) + ": table '" + rows.table() + "' of a step: " + why};
    };
    if (table == copied_tables().end()) return refused("no table of runs");
    auto columns = statement("SELECT count(*) FROM pragma_table_info('" + table->name + "')");
    if (!columns) return columns.error();
    const auto count = single_integer(**columns);
    if (!count) return count.error();
    std::string sql =
        (table->again == Again::replaced ? "INSERT OR REPLACE INTO " : "INSERT INTO ") + table->name + " VALUES (?";
    for (std::int64_t column = 1; column < count->value_or(0); ++column) sql += ",?";
    sql += table->again == Again::replaced ? ")" : ") ON CONFLICT DO NOTHING";
    auto insert = statement(sql);
    if (!insert) return insert.error();
    RowOctets octets{rows.values()};
    const auto numbered = [&](std::int64_t number, std::uint64_t first, std::uint64_t end) {
        return segment_key(run, static_cast<std::int64_t>(first)) <= number &&
               number < segment_key(run, static_cast<std::int64_t>(end));
    };
    for (std::uint32_t row = 0; row < rows.rows(); ++row) {
        std::int64_t first = -1;
        for (int column = 0; column < static_cast<int>(count->value_or(0)); ++column)
            if (auto bound = octets.bind(**insert, column + 1, column == 0 ? &first : nullptr); !bound)
                return refused(bound.error().message.c_str());
        const bool own = [&] {
            switch (table->by) {
            case KnownBy::item:
                return item_key(run, step.before.seq()) < first && first <= item_key(run, step.after.seq());
            case KnownBy::segment: return numbered(first, step.before.segments(), step.after.segments());
            case KnownBy::of_segment: return numbered(first / 65'536, step.before.segments(), step.after.segments());
            case KnownBy::of_block: return numbered(first / 65'536, step.before.blocks(), step.after.blocks());
            case KnownBy::run: return first == std::int64_t{run.value};
            case KnownBy::dictionary: return first == std::int64_t{step.dictionary};
            case KnownBy::word: return true;
            }
            return false;
        }();
        if (!own) return refused("a row that is not of its run, or not of its numbers");
        if (auto done = (*insert)->run(); !done) {
            const bool disk = done.error().message.find("constraint failed") == std::string::npos &&
                              done.error().message.find("cannot store") == std::string::npos;
            return disk ? done : refused(done.error().message.c_str());
        }
    }
    if (!octets.empty()) return refused("more octets than rows");
    return {};
}

/// Whether the items from `first` to `last` have each number once.
Result<void> RunRowsWriter::check_items(RunId run, Sequence first, Sequence last) {
    auto row = statement("SELECT count(*), count(DISTINCT key), (SELECT count(*) FROM packets WHERE key BETWEEN ?1 AND"
                         " ?2 AND run <> ?1 >> 40) FROM (" +
                         item_keys_sql() + ") WHERE key BETWEEN ?1 AND ?2");
    if (!row) return row.error();
    (*row)->bind(1, item_key(run, first)).bind(2, item_key(run, last));
    auto found = (*row)->step();
    if (!found) return found.error();
    const auto wanted = static_cast<std::int64_t>(last - first + 1);
    const bool whole = (*row)->integer(0) == wanted && (*row)->integer(1) == wanted && (*row)->integer(2) == 0;
    (*row)->reset();
    // From the last packet on, because its samples are the item behind it.
    auto beyond = statement("SELECT count(*) FROM (" + item_keys_sql() + ") WHERE key > ?1");
    if (!beyond) return beyond.error();
    (*beyond)->bind(1, item_key(run, last)).bind(2, item_key(run, sequence_max));
    found = (*beyond)->step();
    if (!found) return found.error();
    const bool none_beyond = (*beyond)->integer(0) == 0;
    (*beyond)->reset();
    if (whole && none_beyond) return {};
    return Error{"run " + std::to_string(run.value) + ": a step that should hold the items " + std::to_string(first) +
                 " to " + std::to_string(last) + " leaves one out, holds one twice, or more than these"};
}

Result<RunRowsWriter::Taken> RunRowsWriter::take(RunId run, const RunStep& step) {
    const auto here = position_of(*database_, run);
    if (!here) return here.error();
    for (const auto& rows : step.rows.tables()) {
        // A step that is older than what is here must not take rows back that have changed since.
        const auto table = std::ranges::find(copied_tables(), rows.table(), &CopiedTable::name);
        const bool changes = table != copied_tables().end() && table->again == Again::replaced;
        if (changes && !within(*here, step.after)) continue;
        if (auto done = write(run, step, rows); !done) return done.error();
    }
    auto state = statement("SELECT state FROM runs WHERE run = ?");
    if (!state) return state.error();
    if (!step.rows.whole() && within(*here, step.after)) {
        auto running = statement("UPDATE runs SET state = 'running', outcome = 'running', outcome_reason = '', digest ="
                                 " '', ended = '', last_seq = NULL WHERE run = ?");
        if (!running) return running.error();
        if (auto done = (*running)->bind(1, std::int64_t{run.value}).run(); !done) return done.error();
    }
    for (const auto& [link, kept] : step.rows.raw_kept()) {
        auto removed = statement("DELETE FROM raw_octets WHERE run = ?1 AND link = ?2 AND first < ?3");
        if (!removed) return removed.error();
        (*removed)->bind(1, std::int64_t{run.value}).bind(2, std::string_view{link}).bind(3, sqlite::number(kept));
        if (auto done = (*removed)->run(); !done) return done.error();
    }
    Taken taken;
    if (step.after.seq() > here->seq()) {
        taken.first = here->seq() + 1;
        taken.last = step.after.seq();
        if (auto done = check_items(run, taken.first, taken.last); !done) return done.error();
        auto search = statement(add_to_search_sql);
        if (!search) return search.error();
        (*search)->bind(1, item_key(run, taken.first)).bind(2, item_key(run, taken.last));
        if (auto done = (*search)->run(); !done) return done.error();
    }
    (*state)->bind(1, std::int64_t{run.value});
    auto found = (*state)->step();
    if (!found) return found.error();
    if (!*found)
        return Error{"run " + std::to_string(run.value) + ": a step of a run of which the beginning is not here"};
    taken.ended = (*state)->text(0) == "finished";
    (*state)->reset();
    const auto now = position_of(*database_, run);
    if (!now) return now.error();
    if (!within(step.after, *now))
        return Error{"run " + std::to_string(run.value) + ": a step that does not hold what it says it does"};
    return taken;
}

}  // namespace aeolis::archive
