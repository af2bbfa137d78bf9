// SPDX-License-Identifier: Apache-2.0
#include "server/archive/item_rows.hpp"
#include "server/archive/items.hpp"
#include "server/archive/reader.hpp"
#include "server/archive/reader_state.hpp"
#include "server/archive/schema.hpp"

#include <algorithm>

// Items of all kinds as one sequence: each table is read from the same position.
namespace aeolis::archive {

namespace {

/// A page being collected. `through` is lowered when a table has more rows than fit; newest first, `after` is raised.
struct Page {
    RunId run;
    Sequence after = 0;
    Sequence through = 0;
    std::size_t limit = 0;
    Order order{};
    std::vector<v1::Item> items{};

    bool newest_first() const { return order == Order::newest_first; }
    /// Leaves what lies beyond this item, in the page's order, to the next page.
    void end_with(const v1::Item& item) {
        if (newest_first())
            after = std::max<Sequence>(after, item.seq() - 1);
        else
            through = std::min<Sequence>(through, item.seq());
    }
    bool holds(const v1::Item& item) const { return after < item.seq() && item.seq() <= through; }
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
    if (count == page.limit) page.end_with(page.items.back());
    return {};
}

/// Sorts the page and removes items beyond its end.
void finish(Page& page) {
    std::sort(page.items.begin(), page.items.end(), [&](const auto& a, const auto& b) {
        return page.newest_first() ? a.seq() > b.seq() : a.seq() < b.seq();
    });
    while (!page.items.empty() && !page.holds(page.items.back())) page.items.pop_back();
    if (page.items.size() <= page.limit) return;
    page.items.resize(page.limit);
    page.end_with(page.items.back());
}

/// Collects the items of one kind.
template <typename Record>
Result<void> collect(Reader::State& reader, const RunInfo& info, Page& page, const char* sql) {
    const auto* words = reader.words_of(info);
    return collect(reader, sql, page, [&](const auto& row) { return reader.item<Record>(row, words); });
}

template <typename Record>
Result<void> collect(Reader::State& reader, const RunInfo& info, Page& page) {
    return collect<Record>(reader, info, page, rows_sql<Record>(page.order));
}

Result<void> collect_alarms(Reader::State& reader, const RunInfo& info, Page& page) {
    auto done = collect<AlarmRecord>(reader, info, page);
    if (done) done = collect<StalenessRecord>(reader, info, page);
    if (done) done = collect<AlarmActionRecord>(reader, info, page);
    return done;
}

/// Collects packets and their samples. A row gives one item or, if sampled, two; the page may begin between them.
Result<void> collect_packets(Reader::State& reader, const RunInfo& info, Page& page, Reader::ItemKinds kinds) {
    auto rows = reader.query(rows_sql<PacketRecord>(page.order));
    if (!rows) return rows.error();
    (*rows)
        ->bind(1, item_key(page.run, page.after))
        .bind(2, item_key(page.run, page.through))
        .bind(3, static_cast<std::int64_t>(page.limit + 1));  // the first row may have no item left
    const auto* words = reader.words_of(info);
    std::vector<double> values;
    std::size_t count = 0, octets = 0;
    Sequence last = page.newest_first() ? page.through : page.after;  // the last item that is complete
    const auto add = [&](v1::Item item) {
        if (kinds.octets_max != SIZE_MAX) octets += item.ByteSizeLong();
        page.items.push_back(std::move(item));
    };
    for (; octets < kinds.octets_max; ++count) {
        auto found = (*rows)->step();
        if (!found) return found.error();
        if (!*found) break;
        const auto record = read_row<PacketRecord>(**rows);
        last = record.sampled && !page.newest_first() ? record.seq + 1 : record.seq;
        if (kinds.packets && record.seq > page.after) add(to_item(record, words));
        if (!kinds.samples || !record.sampled || record.seq == page.through) continue;
        // With another dictionary the values are unknown; the item still keeps its number.
        SampleRecord sample{{record.seq + 1, record.ert}, record.packet.value_or(0), record.sclk, record.source, {}};
        values.clear();
        if (words != nullptr && record.packet && reader.decode(octets_of_packet(**rows), *record.packet)) {
            reader.columns.append_values(reader.decoded, values);
            sample.texts = reader.columns.texts(reader.decoded);
            sample.sclk_by_reception = !reader.decoded.timed;
            add(to_item(sample, reader.columns.channels(reader.decoded.packet), values));
        } else {
            add(to_item(sample, {}, {}));
        }
    }
    if (count < page.limit + 1 && octets < kinds.octets_max) return {};
    if (page.newest_first())
        page.after = std::max<Sequence>(page.after, last - 1);
    else
        page.through = std::min(page.through, last);
    return {};
}

/// Collects the items of all kinds.
Result<void> collect_all(Reader::State& reader, Page& page, Reader::ItemKinds kinds) {
    if (auto fits = check_limit(page.limit, items_page_max); !fits) return fits;
    const auto instant = reader.instant(page.run);
    if (!instant) return instant.error();
    if (page.after >= page.through) return {};
    auto done = try_item_kinds([&]<typename Record>(ItemKind<Record>) {
        if constexpr (std::is_same_v<Record, PacketRecord>)
            return kinds.packets || kinds.samples ? collect_packets(reader, instant->run, page, kinds) : Result<void>{};
        else if constexpr (std::is_same_v<Record, ProcedureStatusRecord>)
            return kinds.procedures ? collect<Record>(reader, instant->run, page) : Result<void>{};
        else
            return collect<Record>(reader, instant->run, page);
    });
    if (done) finish(page);
    return done;
}

}  // namespace

Result<ItemPage> Reader::items(RunId run, Sequence after, std::size_t limit) {
    return items(run, after, limit, {});
}

Result<ItemPage> Reader::items(RunId run, Sequence after, std::size_t limit, ItemKinds kinds) {
    const auto last = state_->last_seq(run);
    if (!last) return last.error();
    Page page{run, std::min(after, *last), *last, limit};
    if (auto done = collect_all(*state_, page, kinds); !done) return done.error();
    return ItemPage{std::move(page.items), page.through, page.through < *last, after};
}

Result<ItemPage> Reader::newest_items(RunId run, Sequence before, std::size_t limit, ItemKinds kinds) {
    const auto last = state_->last_seq(run);
    if (!last) return last.error();
    const Sequence through = before == 0 ? *last : std::min(before - 1, *last);
    Page page{run, 0, through, limit, Order::newest_first};
    if (auto done = collect_all(*state_, page, kinds); !done) return done.error();
    return ItemPage{std::move(page.items), through, page.after > 0, page.after};
}

Result<v1::AlarmList> Reader::alarms(RunId run, Sequence after, std::size_t limit, Order order) {
    if (auto fits = check_limit(limit, rows_page_max); !fits) return fits.error();
    const auto instant = state_->instant(run);
    if (!instant) return instant.error();
    static const auto lost_some_time = select_in_order<LinkRecord>(
        "key BETWEEN ?1 AND ?2 AND link IN (SELECT link FROM link_changes WHERE lost AND key"
        " BETWEEN ?1 >> 40 << 40 AND ?2 | 0xFFFFFFFFFF)");
    const auto numbers = numbers_after(after, order, sequence_max);
    Page page{run, numbers.first - 1, numbers.last, limit, order};
    auto done = collect_alarms(*state_, instant->run, page);
    if (done) done = collect<LinkRecord>(*state_, instant->run, page, lost_some_time.in(order));
    if (!done) return done.error();
    finish(page);
    v1::AlarmList list;
    PageSize size{limit};
    for (auto& item : page.items) {
        if (size.full()) {
            page.end_with(*list.changes().rbegin());
            break;
        }
        size.add(item.ByteSizeLong());
        *list.add_changes() = std::move(item);
    }
    const bool more = order == Order::newest_first ? page.after + 1 > numbers.first : page.through < numbers.last;
    if (more && list.changes_size() > 0) list.set_next_after(list.changes().rbegin()->seq());
    return list;
}

}  // namespace aeolis::archive
