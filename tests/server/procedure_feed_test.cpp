// SPDX-License-Identifier: Apache-2.0
#include "server/pipeline/procedure_feed.hpp"

#include "server/archive/reader.hpp"
#include "server/pipeline/pipeline.hpp"
#include "tests/server/reopened_ground.hpp"
#include "tests/server/small_mission.hpp"
#include "tests/support/catch.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <optional>
#include <random>
#include <string>
#include <variant>
#include <vector>

namespace server_procedure_feed_test {

// Procedures carried out in a run: acts and statuses as items, over a cut and a fork.

using namespace aeolis;
using namespace aeolis::test;
using archive::Archive;
using archive::ProcedureActKind;
using archive::ProcedureActRecord;
using archive::Reader;
using archive::RunId;
using pipeline::Pipeline;

namespace {

constexpr RunId first_run{1}, second_run{2};

const std::string written =
    "procedure: p\ntitle: T\nrevision: 1\npurpose: P\nbegin_when: B\nsource: S\npreconditions: []\n"
    "body:\n"
    "  - {step: fast, who: gnc, do: Fast., check: [{channel: speed_mps, is: '>', value: 500, unit: m/s}], limit_s: 9}\n"
    "  - {step: deployed, who: gnc, do: Seen., check: [{event: PARACHUTE_DEPLOY, since: procedure}]}\n"
    "confirmation:\n  - {step: sure, who: gnc, do: Sure.}\n"
    "watchdogs:\n  - {watchdog: high, when: [{channel: altitude_m, is: '>', value: 20000, unit: m}], who: gnc, do: "
    "W}\n";

constexpr std::int64_t second_us = 1'000'000;

ProcedureActRecord act(ProcedureActKind kind, std::uint32_t number, std::int64_t ert_us, std::string step = {},
                       std::string position = "gnc", std::string reason = "because") {
    ProcedureActRecord record;
    record.ert = Ert{ert_us};
    record.kind = kind;
    record.number = number;
    record.step = std::move(step);
    record.position = std::move(position);
    record.by = "A. Ng";
    record.reason = std::move(reason);
    if (kind == ProcedureActKind::begin) {
        record.procedure = "p";
        record.text = written;
    }
    return record;
}

/// What comes to a pipeline, in its order.
struct Packet {
    Octets octets;
    std::int64_t ert_us = 0;
};
using Input = std::variant<Packet, telemetry::EarthTime, ProcedureActRecord, archive::NoteRecord>;

struct Ground : test::ReopenedGround {
    Ground() : ReopenedGround(small_dictionary()) {}
    void hear(std::uint16_t count, std::int64_t ert_us, float speed_mps) {
        REQUIRE(pipeline->accept(live(navigation_packet(count, 1000.0 + count, 9000.0F, speed_mps), ert_us)).ok());
    }
    void pass(std::int64_t ert_us) { REQUIRE(pipeline->accept(telemetry::EarthTime{Ert{ert_us}}).ok()); }
    /// Why it was refused; empty: it was not.
    std::string take(const ProcedureActRecord& record, RunId run = first_run) {
        const auto taken = pipeline->act(run, record);
        REQUIRE(taken.ok());
        return taken->refused;
    }
    void take(const Input& input, RunId run = first_run) {
        if (const auto* packet = std::get_if<Packet>(&input)) {
            REQUIRE(pipeline->accept(live(packet->octets, packet->ert_us)).ok());
        } else if (const auto* time = std::get_if<telemetry::EarthTime>(&input)) {
            REQUIRE(pipeline->accept(*time).ok());
        } else if (const auto* note = std::get_if<archive::NoteRecord>(&input)) {
            REQUIRE(pipeline->annotate(run, *note).ok());
        } else {
            REQUIRE(pipeline->act(run, std::get<ProcedureActRecord>(input)).ok());
        }
    }
    std::vector<v1::Item> stored(RunId run = first_run) const { return reader().items(run, 0, 10'000)->items; }
    /// The items of the procedures: "act", or the status with its steps' states.
    std::vector<std::string> told() {
        REQUIRE(pipeline->commit().ok());
        std::vector<std::string> all;
        for (const auto& item : stored()) {
            if (item.has_procedure_act()) all.push_back(v1::ProcedureAct::Kind_Name(item.procedure_act().kind()));
            if (!item.has_procedure()) continue;
            auto& line = all.emplace_back(fmt::format("{} {}", item.procedure().number(),
                                                      v1::ProcedureStatus::Part_Name(item.procedure().part())));
            for (const auto& step : item.procedure().steps()) line += ' ' + v1::ProcedureStep::State_Name(step.state());
        }
        return all;
    }
};

std::vector<std::string> texts_of(const std::vector<v1::Item>& items) {
    std::vector<std::string> texts;
    for (const auto& item : items) texts.push_back(item.ShortDebugString());
    return texts;
}

/// A run of anything: packets that come late, times without anything, acts in and out of place by a clock ahead.
std::vector<Input> any_inputs(unsigned seed) {
    std::mt19937 random{seed};
    const auto any = [&](std::size_t below) { return random() % below; };
    std::vector<Input> inputs;
    std::int64_t now_us = 0;
    std::uint16_t count = 0;
    for (int i = 0; i < 120; ++i) {
        switch (any(6)) {
        case 0: {
            ++count;
            const auto speed = static_cast<float>(400 + any(200));
            inputs.emplace_back(
                Packet{navigation_packet(count, 1000.0 + count, any(9) == 0 ? 21000.0F : 9000.0F, speed),
                       now_us - static_cast<std::int64_t>(any(300'000))});
            break;
        }
        case 1:
            if (any(12) != 0) break;
            ++count;
            inputs.emplace_back(Packet{mortar_packet(count, 1000.0 + count, 400.0F), now_us});
            break;
        case 2:
        case 3:
            now_us += second_us;
            inputs.emplace_back(telemetry::EarthTime{Ert{now_us}});
            break;
        case 4: {
            if (any(12) == 0) {
                inputs.emplace_back(
                    archive::NoteRecord{{0, Ert{now_us}}, "a note", "Ada", "2026-11-22T12:00:00Z", {}, {}, {}, 0});
                break;
            }
            static constexpr std::array steps{"", "fast", "deployed", "sure", "high", "none"};
            auto kind = static_cast<ProcedureActKind>(any(archive::procedure_act_kinds));
            if (kind == ProcedureActKind::stop && any(4) != 0) kind = ProcedureActKind::tick;
            inputs.emplace_back(act(kind, static_cast<std::uint32_t>(any(4)),
                                    now_us + static_cast<std::int64_t>(any(5'000'000)), steps[any(steps.size())],
                                    any(2) == 0 ? "flight_director" : "gnc", any(3) == 0 ? "" : "because"));
            break;
        }
        default: break;
        }
    }
    return inputs;
}

}  // namespace

TEST_CASE("an act and the status behind it are items of the run, the same when published and when read back",
          "[procedures][archive]") {
    Ground ground;
    REQUIRE(ground.pipeline->begin({}).ok());
    ground.hear(0, second_us, 400.0F);
    ground.pass(2 * second_us);
    CHECK(ground.take(act(ProcedureActKind::begin, 0, 2 * second_us)).empty());
    CHECK(ground.take(act(ProcedureActKind::tick, 1, 2 * second_us, "fast")).empty());
    CHECK(ground.told() ==
          std::vector<std::string>{"begin", "1 body active waiting waiting", "tick", "1 body ticked active waiting"});
    CHECK(texts_of(ground.published) == texts_of(ground.stored()));
    const auto statuses = ground.reader().procedures(first_run);
    REQUIRE(statuses->size() == 1);
    const auto& status = statuses->front().procedure();
    CHECK(status.title() == "T");
    CHECK(status.begun_by() == "A. Ng (gnc)");
    CHECK(status.steps(0).by() == "A. Ng (gnc)");
    CHECK(status.steps(0).reason() == "because");
    CHECK(status.steps(0).conditions(0).text() == "speed_mps > 500 m/s");
    CHECK(status.steps(0).conditions(0).verdict() == v1::ProcedureCondition::does_not_hold);
    const auto acts = ground.reader().procedure_acts(first_run, 1);
    REQUIRE(acts->size() == 2);
    CHECK(acts->at(0).procedure_act().text() == written);
    CHECK(acts->at(1).procedure_act().procedure() == "p");
    CHECK(acts->at(1).procedure_act().text().empty());
    CHECK(ground.reader().procedure_acts(first_run, 2)->empty());
    CHECK(ground.reader().procedures(first_run, Ert{second_us})->empty());
}

TEST_CASE("a step checks itself by what is received, which its status tells within a second; evidence alone is told "
          "every ten",
          "[procedures]") {
    Ground ground;
    REQUIRE(ground.pipeline->begin({}).ok());
    ground.hear(0, second_us, 400.0F);
    ground.pass(2 * second_us);
    REQUIRE(ground.take(act(ProcedureActKind::begin, 0, 2 * second_us)).empty());
    for (std::uint16_t second = 3; second < 11; ++second) {
        ground.hear(second, second * second_us, 400.0F + second);
        ground.pass(second * second_us);
    }
    CHECK(ground.told() == std::vector<std::string>{"begin", "1 body active waiting waiting"});
    ground.hear(12, 12 * second_us, 412.0F);
    ground.pass(12 * second_us);
    REQUIRE(ground.told().size() == 3);
    CHECK(ground.reader().procedures(first_run)->front().procedure().steps(0).conditions(0).evidence() ==
          "speed_mps is 412 m/s, received 2000-001T12:00:12.000");
    CHECK(ground.told().back() == "1 body late waiting waiting");  // 9 s were given
    ground.hear(13, 13 * second_us, 600.0F);
    CHECK(ground.told().size() == 3);  // until Earth's clock has passed
    ground.pass(13 * second_us);
    CHECK(ground.told().back() == "1 body checked active waiting");
    REQUIRE(ground.pipeline->accept(live(mortar_packet(14, 1014.0, 390.0F), 14 * second_us)).ok());
    ground.pass(14 * second_us);
    CHECK(ground.told().back() == "1 confirmation checked checked active");
    REQUIRE(ground.take(act(ProcedureActKind::tick, 1, 15 * second_us, "sure")).empty());
    CHECK(ground.told().back() == "1 confirmed checked checked ticked");
    const auto over = ground.reader().procedures(first_run)->front().procedure();
    CHECK(over.steps(0).limit_passed_us() == 11 * second_us);  // that it was late stays
    CHECK_FALSE(over.steps(1).has_limit_passed_us());
    const auto before = ground.told().size();
    for (std::uint16_t second = 16; second < 40; ++second) {
        ground.hear(second, second * second_us, 400.0F + second);
        ground.pass(second * second_us);
    }
    CHECK(ground.told().size() == before);
}

TEST_CASE("a procedure that begins knows what was received before it", "[procedures]") {
    Ground ground;
    REQUIRE(ground.pipeline->begin({}).ok());
    ground.hear(0, second_us, 501.0F);
    ground.pass(2 * second_us);
    REQUIRE(ground.take(act(ProcedureActKind::begin, 0, 2 * second_us)).empty());
    CHECK(ground.told().back() == "1 body checked active waiting");
}

TEST_CASE("an act that has no place is refused in a sentence, and leaves no item", "[procedures]") {
    Ground ground;
    REQUIRE(ground.pipeline->begin({}).ok());
    ground.hear(0, second_us, 400.0F);
    REQUIRE(ground.take(act(ProcedureActKind::begin, 0, 2 * second_us)).empty());
    const auto before = ground.told();
    CHECK(ground.take(act(ProcedureActKind::tick, 2, 3 * second_us, "fast")) ==
          "there is no procedure of the number 2 in this run");
    CHECK(ground.take(act(ProcedureActKind::tick, 1, 3 * second_us, "sure")) == "step sure is waiting, not active");
    CHECK(ground.take(act(ProcedureActKind::stop, 1, 3 * second_us)) == "only the flight director stops a procedure");
    CHECK(ground.take(act(ProcedureActKind::tick, 1, 3 * second_us, "fast", "captain")) == "'captain' is no position");
    CHECK(ground.take(act(ProcedureActKind::tick, 1, 3 * second_us, "fast"), second_run) ==
          "run 2 does not go on: people act on procedures and positions while a run does");
    auto faulty = act(ProcedureActKind::begin, 0, 3 * second_us);
    faulty.text += "rest: 1\n";
    CHECK_THAT(ground.take(faulty), Catch::StartsWith("procedure p breaks a rule: p.yaml:"));
    CHECK(ground.told() == before);
    REQUIRE(ground.pipeline->finish({}).ok());
    CHECK(ground.take(act(ProcedureActKind::tick, 1, 3 * second_us, "fast")) ==
          "run 1 does not go on: people act on procedures and positions while a run does");
}

TEST_CASE("the time of an act is within a second of what was received, whatever its sender's clock says",
          "[procedures]") {
    Ground ground;
    REQUIRE(ground.pipeline->begin({}).ok());
    ground.hear(0, 10 * second_us, 400.0F);
    REQUIRE(ground.take(act(ProcedureActKind::begin, 0, 60 * second_us)).empty());
    REQUIRE(ground.take(act(ProcedureActKind::hold, 1, 0)).empty());
    REQUIRE(ground.pipeline->commit().ok());
    const auto acts = ground.reader().procedure_acts(first_run, 1);
    CHECK(acts->at(0).ert_us() == 11 * second_us);
    CHECK(acts->at(1).ert_us() == 10 * second_us);
}

TEST_CASE("a run in which nobody begins a procedure has no item of one", "[procedures]") {
    Ground ground;
    REQUIRE(ground.pipeline->begin({}).ok());
    for (std::uint16_t second = 1; second < 40; ++second) {
        ground.hear(second, second * second_us, 400.0F + second);
        ground.pass(second * second_us);
    }
    REQUIRE(ground.pipeline->finish({}).ok());
    for (const auto& item : ground.stored()) CHECK((!item.has_procedure() && !item.has_procedure_act()));
}

TEST_CASE("flown again to where it was cut off, a run has the same statuses and goes on as if it had not been, from 40 "
          "seeds",
          "[procedures][resume]") {
    std::size_t statuses = 0, with_acts = 0;
    for (unsigned seed = 1; seed <= 40; ++seed) {
        INFO("seed " << seed);
        const auto inputs = any_inputs(seed);
        Ground whole;
        REQUIRE(whole.pipeline->begin({}).ok());
        for (const auto& input : inputs) whole.take(input);
        REQUIRE(whole.pipeline->commit().ok());

        Ground cut;
        REQUIRE(cut.pipeline->begin({}).ok());
        const std::size_t last = inputs.size() / 4 + seed * inputs.size() / 80;
        for (std::size_t i = 0; i < last; ++i) cut.take(inputs[i]);
        REQUIRE(cut.pipeline->commit().ok());
        const auto before = texts_of(cut.stored());
        cut.open();

        const auto flown = cut.reader().cut_off(first_run);
        const auto acts = cut.reader().all_procedure_acts(first_run);
        REQUIRE((flown.ok() && acts.ok()));
        with_acts += acts->empty() ? 0 : 1;
        REQUIRE(cut.pipeline->resume(first_run, {}, flown->last_seq, cut.compare(), flown->annotations, *acts).ok());
        CHECK(cut.take(act(ProcedureActKind::begin, 0, 0)) ==
              "run 1 is flown again up to where it was cut off: try again when it goes on");
        std::size_t next = 0;
        for (;; ++next) {
            const auto caught_up = cut.pipeline->caught_up();
            REQUIRE(caught_up.ok());
            if (*caught_up) break;
            REQUIRE(next < last);
            const auto& input = inputs[next];
            if (std::holds_alternative<Packet>(input) || std::holds_alternative<telemetry::EarthTime>(input))
                cut.take(input);
        }
        CHECK(texts_of(cut.stored()) == before);
        for (; next < inputs.size(); ++next) {
            const auto& input = inputs[next];
            const bool of_people =
                std::holds_alternative<ProcedureActRecord>(input) || std::holds_alternative<archive::NoteRecord>(input);
            if (next < last && of_people) continue;  // it is stored
            cut.take(input);
        }
        REQUIRE(cut.pipeline->commit().ok());
        REQUIRE(texts_of(cut.stored()) == texts_of(whole.stored()));
        for (const auto& item : whole.stored()) statuses += item.has_procedure() ? 1 : 0;
    }
    CHECK(statuses > 200);
    CHECK(with_acts > 20);
}

TEST_CASE("a fork has the acts and statuses of its parent up to the fork, none from behind it, and goes on with them",
          "[procedures][fork]") {
    Ground ground;
    REQUIRE(ground.pipeline->begin({}).ok());
    const auto fly = [&](std::uint16_t from, std::uint16_t to) {
        for (std::uint16_t second = from; second < to; ++second) {
            ground.hear(second, second * second_us, 400.0F);
            ground.pass(second * second_us);
        }
    };
    fly(1, 5);
    REQUIRE(ground.take(act(ProcedureActKind::begin, 0, 5 * second_us)).empty());
    fly(5, 10);
    REQUIRE(ground.take(act(ProcedureActKind::hold, 1, 10 * second_us)).empty());
    fly(10, 40);
    REQUIRE(ground.take(act(ProcedureActKind::release, 1, 40 * second_us)).empty());
    REQUIRE(ground.pipeline->finish({}).ok());

    const auto annotations = ground.reader().annotations(first_run);
    REQUIRE(annotations->size() == 3);
    REQUIRE(ground.pipeline->begin({}, {first_run, ground.compare(), *annotations, Ert{20 * second_us}}).ok());
    fly(1, 20);
    CHECK(ground.take(act(ProcedureActKind::begin, 0, 0), second_run) ==
          "run 2 is flown again up to where it was forked: try again when it goes on");
    const auto forked = ground.pipeline->forked();
    REQUIRE(forked.ok());
    auto parent = texts_of(ground.stored(first_run));
    parent.resize(*forked);
    CHECK(texts_of(ground.stored(second_run)) == parent);
    CHECK(ground.reader().procedure_acts(second_run, 1)->size() == 2);
    CHECK(ground.take(act(ProcedureActKind::release, 1, 21 * second_us), second_run).empty());
    REQUIRE(ground.pipeline->commit().ok());
    CHECK(ground.reader().procedures(second_run)->front().procedure().held().empty());
}

TEST_CASE("in a silence around a fork the acts before it are repeated, and none from behind it", "[procedures][fork]") {
    Ground ground;
    REQUIRE(ground.pipeline->begin({}).ok());
    const auto fly = [&] {
        for (std::uint16_t second = 1; second < 5; ++second) {
            ground.hear(second, second * second_us, 400.0F);
            ground.pass(second * second_us);
        }
    };
    const auto wait_until = [&](int end_s) {
        for (int second = 5; second <= end_s; ++second) ground.pass(second * second_us);
    };
    fly();
    REQUIRE(ground.take(act(ProcedureActKind::begin, 0, 5 * second_us)).empty());
    wait_until(22);
    REQUIRE(ground.take(act(ProcedureActKind::hold, 1, 22 * second_us)).empty());
    wait_until(28);
    REQUIRE(ground.take(act(ProcedureActKind::release, 1, 28 * second_us)).empty());
    REQUIRE(ground.pipeline->finish({}).ok());

    const auto annotations = ground.reader().annotations(first_run);
    REQUIRE(annotations->size() == 3);
    REQUIRE(ground.pipeline->begin({}, {first_run, ground.compare(), *annotations, Ert{25 * second_us}}).ok());
    fly();
    wait_until(25);
    REQUIRE(ground.pipeline->forked().ok());
    CHECK(ground.reader().procedure_acts(second_run, 1)->size() == 2);
    CHECK(ground.reader().procedures(second_run)->front().procedure().held() == "A. Ng (gnc): because");
    CHECK(ground.take(act(ProcedureActKind::release, 1, 26 * second_us), second_run).empty());
}

TEST_CASE("a value that comes late, behind a newer one of its channel, counts in no condition", "[procedures]") {
    Ground ground;
    REQUIRE(ground.pipeline->begin({}).ok());
    ground.hear(1, second_us, 400.0F);
    REQUIRE(ground.take(act(ProcedureActKind::begin, 0, second_us)).empty());
    ground.hear(10, 3 * second_us, 450.0F);
    ground.hear(5, 4 * second_us, 600.0F);
    ground.pass(5 * second_us);
    const auto state = [&] {
        REQUIRE(ground.pipeline->commit().ok());
        return ground.reader().procedures(first_run)->front().procedure().steps(0).state();
    };
    CHECK(state() == v1::ProcedureStep::active);
    ground.hear(11, 6 * second_us, 600.0F);
    ground.pass(7 * second_us);
    CHECK(state() == v1::ProcedureStep::checked);
}

}  // namespace server_procedure_feed_test
