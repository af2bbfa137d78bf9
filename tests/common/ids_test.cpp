// SPDX-License-Identifier: Apache-2.0
#include "common/ids.hpp"
#include "tests/support/catch.hpp"

#include <type_traits>

namespace common_ids_test {

using namespace aeolis;

TEST_CASE("two kinds of id do not mix", "[common]") {
    CHECK(ToneId{3} == ToneId{3});
    CHECK(ToneId{3} < ToneId{4});
    STATIC_REQUIRE_FALSE(std::is_convertible_v<TimepointId, AnchorId>);
    STATIC_REQUIRE_FALSE(std::is_convertible_v<int, Opcode>);
}

}  // namespace common_ids_test
