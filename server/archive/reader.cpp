// SPDX-License-Identifier: Apache-2.0
#include "server/archive/reader.hpp"

#include "server/archive/items.hpp"
#include "server/archive/kept_request.hpp"
#include "server/archive/reader_state.hpp"
#include "server/archive/schema.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

namespace aeolis::archive {

Reader::Reader(std::unique_ptr<State> state) : state_(std::move(state)) {}
Reader::Reader(Reader&&) noexcept = default;
Reader& Reader::operator=(Reader&&) noexcept = default;
Reader::~Reader() = default;

Result<ClosedRange> closed(const SclkRange& range) {
    constexpr double everything = std::numeric_limits<double>::infinity();
    const ClosedRange closed{range.from_s.value_or(-everything), range.to_s.value_or(everything)};
    if (std::isnan(closed.from_s) || std::isnan(closed.to_s)) return Error{"the range is not a number"};
    if (closed.from_s > closed.to_s)
        return Error{"the range is upside down: from " + std::to_string(closed.from_s) + " to " +
                     std::to_string(closed.to_s)};
    return closed;
}

Result<void> check_limit(std::size_t limit, std::size_t most) {
    if (limit >= 1 && limit <= most) return {};
    return Error{"limit " + std::to_string(limit) + " is not 1 … " + std::to_string(most)};
}

Result<Reader> Reader::open(const std::filesystem::path& file, const dictionary::Dictionary& dictionary,
                            const telemetry::OtherMission* other) {
    auto database = sqlite::Database::open(file.string(), sqlite::Mode::read_only);
    if (!database) return database.error();
    if (auto done = check_for_reading(*database); !done) return done.error();
    return Reader(std::make_unique<State>(std::move(database).value(), dictionary, other));
}

void Reader::stop_when(std::function<bool()> stop) {
    state_->database.stop_when(std::move(stop));
}
bool Reader::stopped() const {
    return state_->database.stopped();
}

std::string search_words(std::string_view text) {
    const auto in_word = [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) != 0 || static_cast<unsigned char>(c) >= 0x80;
    };
    std::string words;
    for (auto at = text.begin(); at != text.end();) {
        const auto begin = std::find_if(at, text.end(), in_word);
        at = std::find_if_not(begin, text.end(), in_word);
        if (begin != at) words += (words.empty() ? "\"" : " \"") + std::string(begin, at) + "\"*";
    }
    return words;
}

bool Reader::outdated() const {
    return state_->database.moved();
}

Result<Query> Reader::State::query(const char* sql) {
    auto found = statements.find(sql);
    if (found == statements.end()) {
        auto prepared = database.prepare(sql);
        if (!prepared) return prepared.error();
        found = statements.emplace(sql, std::move(prepared).value()).first;
    }
    return Query(found->second);
}

Result<RunInfo> Reader::State::info(RunId run) {
    static constexpr char sql[] = "SELECT state, dictionary, entry_sclk FROM runs WHERE run = ?";
    auto rows = query(sql);
    if (!rows) return rows.error();
    auto& row = **rows;
    row.bind(1, std::int64_t{run.value});
    auto found = row.step();
    if (!found) return found.error();
    if (!*found) return Error{"no run " + std::to_string(run.value)};
    return RunInfo{run, row.text(0) == "finished", static_cast<std::uint16_t>(row.integer(1)), Sclk{row.real(2)}};
}

Result<Reader::State::Instant> Reader::State::instant(RunId run) {
    auto snapshot = sqlite::Transaction::begin_read(database);
    if (!snapshot) return snapshot.error();
    const auto known = info(run);
    if (!known) return known.error();
    return Instant{std::move(*snapshot), *known};
}

Result<void> Reader::State::same_dictionary(const RunInfo& run) const {
    if (words_of(run) != nullptr) return {};
    return Error{"run " + std::to_string(run.run.value) + " was recorded with dictionary " +
                 std::to_string(run.dictionary) + ", this program has " + std::to_string(dictionary.id) +
                 ": only its packets and texts can be shown"};
}

Result<Sequence> Reader::State::last_seq(RunId run) {
    auto rows = query(last_key_sql());
    if (!rows) return rows.error();
    auto& row = **rows;
    row.bind(1, item_key(run, 0)).bind(2, item_key(run, sequence_max));
    auto found = row.step();
    if (!found) return found.error();
    return row.is_null(0) ? Sequence{0} : sequence_of(row.integer(0));
}

Result<Sequence> Reader::last_seq(RunId run) {
    if (auto info = state_->info(run); !info) return info.error();
    return state_->last_seq(run);
}

Result<std::vector<AuditEntry>> Reader::audit(std::uint64_t after, std::size_t limit, Order order) {
    return audit_entries(state_->database, after, limit, order);
}

Result<std::vector<ForecastRecord>> Reader::forecasts(RunId run, bool truths, std::uint64_t after, std::size_t limit,
                                                      Order order) {
    return forecasts_of(state_->database, run, truths, after, limit, order);
}

Result<std::optional<ForecastRecord>> Reader::forecast(RunId run, std::uint64_t number) {
    return forecast_of(state_->database, run, number);
}

Result<std::vector<LayoutRecord>> Reader::layouts(const std::string& owner) {
    return layouts_of(state_->database, owner);
}

namespace {

/// The clock correlation in a row. Columns: correlation_sclk, correlation_scet_us, clock_rate, leap_seconds,
/// clock_version.
ClockCorrelation clock_of(const sqlite::Statement& row, int column) {
    return {Sclk{row.real(column)}, Scet{row.integer(column + 1)}, row.real(column + 2),
            static_cast<std::int32_t>(row.integer(column + 3)), static_cast<std::uint32_t>(row.integer(column + 4))};
}

}  // namespace

Result<std::vector<RequestRecord>> Reader::State::requests(RunId run) {
    auto rows = query("SELECT cycle, request FROM requests WHERE run = ? ORDER BY position");
    if (!rows) return rows.error();
    auto& row = **rows;
    row.bind(1, std::int64_t{run.value});
    std::vector<RequestRecord> all;
    for (;;) {
        auto one = row.step();
        if (!one) return one.error();
        if (!*one) return all;
        all.push_back({static_cast<std::uint64_t>(row.integer(0)), std::string(row.text(1))});
    }
}

Result<v1::InterventionList> Reader::interventions(RunId run, const InterventionQuery& query) {
    if (auto fits = check_limit(query.limit, rows_page_max); !fits) return fits.error();
    const auto state = this->run(run);
    if (!state) return state.error();
    static const std::string sql =
        "SELECT position, cycle, request FROM requests WHERE run = ?1 AND position BETWEEN ?2 AND ?3 ORDER BY position";
    static const SqlInOrder in_order{sql, sql + " DESC"};
    auto rows = state_->query(in_order.in(query.order));
    if (!rows) return rows.error();
    auto& row = **rows;
    const auto places = numbers_after(query.after, query.order, INT64_MAX);
    row.bind(1, std::int64_t{run.value})
        .bind(2, static_cast<std::int64_t>(places.first))
        .bind(3, static_cast<std::int64_t>(places.last));
    v1::InterventionList list;
    std::uint64_t place = 0;  // of the last one in the list
    for (PageSize size{query.limit};;) {
        auto found = row.step();
        if (!found) return found.error();
        if (!*found) return list;
        auto kept = kept_request(std::string(row.text(2)));
        if (!kept.has_intervention()) continue;
        if (size.full()) {
            list.set_next_after(place);
            return list;
        }
        auto& intervention = *list.add_interventions();
        intervention = std::move(*kept.mutable_intervention());
        intervention.set_e_s(state->start_sclk() - state->entry_sclk() +
                             static_cast<double>(row.integer(1)) * seconds_per_tick);
        size.add(intervention.ByteSizeLong());
        place = static_cast<std::uint64_t>(row.integer(0));
    }
}

Result<v1::InstructorPlan> Reader::instructor_plan(RunId run) {
    auto rows = state_->query("SELECT request FROM requests WHERE run = ? AND cycle = 0 ORDER BY position");
    if (!rows) return rows.error();
    auto& row = **rows;
    row.bind(1, std::int64_t{run.value});
    for (;;) {
        auto found = row.step();
        if (!found) return found.error();
        if (!*found) return v1::InstructorPlan{};
        const auto kept = kept_request(std::string(row.text(0)));
        if (kept.has_plan()) return kept.plan();
    }
}

Result<std::vector<v1::Jump>> Reader::jumps(RunId run) {
    auto rows = state_->query("SELECT request FROM requests WHERE run = ? AND request LIKE '%jump%' ORDER BY position");
    if (!rows) return rows.error();
    auto& row = **rows;
    row.bind(1, std::int64_t{run.value});
    std::vector<v1::Jump> jumps;
    for (;;) {
        auto found = row.step();
        if (!found) return found.error();
        if (!*found) return jumps;
        const auto kept = kept_request(std::string(row.text(0)));
        if (!kept.has_jump()) continue;
        if (!jumps.empty() && jumps.back().begins()) jumps.pop_back();  // it has ended
        jumps.push_back(kept.jump());
    }
}

Result<std::string> Reader::scenario_text(RunId run) {
    const auto instant = state_->instant(run);
    if (!instant) return instant.error();
    if (auto same = state_->same_dictionary(instant->run); !same) return same.error();
    auto rows = state_->query("SELECT scenario_text FROM runs WHERE run = ?");
    if (!rows) return rows.error();
    auto& row = **rows;
    row.bind(1, std::int64_t{run.value});
    if (auto found = row.step(); !found) return found.error();
    auto text = std::string(row.text(0));
    if (text.empty()) return Error{"run " + std::to_string(run.value) + " has no scenario: it follows another mission"};
    return text;
}

namespace {

Sequence sequence_of_annotation(const Annotation& annotation) {
    return std::visit([](const auto& record) { return record.seq; }, annotation);
}

/// Reads from the columns forked_run, forked_cycle, forked_e_s and forked_seed, the first of which is `column`.
std::optional<ForkPoint> fork_point(const sqlite::Statement& row, int column) {
    if (row.is_null(column)) return std::nullopt;
    return ForkPoint{{static_cast<std::uint32_t>(row.integer(column))},
                     static_cast<std::uint64_t>(row.integer(column + 1)),
                     row.real(column + 2),
                     static_cast<std::uint64_t>(row.integer(column + 3))};
}

}  // namespace

Result<FlownRun> Reader::cut_off(RunId run) {
    const auto state = this->run(run);
    if (!state) return state.error();
    if (state->state() != v1::RunState::interrupted)
        return Error{"run " + std::to_string(run.value) + " was not cut off: it is " +
                     v1::RunState::State_Name(state->state())};
    return flown(run);
}

Result<FlownRun> Reader::flown(RunId run) {
    auto snapshot = sqlite::Transaction::begin_read(state_->database);
    if (!snapshot) return snapshot.error();
    static constexpr char run_sql[] =
        "SELECT case_number, scenario_text, started, seed, dictionary, correlation_sclk, correlation_scet_us,"
        " clock_rate, leap_seconds, clock_version, forked_run, forked_cycle, forked_e_s, forked_seed FROM runs"
        " WHERE run = ?";
    auto rows = state_->query(run_sql);
    if (!rows) return rows.error();
    auto& row = **rows;
    row.bind(1, std::int64_t{run.value});
    auto found = row.step();
    if (!found) return found.error();
    if (!*found) return Error{"no run " + std::to_string(run.value)};
    FlownRun flown;
    flown.run = run;
    flown.case_number = static_cast<std::uint64_t>(row.integer(0));
    flown.forked_from = fork_point(row, 10);
    flown.scenario_text = row.text(1);
    flown.started = row.text(2);
    flown.seed = static_cast<std::uint64_t>(row.integer(3));
    flown.clock = clock_of(row, 5);
    if (auto same = state_->same_dictionary({run, false, static_cast<std::uint16_t>(row.integer(4)), {}}); !same)
        return same.error();
    auto last = state_->last_seq(run);
    if (!last) return last.error();
    flown.last_seq = *last;
    auto requests = state_->requests(run);
    if (!requests) return requests.error();
    flown.requests = std::move(*requests);
    static constexpr char annotations_sql[] = "SELECT key FROM notes WHERE key BETWEEN ?1 AND ?2 UNION ALL"
                                              " SELECT key FROM alarm_actions WHERE key BETWEEN ?1 AND ?2 UNION ALL"
                                              " SELECT key FROM procedure_acts WHERE key BETWEEN ?1 AND ?2 UNION ALL"
                                              " SELECT key FROM position_acts WHERE key BETWEEN ?1 AND ?2 ORDER BY key";
    auto annotations = state_->query(annotations_sql);
    if (!annotations) return annotations.error();
    (*annotations)->bind(1, item_key(run, 0)).bind(2, item_key(run, sequence_max));
    for (;;) {
        auto one = (*annotations)->step();
        if (!one) return one.error();
        if (!*one) return flown;
        flown.annotations.push_back(sequence_of((*annotations)->integer(0)));
    }
}

Result<std::vector<Annotation>> Reader::annotations(RunId run) {
    std::vector<Annotation> all;
    const auto add = [&]<typename Record>(const Record&) -> Result<void> {
        auto rows = state_->query(rows_sql<Record>());
        if (!rows) return rows.error();
        auto& row = **rows;
        row.bind(1, item_key(run, 0)).bind(2, item_key(run, sequence_max)).bind(3, std::int64_t{-1});
        for (;;) {
            auto found = row.step();
            if (!found) return found.error();
            if (!*found) return {};
            all.emplace_back(read_row<Record>(row));
        }
    };
    if (auto read = add(NoteRecord{}); !read) return read.error();
    if (auto read = add(AlarmActionRecord{}); !read) return read.error();
    if (auto read = add(ProcedureActRecord{}); !read) return read.error();
    if (auto read = add(PositionActRecord{}); !read) return read.error();
    std::ranges::sort(all, {}, sequence_of_annotation);
    return all;
}

namespace {
/// The runs ?1 to ?2, in order.
const SqlInOrder& runs_sql() {
    static const std::string columns =
        "SELECT r.run, scenario, title, venue, seed, state, outcome, pace, started, last_seq, entry_sclk, start_sclk,"
        " light_time_s, tone_model, digest, coalesce(progress, 0), correlation_sclk, correlation_scet_us, clock_rate,"
        " leap_seconds, clock_version, forked_run, forked_cycle, forked_e_s, forked_seed"
        " FROM runs r LEFT JOIN recordings c ON c.run = r.run"
        " WHERE r.run BETWEEN ?1 AND ?2 ORDER BY r.run";
    static const SqlInOrder sql{columns, columns + " DESC"};
    return sql;
}
constexpr char solution_sql[] = "SELECT name, value FROM run_solution WHERE run = ? ORDER BY position";
}  // namespace

Result<v1::RunState> Reader::State::run_state(const sqlite::Statement& row) {
    v1::RunState state;
    const RunId run{static_cast<std::uint32_t>(row.integer(0))};
    state.set_run(run.value);
    state.set_scenario(std::string(row.text(1)));
    state.set_title(std::string(row.text(2)));
    state.set_venue(std::string(row.text(3)));
    state.set_seed(static_cast<std::uint64_t>(row.integer(4)));
    auto phase = v1::RunState::none;
    if (v1::RunState::State_Parse(std::string(row.text(5)), &phase)) state.set_state(phase);
    state.set_outcome(static_cast<v1::Landing::Outcome>(ColumnType<Outcome>::read(row, 6)));
    state.set_pace(row.real(7));
    state.set_started(std::string(row.text(8)));
    state.set_entry_sclk(row.real(10));
    state.set_start_sclk(row.real(11));
    state.set_light_time_s(row.real(12));
    state.set_tone_model(std::string(row.text(13)));
    state.set_digest(std::string(row.text(14)));
    state.set_relay_progress(row.real(15));
    *state.mutable_clock() = to_reply(clock_of(row, 16));
    if (const auto fork = fork_point(row, 21)) *state.mutable_forked_from() = to_reply(*fork);
    auto last = row.is_null(9) ? last_seq(run) : Result<Sequence>(static_cast<Sequence>(row.integer(9)));
    if (!last) return last.error();
    state.set_last_seq(*last);
    auto values = query(solution_sql);
    if (!values) return values.error();
    (*values)->bind(1, std::int64_t{run.value});
    for (;;) {
        auto found = (*values)->step();
        if (!found) return found.error();
        if (!*found) return state;
        auto& argument = *state.add_solution();
        argument.set_name(std::string((*values)->text(0)));
        argument.set_value((*values)->real(1));
    }
}

Result<v1::RunList> Reader::runs(const RunQuery& query) {
    if (auto fits = check_limit(query.limit, rows_page_max); !fits) return fits.error();
    auto snapshot = sqlite::Transaction::begin_read(state_->database);
    if (!snapshot) return snapshot.error();
    auto rows = state_->query(runs_sql().in(query.order));
    if (!rows) return rows.error();
    const auto numbers = numbers_after(query.after, query.order, UINT32_MAX);
    (*rows)->bind(1, static_cast<std::int64_t>(numbers.first)).bind(2, static_cast<std::int64_t>(numbers.last));
    v1::RunList list;
    for (PageSize size{query.limit};;) {
        auto found = (*rows)->step();
        if (!found) return found.error();
        if (!*found) return list;
        if (size.full()) {
            list.set_next_after(list.runs().rbegin()->run());
            return list;
        }
        auto state = state_->run_state(**rows);
        if (!state) return state.error();
        size.add(state->ByteSizeLong());
        *list.add_runs() = std::move(state).value();
    }
}

Result<v1::RunState> Reader::run(RunId run) {
    auto snapshot = sqlite::Transaction::begin_read(state_->database);
    if (!snapshot) return snapshot.error();
    auto rows = state_->query(runs_sql().in({}));
    if (!rows) return rows.error();
    (*rows)->bind(1, std::int64_t{run.value}).bind(2, std::int64_t{run.value});
    auto found = (*rows)->step();
    if (!found) return found.error();
    if (!*found) return Error{"no run " + std::to_string(run.value)};
    return state_->run_state(**rows);
}

}  // namespace aeolis::archive
