// SPDX-License-Identifier: Apache-2.0
#include "flight/commands/farm.hpp"
#include "tests/support/catch.hpp"

#include <type_traits>
#include <vector>

namespace flight_farm_test {

using namespace aeolis;
using namespace aeolis::flight;

namespace {

constexpr Farm::Settings settings{76, 1, 16};
using Verdict = Farm::Verdict;

Verdict in_sequence(Farm& farm, int sequence) {
    return farm.take({{.spacecraft = 76, .virtual_channel = 1, .sequence = static_cast<std::uint8_t>(sequence)}, {}});
}
Verdict by_bypass(Farm& farm) {
    return farm.take({{.bypass = true, .spacecraft = 76, .virtual_channel = 1}, {}});
}
Verdict control(Farm& farm, const std::vector<std::uint8_t>& command) {
    return farm.take({{.bypass = true, .control = true, .spacecraft = 76, .virtual_channel = 1}, command});
}

}  // namespace

static_assert(std::is_trivially_copyable_v<Farm>);  // part of a computer, which is copied as a value

TEST_CASE("frames are taken in sequence, over the end of the count, and none twice", "[flight]") {
    Farm farm{settings};
    for (int i = 0; i < 1000; ++i) {
        CHECK(in_sequence(farm, i) == Verdict::accepted);
        CHECK(in_sequence(farm, i) == Verdict::repeated);
        CHECK(farm.clcw().expected == static_cast<std::uint8_t>(i + 1));
    }
    CHECK_FALSE(farm.clcw().retransmit);
    CHECK_FALSE(farm.clcw().lockout);
}

TEST_CASE("after a missing frame nothing is taken until it comes, and ground is asked for it", "[flight]") {
    Farm farm{settings};
    CHECK(in_sequence(farm, 0) == Verdict::accepted);
    CHECK(in_sequence(farm, 2) == Verdict::out_of_sequence);
    CHECK(in_sequence(farm, 3) == Verdict::out_of_sequence);
    CHECK(farm.clcw().retransmit);
    CHECK(farm.clcw().expected == 1);
    CHECK(in_sequence(farm, 1) == Verdict::accepted);
    CHECK_FALSE(farm.clcw().retransmit);
}

TEST_CASE("the window is half before and half behind the expected sequence; outside it the channel locks", "[flight]") {
    for (int ahead = -128; ahead < 128; ++ahead) {
        Farm farm{settings};
        for (int i = 0; i < 100; ++i) (void)in_sequence(farm, i);
        const Verdict verdict = in_sequence(farm, 100 + ahead);
        const auto expected = ahead == 0                 ? Verdict::accepted
                              : ahead > 0 && ahead < 8   ? Verdict::out_of_sequence
                              : ahead < 0 && ahead >= -8 ? Verdict::repeated
                                                         : Verdict::locked_out;
        INFO(ahead);
        CHECK(verdict == expected);
        CHECK(farm.clcw().lockout == (expected == Verdict::locked_out));
    }
}

TEST_CASE("a locked channel takes only by bypass, until it is unlocked", "[flight]") {
    Farm farm{settings};
    CHECK(in_sequence(farm, 100) == Verdict::locked_out);
    CHECK(in_sequence(farm, 0) == Verdict::locked_out);
    CHECK(by_bypass(farm) == Verdict::accepted);
    CHECK(control(farm, {0x82, 0x00, 9}) == Verdict::locked_out);
    CHECK(farm.clcw().expected == 0);
    CHECK(control(farm, {0x00}) == Verdict::executed);
    CHECK(control(farm, {0x82, 0x00, 9}) == Verdict::executed);
    CHECK(in_sequence(farm, 9) == Verdict::accepted);
    CHECK(farm.clcw().farm_b == 0);  // four by bypass
}

TEST_CASE("what is for others, or no control command, is refused and changes nothing", "[flight]") {
    Farm farm{settings};
    const Clcw before = farm.clcw();
    CHECK(farm.take({{.spacecraft = 77, .virtual_channel = 1}, {}}) == Verdict::not_for_this_channel);
    CHECK(farm.take({{.spacecraft = 76, .virtual_channel = 0}, {}}) == Verdict::not_for_this_channel);
    CHECK(farm.take({{.control = true, .spacecraft = 76, .virtual_channel = 1}, {}}) == Verdict::no_such_control);
    for (const auto& command :
         std::vector<std::vector<std::uint8_t>>{{}, {0x01}, {0x82, 0x00}, {0x82, 0x01, 5}, {0, 0}})
        CHECK(control(farm, command) == Verdict::no_such_control);
    CHECK(farm.clcw() == before);
}

}  // namespace flight_farm_test
