// SPDX-License-Identifier: Apache-2.0
#include "flight/cross_string/cross_string.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/outbox.hpp"

#include <vector>

namespace flight_cross_string_test {

using namespace aeolis;
using namespace aeolis::flight;

namespace {

struct Nothing {
    std::uint8_t filler = 0;
    template <typename Exchange>
    void carry(Exchange& exchange) {
        exchange(filler);
    }
};

StatePart state_at(double at_s, StateHeader header) {
    header.time = Sclk{at_s};
    Nothing nothing;
    StatePart whole;
    StateFrame::of(header, nothing).in_parts([&](const StatePart& part) { whole = part; });
    return whole;
}

const StateHeader in_edl{.time = {}, .revision = 5, .begun = true, .separated = true, .touchdown = false};

struct Backup {
    CrossString line{[] {
        Load load;
        load.string = String::b;
        load.role = Role::second_chance;
        return load;
    }()};
    test::OutboxRecorder recorder{ModuleId::cross_string};

    template <typename M>
    void handle(const M& message, double at_s) {
        recorder.begin(ModuleId::cross_string, Sclk{at_s});
        line.on(message, recorder.out);
    }
    void enable(double at_s) { handle(EnableSecondChanceCommand{{}, true}, at_s); }
    /// Whether it has taken over by the end of the silence from `from_s` to `to_s`.
    bool after_silence(double from_s, double to_s) {
        for (double at_s = from_s; at_s <= to_s; at_s += 1.0 / 64) handle(ClockTick{Sclk{at_s}}, at_s);
        return line.in_control();
    }
};

}  // namespace

TEST_CASE("Second Chance takes over after a quarter of a second of silence, not a tick before", "[cross_string][R33]") {
    Backup backup;
    backup.enable(99.0);
    backup.handle(state_at(100.0, in_edl), 100.0);
    CHECK_FALSE(backup.after_silence(100.0, 100.25));
    CHECK(backup.after_silence(100.25 + 1.0 / 64, 100.25 + 1.0 / 64));
    CHECK(backup.recorder.sent<Resume>().size() == 2);  // to edl and to the command dispatcher
    CHECK(backup.recorder.sent<StatePart>().size() == 1);
}

TEST_CASE("a take-over, made or refused for the age of prime's state, is explained by prime's silence and that state",
          "[cross_string][R33][R38]") {
    const auto told_by = [](Backup& backup) {
        const auto told = backup.recorder.explanations();
        REQUIRE(told.size() == 1);
        CHECK(told[0].decision == Decision::take_over);
        REQUIRE(told[0].conditions.size() == 4);
        CHECK(told[0].conditions[0].quantity == Quantity::prime_silent_s);
        CHECK(told[0].conditions[0].holds);
        CHECK(told[0].conditions[1].quantity == Quantity::state_age_s);
        CHECK(told[0].conditions[2].holds);
        CHECK(told[0].conditions[3].holds);
        return told[0];
    };
    Backup backup;
    backup.enable(99.0);
    backup.handle(state_at(100.0, in_edl), 100.0);
    REQUIRE(backup.after_silence(100.25 + 1.0 / 64, 100.25 + 1.0 / 64));
    const auto made = told_by(backup);
    CHECK(made.verdict == ExplanationVerdict::decided);
    CHECK(made.conditions[0].value == 0.265625);
    CHECK(made.conditions[0].bound == prime_silent_s);
    CHECK(made.conditions[1].value == 0.265625);
    CHECK(made.conditions[1].holds);
    Backup late;
    late.handle(state_at(100.0, in_edl), 100.0);
    late.enable(160.0);
    REQUIRE_FALSE(late.after_silence(160.0, 160.0));
    const auto refused = told_by(late);
    CHECK(refused.verdict == ExplanationVerdict::refused);
    CHECK(refused.conditions[1].value == 60.0);
    CHECK_FALSE(refused.conditions[1].holds);
}

TEST_CASE("without ground's enabling, before cruise-stage separation, before do edl or after touchdown it never takes "
          "over",
          "[cross_string][R1][R34]") {
    SECTION("not enabled") {
        Backup backup;
        backup.handle(state_at(100.0, in_edl), 100.0);
        CHECK_FALSE(backup.after_silence(100.0, 200.0));
    }
    SECTION("enabled, and disabled again") {
        Backup backup;
        backup.enable(90.0);
        backup.handle(EnableSecondChanceCommand{{}, false}, 95.0);
        backup.handle(state_at(100.0, in_edl), 100.0);
        CHECK_FALSE(backup.after_silence(100.0, 200.0));
    }
    SECTION("never heard of prime") {
        Backup backup;
        backup.enable(90.0);
        CHECK_FALSE(backup.after_silence(100.0, 200.0));
    }
    StateHeader state = in_edl;
    SECTION("before cruise-stage separation") {
        state.separated = false;
    }
    SECTION("before do edl") {
        state.begun = false;
    }
    SECTION("after touchdown") {
        state.touchdown = true;
    }
    Backup backup;
    if (!state.separated || !state.begun || state.touchdown) {
        backup.enable(90.0);
        backup.handle(state_at(100.0, state), 100.0);
        CHECK_FALSE(backup.after_silence(100.0, 200.0));
    }
}

TEST_CASE("a state that is too old is not flown from, and ground hears why", "[cross_string][R34]") {
    SECTION("enabled a minute after prime fell silent") {
        Backup backup;
        backup.handle(state_at(100.0, in_edl), 100.0);
        backup.enable(160.0);
        CHECK_FALSE(backup.after_silence(160.0, 160.0));
        CHECK(backup.recorder.events<evr::SECOND_CHANCE_STATE_TOO_OLD>() == 1);
        CHECK_FALSE(backup.after_silence(160.0 + 1.0 / 64, 170.0));
        CHECK(backup.recorder.events<evr::SECOND_CHANCE_STATE_TOO_OLD>() == 0);  // said once
    }
    SECTION("a second of noise before the silence") {
        Backup backup;
        backup.enable(90.0);
        backup.handle(state_at(100.0, in_edl), 100.0);
        for (int cycle = 1; cycle <= 64; ++cycle) backup.handle(StatePart{}, 100.0 + cycle / 64.0);
        CHECK_FALSE(backup.after_silence(101.0, 110.0));
    }
}

TEST_CASE("while it listens the backup's managers learn which units prime addresses", "[cross_string][R2][R33]") {
    Backup backup;
    StateHeader header = in_edl;
    header.units[Device::pyro] = Unit::b;
    backup.handle(state_at(100.0, header), 100.0);
    REQUIRE(backup.recorder.sent<UnitsSelected>().size() == 1);
    CHECK(backup.recorder.sent<UnitsSelected>()[0].units == header.units);
    backup.handle(state_at(101.0, header), 101.0);
    CHECK(backup.recorder.sent<UnitsSelected>().empty());
}

TEST_CASE("what comes on the line is life, readable or not", "[cross_string][R34]") {
    Backup backup;
    backup.enable(90.0);
    backup.handle(state_at(100.0, in_edl), 100.0);
    for (int cycle = 1; cycle < 640; ++cycle) {
        const double at_s = 100.0 + cycle / 64.0;
        StatePart noise;
        noise.index = 3;
        backup.handle(noise, at_s);
        backup.handle(ClockTick{Sclk{at_s}}, at_s);
        REQUIRE_FALSE(backup.line.in_control());
    }
}

TEST_CASE("touchdown turns Second Chance off for good", "[cross_string][R34]") {
    Backup backup;
    backup.enable(90.0);
    StateHeader landed = in_edl;
    landed.touchdown = true;
    backup.handle(state_at(100.0, landed), 100.0);
    CHECK(backup.recorder.events<evr::SECOND_CHANCE_OFF>() == 1);
    backup.handle(state_at(101.0, in_edl), 101.0);
    CHECK_FALSE(backup.after_silence(101.0, 110.0));
    backup.enable(111.0);
    REQUIRE(backup.recorder.sent<CommandOutcome>().size() == 1);
    CHECK(backup.recorder.sent<CommandOutcome>()[0].refused == CommandRefusal::wrong_phase);

    Backup that_flew;
    that_flew.enable(90.0);
    that_flew.handle(state_at(100.0, in_edl), 100.0);
    REQUIRE(that_flew.after_silence(100.0, 101.0));
    that_flew.handle(EdlFinished{}, 130.0);
    CHECK_FALSE(that_flew.line.in_control());
}

TEST_CASE("prime that stands by is not ordered on while the other computer runs the buses",
          "[cross_string][R32][R34]") {
    CrossString line{Load{}};
    test::OutboxRecorder recorder{ModuleId::cross_string};
    const auto handle = [&](const auto& message, double at_s) {
        recorder.begin(ModuleId::cross_string, Sclk{at_s});
        line.on(message, recorder.out);
    };
    handle(ResumePrimeCommand{}, 100.0);
    CHECK(recorder.sent<ResumePrimeCommand>().size() == 1);
    handle(OtherRunsBuses{Sclk{101.0}}, 101.0);
    handle(ResumePrimeCommand{}, 101.0 + prime_silent_s);
    CHECK(recorder.sent<ResumePrimeCommand>().empty());
    REQUIRE(recorder.sent<CommandOutcome>().size() == 1);
    CHECK(recorder.sent<CommandOutcome>()[0].refused == CommandRefusal::wrong_phase);
    handle(ResumePrimeCommand{}, 101.0 + prime_silent_s + 1.0 / 64);
    CHECK(recorder.sent<ResumePrimeCommand>().size() == 1);

    Backup backup;
    backup.handle(ResumePrimeCommand{}, 100.0);
    CHECK(backup.recorder.out.sent().empty());
}

TEST_CASE("prime puts its state on the line each time, and keeps it for a restart when it has changed",
          "[cross_string][R32][R33]") {
    CrossString line{Load{}};
    test::OutboxRecorder recorder{ModuleId::cross_string};
    const auto told = [&](std::uint32_t revision, double at_s) {
        StateHeader header = in_edl;
        header.revision = revision;
        recorder.bus->begin_cycle();
        recorder.begin(ModuleId::cross_string, Sclk{at_s});
        line.on(state_at(at_s, header), recorder.out);
        return std::pair{!recorder.bus->cross_string.empty(), !recorder.bus->restart_record.empty()};
    };
    CHECK(told(5, 100.0) == std::pair{true, true});
    CHECK(told(5, 100.5) == std::pair{true, false});
    CHECK(told(6, 100.5) == std::pair{true, true});
    CHECK(told(6, 100.5 + keep_every_s - 1.0 / 64) == std::pair{true, false});
    CHECK(told(6, 100.5 + keep_every_s) == std::pair{true, true});
}

TEST_CASE("what was kept goes to edl after a restart, and what cannot be read is reported", "[cross_string][R32]") {
    CrossString line{Load{}};
    test::OutboxRecorder recorder{ModuleId::cross_string};
    line.on(StoredStatePart{state_at(100.0, in_edl)}, recorder.out);
    REQUIRE(recorder.sent<Resume>().size() == 2);
    CHECK(recorder.sent<Resume>()[0].reason == ResumeReason::restart);
    recorder.begin(ModuleId::cross_string, Sclk{101.0});
    StatePart broken = state_at(100.0, in_edl);
    broken.octets[5] ^= 1U;
    line.on(StoredStatePart{broken}, recorder.out);
    CHECK(recorder.sent<Resume>().empty());
    CHECK(recorder.events<evr::STATE_UNREADABLE>() == 1);
}

}  // namespace flight_cross_string_test
