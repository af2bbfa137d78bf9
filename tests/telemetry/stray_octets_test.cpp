// SPDX-License-Identifier: Apache-2.0
#include "telemetry/stray_octets.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/octets.hpp"

namespace telemetry_stray_octets_test {

using namespace aeolis;

TEST_CASE("the fill of Proximity-1 is no stray octet, from any of its octets on; anything else is",
          "[telemetry][R55]") {
    const auto stray = [](const char* before, const char* behind) {
        telemetry::StrayOctets octets;
        octets.skipped(test::hex(before));
        octets.frame();
        octets.skipped(test::hex(behind));
        return octets.number();
    };
    CHECK(stray("352ef853352ef853", "352ef853") == 0);
    CHECK(stray("f853352e", "2ef853352ef8") == 0);
    CHECK(stray("352ef8", "f853") == 0);  // a frame between
    CHECK(stray("", "352ef8f853") == 3);
    CHECK(stray("0000000000", "") == 5);
    CHECK(stray("352e00352ef853", "ff") == 4);
}

}  // namespace telemetry_stray_octets_test
