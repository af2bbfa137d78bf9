// SPDX-License-Identifier: Apache-2.0
#include "flight/devices/imu.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/device_module.hpp"

namespace flight_imu_test {

using namespace aeolis;
using namespace aeolis::flight;

namespace {

/// Ticks from SCLK 1000 on, each with the samples of a 200 Hz unit, of which `lose(number)` are left out.
template <typename Lose>
std::vector<int> reports(test::Spoken<ImuManager>& imu, int ticks, const Lose& lose) {
    std::vector<int> missing;
    int given = 0;
    for (int tick = 1; tick <= ticks; ++tick) {
        ImuReadings readings;
        for (; given < tick * 200 / 64; ++given)
            if (!lose(given)) readings.samples.push_back({.count = static_cast<std::uint32_t>(given)});
        const Sclk now{1000.0 + tick / 64.0};
        imu.on(readings, now);
        for (const auto& record : imu.on(Tick{now}, now).template sent<Record>())
            if (read_bits(record.data, 0, 16) == evr::IMU_SAMPLES_MISSING::id.value)
                missing.push_back(static_cast<int>(read_bits(record.data, 16, 16)));
    }
    return missing;
}

}  // namespace

TEST_CASE("IMU samples reach Edl and EdlComm once, in the cycle in which they came", "[devices][R2]") {
    test::Spoken<ImuManager> imu{ModuleId::imu};
    ImuReadings readings;
    readings.samples.push_back({.count = 5});
    imu.on(readings);
    const auto sent = imu.on(Tick{Sclk{1.0}}).sent<ImuReadings>();
    REQUIRE(sent.size() == 2);
    for (const auto& one : sent) CHECK(one.samples.size() == 1);
    const auto none = imu.on(Tick{Sclk{1.0}}).sent<ImuReadings>();
    REQUIRE(none.size() == 1);  // to Edl, which has its turn without any too
    CHECK(none[0].samples.empty());
}

TEST_CASE("200 samples a second are whole; fewer are reported with their number, once a second", "[devices][R2]") {
    test::Spoken<ImuManager> imu{ModuleId::imu};
    CHECK(reports(imu, 64 * 3, [](int) { return false; }).empty());

    test::Spoken<ImuManager> lossy{ModuleId::imu};
    CHECK(reports(lossy, 64 * 4, [](int n) { return n == 300 || n == 301 || (n >= 600 && n < 800); }) ==
          std::vector{2, 200});
}

TEST_CASE("the second in which the IMU is changed over is not judged", "[devices][R2]") {
    test::Spoken<ImuManager> imu{ModuleId::imu};
    reports(imu, 64, [](int) { return false; });
    imu.on(test::all_b());
    CHECK(reports(imu, 64, [](int n) { return n < 100; }).empty());
    CHECK(imu.recorder.bus->units[Device::imu] == Unit::b);
}

TEST_CASE("the rover's own IMU is told of once a second, by magnitude, and to nobody but ground", "[devices][R5]") {
    test::Spoken<ImuManager> imu{ModuleId::imu};
    std::vector<packet::RoverImu> told;
    for (int eighth = 0; eighth < 24; ++eighth) {
        auto& recorder =
            imu.on(RoverImuReading{{2.0, -3.0, 6.0}, {0.2 + eighth, 0.0, 0.0}}, Sclk{1000.0 + eighth / 8.0});
        CHECK(recorder.sent<ImuReadings>().empty());
        for (const auto& record : recorder.sent<Record>()) {
            CHECK(record.apid == packet::RoverImu::apid);
            BitReader in{record.data};
            told.push_back({.rover_imu_rate_rps = in.get_float(), .rover_imu_force_mps2 = in.get_float()});
        }
    }
    REQUIRE(told.size() == 3);
    for (std::size_t second = 0; second < told.size(); ++second) {
        CHECK(told[second].rover_imu_force_mps2 == 7.0F);
        CHECK(told[second].rover_imu_rate_rps == Approx(0.2 + 8.0 * static_cast<double>(second)));
    }
}

TEST_CASE("a second that begins without a reading of the rover's IMU is told of by its next one", "[devices][R5]") {
    test::Spoken<ImuManager> imu{ModuleId::imu};
    const auto records = [&](double sclk_s) {
        return imu.on(RoverImuReading{}, Sclk{sclk_s}).template sent<Record>().size();
    };
    CHECK(records(1000.0) == 1);
    CHECK(records(1001.25) == 1);
    CHECK(records(1001.875) == 0);
    CHECK(records(1002.0) == 1);
}

TEST_CASE("the IMU's manager confirms each tick and addresses the selected unit", "[devices][R2][R22]") {
    CHECK(test::confirms_and_addresses<ImuManager>(ModuleId::imu, Device::imu));
}

}  // namespace flight_imu_test
