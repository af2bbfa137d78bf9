// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/vector.hpp"
#include "tests/support/catch.hpp"

namespace flight_gnc_vector_test {

using namespace aeolis::flight::gnc;

TEST_CASE("a quaternion of a message keeps its order w, x, y, z and comes back unit", "[gnc][R27]") {
    const Quaternion q = to_quaternion({2.0, 0.0, 0.0, 2.0});  // 90° about z
    CHECK((q * Vector3::UnitX() - Vector3::UnitY()).norm() < 1e-15);
    CHECK(to_array(q)[0] == Approx(std::sqrt(0.5)));
    CHECK(to_array(q)[3] == Approx(std::sqrt(0.5)));
}

TEST_CASE("a vector of a message goes there and back", "[gnc][R27]") {
    CHECK(to_array(to_vector({1.0, -2.0, 3.0})) == std::array<double, 3>{1.0, -2.0, 3.0});
}

}  // namespace flight_gnc_vector_test
