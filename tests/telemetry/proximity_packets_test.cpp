// SPDX-License-Identifier: Apache-2.0
#include "common/space_packet.hpp"
#include "telemetry/proximity_packets.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/octets.hpp"

#include <algorithm>

namespace telemetry_proximity_packets_test {

using namespace aeolis;
using namespace aeolis::telemetry;

namespace {

using Octets = std::vector<std::uint8_t>;

Octets packet_of(std::size_t data_octets, std::uint16_t apid = 0x20) {
    Octets packet(tm_overhead_octets + data_octets, 0x5A);
    seal_tm_packet(packet, Apid{apid}, 0, Sclk{1.0}, 1);
    return packet;
}

PltuReceiver::Received received(Construction construction, const Octets& data, FramePlace place = FramePlace::next) {
    return {{{.construction = construction, .spacecraft = 76}, data}, place};
}

Octets segment(bool first, bool last, std::uint8_t packet, std::span<const std::uint8_t> part) {
    Octets octets(1 + part.size());
    octets[0] = segment_header_octet({first, last, packet});
    std::ranges::copy(part, octets.begin() + 1);
    return octets;
}

std::vector<Octets> all(ProximityPackets& packets) {
    std::vector<Octets> found;
    while (const auto packet = packets.next()) found.push_back(test::copy_of(*packet));
    return found;
}

}  // namespace

TEST_CASE("whole packets of a frame come out one by one", "[telemetry]") {
    ProximityPackets packets;
    Octets data = packet_of(3);
    const Octets second = packet_of(40);
    data.insert(data.end(), second.begin(), second.end());
    packets.add(received(Construction::packets, data));
    CHECK(all(packets) == std::vector<Octets>{packet_of(3), second});
    CHECK(packets.counters() == PacketCounters{.packets = 2});
}

TEST_CASE("a packet cut into segments over frames comes out whole, also when two are sent at a time", "[telemetry]") {
    const Octets a = packet_of(500), b = packet_of(300);
    ProximityPackets packets;
    const std::span sa{a}, sb{b};
    packets.add(received(Construction::segments, segment(true, false, 1, sa.first(200))));
    packets.add(received(Construction::segments, segment(true, false, 2, sb.first(100))));
    packets.add(received(Construction::segments, segment(false, false, 1, sa.subspan(200, 200))));
    packets.add(received(Construction::segments, segment(false, true, 2, sb.subspan(100))));
    packets.add(received(Construction::segments, segment(false, true, 1, sa.subspan(400))));
    packets.add(received(Construction::segments, segment(true, true, 3, packet_of(1))));
    CHECK(all(packets) == std::vector<Octets>{b, a, packet_of(1)});
}

TEST_CASE("a missing frame, a second beginning and a segment without beginning cost that packet only", "[telemetry]") {
    const Octets a = packet_of(500);
    const std::span sa{a};
    ProximityPackets packets;
    packets.add(received(Construction::segments, segment(true, false, 1, sa.first(200))));
    packets.add(received(Construction::segments, segment(false, true, 1, sa.subspan(400)), FramePlace::after_gap));
    CHECK(all(packets).empty());
    CHECK(packets.counters().cut_packets == 1);
    packets.add(received(Construction::segments, segment(true, false, 1, sa.first(200))));
    packets.add(received(Construction::segments, segment(true, false, 1, sa.first(300))));
    packets.add(received(Construction::segments, segment(false, true, 1, sa.subspan(300))));
    CHECK(all(packets) == std::vector<Octets>{a});
    CHECK(packets.counters().cut_packets == 2);
}

TEST_CASE("fill, supervisory frames and what is no packet are counted and not given out", "[telemetry]") {
    ProximityPackets packets;
    packets.add(received(Construction::packets, packet_of(3, idle_apid)));
    packets.add(received(Construction::octets, {1, 2, 3}));
    packets.add(received(Construction::packets, test::hex("ffffffffffffffff")));
    auto supervisory = received(Construction::packets, packet_of(3));
    supervisory.frame.header.supervisory = true;
    packets.add(supervisory);
    CHECK(all(packets).empty());
    CHECK(packets.counters() == PacketCounters{.idle_packets = 1, .unreadable_octets = 8});
    CHECK(packets.other_frames() == 2);
}

TEST_CASE("of a late frame whole packets are used, and a segment costs no other packet", "[telemetry][R55]") {
    const Octets a = packet_of(500);
    const std::span sa{a};
    ProximityPackets packets;
    packets.add(received(Construction::segments, segment(true, false, 1, sa.first(300))));
    packets.add(received(Construction::segments, segment(false, true, 2, sa.subspan(400)), FramePlace::late));
    packets.add(received(Construction::packets, packet_of(3), FramePlace::late));
    packets.add(received(Construction::segments, segment(false, true, 1, sa.subspan(300))));
    CHECK(all(packets) == std::vector<Octets>{packet_of(3), a});
    CHECK(packets.counters().cut_packets == 0);
    CHECK(packets.counters().unreadable_octets == 1 + sa.subspan(400).size());
}

TEST_CASE("segments without end cost no more than one largest packet", "[telemetry]") {
    ProximityPackets packets;
    const Octets part(2000, 0);
    packets.add(received(Construction::segments, segment(true, false, 1, part)));
    for (int i = 0; i < 1000; ++i) packets.add(received(Construction::segments, segment(false, false, 1, part)));
    CHECK(packets.counters().cut_packets == 1);
    CHECK(packets.counters().unreadable_octets == 1001 * part.size());
}

}  // namespace telemetry_proximity_packets_test
