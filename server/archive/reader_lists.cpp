// SPDX-License-Identifier: Apache-2.0
#include "commands/timeline_change.hpp"
#include "server/archive/item_rows.hpp"
#include "server/archive/items.hpp"
#include "server/archive/reader.hpp"
#include "server/archive/reader_state.hpp"
#include "server/archive/schema.hpp"
#include "telemetry/text.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <ranges>
#include <set>
#include <tuple>

namespace aeolis::archive {

namespace {

std::string hex(std::span<const std::uint8_t> octets) {
    static constexpr char digits[] = "0123456789abcdef";
    std::string text;
    text.reserve(2 * octets.size());
    for (const auto octet : octets) {
        text.push_back(digits[octet >> 4U]);
        text.push_back(digits[octet & 15U]);
    }
    return text;
}

/// The words of a query in FTS5's form.
struct Wanted {
    explicit Wanted(const std::string& text) : asked(!text.empty()), words(search_words(text)) {}
    bool asked;
    std::string words;
    bool nothing() const { return asked && words.empty(); }  ///< punctuation only: no row matches
};

/// Reads rows of one table until `take` says that the page is full. Returns the number to continue after; 0: no more
/// rows.
template <typename Take>
Result<Sequence> scan(Reader::State& reader, const char* sql, RunId run, const Numbers& numbers, Take take,
                      const std::string& words = {}) {
    if (numbers.first > numbers.last) return Sequence{0};
    auto rows = reader.query(sql);
    if (!rows) return rows.error();
    auto& row = **rows;
    row.bind(1, item_key(run, numbers.first)).bind(2, item_key(run, numbers.last));
    row.bind(3, static_cast<std::int64_t>(rows_scanned_max));
    if (!words.empty()) row.bind(4, std::string_view(words));
    Sequence last = 0;
    for (std::size_t scanned = 0;; ++scanned) {
        auto found = row.step();
        if (!found) return found.error();
        if (!*found) return scanned == rows_scanned_max ? last : Sequence{0};
        last = sequence_of(row.integer(0));
        Result<bool> full = take(row);
        if (!full) return full.error();
        if (*full) return last;
    }
}

/// A page of items of one kind, selected by `query`'s words and by `wanted` on the record.
template <typename Record, typename List, typename Query>
Result<List> page_of(Reader::State& reader, RunId run, const Query& query, auto wanted,
                     google::protobuf::RepeatedPtrField<v1::Item>* (List::*items)()) {
    if (auto fits = check_limit(query.limit, rows_page_max); !fits) return fits.error();
    const auto instant = reader.instant(run);
    if (!instant) return instant.error();
    const Wanted words(query.text);
    List list;
    if (words.nothing()) return list;
    auto& page = *(list.*items)();
    PageSize size{query.limit};
    const auto next = scan(
        reader, words.asked ? found_rows_sql<Record>(query.order) : rows_sql<Record>(query.order), run,
        numbers_after(query.after, query.order, sequence_max),
        [&](const auto& row) -> Result<bool> {
            if (!wanted(read_row<Record>(row))) return false;
            auto item = reader.item<Record>(row);
            if (!item) return item.error();
            size.add(item->ByteSizeLong());
            *page.Add() = std::move(*item);
            return size.full();
        },
        words.words);
    if (!next) return next.error();
    list.set_next_after(*next);
    return list;
}

struct HeardRange {
    Ert from, to;
};
/// The range of time on Earth that corresponds to a range on board.
Result<HeardRange> heard_range(Reader& reader, RunId run, const SclkRange& asked) {
    if (const auto range = closed(asked); !range) return range.error();
    HeardRange heard{Ert{INT64_MIN}, Ert{INT64_MAX}};
    if (!asked.from_s && !asked.to_s) return heard;
    const auto state = reader.run(run);
    if (!state) return state.error();
    if (asked.from_s) heard.from = ert_of(*state, Sclk{*asked.from_s});
    if (asked.to_s) heard.to = ert_of(*state, Sclk{*asked.to_s});
    return heard;
}

void add_fields(v1::PacketRow& row, const dictionary::Packet& packet, const telemetry::Decoded& decoded) {
    for (std::size_t i = 0; i < packet.fields.size(); ++i) {
        const auto& field = packet.fields[i];
        auto& written = *row.add_fields();
        written.set_name(field.name);
        written.set_text(telemetry::value_text(field.type, decoded.value[i]));
        written.set_position_bits(field.position_bits);
        written.set_bits(field.type.bits);
    }
}

/// Adds all contents of another mission's packet, including text, octets and lists of any length.
void add_contents(v1::PacketRow& row, const telemetry::DecodedContents& contents) {
    for (const auto& value : contents.values) {
        auto& written = *row.add_fields();
        written.set_name(value.name);
        written.set_text(telemetry::datum_text(value.calibrated));
        written.set_position_bits(static_cast<std::uint32_t>(value.position_bits));
        written.set_bits(static_cast<std::uint32_t>(value.bits));
    }
}

}  // namespace

Result<v1::PacketList> Reader::packets(RunId run, const PacketQuery& query) {
    const auto range = closed(query.range);
    if (!range) return range.error();
    if (auto fits = check_limit(query.limit, packets_page_max); !fits) return fits.error();
    const auto instant = state_->instant(run);
    if (!instant) return instant.error();
    std::optional<std::uint16_t> wanted;
    if (query.name) {
        if (auto same = state_->same_dictionary(instant->run); !same) return same.error();
        const auto* packet = state_->dictionary.packet(*query.name);
        if (packet == nullptr) return Error{"no packet '" + *query.name + "'"};
        wanted = static_cast<std::uint16_t>(packet - state_->dictionary.packets.data());
    }
    const auto complete = state_->recording_complete(run);
    if (!complete) return complete.error();
    const auto* words = state_->words_of(instant->run);
    v1::PacketList list;
    PageSize size{query.limit};
    const auto numbers = numbers_after(query.after, query.order, sequence_max);
    const auto take = [&](const auto& row) -> Result<bool> {
        const auto record = read_row<PacketRecord>(row);
        if ((wanted && record.packet != wanted) || !range->holds(record.sclk.seconds)) return false;
        const auto verdict = state_->verdict_on(run, record, *complete);
        if (!verdict) return verdict.error();
        if (!query.verdict.empty() && query.verdict != verdict->name) return false;
        auto& written = *list.add_packets();
        written.set_verdict(verdict->name);
        written.set_other_hex(hex(verdict->other_octets));
        *written.mutable_unit() = std::move(*to_item(record, words).mutable_unit());
        written.set_ert_us(record.ert.microseconds);
        written.set_problem(record.refusal);
        const auto octets = octets_of_packet(row);
        written.set_hex(hex(octets));
        if (query.fields && words != nullptr && state_->other != nullptr)
            add_contents(written, state_->other->contents(octets));
        else if (query.fields && words != nullptr && record.packet && state_->decode(octets, *record.packet))
            add_fields(written, words->packets[state_->decoded.packet], state_->decoded);
        size.add(written.ByteSizeLong());
        return size.full();
    };
    const auto next = scan(*state_, rows_sql<PacketRecord>(query.order), run, numbers, take);
    if (!next) return next.error();
    list.set_next_after(*next);
    return list;
}

Result<std::vector<std::vector<std::uint8_t>>> Reader::received_octets(RunId run, Sequence& after, std::size_t limit) {
    auto rows =
        state_->query("SELECT key, octets FROM packets WHERE key > ?1 AND key <= ?2 AND link IS NOT"
                      " (SELECT number FROM words WHERE kind = 'link' AND word = 'station') ORDER BY key LIMIT ?3");
    if (!rows) return rows.error();
    auto& row = **rows;
    row.bind(1, item_key(run, after)).bind(2, item_key(run, sequence_max)).bind(3, static_cast<std::int64_t>(limit));
    std::vector<std::vector<std::uint8_t>> packets;
    for (;;) {
        auto found = row.step();
        if (!found) return found.error();
        if (!*found) return packets;
        after = sequence_of(row.integer(0));
        const auto octets = row.octets(1);
        packets.emplace_back(octets.begin(), octets.end());
    }
}

Result<void> Reader::each_recorded_packet(RunId run, const TakePacket& take) {
    const auto instant = state_->instant(run);
    if (!instant) return instant.error();
    if (auto same = state_->same_dictionary(instant->run); !same) return same.error();
    auto rows = state_->query("SELECT octets FROM packets WHERE key BETWEEN ?1 AND ?2 AND source = 2 ORDER BY key");
    if (!rows) return rows.error();
    (*rows)->bind(1, item_key(run, 1)).bind(2, item_key(run, sequence_max));
    for (;;) {
        auto found = (*rows)->step();
        if (!found) return found.error();
        if (!*found) return {};
        take((*rows)->octets(0));
    }
}

Result<v1::EventList> Reader::events(RunId run, const EventQuery& query) {
    const auto range = closed(query.range);
    if (!range) return range.error();
    const auto wanted = [&](const EventRecord& event) {
        return (query.duplicates || !event.duplicate) && range->holds(event.sclk.seconds) &&
               (query.levels.empty() ||
                std::ranges::find(query.levels, telemetry::name_of(event.level)) != query.levels.end());
    };
    return page_of<EventRecord>(*state_, run, query, wanted, &v1::EventList::mutable_events);
}

Result<v1::ToneList> Reader::tones(RunId run, const ToneQuery& query) {
    const auto range = closed(query.range);
    if (!range) return range.error();
    const auto wanted = [&](const ToneRecord& tone) { return range->holds(tone.sclk.seconds); };
    return page_of<ToneRecord>(*state_, run, query, wanted, &v1::ToneList::mutable_tones);
}

Result<v1::ExplanationList> Reader::explanations(RunId run, const ExplanationQuery& query) {
    const auto range = closed(query.range);
    if (!range) return range.error();
    const auto wanted = [&](const ExplanationRecord& record) {
        return (query.duplicates || !record.duplicate) && range->holds(record.sclk.seconds) &&
               (query.decision.empty() || record.explanation.decision == query.decision);
    };
    return page_of<ExplanationRecord>(*state_, run, query, wanted, &v1::ExplanationList::mutable_explanations);
}

Result<v1::NoteList> Reader::notes(RunId run, const NoteQuery& query) {
    const auto wanted = [](const NoteRecord&) { return true; };
    return page_of<NoteRecord>(*state_, run, query, wanted, &v1::NoteList::mutable_notes);
}

namespace {

/// Passes every stage of the run's commands to `take`, in the order of receipt; with words, those that contain them.
Result<void> each_stage(Reader::State& reader, RunId run, const std::function<void(const StageRecord&)>& take,
                        const std::string& words = {}) {
    for (Sequence after = 0;;) {
        const auto next = scan(
            reader, words.empty() ? rows_sql<StageRecord>() : found_rows_sql<StageRecord>(), run,
            numbers_after(after, {}, sequence_max),
            [&](const auto& row) -> Result<bool> {
                take(read_row<StageRecord>(row));
                return false;
            },
            words);
        if (!next) return next.error();
        if (*next == 0) return {};
        after = *next;
    }
}

void add_stage(const StageRecord& stage, v1::CommandHistory& history) {
    if (history.stages_size() == 0) {
        history.set_command(stage.command);
        history.set_name(stage.name);
        history.set_arguments(stage.arguments);
        history.set_client_id(stage.client_id);
    }
    if (!stage.octets.empty()) history.set_octets(hex(stage.octets));
    if (stage.stage == commands::Stage::released) {  // its final stage
        history.set_held(stage.held);
        history.set_needs_approval(stage.needs_approval);
    }
    *history.add_stages() = to_item(stage);
}

/// The commands that a query asks for, by number, with the octets of their stages.
using CommandSizes = std::map<std::uint64_t, std::size_t>;

Result<CommandSizes> matching_commands(Reader::State& reader, RunId run, const CommandQuery& query,
                                       const HeardRange& range) {
    CommandSizes sizes;
    std::set<std::uint64_t> in_range;
    const auto take = [&](const StageRecord& stage) {
        sizes[stage.command] += to_item(stage).ByteSizeLong() + 2 * stage.octets.size();
        if (range.from <= stage.ert && stage.ert <= range.to) in_range.insert(stage.command);
    };
    if (auto done = each_stage(reader, run, take); !done) return done.error();
    std::erase_if(sizes, [&](const auto& command) { return !in_range.contains(command.first); });
    const Wanted wanted(query.text);
    if (!wanted.asked) return sizes;
    std::set<std::uint64_t> found;
    if (!wanted.nothing())
        if (auto done = each_stage(
                reader, run, [&](const StageRecord& stage) { found.insert(stage.command); }, wanted.words);
            !done)
            return done.error();
    std::erase_if(sizes, [&](const auto& command) { return !found.contains(command.first); });
    return sizes;
}

/// The numbers of the page, in the order asked, and where the next page goes on.
struct CommandPage {
    std::vector<std::uint64_t> commands;
    std::uint64_t next_after = 0;
};
CommandPage page_of(const CommandSizes& sizes, const CommandQuery& query) {
    CommandPage page;
    PageSize size{query.limit};
    const auto numbers = numbers_after(query.after, query.order, INT64_MAX);
    const auto take = [&](const auto& command) {
        if (command.first < numbers.first || command.first > numbers.last) return true;
        if (size.full()) {
            page.next_after = page.commands.back();
            return false;
        }
        page.commands.push_back(command.first);
        size.add(command.second);
        return true;
    };
    if (query.order == Order::newest_first)
        std::ignore = std::ranges::all_of(sizes | std::views::reverse, take);
    else
        std::ignore = std::ranges::all_of(sizes, take);
    return page;
}

}  // namespace

/// Reads the stages twice: first to choose the commands of the page, then to build these alone.
Result<v1::CommandList> Reader::commands(RunId run, const CommandQuery& query) {
    if (auto fits = check_limit(query.limit, commands_page_max); !fits) return fits.error();
    const auto range = heard_range(*this, run, query.range);
    if (!range) return range.error();
    const auto instant = state_->instant(run);
    if (!instant) return instant.error();
    const auto sizes = matching_commands(*state_, run, query, *range);
    if (!sizes) return sizes.error();
    const auto page = page_of(*sizes, query);
    v1::CommandList list;
    std::map<std::uint64_t, v1::CommandHistory*> histories;
    for (const auto number : page.commands) histories[number] = list.add_commands();
    const auto take = [&](const StageRecord& stage) {
        if (const auto history = histories.find(stage.command); history != histories.end())
            add_stage(stage, *history->second);
    };
    if (auto done = each_stage(*state_, run, take); !done) return done.error();
    list.set_next_after(page.next_after);
    return list;
}

Result<v1::CommandList> Reader::timeline_commands(RunId run) {
    const auto instant = state_->instant(run);
    if (!instant) return instant.error();
    std::map<std::uint64_t, v1::CommandHistory> histories;
    const auto take = [&](const StageRecord& stage) {
        if (commands::changes_offsets(stage.name)) add_stage(stage, histories[stage.command]);
    };
    if (auto done = each_stage(*state_, run, take); !done) return done.error();
    v1::CommandList list;
    for (auto& [number, history] : histories) *list.add_commands() = std::move(history);
    return list;
}

Result<v1::RecordingSummary> Reader::recording(RunId run) {
    const auto instant = state_->instant(run);
    if (!instant) return instant.error();
    static constexpr char sql[] = "SELECT recorded, realtime, realtime_not_recorded, realtime_differs,"
                                  " never_seen_live, progress, recorded_octets FROM recordings WHERE run = ?1";
    auto rows = state_->query(sql);
    if (!rows) return rows.error();
    auto& row = **rows;
    row.bind(1, std::int64_t{run.value});
    auto found = row.step();
    if (!found) return found.error();
    v1::RecordingSummary summary;
    if (!*found) return summary;
    const auto number = [&](int column) { return static_cast<std::uint64_t>(row.integer(column)); };
    summary.set_recorded(number(0));
    summary.set_realtime(number(1));
    summary.set_realtime_not_recorded(number(2));
    summary.set_realtime_differs(number(3));
    summary.set_never_seen_live(number(4));
    summary.set_progress(row.real(5));
    summary.set_recorded_octets(number(6));
    return summary;
}

// ---- procedures -----------------------------------------------------------------------------------------------------

namespace {

/// Binds the first three parameters to all items of a run.
sqlite::Statement& of_run(sqlite::Statement& rows, RunId run) {
    return rows.bind(1, item_key(run, 0)).bind(2, item_key(run, sequence_max)).bind(3, std::int64_t{-1});
}

/// Gives each row of a statement whose parameters are bound to `take`; ends with the first Error.
Result<void> each_row(sqlite::Statement& rows, auto take) {
    for (;;) {
        const auto found = rows.step();
        if (!found) return found.error();
        if (!*found) return {};
        if (auto taken = take(rows); !taken) return taken;
    }
}

/// All records of a run, in order.
template <typename Record>
Result<std::vector<Record>> all_records(Reader::State& reader, RunId run) {
    auto rows = reader.query(rows_sql<Record>());
    if (!rows) return rows.error();
    std::vector<Record> records;
    auto read = each_row(of_run(**rows, run), [&](sqlite::Statement& row) -> Result<void> {
        records.push_back(read_row<Record>(row));
        return {};
    });
    if (!read) return read.error();
    return records;
}

template <typename Record>
Result<std::vector<v1::Item>> all_items(Reader::State& reader, sqlite::Statement& rows) {
    std::vector<v1::Item> items;
    auto read = each_row(rows, [&](sqlite::Statement& row) -> Result<void> {
        auto item = reader.item<Record>(row);
        if (!item) return item.error();
        items.push_back(std::move(*item));
        return {};
    });
    if (!read) return read.error();
    return items;
}

}  // namespace

Result<std::vector<v1::Item>> Reader::procedures(RunId run, std::optional<Ert> at) {
    static const std::string sql =
        select_sql<ProcedureStatusRecord>("key IN (SELECT max(key) FROM procedure_statuses WHERE key BETWEEN ?1 AND ?2"
                                          " AND ert_us <= ?4 GROUP BY number)");
    auto rows = state_->query(sql.c_str());
    if (!rows) return rows.error();
    of_run(**rows, run).bind(4, at ? at->microseconds : std::numeric_limits<std::int64_t>::max());
    auto items = all_items<ProcedureStatusRecord>(*state_, **rows);
    if (items) std::ranges::sort(*items, {}, [](const v1::Item& item) { return item.procedure().number(); });
    return items;
}

Result<std::vector<ProcedureActRecord>> Reader::all_procedure_acts(RunId run) {
    return all_records<ProcedureActRecord>(*state_, run);
}

Result<std::vector<PositionActRecord>> Reader::all_position_acts(RunId run) {
    return all_records<PositionActRecord>(*state_, run);
}

Result<std::vector<v1::Item>> Reader::position_acts(RunId run, std::optional<Ert> at) {
    static const std::string sql = select_sql<PositionActRecord>("key BETWEEN ?1 AND ?2 AND ert_us <= ?4");
    auto rows = state_->query(sql.c_str());
    if (!rows) return rows.error();
    of_run(**rows, run).bind(4, at ? at->microseconds : std::numeric_limits<std::int64_t>::max());
    return all_items<PositionActRecord>(*state_, **rows);
}

Result<std::optional<v1::Item>> Reader::newest_position_act(RunId run, std::optional<Ert> at) {
    static const std::string sql =
        select_sql<PositionActRecord>("key = (SELECT max(key) FROM position_acts WHERE key BETWEEN ?1 AND ?2"
                                      " AND ert_us <= ?4)");
    auto rows = state_->query(sql.c_str());
    if (!rows) return rows.error();
    of_run(**rows, run).bind(4, at ? at->microseconds : std::numeric_limits<std::int64_t>::max());
    auto acts = all_items<PositionActRecord>(*state_, **rows);
    if (!acts) return acts.error();
    return acts->empty() ? std::optional<v1::Item>{} : std::optional{std::move(acts->front())};
}

Result<bool> Reader::has_procedure(RunId run, std::uint32_t number) {
    auto rows = state_->query("SELECT 1 FROM procedure_acts WHERE key BETWEEN ?1 AND ?2 AND key > ?3 AND number = ?4 "
                              "LIMIT 1");
    if (!rows) return rows.error();
    return of_run(**rows, run).bind(4, std::int64_t{number}).step();
}

Result<std::vector<v1::Item>> Reader::procedure_acts(RunId run, std::uint32_t number) {
    static const std::string sql = select_sql<ProcedureActRecord>("key BETWEEN ?1 AND ?2 AND number = ?4");
    auto rows = state_->query(sql.c_str());
    if (!rows) return rows.error();
    of_run(**rows, run).bind(4, std::int64_t{number});
    return all_items<ProcedureActRecord>(*state_, **rows);
}

}  // namespace aeolis::archive
