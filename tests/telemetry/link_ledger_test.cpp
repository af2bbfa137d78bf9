// SPDX-License-Identifier: Apache-2.0
#include "telemetry/station/link_ledger.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/octets.hpp"

#include <map>

namespace telemetry_link_ledger_test {

using namespace aeolis;
using namespace aeolis::telemetry;

TEST_CASE("a link's totals go on over its connections, and what went wrong is said once", "[server][downlink][R54]") {
    LinkLedger ledger{"downlink"};
    const auto packet = test::hex("012dc0070001aabb");
    const auto connection = [&](std::size_t cut) {
        auto source = telemetry::PacketSource::of_packets(0);
        auto octets = packet;
        octets.insert(octets.end(), packet.begin(), packet.end() - static_cast<std::ptrdiff_t>(cut));
        ledger.received(Ert{0}, octets.size());
        source.receive(octets);
        source.end();
        return source;
    };
    const auto first = connection(3);
    const auto one = ledger.totals(&first, Ert{0});
    CHECK(one.packets.packets == 1);
    CHECK(one.packets.cut_packets == 1);
    REQUIRE(one.sequences.size() == 1);
    CHECK(one.sequences[0].name == "APID 301");
    CHECK(ledger.faults_since(one) == "1 packets cut off, 5 octets unreadable");
    ledger.end(first);
    ledger.bad_datagram();
    const auto between = ledger.totals(nullptr, Ert{0});
    CHECK(between.packets == one.packets);
    CHECK(between.sequences.empty());  // unchanged
    CHECK(ledger.changed(between));
    CHECK_FALSE(ledger.changed(between));
    CHECK(ledger.faults_since(between) == "1 bad datagrams");
    CHECK(ledger.faults_since(between).empty());
    const auto second = connection(8);
    const auto both = ledger.totals(&second, Ert{0});
    CHECK(both.packets.packets == 2);
    CHECK(both.counters.octets == 21);
    REQUIRE(both.sequences.size() == 1);
    CHECK(both.sequences[0].counters.received == 2);
    CHECK(ledger.faults_since(both).empty());
}

TEST_CASE("sequences of a link beyond a number are told in one row, in time in proportion, and no total falls",
          "[server][downlink][R54]") {
    constexpr std::size_t prefixes = 3, apids = 2000;
    LinkLedger ledger{"downlink"};
    LinkTotals all;
    for (std::size_t connection = 0; connection < 2 * prefixes; ++connection) {
        // Packets in frames of another spacecraft each: as many names again.
        auto source =
            telemetry::PacketSource::of_frames({.frame_octets = 15, .marker = false, .agreed = {.crc = false}});
        for (std::size_t apid = 0; apid < apids; ++apid) {
            auto packet = test::hex("0000c0000002aabbcc");
            packet[0] = static_cast<std::uint8_t>(apid / 256);
            packet[1] = static_cast<std::uint8_t>(apid % 256);
            TransferFrame frame;
            frame.spacecraft = static_cast<std::uint16_t>(connection % prefixes);
            frame.count = static_cast<std::uint32_t>(apid % 256);
            frame.first_header_pointer = 0;
            frame.data = packet;
            std::vector<std::uint8_t> octets(15);
            write_tm_frame(frame, 0, false, octets);
            source.receive(octets);
            while (source.next()) {
            }
        }
        auto told = ledger.totals(&source, Ert{0});
        std::map<std::pair<bool, std::string>, std::uint64_t> before;
        for (const auto& each : all.sequences) before[{each.packets, each.name}] = each.counters.received;
        for (const auto& each : told.sequences) CHECK(each.counters.received > before[{each.packets, each.name}]);
        merge(all, std::move(told));
        ledger.end(source);
    }
    CHECK(all.sequences.size() == telemetry::sequences_named_max + 1);
    std::uint64_t packets = 0;
    for (const auto& each : all.sequences) packets += each.packets ? each.counters.received : 0;
    CHECK(packets == 2 * prefixes * apids);
}

}  // namespace telemetry_link_ledger_test
