// SPDX-License-Identifier: Apache-2.0
#include "common/ck.hpp"

#include "tests/support/catch.hpp"

namespace common_ck_test {

using namespace aeolis;

TEST_CASE("an attitude kernel is read as it was written, with and without rates", "[spice]") {
    for (const bool rates : {false, true}) {
        CkSegment segment;
        segment.name = "attitude";
        segment.structure = -76000;
        for (std::size_t i = 0; i < 250; ++i) {
            CkSegment::Pointing pointing{
                static_cast<double>(i) * 8192.0, {1.0, 0.0, 1e-3 * static_cast<double>(i), 0.0}, {}};
            if (rates) pointing.w_AB_A_rps = std::array{0.1, 0.0, -0.2};
            segment.pointings.push_back(pointing);
        }
        segment.start_ticks = 0.0;
        segment.stop_ticks = segment.pointings.back().sclk_ticks;
        segment.intervals_at_ticks = {0.0, 8192.0 * 200};
        const auto file = write_ck({segment}, "aeolis");
        REQUIRE(file.ok());
        const auto read = read_ck(*file);
        REQUIRE(read.ok());
        REQUIRE(read->size() == 1);
        CHECK(read->front().structure == -76000);
        CHECK(read->front().intervals_at_ticks == segment.intervals_at_ticks);
        REQUIRE(read->front().pointings.size() == 250);
        for (std::size_t i = 0; i < 250; ++i) {
            CHECK(read->front().pointings[i].sclk_ticks == segment.pointings[i].sclk_ticks);
            CHECK(read->front().pointings[i].q_BA == segment.pointings[i].q_BA);
            CHECK(read->front().pointings[i].w_AB_A_rps == segment.pointings[i].w_AB_A_rps);
        }
    }
}

TEST_CASE("the clock kernel has its clock's number and an instant of it", "[spice]") {
    const auto text = clock_kernel(-76, {397501914.5}, 397501000.0, 1.000001);
    CHECK_THAT(text, Catch::StartsWith("KPL/SCLK\n") && Catch::Contains("SCLK_DATA_TYPE_76         = ( 1 )") &&
                         Catch::Contains("SCLK01_MODULI_76          = ( 4294967296 65536 )") &&
                         Catch::Contains("SCLK01_COEFFICIENTS_76    = ( 0.0 516.99") && Catch::Contains(" 1.000001"));
}

}  // namespace common_ck_test
