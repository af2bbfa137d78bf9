// SPDX-License-Identifier: Apache-2.0
#include "telemetry/proof.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/small_dictionary.hpp"

namespace telemetry_proof_test {

using namespace aeolis;
using namespace aeolis::telemetry;
using aeolis::tests::PacketFiller;

namespace {

std::vector<std::uint8_t> status(double speed_mps, std::uint16_t count) {
    static const auto dictionary = tests::small_dictionary();
    return PacketFiller{dictionary, "Status"}.real("speed_mps", speed_mps).seal(count);
}

}  // namespace

TEST_CASE("the proof holds when every real-time packet is in the recording, bit for bit", "[proof][R29]") {
    PacketRegister packets;
    for (std::uint16_t count = 0; count < 3; ++count) packets.add(status(1.0, count), Path::realtime);
    CHECK_FALSE(prove(packets).holds());
    CHECK(prove(packets).realtime_not_recorded == 3);

    for (std::uint16_t count = 0; count < 10; ++count) packets.add(status(1.0, count), Path::recorded);
    const Proof proof = prove(packets);
    CHECK(proof.holds());
    CHECK(proof.recorded == 10);
    CHECK(proof.realtime == 3);
    CHECK(proof.never_seen_live == 7);
    CHECK(text_of(proof) ==
          "all 3 packets seen in real time are in the recording, bit for bit; of 10 packets recorded, 7 "
          "were never seen live");
}

TEST_CASE("one missing and one differing packet break the proof and are counted apart", "[proof][R29]") {
    PacketRegister packets;
    packets.add(status(1.0, 0), Path::realtime);
    packets.add(status(1.0, 1), Path::realtime);
    packets.add(status(1.0, 2), Path::realtime);
    packets.add(status(1.0, 0), Path::recorded);
    packets.add(status(2.0, 1), Path::recorded);
    const Proof proof = prove(packets);
    CHECK_FALSE(proof.holds());
    CHECK(proof.realtime_not_recorded == 1);
    CHECK(proof.realtime_differs == 1);
    CHECK(proof.never_seen_live == 0);
}

TEST_CASE("what could not be compared is no proof", "[proof]") {
    PacketRegister packets{1};
    packets.add(status(1.0, 0), Path::realtime);
    packets.add(status(1.0, 0), Path::recorded);
    CHECK(prove(packets).holds());
    packets.add(status(1.0, 1), Path::recorded);
    CHECK_FALSE(prove(packets).holds());
}

}  // namespace telemetry_proof_test
