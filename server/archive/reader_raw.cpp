// SPDX-License-Identifier: Apache-2.0
// What links brought, as it came, and the packets found in it.
#include "server/archive/reader_state.hpp"

#include <limits>

namespace aeolis::archive {
namespace {

constexpr char links_sql[] =
    "SELECT link, min(first), sum(length(octets)), (SELECT word = 'stream' FROM words WHERE kind = 'octets of ' || link"
    " AND number = ?1) FROM raw_octets WHERE run = ?1 GROUP BY link ORDER BY link";
constexpr char octets_sql[] =
    "SELECT link, ert_us, first, octets FROM raw_octets WHERE run = ?1 AND (link, first) > (?2, ?3)"
    " AND (?4 = '' OR link = ?4) AND ert_us BETWEEN ?5 AND ?6 ORDER BY link, first LIMIT ?7";
constexpr char packets_sql[] =
    "SELECT l.word, u.ert_us, u.key & 0xFFFFFFFFFF, u.octets FROM packets u"
    " JOIN words l ON l.kind = 'link' AND l.number = u.link"
    " WHERE u.key > (?1 << 40) + ?3 AND u.key < (?1 + 1) << 40 AND (?4 = '' OR l.word = ?4) AND ?2 IS NOT NULL"
    " AND l.word <> 'station'"  // made on ground: no link brought it
    " AND u.ert_us BETWEEN ?5 AND ?6 ORDER BY u.key LIMIT ?7";

}  // namespace

Result<std::vector<RawLink>> Reader::raw_links(RunId run) {
    auto rows = state_->query(links_sql);
    if (!rows) return rows.error();
    (*rows)->bind(1, std::int64_t{run.value});
    std::vector<RawLink> links;
    for (;;) {
        auto found = (*rows)->step();
        if (!found) return found.error();
        if (!*found) return links;
        const auto& row = **rows;
        links.push_back({std::string{row.text(0)}, static_cast<std::uint64_t>(row.integer(1)),
                         static_cast<std::uint64_t>(row.integer(2)), !row.is_null(3) && row.integer(3) != 0});
    }
}

Result<RawPage> Reader::raw(RunId run, const RawQuery& query, const std::optional<RawPiece>& after) {
    auto rows = state_->query(query.packets ? packets_sql : octets_sql);
    if (!rows) return rows.error();
    const std::string link = after ? after->link : "";
    (*rows)
        ->bind(1, std::int64_t{run.value})
        .bind(2, std::string_view(link))
        .bind(3, after ? sqlite::number(after->first) : std::int64_t{query.packets ? 0 : -1})
        .bind(4, std::string_view(query.link))
        .bind(5, query.from ? query.from->microseconds : std::numeric_limits<std::int64_t>::min())
        .bind(6, query.to ? query.to->microseconds : std::numeric_limits<std::int64_t>::max())
        .bind(7, static_cast<std::int64_t>(raw_page_max));
    RawPage page;
    for (;;) {
        auto found = (*rows)->step();
        if (!found) return found.error();
        if (!*found) break;
        const auto& row = **rows;
        const auto octets = row.octets(3);
        page.pieces.push_back({std::string{row.text(0)},
                               Ert{row.integer(1)},
                               static_cast<std::uint64_t>(row.integer(2)),
                               {octets.begin(), octets.end()}});
    }
    page.last = page.pieces.size() < raw_page_max;
    return page;
}

}  // namespace aeolis::archive
