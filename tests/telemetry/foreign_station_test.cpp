// SPDX-License-Identifier: Apache-2.0
#include "common/space_packet.hpp"
#include "common/tm_frame.hpp"
#include "telemetry/station/foreign_station.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/octets.hpp"

#include <algorithm>

namespace foreign_station_test {

using namespace aeolis;
using namespace aeolis::telemetry;

namespace {

using Octets = std::vector<std::uint8_t>;

constexpr std::size_t frame_octets = 223, packet_octets = frame_octets - 6 - 2;  // a packet a frame, header and CRC

ForeignStation::Recognise bare_packets() {
    return [](auto, bool) -> Result<RecognisedSource> { return RecognisedSource{PacketSource::of_packets(0), ""}; };
}

ForeignStation::Recognise cadus() {
    return [](auto beginning, bool ended) -> Result<RecognisedSource> {
        if (const auto found = recognise_cadus(beginning, {}, ended))
            return RecognisedSource{PacketSource::of_frames(*found), "CADUs"};
        return Error{"no layout reads these frames"};
    };
}

Octets packet_of(std::uint16_t count, std::size_t octets = packet_octets) {
    Octets packet(octets);
    seal_tm_packet(packet, Apid{0x20}, count, Sclk{1.0}, 1);
    return packet;
}

Octets joined(const std::vector<Octets>& parts) {
    Octets all;
    for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
    return all;
}

/// TM frames behind sync markers.
Octets cadus_of(const std::vector<Octets>& packets) {
    Octets all;
    for (std::size_t i = 0; i < packets.size(); ++i) {
        TransferFrame frame;
        frame.spacecraft = 76;
        frame.count = static_cast<std::uint32_t>(i);
        frame.first_header_pointer = 0;
        frame.data = packets[i];
        Octets octets(frame_octets);
        write_tm_frame(frame, static_cast<std::uint8_t>(i), true, octets);
        all.insert(all.end(), attached_sync_marker.begin(), attached_sync_marker.end());
        all.insert(all.end(), octets.begin(), octets.end());
    }
    return all;
}

/// What a station makes of a link.
struct Heard {
    std::vector<Octets> packets;
    Octets octets;

    void add(const Received& received) {
        for (const auto& packet : received.packets) packets.push_back(packet.octets);
        for (const auto& piece : received.octets) octets.insert(octets.end(), piece.octets.begin(), piece.octets.end());
    }
    void hear(ForeignStation& station, std::span<const std::uint8_t> octets_heard, bool datagram = false) {
        Downlink downlink;
        downlink.octets.push_back({downlink_link, Ert{7}, test::copy_of(octets_heard), datagram});
        add(station.receive(std::move(downlink)));
    }
};

}  // namespace

TEST_CASE("another mission's link gives the same packets and counts as a recording and live, octet by octet",
          "[station][downlink][R55]") {
    std::vector<Octets> packets;
    for (std::uint16_t i = 0; i < 40; ++i) packets.push_back(packet_of(i));
    auto stream = cadus_of(packets);
    stream[10 * (frame_octets + 4) + 50] ^= 1U;  // a bad frame
    auto arrived = packets;
    arrived.erase(arrived.begin() + 10);

    const auto played = [&](bool ahead, std::size_t piece) {
        ForeignStation station{cadus()};
        Heard heard;
        if (ahead) REQUIRE(station.recognise(stream, true));
        for (std::size_t at = 0; at < stream.size(); at += piece)
            heard.hear(station, std::span{stream}.subspan(at, std::min(piece, stream.size() - at)));
        heard.add(station.end(Ert{8}));
        CHECK(station.take_layout() == "CADUs");
        CHECK(station.take_layout().empty());
        CHECK_FALSE(station.take_unread());
        const bool all_packets = heard.packets == arrived, all_octets = heard.octets == stream;
        CHECK(all_packets);
        CHECK(all_octets);
        return std::pair{station.totals(Ert{8}), station.stray_octets()};
    };
    const auto [file, stray] = played(true, 65536);
    CHECK(stray > packet_octets);
    CHECK(file.counters.octets == stream.size());
    CHECK(file.counters.frames == 39);
    CHECK(file.counters.bad_crc == 1);
    CHECK(file.counters.missing_frames == 1);
    for (const auto& [ahead, piece] : {std::pair{true, std::size_t{1}}, {false, 1}, {false, 100}, {false, 65536}}) {
        CAPTURE(ahead, piece);
        const auto [other, other_stray] = played(ahead, piece);
        CHECK(other.counters == file.counters);
        CHECK(other.packets == file.packets);
        CHECK(other_stray == stray);
    }
}

TEST_CASE("each packet has the reception time of the frame that completed it, also before the layout is known",
          "[station][downlink][frames][R55]") {
    std::vector<Octets> packets;
    for (std::uint16_t i = 0; i < 20; ++i) packets.push_back(packet_of(i));
    const auto stream = cadus_of(packets);
    constexpr std::size_t cadu_octets = frame_octets + 4;
    for (const bool ahead : {false, true})
        for (const bool datagrams : {false, true}) {
            CAPTURE(ahead, datagrams);
            ForeignStation station{cadus()};
            if (ahead) REQUIRE(station.recognise(stream, true));
            std::vector<std::int64_t> times;
            const auto take = [&](const Received& received) {
                for (const auto& packet : received.packets) times.push_back(packet.ert.microseconds);
            };
            for (std::size_t i = 0; i < packets.size(); ++i) {
                Downlink downlink;
                const auto cadu = std::span{stream}.subspan(i * cadu_octets, cadu_octets);
                downlink.octets.push_back(
                    {downlink_link, Ert{static_cast<std::int64_t>(100 * i)}, test::copy_of(cadu), datagrams});
                take(station.receive(std::move(downlink)));
            }
            take(station.end(Ert{1'000'000}));
            REQUIRE(times.size() == packets.size());
            for (std::size_t i = 0; i < times.size(); ++i) CHECK(times[i] == static_cast<std::int64_t>(100 * i));
        }
}

TEST_CASE("each datagram of another mission stands for itself, before its layout is known as well",
          "[station][downlink][R54]") {
    const std::vector<Octets> packets{packet_of(1, 30), packet_of(2, 40), packet_of(3, 50)};
    ForeignStation station{[tries = 0](auto, bool) mutable -> Result<RecognisedSource> {
        if (++tries == 1) return Error{"not yet"};
        return RecognisedSource{PacketSource::of_packets(0), ""};
    }};
    Heard heard;
    heard.hear(station, packets[0], true);
    CHECK(heard.packets.empty());
    heard.hear(station, Octets(60, 0xEE), true);  // the layout is known now
    CHECK(heard.packets == std::vector<Octets>{packets[0]});
    heard.hear(station, {}, true);
    heard.hear(station, std::span{packets[1]}.first(39), true);
    heard.hear(station, packets[2], true);
    CHECK(heard.packets == std::vector<Octets>{packets[0], packets[2]});
    const auto totals = station.totals(Ert{8});
    CHECK(totals.bad_datagrams == 2);
    CHECK(totals.packets.packets == 2);
    CHECK(totals.counters.octets == 30 + 60 + 39 + 50);
}

TEST_CASE("bare packets that lost their boundaries end with their stream, and the next begins with a packet",
          "[station][downlink]") {
    const auto packet = packet_of(1, 30);
    ForeignStation station{bare_packets()};
    Heard heard;
    heard.hear(station, joined({packet, Octets(20, 0x5A), packet}));
    CHECK(station.lost());
    heard.add(station.end(Ert{8}));
    CHECK_FALSE(station.lost());
    heard.hear(station, packet);
    heard.add(station.end(Ert{9}));
    CHECK(heard.packets == std::vector<Octets>{packet, packet});
    const auto totals = station.totals(Ert{9});
    CHECK(totals.packets.packets == 2);
    CHECK(totals.packets.unreadable_octets == 50);
    REQUIRE(totals.sequences.size() == 1);
    CHECK(totals.sequences[0].counters.received == 2);
    CHECK(station.ledger().heard_sequences());
}

TEST_CASE(
    "a stream whose layout is not found is counted as not read, at its end or when its beginning is full, and the "
    "next is tried anew",
    "[station][downlink]") {
    ForeignStation station{cadus()};
    Heard heard;
    const Octets noise(1000, 0x55);
    heard.hear(station, noise);
    CHECK_FALSE(station.take_unread());
    heard.add(station.end(Ert{8}));
    auto unread = station.take_unread();
    REQUIRE(unread);
    CHECK(unread->octets == 1000);
    CHECK(unread->why == "no layout reads these frames");
    CHECK_FALSE(station.take_unread());

    for (std::size_t octets = 0; octets < ForeignStation::beginning_octets_max; octets += 65536) {
        CHECK_FALSE(station.take_unread());
        heard.hear(station, Octets(65536, 0x55));
    }
    unread = station.take_unread();
    REQUIRE(unread);
    CHECK(unread->octets == ForeignStation::beginning_octets_max);
    CHECK(station.totals(Ert{8}).counters.skipped_octets == 1000 + ForeignStation::beginning_octets_max);
    CHECK_FALSE(station.ledger().heard_sequences());

    std::vector<Octets> packets;
    for (std::uint16_t i = 0; i < 10; ++i) packets.push_back(packet_of(i));
    heard.hear(station, cadus_of(packets));
    heard.add(station.end(Ert{9}));
    const bool all_packets = heard.packets == packets;
    CHECK(all_packets);
}

}  // namespace foreign_station_test
