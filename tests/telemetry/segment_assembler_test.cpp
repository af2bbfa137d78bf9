// SPDX-License-Identifier: Apache-2.0
#include "telemetry/segment_assembler.hpp"

#include "common/space_packet.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/octets.hpp"

namespace telemetry_segment_assembler_test {

using namespace aeolis;
using namespace aeolis::telemetry;
using Octets = std::vector<std::uint8_t>;

namespace {

constexpr unsigned middle = 0, first = 1, last = 2, unsegmented = 3;

Octets packet(unsigned flags, unsigned count, const Octets& data, unsigned apid = 0x123, bool secondary = false) {
    const auto length = data.size() - 1;
    Octets octets{static_cast<std::uint8_t>((secondary ? 8U : 0U) | apid >> 8U),
                  static_cast<std::uint8_t>(apid & 0xFFU),
                  static_cast<std::uint8_t>(flags << 6U | count >> 8U),
                  static_cast<std::uint8_t>(count & 0xFFU),
                  static_cast<std::uint8_t>(length >> 8U),
                  static_cast<std::uint8_t>(length & 0xFFU)};
    octets.insert(octets.end(), data.begin(), data.end());
    return octets;
}

std::vector<Octets> all(SegmentAssembler& assembler, const std::vector<Octets>& packets) {
    std::vector<Octets> found;
    for (const auto& each : packets)
        if (const auto whole = assembler.add(each)) found.push_back(test::copy_of(*whole));
    assembler.end();
    return found;
}

}  // namespace

TEST_CASE("segments of several APIDs are put together, also where the count wraps", "[telemetry][R55]") {
    SegmentAssembler assembler;
    const auto found =
        all(assembler, {packet(first, 0x3FFF, {1, 2}), packet(first, 7, {9}, 0x50), packet(unsegmented, 3, {5}, 0x51),
                        packet(last, 0, {3}), packet(middle, 8, {8, 7}, 0x50), packet(last, 9, {6}, 0x50)});
    CHECK(found == std::vector<Octets>{packet(unsegmented, 3, {5}, 0x51), packet(unsegmented, 0x3FFF, {1, 2, 3}),
                                       packet(unsegmented, 7, {9, 8, 7, 6}, 0x50)});
    CHECK(assembler.lost_segments() == 0);
}

TEST_CASE("what is not whole is never a packet, and each of its segments is counted", "[telemetry][R55]") {
    struct Case {
        const char* what;
        std::vector<Octets> packets;
        std::uint64_t lost;
    };
    const std::vector<std::uint8_t> long_data(60'000, 1);
    for (const auto& [what, packets, lost] :
         {Case{"a segment is missing", {packet(first, 0, {1}), packet(last, 2, {3})}, 2},
          Case{"a segment comes twice",
               {packet(first, 0, {1}), packet(middle, 1, {2}), packet(middle, 1, {2}), packet(last, 2, {3})},
               4},
          Case{"the first is missing", {packet(middle, 1, {2}), packet(last, 2, {3})}, 2},
          Case{"it ends without a last one", {packet(first, 0, {1}), packet(middle, 1, {2})}, 2},
          Case{"another begins before", {packet(first, 0, {1}), packet(first, 1, {2})}, 2},
          Case{"a later one has a header of unknown length",
               {packet(first, 0, {1}, 0x123, true), packet(last, 1, {2}, 0x123, true)},
               2},
          Case{"together they are longer than a packet",
               {packet(first, 0, long_data), packet(last, 1, long_data)},
               2}}) {
        CAPTURE(what);
        SegmentAssembler assembler;
        CHECK(all(assembler, packets).empty());
        CHECK(assembler.lost_segments() == lost);
    }
}

TEST_CASE("unfinished packets take bounded memory", "[telemetry][bounds]") {
    SegmentAssembler assembler;
    for (unsigned apid = 0; apid < 2047; ++apid) CHECK_FALSE(assembler.add(packet(first, 0, {1}, apid)));
    CHECK(assembler.lost_segments() == 2047 - SegmentAssembler::unfinished_max);
}

}  // namespace telemetry_segment_assembler_test
