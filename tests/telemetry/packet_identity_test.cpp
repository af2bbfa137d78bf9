// SPDX-License-Identifier: Apache-2.0
#include "telemetry/packet_identity.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/small_dictionary.hpp"

#include <map>
#include <random>
#include <set>

namespace telemetry_unit_identity_test {

using namespace aeolis;
using namespace aeolis::telemetry;
using aeolis::tests::PacketFiller;

namespace {

std::vector<std::uint8_t> status(double speed_mps, std::uint16_t count, double sclk = 1000.0) {
    static const auto dictionary = tests::small_dictionary();
    return PacketFiller{dictionary, "Status"}.real("speed_mps", speed_mps).seal(count, Sclk{sclk});
}

}  // namespace

TEST_CASE("a packet is named by APID, SCLK, count and CRC", "[packet_identity]") {
    const auto packet = status(400.0, 16383, 1000.015625);
    const auto identity = identity_of(packet);
    CHECK(identity.apid == tests::status_apid);
    CHECK(identity.sclk_65536 == 1000 * 65536 + 1024);
    CHECK(identity.count == 16383);
    CHECK(identity.crc == (packet[packet.size() - 2] << 8 | packet.back()));
}

TEST_CASE("a recorded packet that was seen in real time is a duplicate, and the reverse", "[packet_identity]") {
    PacketRegister packets;
    CHECK(packets.add(status(400.0, 1), Path::realtime) == Standing::first);
    CHECK(packets.add(status(400.0, 1), Path::recorded) == Standing::duplicate);
    CHECK(packets.add(status(400.0, 2), Path::recorded) == Standing::first);
    CHECK(packets.add(status(400.0, 2), Path::realtime) == Standing::duplicate);
    CHECK(packets.counts().both == 2);
}

TEST_CASE("the same packet twice on one path is told from a duplicate", "[packet_identity]") {
    PacketRegister packets;
    CHECK(packets.add(status(400.0, 1), Path::recorded) == Standing::first);
    CHECK(packets.add(status(400.0, 1), Path::recorded) == Standing::again);
    CHECK(packets.counts().recorded == 1);
    CHECK(packets.counts().again == 1);
}

TEST_CASE("one bit that differs is found, once for each packet", "[packet_identity]") {
    PacketRegister packets;
    CHECK(packets.add(status(400.0, 1), Path::realtime) == Standing::first);
    CHECK(packets.add(status(400.00003, 1), Path::recorded) == Standing::differs);
    CHECK(packets.add(status(400.00003, 1), Path::recorded) == Standing::differs);
    CHECK(packets.counts().differs == 1);
    REQUIRE(packets.differing().size() == 1);
    CHECK(packets.differing()[0].count == 1);
}

TEST_CASE("a count that has wrapped names another packet", "[packet_identity]") {
    PacketRegister packets;
    CHECK(packets.add(status(400.0, 5, 1000.0), Path::realtime) == Standing::first);
    CHECK(packets.add(status(400.0, 5, 17384.0), Path::realtime) == Standing::first);
}

TEST_CASE("a full register says that it cannot tell", "[packet_identity]") {
    PacketRegister packets{2};
    packets.add(status(400.0, 1), Path::realtime);
    packets.add(status(400.0, 2), Path::realtime);
    CHECK(packets.add(status(400.0, 3), Path::recorded) == Standing::unregistered);
    CHECK(packets.add(status(400.0, 2), Path::recorded) == Standing::duplicate);
    CHECK(packets.counts().unregistered == 1);
}

TEST_CASE("the counts agree with sets kept by hand", "[packet_identity][property]") {
    std::mt19937 random{42};
    PacketRegister packets;
    std::map<std::uint16_t, std::set<int>> live, recorded;
    for (int round = 0; round < 5000; ++round) {
        const auto count = static_cast<std::uint16_t>(random() % 500);
        const int content = random() % 50 == 0 ? 1 : 0;
        const bool is_live = random() % 2 == 0;
        (is_live ? live : recorded)[count].insert(content);
        packets.add(status(content, count), is_live ? Path::realtime : Path::recorded);
    }
    std::uint64_t both = 0, differs = 0;
    for (const auto& [count, contents] : live) both += recorded.contains(count) ? 1 : 0;
    for (std::uint16_t count = 0; count < 500; ++count) {
        std::set<int> all = live[count];
        all.merge(recorded[count]);
        differs += all.size() > 1 ? 1 : 0;
    }
    CHECK(packets.counts().both == both);
    CHECK(packets.counts().differs == differs);
}

}  // namespace telemetry_unit_identity_test
