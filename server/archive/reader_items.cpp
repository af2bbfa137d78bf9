// SPDX-License-Identifier: Apache-2.0
#include "server/archive/items.hpp"
#include "server/archive/reader.hpp"
#include "server/archive/reader_state.hpp"
#include "server/archive/row_reader.hpp"
#include "server/archive/schema.hpp"

#include <algorithm>

// Items of all kinds, as one sequence, by reading each table from the same place on.
namespace aeolis::archive {

namespace {

/// One page being collected. `through` comes down when a table has more rows than fit.
struct Page {
    RunId run;
    Sequence after = 0;
    Sequence through = 0;
    std::size_t limit = 0;
    std::vector<v1::Item> items;
};

template <typename Read>
Result<void> collect(Reader::State& reader, const char* sql, Page& page, Read read) {
    auto rows = reader.query(sql);
    if (!rows) return rows.error();
    (*rows)
        ->bind(1, item_key(page.run, page.after + 1))
        .bind(2, item_key(page.run, page.through))
        .bind(3, static_cast<std::int64_t>(page.limit));
    std::size_t count = 0;
    for (;; ++count) {
        auto found = (*rows)->step();
        if (!found) return found.error();
        if (!*found) break;
        auto item = read(**rows);
        if (!item) return item.error();
        page.items.push_back(std::move(item).value());
    }
    if (count == page.limit) page.through = std::min<Sequence>(page.through, page.items.back().seq());
    return {};
}

/// In order, and no more than is complete.
void finish(Page& page) {
    std::sort(page.items.begin(), page.items.end(), [](const auto& a, const auto& b) { return a.seq() < b.seq(); });
    while (!page.items.empty() && page.items.back().seq() > page.through) page.items.pop_back();
    if (page.items.size() <= page.limit) return;
    page.items.resize(page.limit);
    page.through = page.items.back().seq();
}

template <typename Read>
auto as_item(Read read) {
    return [read](const sqlite::Statement& row) -> Result<v1::Item> { return to_item(read(row)); };
}

Result<void> collect_alarms(Reader::State& reader, const RunInfo& info, Page& page) {
    const auto staleness = [words = reader.words_of(info)](const sqlite::Statement& row) -> Result<v1::Item> {
        return to_item(row::staleness(row), words);
    };
    auto done = collect(reader, row::alarm_rows, page, as_item(row::alarm));
    if (done) done = collect(reader, row::staleness_rows, page, staleness);
    if (done) done = collect(reader, row::alarm_action_rows, page, as_item(row::alarm_action));
    return done;
}

/// A unit's row stands for one or two items: itself and, sampled, the next number. The page may begin between them.
Result<void> collect_units(Reader::State& reader, const RunInfo& info, Page& page, Reader::ItemKinds kinds) {
    auto rows = reader.query(row::unit_rows);
    if (!rows) return rows.error();
    (*rows)
        ->bind(1, item_key(page.run, page.after))
        .bind(2, item_key(page.run, page.through))
        .bind(3, static_cast<std::int64_t>(page.limit + 1));  // the first may have nothing left to give
    const auto* words = reader.words_of(info);
    std::vector<double> values;
    std::size_t count = 0;
    Sequence last = page.after;
    for (;; ++count) {
        auto found = (*rows)->step();
        if (!found) return found.error();
        if (!*found) break;
        const auto unit = row::unit(**rows);
        last = unit.sampled ? unit.seq + 1 : unit.seq;
        if (kinds.units && unit.seq > page.after) page.items.push_back(to_item(unit, words));
        if (!kinds.samples || !unit.sampled) continue;
        // With another dictionary the values cannot be told; the item still takes its place.
        const SampleRecord sample{unit.seq + 1, unit.packet.value_or(0), unit.sclk, unit.source, {}};
        values.clear();
        if (words != nullptr && reader.decode((*rows)->octets(row::unit_octets_column))) {
            reader.columns.append_values(reader.decoded, values);
            page.items.push_back(to_item(sample, reader.columns.channels(reader.decoded.packet), values));
        } else {
            page.items.push_back(to_item(sample, {}, {}));
        }
    }
    if (count == page.limit + 1) page.through = std::min(page.through, last);
    return {};
}

}  // namespace

Result<ItemPage> Reader::items(RunId run, Sequence after, std::size_t limit) {
    return items(run, after, limit, {});
}

Result<ItemPage> Reader::items(RunId run, Sequence after, std::size_t limit, ItemKinds kinds) {
    if (auto fits = check_limit(limit, items_page_max); !fits) return fits.error();
    const auto instant = state_->instant(run);
    if (!instant) return instant.error();
    const auto last = state_->last_seq(run);
    if (!last) return last.error();
    if (after >= *last) return ItemPage{{}, *last, false};

    Page page{run, after, *last, limit, {}};
    if (kinds.units || kinds.samples)
        if (auto done = collect_units(*state_, instant->run, page, kinds); !done) return done.error();
    const auto explanation = [this](const sqlite::Statement& row) { return state_->explanation_item(row); };
    const auto tone = [this](const sqlite::Statement& row) { return state_->tone_item(row); };
    auto done = collect(*state_, row::event_rows, page, as_item(row::event));
    if (done) done = collect(*state_, row::tone_rows, page, tone);
    if (done) done = collect(*state_, row::stage_rows, page, as_item(row::stage));
    if (done) done = collect(*state_, row::firing_rows, page, as_item(row::firing));
    if (done) done = collect(*state_, row::explanation_rows, page, explanation);
    if (done) done = collect(*state_, row::link_rows, page, as_item(row::link));
    if (done) done = collect(*state_, row::note_rows, page, as_item(row::note));
    if (done) done = collect_alarms(*state_, instant->run, page);
    if (!done) return done.error();
    finish(page);
    return ItemPage{std::move(page.items), page.through, page.through < *last};
}

Result<v1::AlarmList> Reader::alarms(RunId run, Sequence after, std::size_t limit) {
    if (auto fits = check_limit(limit, rows_page_max); !fits) return fits.error();
    const auto instant = state_->instant(run);
    if (!instant) return instant.error();
    Page page{run, std::min(after, sequence_max - 1), sequence_max, limit, {}};
    auto done = collect_alarms(*state_, instant->run, page);
    if (done) done = collect(*state_, row::lost_link_rows, page, as_item(row::link));
    if (!done) return done.error();
    finish(page);
    v1::AlarmList list;
    for (auto& item : page.items) *list.add_changes() = std::move(item);
    list.set_next_after(page.through == sequence_max ? 0 : page.through);
    return list;
}

Result<v1::Item> Reader::State::tone_item(const sqlite::Statement& row) {
    auto record = row::tone(row);
    auto best = query(row::tone_likelihood_rows);
    if (!best) return best.error();
    (*best)->bind(1, row.integer(0));
    for (;;) {
        auto found = (*best)->step();
        if (!found) return found.error();
        if (!*found) return to_item(record);
        record.best.push_back(row::tone_likelihood(**best));
    }
}

Result<v1::Item> Reader::State::explanation_item(const sqlite::Statement& row) {
    auto record = row::explanation(row);
    auto conditions = query(row::condition_rows);
    if (!conditions) return conditions.error();
    (*conditions)->bind(1, row.integer(0));
    for (;;) {
        auto found = (*conditions)->step();
        if (!found) return found.error();
        if (!*found) return to_item(record);
        record.explanation.conditions.push_back(row::condition(**conditions));
    }
}

}  // namespace aeolis::archive
