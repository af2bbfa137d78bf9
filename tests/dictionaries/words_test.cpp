// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/words.hpp"
#include "tests/support/catch.hpp"

namespace dictionaries_words_test {

using namespace aeolis::dictionary;

TEST_CASE("a word is wholly a number, or it is none", "[dictionary]") {
    CHECK(to_number("-600.046875") == -600.046875);
    CHECK(to_number("1e-3") == 1e-3);
    for (const char* word : {"", " 1", "1 ", "1s", "nan", "inf", "0x10", "1,5", "--1"}) {
        INFO(word);
        CHECK_FALSE(to_number(word));
    }
}

TEST_CASE("whole numbers are decimal or hexadecimal", "[dictionary]") {
    CHECK(to_integer("-7") == -7);
    CHECK(to_integer("0x010") == 16);
    for (const char* word : {"", "0x", "0x-1", "1.0", "ten", "99999999999999999999"}) {
        INFO(word);
        CHECK_FALSE(to_integer(word));
    }
}

TEST_CASE("a word has no white space around it", "[dictionary]") {
    CHECK(trimmed(" \t12 34\r\n") == "12 34");
    CHECK(trimmed(" \n").empty());
    CHECK(trimmed("").empty());
}

TEST_CASE("a number's word reads back as the same number", "[dictionary]") {
    for (const double value : {0.0, -4.6019, 1.0 / 3.0, 397501714.997, 1e300})
        CHECK(to_number(number_word(value)) == value);
}

TEST_CASE("keywords and odd characters are no names in C++", "[dictionary][R40]") {
    CHECK_FALSE(unusable_as_identifier("coolant_vent"));
    for (const char* name : {"", "class", "x-band", "2nd", "_x", "a__b", "\xC3\xA4"}) {
        INFO(name);
        CHECK(unusable_as_identifier(name));
    }
}

}  // namespace dictionaries_words_test
