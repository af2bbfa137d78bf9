// SPDX-License-Identifier: Apache-2.0
#include "telemetry/station/ground_station.hpp"

#include "common/proximity_frame.hpp"
#include "common/space_packet.hpp"
#include "tests/support/catch.hpp"

#include <algorithm>
#include <vector>

namespace telemetry_ground_station_test {

using namespace aeolis;
using namespace aeolis::telemetry;

namespace {

std::vector<std::uint8_t> packet_of(std::uint16_t count) {
    std::vector<std::uint8_t> packet(60);
    seal_tm_packet(packet, Apid{0x10}, count, Sclk{397501715.0}, 1);
    return packet;
}

std::vector<std::uint8_t> pltu_of(std::uint8_t sequence, std::span<const std::uint8_t> packets) {
    std::vector<std::uint8_t> pltu(pltu_octets_max);
    pltu.resize(write_pltu({.sequence = sequence}, packets, pltu));
    return pltu;
}

const Received& receive(GroundStation& station, Downlink downlink, Ert now) {
    downlink.now = now;
    return station.receive(downlink);
}

}  // namespace

TEST_CASE("the station finds the packets of the UHF link however its octets are cut, dated by the last of them",
          "[station]") {
    std::vector<std::uint8_t> air;
    for (std::uint8_t i = 0; i < 20; ++i) {
        const auto pltu = pltu_of(i, packet_of(i));
        air.insert(air.end(), pltu.begin(), pltu.end());
    }
    GroundStation station{0.0};
    std::vector<std::vector<std::uint8_t>> found;
    Ert last;
    for (std::size_t at = 0; at < air.size(); at += 16) {
        const auto end = std::min(at + 16, air.size());
        Downlink landed;
        landed.octets.push_back(
            {uhf_live_link,
             Ert{static_cast<std::int64_t>(at)},
             {air.begin() + static_cast<std::ptrdiff_t>(at), air.begin() + static_cast<std::ptrdiff_t>(end)}});
        for (const auto& packet : receive(station, landed, Ert{1000}).packets) {
            CHECK(packet.link == uhf_live_link);
            CHECK(packet.ert.microseconds == static_cast<std::int64_t>(at));
            found.push_back(packet.octets);
        }
    }
    REQUIRE(found.size() == 20);
    for (std::uint16_t i = 0; i < 20; ++i) CHECK(found[i] == packet_of(i));
    CHECK(station.links().at(0).pltus.counters().frames == 20);
    CHECK(station.links().at(0).pltus.counters().missing_frames == 0);
}

TEST_CASE("a spoilt frame costs its packets and no others, and the gap is counted", "[station]") {
    GroundStation station{0.0};
    Downlink landed;
    for (std::uint8_t i = 0; i < 5; ++i) {
        auto pltu = pltu_of(i, packet_of(i));
        if (i == 2) pltu[30] ^= 0x40;
        landed.octets.push_back({uhf_live_link, Ert{i}, pltu});
    }
    CHECK(receive(station, landed, Ert{1000}).packets.size() == 4);
    CHECK(station.links().at(0).pltus.counters().bad_crc == 1);
    CHECK(station.links().at(0).pltus.counters().missing_frames == 1);
}

TEST_CASE("decisions of a modelled receiver pass through the station as they are", "[station]") {
    GroundStation station{0.0};
    Downlink landed;
    landed.tones.emplace_back().tone = ToneId{42};
    const Received received = receive(station, landed, Ert{1000});
    REQUIRE(received.tones.size() == 1);
    CHECK(received.tones[0].tone == ToneId{42});
}

TEST_CASE("each link is received and counted by itself", "[station]") {
    GroundStation station{0.0};
    Downlink landed;
    landed.octets.push_back({uhf_live_link, Ert{1}, pltu_of(0, packet_of(0))});
    landed.octets.push_back({{"uhf_mro", false}, Ert{1}, pltu_of(0, packet_of(0))});
    landed.octets.push_back({{"uhf_mro", false}, Ert{1}, pltu_of(2, packet_of(2))});
    CHECK(receive(station, landed, Ert{1}).packets.size() == 3);
    REQUIRE(station.links().size() == 2);
    CHECK(station.links()[1].link.name == "uhf_mro");
    CHECK(station.links()[0].pltus.counters().missing_frames == 0);
    CHECK(station.links()[1].pltus.counters().missing_frames == 1);
}

TEST_CASE("a damaged length holds the next frame back no longer than the link is up", "[station]") {
    GroundStation station{0.0};
    Downlink landed;
    auto damaged = pltu_of(0, packet_of(0));
    damaged[5] |= 0x07;  // the frame seems to go on for 2 kB
    const auto next = pltu_of(1, packet_of(1));
    damaged.insert(damaged.end(), next.begin(), next.end());
    landed.octets.push_back({uhf_live_link, Ert{1}, damaged});
    CHECK(receive(station, landed, Ert{1}).packets.empty());
    Downlink down;
    down.links.push_back({uhf_live_link, Ert{2}, false});
    CHECK(receive(station, down, Ert{2}).packets.size() == 1);
}

TEST_CASE("a damaged length holds the next frame back half a second on a link that has fallen quiet, and not while "
          "octets come",
          "[station]") {
    GroundStation station{0.0};
    const auto at_ms = [](std::int64_t ms) { return Ert{ms * 1000}; };
    const auto bring = [&](std::int64_t ms, const std::vector<std::uint8_t>& octets) {
        Downlink landed;
        if (!octets.empty()) landed.octets.push_back({uhf_live_link, at_ms(ms), octets});
        return receive(station, landed, at_ms(ms)).packets.size();
    };
    auto damaged = pltu_of(0, packet_of(0));
    damaged[5] |= 0x07;  // the frame seems to go on for 2 kB
    const auto next = pltu_of(1, packet_of(1));
    damaged.insert(damaged.end(), next.begin(), next.end());
    CHECK(bring(0, damaged) == 0);
    CHECK(bring(400, {}) == 0);
    CHECK(bring(516, {}) == 1);
    CHECK(bring(2000, {}) == 0);
    CHECK(station.links().at(0).pltus.counters().frames == 1);

    const auto whole = pltu_of(2, packet_of(2));
    const std::vector<std::uint8_t> first(whole.begin(), whole.begin() + 40), rest(whole.begin() + 40, whole.end());
    CHECK(bring(3000, first) == 0);
    CHECK(bring(3400, {}) == 0);
    CHECK(bring(3450, rest) == 1);  // no pause as long as that cuts a frame
}

}  // namespace telemetry_ground_station_test
