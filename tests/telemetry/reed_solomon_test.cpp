// SPDX-License-Identifier: Apache-2.0
#include "telemetry/reed_solomon.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/octets.hpp"
#include "tests/support/reed_solomon_encoder.hpp"

#include <algorithm>
#include <numeric>

namespace telemetry_reed_solomon_test {

using namespace aeolis;
using namespace aeolis::telemetry;

namespace {

using Octets = std::vector<std::uint8_t>;

std::vector<ReedSolomonCode> all_codes() {
    std::vector<ReedSolomonCode> codes;
    for (const std::size_t symbols : {32U, 16U})
        for (const std::size_t interleave : {1U, 2U, 3U, 4U, 5U, 8U})
            for (const auto basis : {ReedSolomonCode::Basis::dual, ReedSolomonCode::Basis::conventional})
                codes.push_back({symbols, interleave, basis});
    return codes;
}

/// Makes `errors` symbols of one word of the codeblock wrong.
void damage(Octets& block, const ReedSolomonCode& code, std::size_t word, std::size_t errors, std::mt19937& random) {
    std::vector<std::size_t> places(block.size() / code.interleave);
    std::iota(places.begin(), places.end(), std::size_t{0});
    std::ranges::shuffle(places, random);
    for (std::size_t i = 0; i < errors; ++i)
        block[word + places[i] * code.interleave] ^= static_cast<std::uint8_t>(1 + random() % 255);
}

}  // namespace

TEST_CASE("the generators of both Reed-Solomon codes are the ones that the standard prints", "[telemetry][R54]") {
    // [ccsds-131.0-b-5, annex on expanded coefficients]: G0 … G16 as powers of alpha; the rest is symmetric.
    const std::vector<unsigned> wide{0, 249, 59, 66, 4, 43, 126, 251, 97, 30, 3, 213, 50, 66, 170, 5, 24};
    const std::vector<unsigned> narrow{0, 30, 230, 49, 235, 129, 81, 76, 173};
    for (const auto& powers : {wide, narrow}) {
        const auto generator = test::generator_of(2 * (powers.size() - 1));
        for (std::size_t i = 0; i < powers.size(); ++i) {
            CHECK(generator[i] == test::alpha_to(powers[i]));
            CHECK(generator[generator.size() - 1 - i] == test::alpha_to(powers[i]));
        }
    }
}

TEST_CASE("as many wrong symbols a code word as the code can correct are corrected and counted, in every code, "
          "interleaving, basis and shortening",
          "[telemetry][R54]") {
    std::mt19937 random{1};
    for (const auto& code : all_codes())
        for (int round = 0; round < 12; ++round) {
            const std::size_t whole = code.data_octets_max() / code.interleave;
            const std::size_t symbols = round < 4 ? whole : 1 + random() % whole;  // a word's
            const Octets clean = test::codeblock_of(test::random_octets(random, symbols * code.interleave), code);
            Octets block = clean;
            CHECK(correct_codeblock(code, block).symbols == 0);
            std::size_t wrong = 0;
            for (std::size_t word = 0; word < code.interleave; ++word) {
                const std::size_t errors =
                    round % 2 == 0 ? code.check_symbols / 2 : random() % (code.check_symbols / 2);
                damage(block, code, word, errors, random);
                wrong += errors;
            }
            const auto found = correct_codeblock(code, block);
            INFO(code.check_symbols << " check symbols, interleaved " << code.interleave << ", words of " << symbols);
            REQUIRE(block == clean);
            REQUIRE(found.symbols == wrong);
            REQUIRE(found.uncorrectable_words == 0);
        }
}

TEST_CASE("more wrong symbols than the code can correct are told, and the code word is left as it came",
          "[telemetry][R54]") {
    std::mt19937 random{2};
    for (const std::size_t interleave : {1U, 5U}) {
        const ReedSolomonCode code{.check_symbols = 32, .interleave = interleave};
        const Octets clean = test::codeblock_of(test::random_octets(random, code.data_octets_max()), code);
        for (std::size_t errors = 17; errors <= 255; errors += interleave == 1 ? 1 : 17) {
            Octets block = clean;
            damage(block, code, interleave - 1, errors, random);
            const Octets damaged = block;
            const auto found = correct_codeblock(code, block);
            REQUIRE(found.uncorrectable_words == 1);
            REQUIRE(found.symbols == 0);
            REQUIRE(block == damaged);
        }
    }
    // With 16 check symbols another word is as near once in 8!: what is returned then is a word of the code.
    const ReedSolomonCode narrow{.check_symbols = 16, .interleave = 1};
    std::size_t mistaken = 0;
    for (int round = 0; round < 4000; ++round) {
        Octets block = test::random_octets(random, 255);
        if (correct_codeblock(narrow, block).uncorrectable_words > 0) continue;
        ++mistaken;
        CHECK(correct_codeblock(narrow, block).symbols == 0);
    }
    CHECK(mistaken <= 3);
}

TEST_CASE("errors in what a shortened code word does not send are not believed", "[telemetry][R54]") {
    std::mt19937 random{3};
    const ReedSolomonCode code{.check_symbols = 32, .interleave = 1};
    for (int round = 0; round < 100; ++round) {
        // A word of full length with one wrong symbol among those that the shortened one leaves out.
        Octets data = test::random_octets(random, 223);
        std::fill_n(data.begin(), 100, std::uint8_t{0});
        data[random() % 100] = 1;
        const Octets block = test::codeblock_of(data, code);
        Octets shortened{block.begin() + 100, block.end()};
        CHECK(correct_codeblock(code, shortened).uncorrectable_words == 1);
    }
}

}  // namespace telemetry_reed_solomon_test
