// SPDX-License-Identifier: Apache-2.0
#include "server/archive/link_total_columns.hpp"

#include "tests/support/catch.hpp"

#include <set>
#include <string>

namespace server_archive_link_total_columns_test {

using namespace aeolis;
using namespace aeolis::archive;

TEST_CASE("each counter of a link that the API tells is a column, and none is told in another's place", "[archive]") {
    const auto& descriptor = *v1::LinkCounters::descriptor();
    const auto& reflection = *v1::LinkCounters::GetReflection();
    std::set<std::string> named;
    for (const auto& column : link_total_columns()) {
        CAPTURE(column.name);
        CHECK(named.insert(column.name).second);
        const auto* field = descriptor.FindFieldByName(column.name);
        REQUIRE(field != nullptr);
        v1::LinkCounters told;
        column.set(told, 7);
        CHECK(reflection.GetUInt64(told, field) == 7);
    }
    for (int i = 0; i < descriptor.field_count(); ++i) {
        const auto& field = *descriptor.field(i);
        if (field.type() == google::protobuf::FieldDescriptor::TYPE_UINT64) CHECK(named.contains(field.name()));
    }
}

TEST_CASE("each counter is read from the totals once", "[archive]") {
    LinkTotals totals;
    std::uint64_t next = 1;
    for (auto* counter : {&totals.counters.octets,
                          &totals.counters.frames,
                          &totals.counters.bad_crc,
                          &totals.counters.bad_header,
                          &totals.counters.skipped_octets,
                          &totals.counters.gaps,
                          &totals.counters.missing_frames,
                          &totals.counters.repeated_frames,
                          &totals.counters.late_frames,
                          &totals.counters.restarts,
                          &totals.counters.cut_frames,
                          &totals.counters.slips,
                          &totals.counters.corrected_frames,
                          &totals.counters.corrected_symbols,
                          &totals.counters.corrected_headers,
                          &totals.counters.uncorrectable_frames,
                          &totals.counters.other_data_frames,
                          &totals.counters.forgotten_channels,
                          &totals.packets.packets,
                          &totals.packets.idle_packets,
                          &totals.packets.encapsulation_packets,
                          &totals.packets.cut_packets,
                          &totals.packets.lost_segments,
                          &totals.packets.unreadable_octets,
                          &totals.bad_datagrams})
        *counter = next++;
    std::uint64_t expected = 1;
    for (const auto& column : link_total_columns()) {
        CAPTURE(column.name);
        CHECK(column.of(totals) == expected++);
    }
    CHECK(expected == next);
}

}  // namespace server_archive_link_total_columns_test
