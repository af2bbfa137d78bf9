// SPDX-License-Identifier: Apache-2.0
#include "common/space_packet.hpp"
#include "telemetry/packet_extractor.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/octets.hpp"

#include <algorithm>
#include <set>

namespace telemetry_packet_extractor_test {

using namespace aeolis;
using namespace aeolis::telemetry;

namespace {

using Octets = std::vector<std::uint8_t>;

Octets packet_of(std::size_t data_octets, std::uint16_t count) {
    Octets packet(tm_overhead_octets + data_octets, 0x5A);
    seal_tm_packet(packet, Apid{0x20}, count, Sclk{1.0}, 1);
    return packet;
}

struct Stream {
    std::vector<Octets> packets;
    std::vector<Octets> zones;  ///< what each frame carries
    std::vector<std::uint16_t> pointers;
};

/// Random packets one after another, cut into zones of one length.
Stream stream_of(std::mt19937& random, std::size_t packets, std::size_t zone) {
    Stream stream;
    Octets octets;
    std::set<std::size_t> starts;
    for (std::size_t i = 0; i < packets || octets.size() % zone != 0; ++i) {
        // The last ones fill up to a whole zone.
        const std::size_t left = zone - octets.size() % zone;
        const bool last = i + 1 >= packets && left > tm_overhead_octets + 1;
        const std::size_t size = last ? left - tm_overhead_octets : random() % 400;
        stream.packets.push_back(packet_of(size, static_cast<std::uint16_t>(i & 0x3FFF)));
        starts.insert(octets.size());
        octets.insert(octets.end(), stream.packets.back().begin(), stream.packets.back().end());
    }
    for (std::size_t at = 0; at < octets.size(); at += zone) {
        const auto first = octets.begin() + static_cast<std::ptrdiff_t>(at);
        stream.zones.emplace_back(first, first + static_cast<std::ptrdiff_t>(zone));
        const auto next = starts.lower_bound(at);
        stream.pointers.push_back(next != starts.end() && *next < at + zone ? static_cast<std::uint16_t>(*next - at)
                                                                            : no_packet_begins);
    }
    return stream;
}

TransferFrame frame_of(const Stream& stream, std::size_t index) {
    TransferFrame frame;
    frame.first_header_pointer = stream.pointers[index];
    frame.data = stream.zones[index];
    return frame;
}

std::vector<Octets> all(PacketExtractor& extractor) {
    std::vector<Octets> found;
    while (const auto packet = extractor.next()) found.push_back(test::copy_of(*packet));
    return found;
}

}  // namespace

TEST_CASE("packets come whole out of frames of any length, also much shorter than a packet", "[telemetry]") {
    std::mt19937 random{1};
    for (const std::size_t zone : {3U, 5U, 7U, 20U, 100U, 1000U}) {
        const Stream stream = stream_of(random, 200, zone);
        PacketExtractor extractor;
        std::vector<Octets> found;
        for (std::size_t i = 0; i < stream.zones.size(); ++i) {
            extractor.add(frame_of(stream, i), FramePlace::next);
            for (auto& packet : all(extractor)) found.push_back(std::move(packet));
        }
        extractor.end();
        for (auto& packet : all(extractor)) found.push_back(std::move(packet));
        CHECK(found == stream.packets);
        CHECK(extractor.counters() == PacketCounters{.packets = stream.packets.size()});
    }
}

TEST_CASE("a missing frame costs the packets that it carries a part of, and no other", "[telemetry]") {
    std::mt19937 random{2};
    const Stream stream = stream_of(random, 300, 150);
    for (std::size_t lost = 1; lost + 1 < stream.zones.size(); ++lost) {
        PacketExtractor extractor;
        std::vector<Octets> found;
        for (std::size_t i = 0; i < stream.zones.size(); ++i) {
            if (i == lost) continue;
            extractor.add(frame_of(stream, i), i == lost + 1 ? FramePlace::after_gap : FramePlace::next);
            for (auto& packet : all(extractor)) found.push_back(std::move(packet));
        }
        std::size_t at = 0;
        std::vector<Octets> expected;
        for (const Octets& packet : stream.packets) {
            const bool touched = at < (lost + 1) * 150 && at + packet.size() > lost * 150;
            if (!touched) expected.push_back(packet);
            at += packet.size();
        }
        REQUIRE(found == expected);
    }
}

TEST_CASE("where a control field or a CRC is taken for data, no packet is made of it, whatever the packets' sizes are",
          "[telemetry][frames][R55]") {
    std::mt19937 random{11};
    for (const std::size_t trailer : {2U, 4U, 6U})
        for (const std::size_t zone : {60U, 100U, 241U}) {
            CAPTURE(trailer, zone);
            const Stream stream = stream_of(random, 2000, zone);
            const std::set<Octets> sent(stream.packets.begin(), stream.packets.end());
            PacketExtractor extractor;
            std::size_t found = 0, invented = 0;
            const auto take = [&] {
                for (const auto& packet : all(extractor)) {
                    ++found;
                    invented += sent.contains(packet) ? 0 : 1;
                }
            };
            for (std::size_t i = 0; i < stream.zones.size(); ++i) {
                auto frame = frame_of(stream, i);
                Octets data = stream.zones[i];
                for (std::size_t octet = 2; octet < trailer + 2; ++octet)
                    data.push_back(static_cast<std::uint8_t>(octet));
                frame.data = data;
                extractor.add(frame, i % 50 == 49 ? FramePlace::after_gap : FramePlace::next);
                take();
            }
            extractor.end();
            take();
            CHECK(invented == 0);
            CHECK((found > 0 || zone == 60));
            CHECK(extractor.pointers().agreed == 0);
            CHECK(extractor.pointers().contradicted > 100);
            // Most are of packets that lie over one edge.
            const auto& shifts = extractor.pointers().shifts;
            if (zone == 241)
                CHECK(std::ranges::max_element(shifts) - shifts.begin() ==
                      static_cast<std::ptrdiff_t>(PointerVerdicts::shift_max + trailer));
        }
}

TEST_CASE("a packet that ends with its frame waits for the next frame's pointer, until eight have agreed",
          "[telemetry][frames][R55]") {
    PacketExtractor extractor;
    std::vector<Octets> packets;
    const auto add = [&](std::uint16_t pointer = 0, FramePlace place = FramePlace::next) {
        packets.push_back(packet_of(30, static_cast<std::uint16_t>(packets.size())));
        TransferFrame frame;
        frame.first_header_pointer = pointer;
        frame.data = packets.back();
        extractor.add(frame, place, Ert{static_cast<std::int64_t>(packets.size())});
        std::vector<std::pair<Octets, std::int64_t>> given;
        while (const auto packet = extractor.next())
            given.emplace_back(test::copy_of(*packet), extractor.received().microseconds);
        return given;
    };
    using Given = std::vector<std::pair<Octets, std::int64_t>>;
    const auto gives = [&](const std::vector<std::size_t>& numbers, FramePlace place = FramePlace::next) {
        const Given given = add(0, place);
        Given expected;
        for (const std::size_t number : numbers)
            expected.emplace_back(packets.at(number - 1), static_cast<std::int64_t>(number));
        return given == expected;
    };
    CHECK(gives({}));
    for (std::size_t i = 2; i <= PacketExtractor::agreed_enough; ++i) CHECK(gives({i - 1}));
    CHECK(gives({8, 9}));  // eight pointers agreed
    CHECK(gives({10}));
    CHECK(extractor.held_packets() == 0);
    CHECK(add(5).empty());  // where nothing begins
    CHECK(extractor.pointers().contradicted == 1);
    CHECK(gives({}));
    CHECK(extractor.held_packets() == 1);
    CHECK(gives({}, FramePlace::after_gap));  // of frames that contradicted last, nothing without proof
    CHECK(gives({13}));
    extractor.end();
    CHECK(all(extractor) == std::vector<Octets>{packets.at(13)});
    CHECK(extractor.received() == Ert{14});
}

TEST_CASE("a pointer that contradicts the packet before it ends that packet and is followed", "[telemetry]") {
    const Octets a = packet_of(100, 1), b = packet_of(10, 2);
    PacketExtractor extractor;
    TransferFrame frame;
    frame.first_header_pointer = 0;
    frame.data = std::span{a}.first(50);
    extractor.add(frame, FramePlace::next);
    Octets second(5 + b.size() + PacketExtractor::doubtful_octets, 0xE0);  // idle, behind b
    std::ranges::copy(b, second.begin() + 5);
    frame.first_header_pointer = 5;
    frame.data = second;
    extractor.add(frame, FramePlace::next);
    CHECK(all(extractor) == std::vector<Octets>{b});
    CHECK(extractor.counters() == PacketCounters{.packets = 1, .cut_packets = 1, .unreadable_octets = 55});
}

TEST_CASE("fill is not given out: idle frames, idle packets", "[telemetry]") {
    Octets idle(20);
    seal_tm_packet(idle, Apid{idle_apid}, 0, Sclk{0.0}, 0);
    PacketExtractor extractor;
    TransferFrame frame;
    frame.first_header_pointer = 0;
    frame.data = idle;
    extractor.add(frame, FramePlace::next);
    frame.first_header_pointer = only_idle_data;
    extractor.add(frame, FramePlace::next);
    CHECK(all(extractor).empty());
    CHECK(extractor.counters() == PacketCounters{.idle_packets = 1});
}

TEST_CASE("a repeated frame changes nothing, and of a late one the packets come that it holds whole",
          "[telemetry][R55]") {
    std::mt19937 random{5};
    const Stream stream = stream_of(random, 300, 400);
    for (std::size_t late = 1; late + 2 < stream.zones.size(); ++late) {
        PacketExtractor extractor;
        std::vector<Octets> found;
        const auto add = [&](std::size_t i, FramePlace place) {
            extractor.add(frame_of(stream, i), place);
            for (auto& packet : all(extractor)) found.push_back(std::move(packet));
        };
        for (std::size_t i = 0; i < stream.zones.size(); ++i) {
            if (i == late) continue;
            add(i, i == late + 1 ? FramePlace::after_gap : FramePlace::next);
            add(i, FramePlace::repeated);
            if (i == late + 1) add(late, FramePlace::late);
        }
        std::size_t at = 0;
        std::vector<Octets> expected;
        for (const Octets& packet : stream.packets) {  // but those that lie over an edge of the late frame
            const bool over_edge = (at < late * 400 && at + packet.size() > late * 400) ||
                                   (at < (late + 1) * 400 && at + packet.size() > (late + 1) * 400);
            if (!over_edge) expected.push_back(packet);
            at += packet.size();
        }
        std::ranges::sort(expected);
        std::ranges::sort(found);
        REQUIRE(found == expected);
    }
}

TEST_CASE("encapsulation packets between space packets are idle or counted, of one octet and more",
          "[telemetry][R55]") {
    const Octets a = packet_of(10, 1), b = packet_of(20, 2);
    const auto stream_with = [&](std::string_view between) {
        Octets octets = a;
        for (const std::uint8_t octet : test::hex(between)) octets.push_back(octet);
        octets.insert(octets.end(), b.begin(), b.end());
        return octets;
    };
    struct Case {
        const char* between;
        std::size_t idle, other;
    };
    for (const auto& [between, idle, other] :
         {Case{"e0", 1, 0}, Case{"e0e0e0", 3, 0}, Case{"e103ff", 1, 0}, Case{"e2000006aaaa", 1, 0},
          Case{"e300000000000009ee", 1, 0}, Case{"e904aabb", 0, 1}, Case{"fe000001", 0, 0}}) {
        CAPTURE(between);
        const Octets octets = stream_with(between);
        PacketExtractor extractor;
        TransferFrame frame;
        frame.first_header_pointer = 0;
        frame.data = octets;
        extractor.add(frame, FramePlace::next);
        const bool readable = idle + other > 0;
        auto found = all(extractor);
        extractor.end();
        for (auto& packet : all(extractor)) found.push_back(std::move(packet));
        CHECK(found == (readable ? std::vector<Octets>{a, b} : std::vector<Octets>{a}));
        CHECK(extractor.counters().idle_packets == idle);
        CHECK(extractor.counters().encapsulation_packets == other);
        CHECK((extractor.counters().unreadable_octets == 0) == readable);
    }
}

TEST_CASE("frames of any content: nothing outside them is read, and it goes on with the next pointer", "[telemetry]") {
    std::mt19937 random{3};
    PacketExtractor extractor;
    for (int round = 0; round < 5000; ++round) {
        const auto data = test::random_octets(random, 1 + random() % 60);
        TransferFrame frame;
        frame.data = data;
        frame.first_header_pointer =
            static_cast<std::uint16_t>(random() % 3 == 0 ? no_packet_begins : random() % data.size());
        extractor.add(frame, static_cast<FramePlace>(random() % 5));
        (void)all(extractor);
    }
    const Octets good = packet_of(10, 2);
    Octets data = good;
    data.resize(good.size() + PacketExtractor::doubtful_octets, 0xE0);  // idle
    TransferFrame frame;
    frame.data = data;
    frame.first_header_pointer = 0;
    extractor.add(frame, FramePlace::after_gap);
    CHECK(all(extractor) == std::vector<Octets>{good});
}

}  // namespace telemetry_packet_extractor_test
