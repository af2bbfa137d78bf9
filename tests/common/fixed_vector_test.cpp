// SPDX-License-Identifier: Apache-2.0
#include "common/fixed_vector.hpp"
#include "tests/support/catch.hpp"

#include <array>

namespace common_fixed_vector_test {

using namespace aeolis;

TEST_CASE("a full fixed vector refuses and keeps what it has", "[common][R7]") {
    FixedVector<int, 2> values;
    CHECK(values.try_push_back(1));
    CHECK(values.try_push_back(2));
    CHECK_FALSE(values.try_push_back(3));
    CHECK(values.size() == 2);
    CHECK_THROWS_AS(values.push_back(3), CheckFailed);
}

TEST_CASE("erasing keeps the order of the others", "[common]") {
    FixedVector<int, 4> values;
    values.append(std::array{1, 2, 3, 4});
    values.erase_at(1);
    REQUIRE(values.size() == 3);
    CHECK(values[0] == 1);
    CHECK(values[1] == 3);
    CHECK(values.back() == 4);
}

TEST_CASE("an index past the end is a bug", "[common]") {
    FixedVector<int, 4> values;
    CHECK_THROWS_AS(values[0], CheckFailed);
    CHECK_THROWS_AS(values.append(std::array{1, 2, 3, 4, 5}), CheckFailed);
}

TEST_CASE("a vector that grows gives the place to fill until it is full", "[common]") {
    FixedVector<int, 1> vector;
    *vector.try_grow() = 7;
    CHECK(vector.back() == 7);
    CHECK(vector.try_grow() == nullptr);
}

}  // namespace common_fixed_vector_test
