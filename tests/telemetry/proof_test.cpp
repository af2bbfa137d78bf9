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

TEST_CASE("the proof holds when every real-time unit is in the recording, bit for bit", "[proof][R29]") {
    UnitRegister units;
    for (std::uint16_t count = 0; count < 3; ++count) units.add(status(1.0, count), Path::realtime);
    CHECK_FALSE(prove(units).holds());
    CHECK(prove(units).realtime_not_recorded == 3);

    for (std::uint16_t count = 0; count < 10; ++count) units.add(status(1.0, count), Path::recorded);
    const Proof proof = prove(units);
    CHECK(proof.holds());
    CHECK(proof.recorded == 10);
    CHECK(proof.realtime == 3);
    CHECK(proof.never_seen_live == 7);
    CHECK(text_of(proof) == "all 3 units seen in real time are in the recording, bit for bit; of 10 units recorded, 7 "
                            "were never seen live");
}

TEST_CASE("one missing and one differing unit break the proof and are counted apart", "[proof][R29]") {
    UnitRegister units;
    units.add(status(1.0, 0), Path::realtime);
    units.add(status(1.0, 1), Path::realtime);
    units.add(status(1.0, 2), Path::realtime);
    units.add(status(1.0, 0), Path::recorded);
    units.add(status(2.0, 1), Path::recorded);
    const Proof proof = prove(units);
    CHECK_FALSE(proof.holds());
    CHECK(proof.realtime_not_recorded == 1);
    CHECK(proof.realtime_differs == 1);
    CHECK(proof.never_seen_live == 0);
}

TEST_CASE("what could not be compared is no proof", "[proof]") {
    UnitRegister units{1};
    units.add(status(1.0, 0), Path::realtime);
    units.add(status(1.0, 0), Path::recorded);
    CHECK(prove(units).holds());
    units.add(status(1.0, 1), Path::recorded);
    CHECK_FALSE(prove(units).holds());
}

}  // namespace telemetry_proof_test
