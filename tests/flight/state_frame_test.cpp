// SPDX-License-Identifier: Apache-2.0
#include "flight/cross_string/state_frame.hpp"

#include "flight/gnc/vector.hpp"
#include "tests/support/catch.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace flight_state_frame_test {

using namespace aeolis;
using namespace aeolis::flight;

namespace {

/// One of each kind of number that modules hold.
struct Everything {
    double number = 0.0;
    bool flag = false;
    std::optional<Sclk> time;
    MaybeTime anchor;
    std::optional<double> offset_s;
    std::array<double, 3> row{};
    gnc::Vector3 vector = gnc::Vector3::Zero();
    gnc::Quaternion attitude = gnc::Quaternion::Identity();
    std::array<bool, 5> fired{};
    std::uint32_t count = 0;
    FixedVector<double, 3> some;
    struct Table {
        double first = 0.0, second = 1.0;
    } table;

    template <typename Exchange>
    void carry(Exchange& exchange) {
        exchange(number, flag, time, anchor, offset_s, row, vector, attitude, fired, count, some);
        exchange.departures(table, Table{});
    }
};

constexpr std::size_t times_max = 130;  // more than two words of bits

/// Times that are undefined by default.
struct Times {
    std::array<MaybeTime, times_max> at{};
    template <typename Exchange>
    void carry(Exchange& exchange) {
        exchange.departures(
            at.size(), [this](std::size_t i) -> MaybeTime& { return at[i]; }, [](std::size_t) { return MaybeTime{}; });
    }
};

/// The bits of a word of departures, and three values for which there may be three.
struct Bits {
    std::uint64_t departed = 0;
    template <typename Exchange>
    void carry(Exchange& exchange) {
        exchange(departed);
    }
};
struct Three {
    std::array<double, 3> values{};
    template <typename Exchange>
    void carry(Exchange& exchange) {
        exchange.departures(values, std::array<double, 3>{});
    }
};

struct Smaller {
    double number = 0.0;
    template <typename Exchange>
    void carry(Exchange& exchange) {
        exchange(number);
    }
};

struct Long {
    std::array<double, 100> numbers{};
    template <typename Exchange>
    void carry(Exchange& exchange) {
        exchange(numbers);
    }
};

Everything something() {
    Everything e;
    e.number = -3.25;
    e.flag = true;
    e.time = Sclk{17.5};
    e.anchor = Sclk{99.0};
    e.row = {1, 2, 3};
    e.vector = {4, 5, 6};
    e.attitude = gnc::Quaternion{0.5, -0.5, 0.5, -0.5};
    e.fired = {true, false, true, true, false};
    e.count = 77;
    e.some.push_back(7.0);
    e.some.push_back(8.0);
    e.table.first = -0.0;  // of other bits than the default
    return e;
}

const StateHeader header{.time = Sclk{123.0}, .revision = 9, .begun = true, .separated = true, .touchdown = true};

}  // namespace

TEST_CASE("a state arrives at the other computer as it left, number for number", "[cross_string][R33]") {
    Everything sent = something();
    const StateFrame frame = StateFrame::of(header, sent);
    const auto arrived = StateFrame::read(frame.octets());
    REQUIRE(arrived);
    CHECK(arrived->header().time == Sclk{123.0});
    CHECK(arrived->header().revision == 9);
    CHECK(arrived->header().begun);
    CHECK(arrived->header().separated);
    CHECK(arrived->header().touchdown);
    Everything got;
    got.offset_s = 5.0;      // must become undefined, as it was sent
    got.table.second = 5.0;  // must become the default
    for (const double old : {1.0, 2.0, 3.0}) got.some.push_back(old);
    REQUIRE(arrived->restore(got));
    CHECK(got.number == sent.number);
    CHECK(got.flag == sent.flag);
    CHECK(got.time == sent.time);
    CHECK(got.anchor.get() == sent.anchor.get());
    CHECK_FALSE(got.offset_s.has_value());
    CHECK(got.row == sent.row);
    CHECK(got.vector == sent.vector);
    CHECK(got.attitude.coeffs() == sent.attitude.coeffs());
    CHECK(got.fired == sent.fired);
    CHECK(got.count == sent.count);
    CHECK(std::ranges::equal(got.some, sent.some));
    CHECK(std::signbit(got.table.first));
    CHECK(got.table.second == sent.table.second);
}

TEST_CASE("of values that both computers have, only those that depart are handed over", "[cross_string][R33]") {
    Times none, some;
    const std::array<std::size_t, 5> departed{0, 63, 64, 127, 129};
    for (const std::size_t i : departed) some.at[i] = Sclk{static_cast<double>(i)};
    const StateFrame of_none = StateFrame::of(header, none), of_some = StateFrame::of(header, some);
    CHECK(of_some.octets().size() - of_none.octets().size() == departed.size() * (1 + sizeof(double)));
    Times got;
    got.at[7] = Sclk{7.0};
    REQUIRE(of_some.restore(got));
    for (std::size_t i = 0; i < got.at.size(); ++i) CHECK(got.at[i].get() == some.at[i].get());
    REQUIRE(of_none.restore(got));
    for (const MaybeTime& time : got.at) CHECK_FALSE(time.defined());
}

TEST_CASE("a state in which a value departs that does not exist is not restored", "[cross_string][R33]") {
    Bits bits{std::uint64_t{1} << 3U};
    Three three;
    CHECK_FALSE(StateFrame::of(header, bits).restore(three));
}

TEST_CASE("a state that claims more values than there is room for is not restored", "[cross_string][R33]") {
    FixedVector<double, 2> two;
    FixedVector<double, 3> three;
    for (const double value : {1.0, 2.0, 3.0}) three.push_back(value);
    CHECK_FALSE(StateFrame::of(header, three).restore(two));
    CHECK(two.empty());
}

TEST_CASE("one changed bit anywhere, or one octet more or less, and a state is no state", "[cross_string][R33]") {
    Everything sent = something();
    const StateFrame frame = StateFrame::of(header, sent);
    std::vector<std::uint8_t> octets{frame.octets().begin(), frame.octets().end()};
    for (std::size_t bit = 0; bit < octets.size() * 8; ++bit) {
        octets[bit / 8] = static_cast<std::uint8_t>(octets[bit / 8] ^ (1U << (bit % 8)));
        REQUIRE_FALSE(StateFrame::read(octets).has_value());
        octets[bit / 8] = static_cast<std::uint8_t>(octets[bit / 8] ^ (1U << (bit % 8)));
    }
    CHECK(StateFrame::read(octets).has_value());
    octets.push_back(0);
    CHECK_FALSE(StateFrame::read(octets).has_value());
    octets.resize(octets.size() - 2);
    CHECK_FALSE(StateFrame::read(octets).has_value());
    CHECK_FALSE(StateFrame::read({}).has_value());
}

TEST_CASE("a state of another shape is not restored", "[cross_string][R33]") {
    Everything sent = something();
    const StateFrame frame = StateFrame::of(header, sent);
    Smaller smaller;
    CHECK_FALSE(frame.restore(smaller));
}

TEST_CASE("pieces out of order, of two states or at random never make a state; in order they do",
          "[cross_string][R33]") {
    Long state;
    const StateFrame frame = StateFrame::of(header, state);
    std::vector<StatePart> parts;
    frame.in_parts([&](const StatePart& part) { parts.push_back(part); });
    REQUIRE(parts.size() == 4);

    StateAssembly in_order;
    for (std::size_t i = 0; i < parts.size(); ++i) CHECK(in_order.on(parts[i]).has_value() == (i + 1 == parts.size()));
    StateAssembly one_lost;
    for (const std::size_t i : {0, 1, 3}) CHECK_FALSE(one_lost.on(parts[i]).has_value());
    StateAssembly of_two_times;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        StatePart part = parts[i];
        if (i == 2) part.time = part.time + 1.0 / 64;
        CHECK_FALSE(of_two_times.on(part).has_value());
    }
    std::mt19937 random{1};
    StateAssembly at_random;
    for (int round = 0; round < 100000; ++round) {
        StatePart part = parts[random() % parts.size()];
        part.index = static_cast<std::uint8_t>(random() % 5);
        part.count = static_cast<std::uint8_t>(random() % 5);
        part.size = static_cast<std::uint8_t>(random());
        part.octets[random() % part.octets.size()] = static_cast<std::uint8_t>(random());
        REQUIRE_FALSE(at_random.on(part).has_value());
    }
}

}  // namespace flight_state_frame_test
