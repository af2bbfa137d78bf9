// SPDX-License-Identifier: Apache-2.0
#include "common/time_table.hpp"
#include "tests/support/catch.hpp"

#include <cmath>
#include <limits>

namespace common_time_table_test {

using namespace aeolis;

TEST_CASE("a time table is smooth: value and rate are continuous, a parabola is followed inside", "[common]") {
    std::vector<double> time_s, value;
    for (int i = 0; i <= 20; ++i) {
        time_s.push_back(0.5 * i);
        value.push_back(3.0 - 2.0 * time_s.back() + 0.7 * time_s.back() * time_s.back());
    }
    const auto table = TimeTable::make(time_s, value);
    REQUIRE(table);
    for (double t = 0.5; t < 9.5; t += 0.013) {
        CHECK(table->at(t) == Approx(3.0 - 2.0 * t + 0.7 * t * t).margin(1e-9));
        CHECK(table->rate_at(t) == Approx(-2.0 + 1.4 * t).margin(1e-9));
    }
    CHECK(table->at(-1.0) == value.front());
    CHECK(table->at(10.0) == value.back());
    CHECK(table->at(1e9) == value.back());
    CHECK(table->rate_at(1e9) == 0.0);
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
