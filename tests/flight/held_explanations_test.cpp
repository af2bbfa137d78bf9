// SPDX-License-Identifier: Apache-2.0
#include "flight/explanation/held_explanations.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/outbox.hpp"

#include <array>

namespace flight_held_explanations_test {

using namespace aeolis;
using namespace aeolis::flight;

namespace {

constexpr std::array too_fast{at_most(Quantity::speed_mps, 407.1, 405.0)};

struct Fixture {
    HeldExplanations held;
    test::OutboxRecorder recorder{ModuleId::edl};

    /// The explanation that is told of it in that cycle, if any.
    std::optional<Record> at(double sclk, Decision decision, std::uint16_t subject = 0) {
        recorder.begin(ModuleId::edl, Sclk{sclk});
        held.held(decision, subject, too_fast, recorder.out);
        const auto records = recorder.sent<Record>();
        return records.empty() ? std::nullopt : std::optional{records.front()};
    }
};

/// `suppressed` is the last field of the packet.
std::uint16_t suppressed_in(const Record& record) {
    return static_cast<std::uint16_t>(read_bits(record.data, (record.size - std::size_t{2}) * 8, 16));
}

}  // namespace

TEST_CASE("a decision that stays held is told every four seconds, with the count of what was not told",
          "[explanation][R38]") {
    Fixture f;
    int told = 0;
    int cycles = 0;
    int suppressed = 0;
    for (double t = 100.0; t < 112.0; t += seconds_per_tick, ++cycles)
        if (const auto record = f.at(t, Decision::parachute_deploy)) {
            ++told;
            suppressed += suppressed_in(*record);
            CHECK(std::fmod(t - 100.0, HeldExplanations::again_after_s) == 0.0);
        }
    CHECK(told == 3);
    CHECK(suppressed + f.held.take_suppressed(Decision::parachute_deploy) + told == cycles);
    CHECK(f.held.take_suppressed(Decision::parachute_deploy) == 0);
}

TEST_CASE("no more than two are told in a second, however many decisions are held, and none is lost from the count",
          "[explanation][R38]") {
    Fixture f;
    constexpr std::array decisions{Decision::parachute_deploy, Decision::heatshield, Decision::backshell,
                                   Decision::touchdown, Decision::engine_priming};
    int told_in_second = 0;
    int told = 0;
    int counted = 0;
    int offered = 0;
    for (double t = 100.0; t < 130.0; t += seconds_per_tick) {
        if (at_resolution(Sclk{t}, 1) == Sclk{t}) told_in_second = 0;
        for (const Decision decision : decisions) {
            ++offered;
            const auto record = f.at(t, decision);
            if (!record) continue;
            ++told;
            counted += suppressed_in(*record);
            CHECK(++told_in_second <= static_cast<int>(HeldExplanations::each_second_max));
        }
    }
    for (const Decision decision : decisions) counted += f.held.take_suppressed(decision);
    CHECK(told + counted == offered);
    CHECK(told <= 60);
    CHECK(told >= 30);  // each about every four seconds
}

TEST_CASE("another timepoint is told at once, though one was told just before", "[explanation][R38]") {
    Fixture f;
    CHECK(f.at(100.0, Decision::timepoint, 3));
    CHECK_FALSE(f.at(100.5, Decision::timepoint, 3));
    const auto other = f.at(101.0, Decision::timepoint, 4);
    REQUIRE(other);
    CHECK(suppressed_in(*other) == 0);  // what was not told of the other is not its own
}

TEST_CASE("when the decision is made its explanation carries what was left untold", "[explanation][R38]") {
    Fixture f;
    CHECK(f.at(100.0, Decision::parachute_deploy));
    CHECK_FALSE(f.at(100.015625, Decision::parachute_deploy));
    CHECK_FALSE(f.at(100.03125, Decision::parachute_deploy));
    CHECK(f.held.take_suppressed(Decision::parachute_deploy) == 2);
}

}  // namespace flight_held_explanations_test
