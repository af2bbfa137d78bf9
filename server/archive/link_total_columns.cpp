// SPDX-License-Identifier: Apache-2.0
#include "server/archive/link_total_columns.hpp"

#include <array>

namespace aeolis::archive {

namespace {

using Out = v1::LinkCounters;

template <auto Set>
void set(Out& counters, std::uint64_t number) {
    (counters.*Set)(number);
}
template <auto Member, auto Set>
constexpr LinkTotalColumn of_frames(const char* name) {
    return {name, [](const LinkTotals& totals) { return totals.counters.*Member; }, set<Set>};
}
template <auto Member, auto Set>
constexpr LinkTotalColumn of_packets(const char* name) {
    return {name, [](const LinkTotals& totals) { return totals.packets.*Member; }, set<Set>};
}

constexpr std::array link_counters{
    of_frames<&telemetry::LinkCounters::octets, &Out::set_octets>("octets"),
    of_frames<&telemetry::LinkCounters::frames, &Out::set_frames>("frames"),
    of_frames<&telemetry::LinkCounters::bad_crc, &Out::set_bad_crc>("bad_crc"),
    of_frames<&telemetry::LinkCounters::bad_header, &Out::set_bad_header>("bad_header"),
    of_frames<&telemetry::LinkCounters::skipped_octets, &Out::set_skipped_octets>("skipped_octets"),
    of_frames<&telemetry::LinkCounters::gaps, &Out::set_gaps>("gaps"),
    of_frames<&telemetry::LinkCounters::missing_frames, &Out::set_missing_frames>("missing_frames"),
    of_frames<&telemetry::LinkCounters::repeated_frames, &Out::set_repeated_frames>("repeated_frames"),
    of_frames<&telemetry::LinkCounters::late_frames, &Out::set_late_frames>("late_frames"),
    of_frames<&telemetry::LinkCounters::restarts, &Out::set_restarts>("restarts"),
    of_frames<&telemetry::LinkCounters::cut_frames, &Out::set_cut_frames>("cut_frames"),
    of_frames<&telemetry::LinkCounters::slips, &Out::set_slips>("slips"),
    of_frames<&telemetry::LinkCounters::corrected_frames, &Out::set_corrected_frames>("corrected_frames"),
    of_frames<&telemetry::LinkCounters::corrected_symbols, &Out::set_corrected_symbols>("corrected_symbols"),
    of_frames<&telemetry::LinkCounters::corrected_headers, &Out::set_corrected_headers>("corrected_headers"),
    of_frames<&telemetry::LinkCounters::uncorrectable_frames, &Out::set_uncorrectable_frames>("uncorrectable_frames"),
    of_frames<&telemetry::LinkCounters::other_data_frames, &Out::set_other_data_frames>("other_data_frames"),
    of_frames<&telemetry::LinkCounters::forgotten_channels, &Out::set_forgotten_channels>("forgotten_channels"),
    of_packets<&telemetry::PacketCounters::packets, &Out::set_packets>("packets"),
    of_packets<&telemetry::PacketCounters::idle_packets, &Out::set_idle_packets>("idle_packets"),
    of_packets<&telemetry::PacketCounters::encapsulation_packets, &Out::set_encapsulation_packets>(
        "encapsulation_packets"),
    of_packets<&telemetry::PacketCounters::cut_packets, &Out::set_cut_packets>("cut_packets"),
    of_packets<&telemetry::PacketCounters::lost_segments, &Out::set_lost_segments>("lost_segments"),
    of_packets<&telemetry::PacketCounters::unreadable_octets, &Out::set_unreadable_octets>("unreadable_octets"),
    LinkTotalColumn{"bad_datagrams", [](const LinkTotals& totals) { return totals.bad_datagrams; },
                    set<&Out::set_bad_datagrams>},
};

std::string link_counter_names() {
    std::string names;
    for (const auto& column : link_counters) names += std::string(", ") + column.name;
    return names;
}

}  // namespace

std::span<const LinkTotalColumn> link_total_columns() {
    return link_counters;
}

std::string link_totals_table_sql() {
    std::string sql = "CREATE TABLE link_totals (run INTEGER NOT NULL, link TEXT NOT NULL, octets_per_s REAL NOT NULL";
    for (const auto& column : link_counters) sql += std::string(", ") + column.name + " INTEGER NOT NULL";
    return sql + ", PRIMARY KEY (run, link)) STRICT, WITHOUT ROWID;";
}

std::string put_link_totals_sql() {
    std::string sql =
        "INSERT OR REPLACE INTO link_totals (run, link, octets_per_s" + link_counter_names() + ") VALUES (?,?,?";
    for (std::size_t i = 0; i < link_counters.size(); ++i) sql += ",?";
    return sql + ")";
}

std::string link_totals_of_run_sql() {
    return "SELECT link, octets_per_s" + link_counter_names() + " FROM link_totals WHERE run = ?1 ORDER BY link";
}

}  // namespace aeolis::archive
