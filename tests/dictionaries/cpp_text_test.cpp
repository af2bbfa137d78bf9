// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/autocoder/cpp_text.hpp"
#include "tests/support/catch.hpp"

namespace dictionaries_cpp_text_test {

using namespace aeolis::dictionary;
using namespace aeolis::dictionary::autocoder;

TEST_CASE("numbers and text become literals of C++", "[autocoder]") {
    CHECK(hexadecimal(0x20, 3) == "0x020");
    CHECK(double_literal(405) == "405.0");
    CHECK(double_literal(-600.046875) == "-600.046875");
    CHECK(double_literal(1e6) == "1e+06");
    CHECK(optional_literal(std::nullopt) == "std::nullopt");
    CHECK(string_literal("a\"b\\") == "\"a\\\"b\\\\\"");
}

TEST_CASE("a type's values have a type in C++", "[autocoder]") {
    CHECK(camel_case("edl_phase") == "EdlPhase");
    CHECK(camel_case("EdlPhase") == "EdlPhase");
    Type type;
    for (const auto& [bits, name] :
         {std::pair{3U, "std::uint8_t"}, {11U, "std::uint16_t"}, {32U, "std::uint32_t"}, {33U, "std::uint64_t"}}) {
        type.bits = bits;
        CHECK(value_type(type) == name);
    }
    type.encoding = Encoding::twos_complement;
    CHECK(value_type(type) == "std::int64_t");
    type.encoding = Encoding::ieee754;
    type.bits = 32;
    CHECK(value_type(type) == "float");
}

}  // namespace dictionaries_cpp_text_test
