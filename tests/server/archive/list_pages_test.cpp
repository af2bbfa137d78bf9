// SPDX-License-Identifier: Apache-2.0
#include "server/archive/reader.hpp"
#include "tests/server/run_writer.hpp"
#include "tests/server/small_mission.hpp"
#include "tests/support/catch.hpp"

#include <algorithm>
#include <functional>

namespace archive_list_pages_test {

using namespace aeolis;
using namespace aeolis::test;
using archive::Archive;
using archive::Order;
using archive::Reader;
using archive::RunId;

namespace {

constexpr RunId run{1};

struct Page {
    std::vector<std::uint64_t> rows;
    std::uint64_t next_after = 0;
};
struct List {
    const char* name;
    std::function<Page(Reader&, std::uint64_t after, std::size_t limit, Order order)> page;
    std::size_t a_round = 1;  ///< rows of a round of RunWriter
};

template <typename Rows, typename Number>
Page page_of(const Rows& rows, std::uint64_t next_after, Number number) {
    Page page{{}, next_after};
    for (const auto& row : rows) page.rows.push_back(number(row));
    return page;
}
std::uint64_t seq_of(const v1::Item& item) {
    return item.seq();
}
template <typename Query>
Query query_of(std::uint64_t after, std::size_t limit, Order order) {
    Query query;
    query.after = static_cast<decltype(query.after)>(after);
    query.limit = limit;
    query.order = order;
    return query;
}

const std::vector<List> lists{
    {"events",
     [](Reader& reader, std::uint64_t after, std::size_t limit, Order order) {
         const auto list = reader.events(run, query_of<archive::EventQuery>(after, limit, order));
         return page_of(list->events(), list->next_after(), seq_of);
     }},
    {"events with words",
     [](Reader& reader, std::uint64_t after, std::size_t limit, Order order) {
         auto query = query_of<archive::EventQuery>(after, limit, order);
         query.text = "planned";
         const auto list = reader.events(run, query);
         return page_of(list->events(), list->next_after(), seq_of);
     }},
    {"tones",
     [](Reader& reader, std::uint64_t after, std::size_t limit, Order order) {
         const auto list = reader.tones(run, query_of<archive::ToneQuery>(after, limit, order));
         return page_of(list->tones(), list->next_after(), seq_of);
     }},
    {"explanations",
     [](Reader& reader, std::uint64_t after, std::size_t limit, Order order) {
         const auto list = reader.explanations(run, query_of<archive::ExplanationQuery>(after, limit, order));
         return page_of(list->explanations(), list->next_after(), seq_of);
     }},
    {"notes",
     [](Reader& reader, std::uint64_t after, std::size_t limit, Order order) {
         const auto list = reader.notes(run, query_of<archive::NoteQuery>(after, limit, order));
         return page_of(list->notes(), list->next_after(), seq_of);
     }},
    {"packets",
     [](Reader& reader, std::uint64_t after, std::size_t limit, Order order) {
         const auto list = reader.packets(run, query_of<archive::PacketQuery>(after, limit, order));
         return page_of(list->packets(), list->next_after(), [](const auto& row) { return row.unit().unit(); });
     }},
    {"alarms",
     [](Reader& reader, std::uint64_t after, std::size_t limit, Order order) {
         const auto list = reader.alarms(run, after, limit, order);
         return page_of(list->changes(), list->next_after(), seq_of);
     }},
    {"commands",
     [](Reader& reader, std::uint64_t after, std::size_t limit, Order order) {
         const auto list = reader.commands(run, query_of<archive::CommandQuery>(after, limit, order));
         return page_of(list->commands(), list->next_after(), [](const auto& row) { return row.command(); });
     }},
    {"commands with words",
     [](Reader& reader, std::uint64_t after, std::size_t limit, Order order) {
         auto query = query_of<archive::CommandQuery>(after, limit, order);
         query.text = "planned";
         const auto list = reader.commands(run, query);
         return page_of(list->commands(), list->next_after(), [](const auto& row) { return row.command(); });
     }},
    {"interventions",
     [](Reader& reader, std::uint64_t after, std::size_t limit, Order order) {
         const auto list = reader.interventions(run, query_of<archive::InterventionQuery>(after, limit, order));
         return page_of(list->interventions(), list->next_after(),
                        [](const auto& row) { return std::stoull(row.note().text()); });
     }},
};

struct Recorded {
    TemporaryFolder folder;
    dictionary::Dictionary dictionary = small_dictionary();
    Archive archive = std::move(Archive::open(folder / "a.db")).value();
    RunId first = std::move(archive.begin_run({}, dictionary)).value();
    RunWriter rows{archive, first};
    Reader reader = std::move(Reader::open(folder / "a.db", dictionary)).value();
};

/// All rows of a list, page by page; `between` is called after each page.
std::vector<std::uint64_t> walk(Reader& reader, const List& list, Order order, const std::function<void()>& between) {
    std::vector<std::uint64_t> all;
    for (std::uint64_t after = 0;;) {
        const auto page = list.page(reader, after, 7, order);
        CHECK(page.rows.size() <= 7);
        all.insert(all.end(), page.rows.begin(), page.rows.end());
        if (page.next_after == 0) return all;
        after = page.next_after;
        between();
    }
}

}  // namespace

TEST_CASE("the pages of every list hold each row once, in either order, while a writer appends", "[archive][R62]") {
    Recorded recorded;
    recorded.rows.add(30);
    for (const auto& list : lists) {
        INFO(list.name);
        const auto before = walk(recorded.reader, list, Order::oldest_first, [] {});
        CHECK(before.size() == recorded.rows.rounds());
        int appended = 0;
        const auto append = [&] {
            if (++appended <= 2) recorded.rows.add(1);
        };
        const auto oldest = walk(recorded.reader, list, Order::oldest_first, append);
        CHECK(oldest.size() == recorded.rows.rounds());
        CHECK(std::ranges::adjacent_find(oldest, std::greater_equal{}) == oldest.end());
        CHECK(std::ranges::includes(oldest, before));

        appended = 0;
        auto newest = walk(recorded.reader, list, Order::newest_first, append);
        CHECK(std::ranges::adjacent_find(newest, std::less_equal{}) == newest.end());
        std::ranges::reverse(newest);
        CHECK(newest == oldest);  // what came meanwhile stands before the first page
    }
}

TEST_CASE("a page goes on after any number, also one that no row has", "[archive]") {
    Recorded recorded;
    recorded.rows.add(3);
    for (const auto& list : lists) {
        INFO(list.name);
        const auto all = list.page(recorded.reader, 0, 100, Order::oldest_first);
        CHECK(all.rows.size() == 3);
        CHECK(all.next_after == 0);
        const std::uint64_t beyond = INT64_MAX;
        CHECK(list.page(recorded.reader, beyond, 100, Order::oldest_first).rows.empty());
        CHECK(list.page(recorded.reader, beyond, 100, Order::newest_first).rows.size() == 3);
        CHECK(list.page(recorded.reader, 1, 100, Order::newest_first).rows.empty());
    }
}

TEST_CASE("runs have pages in either order", "[archive]") {
    Recorded recorded;
    for (int i = 0; i < 9; ++i) {
        RunWriter rows{recorded.archive, RunId{static_cast<std::uint32_t>(i) + 1}};
        rows.finish();
        REQUIRE(recorded.archive.begin_run({}, recorded.dictionary));
    }
    const List runs{"runs", [](Reader& reader, std::uint64_t after, std::size_t limit, Order order) {
                        const auto list = reader.runs(query_of<archive::RunQuery>(after, limit, order));
                        return page_of(list->runs(), list->next_after(), [](const auto& row) { return row.run(); });
                    }};
    CHECK(walk(recorded.reader, runs, Order::oldest_first, [] {}) ==
          std::vector<std::uint64_t>{1, 2, 3, 4, 5, 6, 7, 8, 9, 10});
    CHECK(walk(recorded.reader, runs, Order::newest_first, [] {}) ==
          std::vector<std::uint64_t>{10, 9, 8, 7, 6, 5, 4, 3, 2, 1});
}

TEST_CASE("the audit has pages in either order", "[archive]") {
    Recorded recorded;
    const std::vector<archive::AuditRecord> acts(3);
    REQUIRE(recorded.archive.append_audit(acts));
    const auto entries = [&](std::uint64_t after, Order order) {
        std::vector<std::uint64_t> numbers;
        const auto page = recorded.reader.audit(after, 2, order);
        REQUIRE(page);
        for (const auto& entry : *page) numbers.push_back(entry.entry);
        return numbers;
    };
    CHECK(entries(0, Order::oldest_first) == std::vector<std::uint64_t>{1, 2});
    CHECK(entries(2, Order::oldest_first) == std::vector<std::uint64_t>{3});
    CHECK(entries(0, Order::newest_first) == std::vector<std::uint64_t>{3, 2});
    CHECK(entries(2, Order::newest_first) == std::vector<std::uint64_t>{1});
}

TEST_CASE("a page of long rows ends before its limit, and the next goes on", "[archive][R62]") {
    Recorded recorded;
    RunWriter long_rows{recorded.archive, recorded.first, std::string(20'000, 'x')};
    long_rows.add(60);
    for (const auto& list : lists) {
        const bool is_short = std::string_view{list.name} == "packets" || std::string_view{list.name} == "alarms" ||
                              std::string_view{list.name} == "interventions" ||
                              std::string_view{list.name}.ends_with("words");
        if (is_short) continue;
        INFO(list.name);
        for (const auto order : {Order::oldest_first, Order::newest_first}) {
            std::size_t rows = 0, pages = 0;
            for (std::uint64_t after = 0;; ++pages) {
                const auto page = list.page(recorded.reader, after, 1'000, order);
                CHECK_FALSE(page.rows.empty());
                CHECK(page.rows.size() <= archive::page_octets_max / 20'000 + 1);
                rows += page.rows.size();
                if (page.next_after == 0) break;
                after = page.next_after;
            }
            CHECK(rows == 60);
            CHECK(pages > 0);
        }
    }
}

}  // namespace archive_list_pages_test
