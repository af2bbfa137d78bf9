// SPDX-License-Identifier: Apache-2.0
#include "common/time_table.hpp"
#include "tests/support/catch.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace common_time_table_test {

using namespace aeolis;

TEST_CASE("a time table is smooth: value and rate are continuous, a parabola is followed but at its vertex",
          "[common]") {
    std::vector<double> time_s, value;
    for (int i = 0; i <= 20; ++i) {
        time_s.push_back(0.5 * i);
        value.push_back(3.0 - 2.0 * time_s.back() + 0.7 * time_s.back() * time_s.back());
    }
    const auto table = TimeTable::make(time_s, value);
    REQUIRE(table);
    for (double t = 0.5; t < 9.5; t += 0.013) {
        if (t > 1.0 && t < 2.5) {  // between the rows about the vertex no value is beyond them
            CHECK(table->at(t) == Approx(3.0 - 2.0 * t + 0.7 * t * t).margin(0.06));
            continue;
        }
        CHECK(table->at(t) == Approx(3.0 - 2.0 * t + 0.7 * t * t).margin(1e-9));
        CHECK(table->rate_at(t) == Approx(-2.0 + 1.4 * t).margin(1e-9));
    }
    CHECK(table->at(-1.0) == value.front());
    CHECK(table->at(10.0) == value.back());
    CHECK(table->at(1e9) == value.back());
    CHECK(table->rate_at(1e9) == 0.0);
}

TEST_CASE("no value of a time table lies beyond the two rows about it", "[common][tones]") {
    std::uint32_t random = 7;
    const auto next = [&random] { return static_cast<double>((random = random * 1664525U + 1013904223U) >> 8); };
    for (int trial = 0; trial < 50; ++trial) {
        std::vector<double> time_s{0.0}, value{0.0};
        for (int i = 0; i < 12; ++i) {
            time_s.push_back(time_s.back() + 0.01 + std::fmod(next(), 50.0));
            value.push_back(std::fmod(next(), 5.0) < 2.0 ? value.back() : std::fmod(next(), 100.0) - 50.0);
        }
        const auto table = TimeTable::make(time_s, value);
        REQUIRE(table);
        for (std::size_t i = 1; i < time_s.size(); ++i)
            for (double x = 0.0; x < 1.0; x += 0.05) {
                const double at = table->at(time_s[i - 1] + x * (time_s[i] - time_s[i - 1]));
                CHECK(at >= std::min(value[i - 1], value[i]) - 1e-9);
                CHECK(at <= std::max(value[i - 1], value[i]) + 1e-9);
            }
    }
    const auto gain_db = TimeTable::make({0.0, 20.0, 40.0, 1000.0}, {14.7, 14.7, 0.0, 0.0});
    CHECK(gain_db->at(60.0) == 0.0);  // dipped by 2.2 dB
}

TEST_CASE("a time table of nothing is zero, of one row constant", "[common]") {
    CHECK(TimeTable{}.at(5.0) == 0.0);
    const auto one = TimeTable::make({3.0}, {7.0});
    REQUIRE(one);
    CHECK(one->at(2.0) == 7.0);
    CHECK(one->at(3.0) == 7.0);
    CHECK(one->rate_at(3.0) == 0.0);
}

TEST_CASE("a time table refuses times that stand still, numbers that are none, columns of unequal length", "[common]") {
    CHECK(TimeTable::make({0.0, 0.0}, {1.0, 2.0}).error().message == "row 2 is not later than the one before");
    CHECK(TimeTable::make({0.0, 1.0}, {1.0, std::numeric_limits<double>::quiet_NaN()}).error().message ==
          "row 2 has a number that is not finite");
    CHECK_FALSE(TimeTable::make({0.0, 1.0}, {1.0}).ok());
}

}  // namespace common_time_table_test
