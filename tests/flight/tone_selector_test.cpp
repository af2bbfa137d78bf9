// SPDX-License-Identifier: Apache-2.0
#include "flight/mfsk/tone_selector.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/outbox.hpp"

#include <array>
#include <vector>

namespace flight_tone_selector_test {

using namespace aeolis;
using namespace aeolis::flight;
constexpr aeolis::flight::Parameters parameters;

namespace {

std::array<ToneSpec, 256> tones() {
    std::array<ToneSpec, 256> specs{};
    for (std::size_t i = 0; i < specs.size(); ++i) specs[i] = {0, static_cast<std::int16_t>(i), 30.0, {}, {}};
    specs[50].supersedes = ToneId{40};
    specs[12].heartbeat_of = EdlPhase::range_control;
    specs[13].heartbeat_of = EdlPhase::sky_crane;
    return specs;
}

/// An Explanation as it was recorded.
struct Told {
    ExplanationVerdict verdict{};
    std::uint16_t tone = 0;
    struct Condition {
        Quantity quantity{};
        double value = 0.0, bound = 0.0;
        bool holds = false;
    };
    std::vector<Condition> conditions;

    const Condition& of(Quantity quantity) const {
        for (const Condition& condition : conditions)
            if (condition.quantity == quantity) return condition;
        FAIL("no such condition");
        return conditions.front();
    }
};

std::vector<Told> told_in(const test::OutboxRecorder& recorder) {
    std::vector<Told> all;
    for (const auto& record : recorder.sent<Record>()) {
        if (record.apid != packet::Explanation::apid) continue;
        BitReader in{record.data};
        REQUIRE(static_cast<Decision>(in.get(16)) == Decision::tone);
        Told told{static_cast<ExplanationVerdict>(in.get(8)), static_cast<std::uint16_t>(in.get(16)), {}};
        for (auto count = in.get(8); count > 0; --count) {
            Told::Condition condition{static_cast<Quantity>(in.get(16)), in.get_double(), in.get_double(), false};
            in.get(8);
            condition.holds = in.get(8) != 0;  // the flag and seven spare bits
            told.conditions.push_back(condition);
        }
        all.push_back(told);
    }
    return all;
}

struct Fixture {
    std::array<ToneSpec, 256> specs = tones();
    ToneSelector selector{Load{}, specs};
    test::OutboxRecorder recorder{ModuleId::mfsk};

    void request(std::uint8_t tone, double at_s) {
        recorder.begin(ModuleId::mfsk, Sclk{at_s});
        selector.on(ToneRequest{ToneId{tone}, Sclk{at_s}}, recorder.out);
    }
    void phase(EdlPhase phase, double at_s) {
        recorder.begin(ModuleId::mfsk, Sclk{at_s});
        selector.on(PhaseChanged{phase}, recorder.out);
    }
    std::optional<ToneId> tick(double at_s) {
        recorder.begin(ModuleId::mfsk, Sclk{at_s});
        selector.on(ClockTick{Sclk{at_s}}, recorder.out);
        return recorder.bus->tone;
    }
};

}  // namespace

TEST_CASE("without a request the carrier goes out without a tone", "[mfsk][R31]") {
    Fixture f;
    CHECK_FALSE(f.tick(0).has_value());
}

TEST_CASE("a tone is sent for ten seconds, not a tick less", "[mfsk][R31]") {
    Fixture f;
    f.request(7, 0);
    CHECK(f.tick(0) == ToneId{7});
    CHECK(f.tick(10.0 - 1.0 / 64) == ToneId{7});
    CHECK_FALSE(f.tick(10.0).has_value());
}

TEST_CASE("the most important outstanding request is sent first, and the choice explains itself", "[mfsk][R31][R38]") {
    Fixture f;
    f.request(10, 0);
    f.request(90, 0);
    f.request(20, 0);
    CHECK(f.tick(0) == ToneId{90});
    CHECK(f.recorder.packets<packet::ToneSelected>() == 1);
    const auto told = told_in(f.recorder);
    REQUIRE(told.size() == 1);
    CHECK(told[0].verdict == ExplanationVerdict::chosen);
    CHECK(told[0].of(Quantity::next_tone).value == 20);
    CHECK(told[0].of(Quantity::tone_priority).value == 90);
    CHECK(told[0].of(Quantity::tone_priority).bound == 20);
    CHECK(f.tick(10) == ToneId{20});
    CHECK(f.tick(20) == ToneId{10});
}

TEST_CASE("the heartbeat comes after the silence of the table that was received whole", "[mfsk][parameters][R25]") {
    Parameters changed;
    changed.heartbeat_after_s = parameters.heartbeat_after_s + 3.0;
    const auto beats_after_s = [&](std::size_t parts) {
        Fixture f;
        parameter_parts(changed, [&](const ParameterPart& part) {
            if (parts-- > 0) f.selector.on(part, f.recorder.out);
        });
        f.phase(EdlPhase::range_control, 0);
        for (double at_s = 0.0;; at_s += seconds_per_tick)
            if (f.tick(at_s)) return at_s;
    };
    const std::size_t all = (parameter_count + part_parameters_max - 1) / part_parameters_max;
    CHECK(beats_after_s(all) == changed.heartbeat_after_s);
    CHECK(beats_after_s(all - 1) == parameters.heartbeat_after_s);
}

TEST_CASE("a tone that is being sent is not cut short by a more important one", "[mfsk][R31]") {
    Fixture f;
    f.request(1, 0);
    CHECK(f.tick(0) == ToneId{1});
    f.request(200, 1);
    CHECK(f.tick(5) == ToneId{1});
    CHECK(f.tick(10) == ToneId{200});
}

TEST_CASE("a request that has become too old is dropped, and says so", "[mfsk][R31][R38]") {
    Fixture f;
    f.request(200, 0);
    f.request(3, 0);
    CHECK(f.tick(0) == ToneId{200});
    f.request(201, 9);
    CHECK(f.tick(10) == ToneId{201});
    f.request(202, 19);
    CHECK(f.tick(20) == ToneId{202});
    CHECK_FALSE(f.tick(30.015625).has_value());
    const auto told = told_in(f.recorder);
    REQUIRE(told.size() == 1);
    CHECK(told[0].verdict == ExplanationVerdict::dropped);
    CHECK(told[0].tone == 3);
    CHECK(told[0].of(Quantity::request_age_s).value == 30.015625);
    CHECK(told[0].of(Quantity::request_age_s).bound == 30.0);
    CHECK_FALSE(told[0].of(Quantity::request_age_s).holds);
}

TEST_CASE("of two requests that are as important the newest goes first, and that is what it explains",
          "[mfsk][R31][R38]") {
    Fixture f;
    f.specs[21].priority = 20;
    f.request(20, 0);
    f.request(21, 3);
    CHECK(f.tick(4) == ToneId{21});
    const auto told = told_in(f.recorder);
    REQUIRE(told.size() == 1);
    CHECK(told[0].of(Quantity::request_age_s).value == 1.0);
    CHECK(told[0].of(Quantity::request_age_s).bound == 4.0);
}

TEST_CASE("a request that a newer event has overtaken is dropped, and says by which", "[mfsk][R31][R38]") {
    Fixture f;
    f.request(200, 0);
    CHECK(f.tick(0) == ToneId{200});
    f.request(40, 1);
    f.request(50, 2);
    const auto told = told_in(f.recorder);
    REQUIRE(told.size() == 1);
    CHECK(told[0].verdict == ExplanationVerdict::dropped);
    CHECK(told[0].tone == 40);
    CHECK(told[0].of(Quantity::overtaking_tone).value == 50);
    CHECK(told[0].of(Quantity::request_age_s).value == 1.0);
    CHECK(f.tick(10) == ToneId{50});
    CHECK_FALSE(f.tick(20).has_value());
}

TEST_CASE("when full, the less important of two requests goes, and says against which", "[mfsk][R31][R38]") {
    Fixture f;
    for (std::uint8_t tone = 100; tone < 164; ++tone) f.request(tone, 0);
    f.request(200, 0);
    CHECK(f.recorder.events<evr::MFSK_REQUESTS_FULL>() == 1);
    auto told = told_in(f.recorder);
    REQUIRE(told.size() == 1);
    CHECK(told[0].tone == 100);
    CHECK(told[0].of(Quantity::overtaking_tone).value == 200);
    CHECK(told[0].of(Quantity::tone_requests).value == 64);
    CHECK_FALSE(told[0].of(Quantity::tone_priority).holds);

    f.request(5, 0);
    CHECK(f.recorder.events<evr::MFSK_REQUESTS_FULL>() == 1);
    told = told_in(f.recorder);
    REQUIRE(told.size() == 1);
    CHECK(told[0].tone == 5);
    CHECK(told[0].of(Quantity::tone_priority).value == 5);
    CHECK(told[0].of(Quantity::tone_priority).bound == 101);
    CHECK(f.tick(0) == ToneId{200});
}

TEST_CASE("after a pause of carrier alone the heartbeat of the phase goes out, for ten seconds, again and again",
          "[mfsk][R31]") {
    Fixture f;
    f.phase(EdlPhase::range_control, 1000);
    f.request(7, 1000);
    CHECK(f.tick(1000) == ToneId{7});
    CHECK_FALSE(f.tick(1010).has_value());
    const double pause_s = parameters.heartbeat_after_s;
    CHECK_FALSE(f.tick(1010 + pause_s - 1.0 / 64).has_value());
    CHECK(f.tick(1010 + pause_s) == ToneId{12});
    CHECK(f.recorder.packets<packet::ToneSelected>() == 1);
    CHECK(told_in(f.recorder).empty());
    CHECK(f.tick(1020 + pause_s - 1.0 / 64) == ToneId{12});
    CHECK_FALSE(f.tick(1020 + pause_s).has_value());
    CHECK(f.tick(1020 + 2 * pause_s) == ToneId{12});
}

TEST_CASE("a heartbeat never goes before a request, and follows the phase", "[mfsk][R31]") {
    Fixture f;
    f.phase(EdlPhase::range_control, 1000);
    f.request(1, 1000);  // less important than any heartbeat
    CHECK(f.tick(1000) == ToneId{1});
    f.phase(EdlPhase::sky_crane, 1005);
    f.request(2, 1005);
    CHECK(f.tick(1010) == ToneId{2});
    CHECK_FALSE(f.tick(1020).has_value());
    CHECK(f.tick(1020 + parameters.heartbeat_after_s) == ToneId{13});
    f.phase(EdlPhase::landed, 1021 + parameters.heartbeat_after_s);  // a phase without a heartbeat
    CHECK_FALSE(f.tick(1030 + parameters.heartbeat_after_s).has_value());
    CHECK_FALSE(f.tick(1200).has_value());
}

TEST_CASE("a computer that has not been told a phase, or stands by, sends no heartbeat; ordered on, it does",
          "[mfsk][R31][R32]") {
    Fixture f;
    CHECK_FALSE(f.tick(1000).has_value());
    f.phase(EdlPhase::range_control, 1000);
    f.recorder.begin(ModuleId::mfsk, Sclk{1001});
    f.selector.on(StandBy{}, f.recorder.out);
    CHECK_FALSE(f.tick(1100).has_value());
    f.selector.on(StandBy{.over = true}, f.recorder.out);
    CHECK(f.tick(1101) == ToneId{12});
}

TEST_CASE("a computer that is to stand by drops the tones that were asked for, and explains each", "[mfsk][R32][R38]") {
    Fixture f;
    f.request(2, 1000);
    f.request(3, 1000);
    f.recorder.begin(ModuleId::mfsk, Sclk{1001});
    f.selector.on(StandBy{}, f.recorder.out);
    const auto told = told_in(f.recorder);
    REQUIRE(told.size() == 2);
    for (const Told& one : told) {
        CHECK(one.verdict == ExplanationVerdict::dropped);
        CHECK(one.of(Quantity::prime_stands_by).holds);
    }
    CHECK(told[0].tone == 2);
    CHECK(told[1].tone == 3);
    CHECK_FALSE(f.tick(1002).has_value());
}

TEST_CASE("each phase from late cruise until the stage has flown away has a heartbeat, and its twin in Second Chance",
          "[mfsk][R31][R35]") {
    for (const EdlPhase phase :
         {EdlPhase::late_cruise, EdlPhase::edl_approach, EdlPhase::edl_main, EdlPhase::exo_atmospheric,
          EdlPhase::wait_for_guidance, EdlPhase::range_control, EdlPhase::heading_alignment, EdlPhase::straighten_up,
          EdlPhase::wait_for_parachute, EdlPhase::parachute_descent, EdlPhase::powered_descent, EdlPhase::sky_crane,
          EdlPhase::flyaway}) {
        std::optional<ToneId> sent[2];
        for (const Role role : {Role::prime, Role::second_chance}) {
            Load load;
            load.role = role;
            ToneSelector selector{load};
            test::OutboxRecorder recorder{ModuleId::mfsk};
            selector.on(PhaseChanged{phase}, recorder.out);
            selector.on(ClockTick{Sclk{1000.0}}, recorder.out);
            sent[static_cast<std::size_t>(role)] = recorder.bus->tone;
        }
        INFO("phase " << static_cast<unsigned>(phase));
        REQUIRE((sent[0] && sent[1]));
        CHECK(tone_specs[sent[0]->value].second_chance == sent[1]);
    }
}

TEST_CASE("in Second Chance only tones of its own set go out, whoever asks for which", "[mfsk][R35]") {
    Load load;
    load.role = Role::second_chance;
    ToneSelector selector{load};
    test::OutboxRecorder recorder{ModuleId::mfsk};
    const auto sent_after = [&](ToneId asked, double at_s) {
        recorder.begin(ModuleId::mfsk, Sclk{at_s});
        selector.on(ToneRequest{asked, Sclk{at_s}}, recorder.out);
        selector.on(ClockTick{Sclk{at_s}}, recorder.out);
        return recorder.bus->tone;
    };
    CHECK(sent_after(tone::touchdown, 100.0) == tone::sc_touchdown);
    double at_s = 120.0;
    for (const ToneSpec& spec : tone_specs) {
        if (spec.set != 0 || spec.priority == 0) continue;
        const auto sent = sent_after(ToneId{static_cast<std::uint8_t>(&spec - tone_specs.data())}, at_s);
        REQUIRE(sent.has_value());
        CHECK(tone_specs[sent->value].set == 1);
        at_s += 200.0;
    }
    recorder.begin(ModuleId::mfsk, Sclk{at_s});
    CHECK_FALSE(sent_after(tone::sc_touchdown, at_s).has_value());  // no prime tone means it: it is not asked for
}

}  // namespace flight_tone_selector_test
