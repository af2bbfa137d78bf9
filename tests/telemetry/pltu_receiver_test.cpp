// SPDX-License-Identifier: Apache-2.0
#include "telemetry/pltu_receiver.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/octets.hpp"

#include <algorithm>

namespace telemetry_pltu_receiver_test {

using namespace aeolis;
using namespace aeolis::telemetry;

namespace {

using Octets = std::vector<std::uint8_t>;

Octets pltu_of(const ProximityHeader& header, const Octets& data) {
    Octets octets(pltu_octets_max);
    octets.resize(write_pltu(header, data, octets));
    return octets;
}

/// All data of the frames that come out of `stream` when it arrives in pieces of random size.
std::vector<Octets> received(PltuReceiver& receiver, std::span<const std::uint8_t> stream, std::mt19937& random) {
    std::vector<Octets> data;
    const auto take = [&] {
        while (const auto frame = receiver.next()) data.push_back(test::copy_of(frame->frame.data));
    };
    while (!stream.empty()) {
        const std::size_t now = std::min<std::size_t>(1 + random() % 700, stream.size());
        receiver.receive(stream.first(now));
        stream = stream.subspan(now);
        take();
    }
    receiver.end();
    take();
    return data;
}

void append(Octets& to, const Octets& octets) {
    to.insert(to.end(), octets.begin(), octets.end());
}

/// Octets among which no marker stands.
Octets noise(std::mt19937& random, std::size_t size) {
    Octets octets = test::random_octets(random, size);
    std::ranges::replace(octets, std::uint8_t{0xF3}, std::uint8_t{0xF4});
    return octets;
}

}  // namespace

TEST_CASE("every good frame is found between any octets, however the stream is cut", "[telemetry]") {
    std::mt19937 random{1};
    for (int round = 0; round < 40; ++round) {
        Octets stream;
        std::vector<Octets> sent;
        std::size_t between = 0;
        for (unsigned i = 0; i < 60; ++i) {
            sent.push_back(test::random_octets(random, 1 + random() % 600));
            const Octets gap = noise(random, random() % 50);
            between += gap.size();
            append(stream, gap);
            append(stream, pltu_of({.spacecraft = 76, .sequence = static_cast<std::uint8_t>(i)}, sent.back()));
        }
        PltuReceiver receiver;
        CHECK(received(receiver, stream, random) == sent);
        CHECK(receiver.counters().frames == sent.size());
        CHECK(receiver.counters().skipped_octets == between);
        CHECK(receiver.counters().octets == stream.size());
        CHECK(receiver.counters().gaps == 0);
    }
}

TEST_CASE("a damaged frame is counted and costs no other, whatever its length field says now", "[telemetry]") {
    std::mt19937 random{2};
    for (int round = 0; round < 300; ++round) {
        Octets stream;
        std::vector<Octets> sent;
        const unsigned damaged = 1 + random() % 8;
        for (unsigned i = 0; i < 10; ++i) {
            Octets data = noise(random, 1 + random() % 300);
            Octets pltu = pltu_of({.spacecraft = 76, .sequence = static_cast<std::uint8_t>(i)}, data);
            if (i == damaged) {
                const std::size_t bit = 24 + random() % ((pltu.size() - 3) * 8);
                pltu[bit / 8] = static_cast<std::uint8_t>(pltu[bit / 8] ^ (1U << (bit % 8)));
            } else {
                sent.push_back(std::move(data));
            }
            append(stream, pltu);
        }
        PltuReceiver receiver;
        REQUIRE(received(receiver, stream, random) == sent);
        CHECK(receiver.counters().bad_crc + receiver.counters().bad_header + (receiver.counters().frames == 9) >= 1);
        CHECK(receiver.counters().missing_frames == 1);
        CHECK(receiver.counters().gaps == 1);
    }
}

TEST_CASE("a frame within the data of a frame is data; when the outer one is damaged the inner one is found",
          "[telemetry]") {
    std::mt19937 random{3};
    const Octets inner = pltu_of({.spacecraft = 1}, {1, 2, 3});
    Octets outer = pltu_of({.spacecraft = 2}, inner);
    PltuReceiver whole;
    CHECK(received(whole, outer, random) == std::vector<Octets>{inner});
    outer.back() ^= 1;
    PltuReceiver damaged;
    CHECK(received(damaged, outer, random) == std::vector<Octets>{{1, 2, 3}});
    CHECK(damaged.counters().bad_crc == 1);
}

TEST_CASE("PLTUs that begin at any bit, inverted or not, are found as those that do not, with fill around them",
          "[telemetry][frames][R55]") {
    std::mt19937 random{31};
    const Octets fill = test::hex("352ef853352ef853352ef853");
    Octets stream = fill;
    std::vector<Octets> sent;
    for (unsigned i = 0; i < 30; ++i) {
        sent.push_back(test::random_octets(random, 1 + random() % 300));
        append(stream, pltu_of({.spacecraft = 76, .sequence = static_cast<std::uint8_t>(i)}, sent.back()));
        if (i % 3 != 0) append(stream, fill);
    }
    for (unsigned shift = 0; shift < 8; ++shift)
        for (const bool inverted : {false, true}) {
            CAPTURE(shift, inverted);
            PltuReceiver receiver;
            CHECK(received(receiver, test::shifted(stream, shift, inverted), random) == sent);
            CHECK(receiver.counters().frames == sent.size());
            CHECK(receiver.counters().bad_crc + receiver.counters().bad_header + receiver.counters().slips == 0);
            CHECK(receiver.stray_octets() <= (shift > 0 ? 1 : 0));  // bits before the first octet
        }
}

TEST_CASE("where bits are added to PLTUs, or all are inverted from there on, the frames behind are found again",
          "[telemetry][frames][R55]") {
    std::mt19937 random{32};
    Octets first, second;
    std::vector<Octets> sent;
    for (unsigned i = 0; i < 20; ++i) {
        sent.push_back(test::random_octets(random, 200));
        append(i < 10 ? first : second,
               pltu_of({.spacecraft = 76, .sequence = static_cast<std::uint8_t>(i)}, sent.back()));
    }
    for (const auto& [shift, inverted] : {std::pair{5U, false}, {0U, true}, {3U, true}}) {
        CAPTURE(shift, inverted);
        Octets stream = first;
        append(stream, test::shifted(second, shift, inverted));
        PltuReceiver receiver;
        CHECK(received(receiver, stream, random) == sent);
        CHECK(receiver.counters().slips == 1);
        CHECK(receiver.counters().missing_frames == 0);
    }
}

TEST_CASE("each spacecraft, channel and service has a frame sequence of its own", "[telemetry]") {
    PltuReceiver receiver;
    for (unsigned i = 0; i < 1000; ++i)
        for (const ProximityHeader header :
             {ProximityHeader{.expedited = true, .spacecraft = 76},
              ProximityHeader{.expedited = false, .spacecraft = 76},
              ProximityHeader{.spacecraft = 76, .physical_channel = 1}, ProximityHeader{.spacecraft = 77}}) {
            ProximityHeader now = header;
            now.sequence = static_cast<std::uint8_t>(i + header.spacecraft);
            receiver.receive(pltu_of(now, {1}));
        }
    while (receiver.next()) {
    }
    CHECK(receiver.counters().frames == 4000);
    CHECK(receiver.counters().gaps == 0);
}

TEST_CASE("any octets at all: each is used or skipped, and the search comes to an end", "[telemetry]") {
    std::mt19937 random{4};
    for (int round = 0; round < 200; ++round) {
        Octets stream;
        while (stream.size() < 5000) {
            append(stream, {0xFA, 0xF3, 0x20});
            append(stream, test::random_octets(random, random() % 12));
        }
        PltuReceiver receiver;
        const auto data = received(receiver, stream, random);
        std::size_t in_frames = 0;
        for (const auto& each : data) in_frames += each.size() + pltu_overhead_octets;
        CHECK(in_frames + receiver.counters().skipped_octets == stream.size());
    }
}

}  // namespace telemetry_pltu_receiver_test
