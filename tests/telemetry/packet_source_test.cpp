// SPDX-License-Identifier: Apache-2.0
#include "common/randomiser.hpp"
#include "common/space_packet.hpp"
#include "telemetry/packet_source.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/octets.hpp"

#include <algorithm>
#include <map>
#include <string>

namespace telemetry_packet_source_test {

using namespace aeolis;
using namespace aeolis::telemetry;

namespace {

using Octets = std::vector<std::uint8_t>;

void append(Octets& to, std::span<const std::uint8_t> octets) {
    to.insert(to.end(), octets.begin(), octets.end());
}

std::vector<Octets> some_packets(std::mt19937& random) {
    std::vector<Octets> packets;
    for (unsigned i = 0; i < 200; ++i) {
        packets.emplace_back(tm_overhead_octets + random() % 300);
        seal_tm_packet(packets.back(), Apid{0x20}, static_cast<std::uint16_t>(i), Sclk{1.0}, 1);
    }
    return packets;
}

/// TM or AOS frames of `length` octets with all packets one after another in one virtual channel; fill at the end.
std::vector<Octets> frames_of(const std::vector<Octets>& packets, FrameStream::Kind kind, std::size_t length,
                              bool crc = true) {
    const std::size_t room = length - (kind == FrameStream::Kind::tm ? 6 : 8) - (crc ? 2 : 0);
    Octets octets;
    std::vector<std::size_t> starts;
    for (const Octets& packet : packets) {
        starts.push_back(octets.size());
        append(octets, packet);
    }
    starts.push_back(octets.size());
    Octets idle(primary_header_octets + room + (room - octets.size() % room));
    seal_tm_packet(idle, Apid{idle_apid}, 0, Sclk{0.0}, 0);
    append(octets, idle);
    std::vector<Octets> frames;
    for (std::size_t at = 0; at + room <= octets.size(); at += room) {
        TransferFrame frame;
        frame.spacecraft = 76;
        frame.count = static_cast<std::uint32_t>(frames.size());
        frame.data = std::span{octets}.subspan(at, room);
        const auto next = std::ranges::lower_bound(starts, at);
        if (next != starts.end() && *next < at + room)
            frame.first_header_pointer = static_cast<std::uint16_t>(*next - at);
        frames.emplace_back(length);
        if (kind == FrameStream::Kind::tm)
            write_tm_frame(frame, static_cast<std::uint8_t>(frames.size()), crc, frames.back());
        else
            write_aos_frame(frame, crc, frames.back());
    }
    return frames;
}

std::vector<Octets> all(PacketSource source, std::span<const std::uint8_t> stream, std::mt19937& random) {
    std::vector<Octets> packets;
    const auto take = [&] {
        while (const auto packet = source.next()) packets.push_back(test::copy_of(*packet));
    };
    while (!stream.empty()) {
        const std::size_t now = std::min<std::size_t>(1 + random() % 900, stream.size());
        source.receive(stream.first(now));
        stream = stream.subspan(now);
        take();
    }
    source.end();
    take();
    return packets;
}

}  // namespace

TEST_CASE("packets come out of bare packets with a prefix, of frames and of PLTUs the same", "[telemetry]") {
    std::mt19937 random{1};
    const auto packets = some_packets(random);
    Octets bare, pltus;
    for (std::size_t i = 0; i < packets.size(); ++i) {
        append(bare, test::hex("60f06060"));
        append(bare, packets[i]);
        Octets pltu(pltu_octets_max);
        pltu.resize(write_pltu({.spacecraft = 76, .sequence = static_cast<std::uint8_t>(i)}, packets[i], pltu));
        append(pltus, pltu);
    }
    CHECK(all(PacketSource::of_packets(4), bare, random) == packets);
    CHECK(all(PacketSource::of_pltus(), pltus, random) == packets);
    for (const auto kind : {FrameStream::Kind::tm, FrameStream::Kind::aos}) {
        Octets stream;
        for (const Octets& frame : frames_of(packets, kind, 223)) append(stream, frame);
        CHECK(crc_frame_octets(stream, 0, true) == 223U);
        CHECK(all(PacketSource::of_frames({.kind = kind, .frame_octets = 223, .marker = false}), stream, random) ==
              packets);
    }
}

TEST_CASE("how CADUs are is found by trying: TM or AOS, randomised or not, with check symbols or without, with a CRC "
          "or without",
          "[telemetry]") {
    std::mt19937 random{2};
    const auto packets = some_packets(random);
    for (const bool crc : {true, false})
        for (const auto kind : {FrameStream::Kind::tm, FrameStream::Kind::aos})
            for (const bool randomised : {false, true})
                for (const std::size_t symbols : {0U, 32U, 160U}) {
                    INFO("CRC " << crc << ", AOS " << (kind == FrameStream::Kind::aos) << ", randomised " << randomised
                                << ", check symbols " << symbols);
                    Octets stream;
                    for (Octets frame : frames_of(packets, kind, 223, crc)) {
                        append(stream, attached_sync_marker);
                        append(frame, test::random_octets(random, symbols));
                        if (randomised) randomise_tm(frame);
                        append(stream, frame);
                    }
                    const auto found = recognise_cadus(stream, {}, true);
                    REQUIRE(found);
                    CHECK(found->agreed.crc == crc);
                    CHECK(found->kind == kind);
                    CHECK(found->randomised == randomised);
                    CHECK(found->frame_octets == 223);
                    CHECK(found->suffix_octets == symbols);
                    CHECK(all(PacketSource::of_frames(*found), stream, random) == packets);
                }
}

TEST_CASE("what was sent in segments comes as one packet, from bare packets and from frames", "[telemetry][R55]") {
    std::mt19937 random{4};
    const Octets block = test::random_octets(random, 500);
    std::vector<Octets> segments;
    const auto segment = [&](unsigned flags, std::size_t first, std::size_t octets) {
        Octets packet = test::hex("0123000000ff");
        packet[2] = static_cast<std::uint8_t>(flags << 6U);
        packet[3] = static_cast<std::uint8_t>(segments.size());
        packet[4] = static_cast<std::uint8_t>((octets - 1) >> 8U);
        packet[5] = static_cast<std::uint8_t>((octets - 1) & 0xFFU);
        append(packet, std::span{block}.subspan(first, octets));
        segments.push_back(packet);
    };
    segment(1, 0, 200);
    segment(0, 200, 200);
    segment(2, 400, 100);
    Octets whole = test::hex("0123c00001f3");
    append(whole, block);
    Octets bare;
    for (const auto& each : segments) append(bare, each);
    CHECK(all(PacketSource::of_packets(0), bare, random) == std::vector<Octets>{whole});
    Octets stream;
    for (const Octets& frame : frames_of(segments, FrameStream::Kind::tm, 223)) append(stream, frame);
    CHECK(all(PacketSource::of_frames({.frame_octets = 223, .marker = false}), stream, random) ==
          std::vector<Octets>{whole});
}

TEST_CASE("bare packets end where no header stands or one is cut, and the rest is counted", "[telemetry]") {
    std::mt19937 random{3};
    const auto packets = some_packets(random);
    BarePackets cut{0};
    cut.receive(std::span{packets[0]}.first(10));
    CHECK_FALSE(cut.next());
    cut.end();
    CHECK(cut.counters() == PacketCounters{.cut_packets = 1, .unreadable_octets = 10});
    BarePackets lost{0};
    lost.receive(packets[0]);
    lost.receive(test::hex("ffffffffffffffff"));
    lost.receive(packets[1]);
    CHECK(lost.next());
    CHECK_FALSE(lost.next());
    lost.end();
    CHECK(lost.counters() == PacketCounters{.packets = 1, .unreadable_octets = 8 + packets[1].size()});
}

TEST_CASE("each format has its name, and no other name a format", "[telemetry]") {
    CHECK(downlink_format("cadu") == DownlinkFormat::cadu);
    CHECK(downlink_format("packets") == DownlinkFormat::packets);
    CHECK_FALSE(downlink_format("CADU"));
    CHECK_FALSE(downlink_format(""));
}

TEST_CASE("counts are kept by virtual channel and by packet id, and segments of two channels never make one packet",
          "[telemetry][R54]") {
    std::mt19937 random{5};
    const auto segment = [&](unsigned flags, unsigned count) {
        Octets packet = test::hex("0123000000ff");
        packet[2] = static_cast<std::uint8_t>(flags << 6U);
        packet[3] = static_cast<std::uint8_t>(count);
        packet[5] = 205;
        append(packet, test::random_octets(random, 206));
        return packet;
    };
    // Channel 0 begins a packet, channel 1 has the end of another: count and APID fit.
    const std::vector<Octets> packets{segment(1, 0), segment(2, 1), segment(3, 2), segment(3, 4), segment(3, 3)};
    const std::vector<unsigned> channels{0, 1, 0, 0, 0};
    Octets stream;
    for (std::size_t i = 0; i < packets.size(); ++i) {
        TransferFrame frame;
        frame.spacecraft = 76;
        frame.virtual_channel = static_cast<std::uint8_t>(channels[i]);
        frame.count = static_cast<std::uint32_t>(channels[i] == 0 ? i * 2 : 7);
        frame.first_header_pointer = 0;
        frame.data = packets[i];
        Octets octets(packets[i].size() + 8);
        write_tm_frame(frame, static_cast<std::uint8_t>(i), true, octets);
        append(stream, octets);
    }
    PacketSource source = PacketSource::of_frames({.frame_octets = packets[0].size() + 8, .marker = false});
    source.receive(stream);
    source.end();
    std::size_t whole = 0;
    while (source.next()) ++whole;
    CHECK(whole == 3);
    CHECK(source.packets().lost_segments == 2);
    const auto sequences = source.sequences();
    REQUIRE(sequences.size() == 4);
    CHECK(sequences[0].name == "spacecraft 76, virtual channel 0");
    CHECK(sequences[0].counters == SequenceCounters{.received = 4, .gaps = 3, .missing = 5});
    CHECK(sequences[1].counters == SequenceCounters{.received = 1});
    CHECK(sequences[2].name == "spacecraft 76, virtual channel 0, APID 291");
    CHECK(sequences[2].packets);
    CHECK(sequences[2].counters == SequenceCounters{.received = 4, .gaps = 2, .missing = 1, .late = 1});
    CHECK(source.link().missing_frames == 5);
}

TEST_CASE("however many channels damaged headers name, a bounded number is followed, and what is forgotten is counted",
          "[telemetry][R54]") {
    Octets stream;
    const Octets data(20, 0x55);
    for (unsigned i = 0; i < 2000; ++i) {
        TransferFrame frame;
        frame.spacecraft = static_cast<std::uint16_t>(i % 1000);
        frame.virtual_channel = static_cast<std::uint8_t>(i / 1000);
        frame.count = 3;
        frame.data = data;
        Octets octets(26);
        write_tm_frame(frame, 0, false, octets);
        append(stream, octets);
    }
    PacketSource source = PacketSource::of_frames({.frame_octets = 26, .marker = false, .agreed = {.crc = false}});
    source.receive(stream);
    source.end();
    CHECK(source.link().frames == 2000);
    CHECK(source.link().forgotten_channels == 2000 - channels_followed_max);
    const auto sequences = source.sequences();
    CHECK(sequences.size() == 2000);  // what is followed no more keeps its counters
    CHECK(std::ranges::all_of(sequences, [](const auto& each) { return each.counters.received == 1; }));
}

TEST_CASE("however many packet ids and channels random headers name, no total of them ever falls", "[telemetry][R54]") {
    constexpr std::size_t ids = 2000;
    PacketSource source = PacketSource::of_frames({.frame_octets = 21, .marker = false, .agreed = {.crc = false}});
    const auto send = [&](std::size_t id, std::uint8_t count) {
        TransferFrame frame;
        frame.spacecraft = static_cast<std::uint16_t>(id / ids);
        frame.count = count;
        frame.first_header_pointer = 0;
        Octets packet = test::hex("0000c0000002aabbcc e0e0e0e0e0e0");  // no packet of them ends with its frame
        packet[0] = static_cast<std::uint8_t>(id % ids / 256);
        packet[1] = static_cast<std::uint8_t>(id % ids % 256);
        packet[3] = count;
        frame.data = packet;
        Octets octets(21);
        write_tm_frame(frame, 0, false, octets);
        source.receive(octets);
        while (source.next()) {
        }
    };
    std::map<std::string, std::uint64_t> told;
    std::uint64_t sum = 0;
    for (std::uint8_t round = 0; round < 2; ++round) {
        for (std::size_t id = 0; id < sequences_named_max + 1000; ++id) send(id, round);
        sum = 0;
        for (const auto& each : source.sequences()) {
            if (!each.packets) continue;
            sum += each.counters.received;
            CHECK(each.counters.received >= told[each.name]);
            told[each.name] = each.counters.received;
        }
        CHECK(sum == (round + 1U) * (sequences_named_max + 1000));
    }
    CHECK(told.size() == sequences_named_max + 1);
    CHECK(told.at(other_sequences) == 2000);
}

TEST_CASE("a short datagram of bare frames or packets loses nothing that comes behind it", "[telemetry]") {
    std::mt19937 random{6};
    const auto packets = some_packets(random);
    auto frames = frames_of(packets, FrameStream::Kind::tm, 223);
    auto source = PacketSource::of_frames({.frame_octets = 223, .marker = false});
    std::size_t bad = 0, whole = 0;
    for (std::size_t i = 0; i < frames.size(); ++i) {
        source.receive(std::span{frames[i]}.first(i == 2 ? 100 : 223));
        bad += source.end_datagram() ? 0 : 1;
        while (source.next()) ++whole;
    }
    CHECK(bad == 1);
    CHECK(source.link().frames == frames.size() - 1);
    CHECK(source.link().cut_frames == 1);
    CHECK(whole > packets.size() - 10);
}

}  // namespace telemetry_packet_source_test
