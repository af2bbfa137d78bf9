// SPDX-License-Identifier: Apache-2.0
#include "server/links/link_ledger.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/octets.hpp"

namespace server_link_ledger_test {

using namespace aeolis;
using namespace aeolis::server;

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

}  // namespace server_link_ledger_test
