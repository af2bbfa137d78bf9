// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/xtce/characters.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/octets.hpp"

namespace dictionaries_characters_test {

using namespace aeolis;
using namespace aeolis::dictionary::xtce;
using Characters = Coding::Characters;

TEST_CASE("text of a packet is read in its own characters, and what is none is no text", "[telemetry][R55]") {
    struct Case {
        Characters characters;
        const char* octets;
        std::optional<std::string> text;
    };
    using enum Characters;
    for (const auto& [characters, octets, text] : {
             Case{utf8, "41420000", "AB"},
             Case{utf8, "", ""},
             Case{utf8, "0000", ""},
             Case{utf8, "c3a9e282acf09f9a80", "é€🚀"},
             Case{utf8, "e9", std::nullopt},        // Latin-1
             Case{utf8, "c0af", std::nullopt},      // too long a spelling
             Case{utf8, "eda080", std::nullopt},    // half of a pair
             Case{utf8, "f4908080", std::nullopt},  // beyond the last
             Case{utf8, "e282", std::nullopt},
             Case{latin1, "e9b000", "é°"},
             Case{utf16_big_endian, "00410020ac0000", std::nullopt},
             Case{utf16_big_endian, "004120ac0000", "A€"},
             Case{utf16_little_endian, "4100ac20", "A€"},
             Case{utf16_big_endian, "fffe4100", "A"},
             Case{utf16_big_endian, "feff0041", "A"},
             Case{utf16_big_endian, "d83dde80", "🚀"},
             Case{utf16_big_endian, "d83d0041", std::nullopt},
             Case{utf16_big_endian, "de80", std::nullopt},
             Case{utf16_big_endian, "d83d", std::nullopt},
         }) {
        CAPTURE(octets);
        CHECK(text_of(test::hex(octets), characters) == text);
    }
}

}  // namespace dictionaries_characters_test
