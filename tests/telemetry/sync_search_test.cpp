// SPDX-License-Identifier: Apache-2.0
#include "telemetry/sync_search.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/octets.hpp"

namespace telemetry_sync_search_test {

using namespace aeolis;
using namespace aeolis::telemetry;

TEST_CASE("a sync marker is found at every bit, inverted or not, and what follows it is read as it was sent",
          "[telemetry][R54]") {
    std::mt19937 random{1};
    for (unsigned shift = 0; shift < 8; ++shift)
        for (const bool inverted : {false, true}) {
            const auto noise = test::random_octets(random, 5);
            auto sent = test::hex("1acffc1d0123456789");
            std::vector<std::uint8_t> stream = noise;
            stream.resize(noise.size() + sent.size() + 1);
            for (std::size_t i = 0; i < sent.size(); ++i) {
                const unsigned octet = inverted ? ~unsigned{sent[i]} & 0xFFU : sent[i];
                stream[5 + i] |= static_cast<std::uint8_t>(octet >> shift);
                stream[6 + i] |= static_cast<std::uint8_t>(octet << (8 - shift));
            }
            const auto found = find_marker(stream, 0);
            REQUIRE(found);
            CHECK(found->octet == 5);
            CHECK(found->alignment == BitAlignment{shift, inverted});
            CHECK(marker_errors(std::span{stream}.subspan(5), found->alignment) == 0);
            CHECK(marker_errors(std::span{stream}.subspan(5), {shift, !inverted}) == 32);
            std::vector<std::uint8_t> read;
            align(stream, 5, sent.size(), found->alignment, read);
            CHECK(read == sent);
            CHECK_FALSE(find_marker(stream, 6));
            CHECK_FALSE(find_marker(std::span{stream}.first(9), 0));  // an octet to come may be part of it
        }
    CHECK(marker_errors(test::hex("1acffc"), {}) == 32);
    CHECK(marker_errors(test::hex("1acffc1f"), {}) == 1);
}

}  // namespace telemetry_sync_search_test
