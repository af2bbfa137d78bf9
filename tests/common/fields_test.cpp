// SPDX-License-Identifier: Apache-2.0
#include "common/fields.hpp"

#include "tests/support/catch.hpp"

#include <array>
#include <optional>

namespace common_fields_test {

using namespace aeolis;

namespace {
struct None {};
struct Three {
    int first = 1;
    std::optional<double> second;
    std::array<char, 2> third{};
};
}  // namespace

TEST_CASE("the fields of an aggregate are counted from its type, and met in their order", "[common]") {
    STATIC_REQUIRE(field_count<None>() == 0);
    STATIC_REQUIRE(field_count<Three>() == 3);
    Three value;
    with_fields(value, [](int& first, std::optional<double>& second, std::array<char, 2>& third) {
        first += 1;
        second = 2.5;
        third[1] = 'x';
    });
    CHECK(value.first == 2);
    CHECK(value.second == 2.5);
    CHECK(value.third[1] == 'x');
    None none;
    int called = 0;
    with_fields(none, [&] { ++called; });
    CHECK(called == 1);
}

}  // namespace common_fields_test
