// SPDX-License-Identifier: Apache-2.0
#include "server/pipeline/positions.hpp"

#include "server/archive/reader.hpp"
#include "server/pipeline/pipeline.hpp"
#include "tests/server/reopened_ground.hpp"
#include "tests/server/small_mission.hpp"
#include "tests/support/catch.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

namespace server_positions_test {

// Positions of a run: acts as items, over a cut and a fork.

using namespace aeolis;
using namespace aeolis::test;
using archive::Archive;
using archive::PositionActKind;
using archive::PositionActRecord;
using archive::Reader;
using archive::RunId;
using pipeline::Pipeline;

namespace {

constexpr RunId first_run{1}, second_run{2};
constexpr std::int64_t second_us = 1'000'000;

PositionActRecord act(PositionActKind kind, const char* position, const char* by, std::int64_t ert_s) {
    PositionActRecord record;
    record.ert = Ert{ert_s * second_us};
    record.kind = kind;
    record.position = position;
    record.by = by;
    return record;
}
PositionActRecord poll(const char* subject, std::int64_t ert_s) {
    auto record = act(PositionActKind::poll, "flight_director", "Fay", ert_s);
    record.subject = subject;
    return record;
}

struct Ground : test::ReopenedGround {
    Ground() : ReopenedGround(small_dictionary()) {}
    void hear(std::uint16_t count) {
        REQUIRE(pipeline->accept(live(navigation_packet(count, 1000.0 + count, 9000.0F, 400.0F), count * second_us)));
    }
    void wait(std::int64_t from_s, std::int64_t to_s) {
        for (auto second = from_s; second <= to_s; ++second)
            REQUIRE(pipeline->accept(telemetry::EarthTime{Ert{second * second_us}}));
    }
    /// Why it was refused; empty: it was not.
    std::string take(const PositionActRecord& record, RunId run = first_run) {
        const auto taken = pipeline->act(run, record);
        REQUIRE(taken);
        return taken->refused;
    }
    std::vector<v1::Item> acts(RunId run = first_run) const { return reader().position_acts(run).value(); }
    std::vector<std::string> texts(RunId run) const {
        std::vector<std::string> all;
        const auto page = reader().items(run, 0, 10'000);
        REQUIRE(page);
        for (const auto& item : page->items) all.push_back(item.ShortDebugString());
        return all;
    }
    /// A directed room whose poll has come to a go, with a packet before each act.
    void fly_to_go() {
        std::uint16_t count = 0;
        for (const auto& each :
             {act(PositionActKind::take, "flight_director", "Fay", 1), act(PositionActKind::take, "command", "Cas", 2),
              poll("do edl", 3), act(PositionActKind::go, "command", "Cas", 4),
              act(PositionActKind::go, "flight_director", "Fay", 5)}) {
            hear(++count);
            REQUIRE(take(each).empty());
        }
    }
};

}  // namespace

TEST_CASE("each act on a position is an item with the room behind it, and binds at once", "[procedures][R59]") {
    Ground ground;
    REQUIRE(ground.pipeline->begin({}));
    CHECK(ground.pipeline->positions().may_send("anybody"));
    ground.fly_to_go();
    CHECK(ground.pipeline->positions().may_send("Cas"));
    CHECK_FALSE(ground.pipeline->positions().may_send("Fay"));
    CHECK(ground.take(act(PositionActKind::take, "gnc", "Gil", 6), RunId{7}) ==
          "run 7 does not go on: people act on procedures and positions while a run does");
    CHECK(ground.take(act(PositionActKind::go, "gnc", "Gil", 6)) == "Gil does not hold gnc");
    REQUIRE(ground.pipeline->commit());

    const auto acts = ground.acts();
    REQUIRE(acts.size() == 5);
    CHECK(acts[0].position_act().board().directed());
    CHECK_FALSE(acts[0].position_act().board().closed().empty());
    CHECK(acts[1].position_act().board().seats(1).by() == "Cas");
    CHECK(acts[2].position_act().board().poll().answers_size() == 1);
    CHECK_FALSE(acts[2].position_act().board().poll().answers(0).answered());
    CHECK(acts[4].position_act().board().poll().decision().go());
    CHECK(acts[4].position_act().board().closed().empty());
    CHECK(ground.reader().newest_position_act(first_run, Ert{3 * second_us}).value()->seq() == acts[2].seq());
    CHECK_FALSE(ground.reader().newest_position_act(first_run, Ert{0}).value());

    REQUIRE(ground.pipeline->finish({}));
    CHECK(ground.pipeline->positions().may_send("anybody"));  // no run goes on: there is nothing to send it to
    CHECK(ground.take(act(PositionActKind::take, "gnc", "Gil", 9)) ==
          "run 1 does not go on: people act on procedures and positions while a run does");
}

TEST_CASE("an act on a procedure is refused to who does not hold its position", "[procedures][R59]") {
    Ground ground;
    REQUIRE(ground.pipeline->begin({}));
    REQUIRE(ground.take(act(PositionActKind::take, "flight_director", "Fay", 1)).empty());
    archive::ProcedureActRecord begin;
    begin.ert = Ert{second_us};
    begin.kind = archive::ProcedureActKind::begin;
    begin.procedure = "p";
    begin.position = "gnc";
    begin.by = "Gil";
    CHECK(ground.pipeline->act(first_run, begin)->refused ==
          "gnc is vacant: take it first; only the flight director stands in for it");
    REQUIRE(ground.take(act(PositionActKind::take, "gnc", "Gil", 2)).empty());
    CHECK_THAT(ground.pipeline->act(first_run, begin)->refused, Catch::StartsWith("procedure p breaks a rule"));
    begin.by = "Cas";
    CHECK(ground.pipeline->act(first_run, begin)->refused == "gnc is held by Gil, not by Cas");
}

TEST_CASE("a run that was cut off goes on with the room as it was", "[procedures][R59]") {
    Ground ground;
    REQUIRE(ground.pipeline->begin({}));
    ground.fly_to_go();
    REQUIRE(ground.pipeline->commit());
    const auto before = ground.texts(first_run);
    ground.open();
    CHECK(ground.pipeline->positions().may_send("anybody"));

    const auto flown = ground.reader().cut_off(first_run);
    REQUIRE(flown);
    REQUIRE(ground.pipeline->resume(first_run, {}, flown->last_seq, ground.compare(), flown->annotations, {},
                                    ground.reader().all_position_acts(first_run).value()));
    CHECK_FALSE(ground.pipeline->positions().may_send("anybody"));
    CHECK(ground.take(act(PositionActKind::no_go, "command", "Cas", 6)) ==
          "run 1 is flown again up to where it was cut off: try again when it goes on");
    for (std::uint16_t count = 1; count <= 5; ++count) ground.hear(count);
    REQUIRE(ground.pipeline->caught_up().value());
    CHECK(ground.texts(first_run) == before);
    CHECK(ground.pipeline->positions().may_send("Cas"));
    CHECK(ground.take(act(PositionActKind::no_go, "command", "Cas", 6)).empty());
    CHECK_FALSE(ground.pipeline->positions().may_send("Cas"));
}

TEST_CASE("a fork has the room as it stood there, also where nothing was received around it",
          "[procedures][fork][R59]") {
    Ground ground;
    REQUIRE(ground.pipeline->begin({}));
    ground.hear(1);
    ground.hear(2);
    ground.wait(3, 3);
    REQUIRE(ground.take(act(PositionActKind::take, "flight_director", "Fay", 3)).empty());
    archive::NoteRecord note;
    note.ert = Ert{4 * second_us};
    note.text = "in the silence";
    note.by = "Fay";
    REQUIRE(ground.pipeline->annotate(first_run, note));
    ground.wait(4, 5);
    REQUIRE(ground.take(act(PositionActKind::take, "command", "Cas", 5)).empty());
    ground.wait(6, 20);
    REQUIRE(ground.take(act(PositionActKind::leave, "command", "Cas", 20)).empty());
    REQUIRE(ground.pipeline->finish({}));

    const auto annotations = ground.reader().annotations(first_run);
    REQUIRE(annotations->size() == 4);
    REQUIRE(ground.pipeline->begin({}, {first_run, ground.compare(), *annotations, Ert{10 * second_us}}));
    ground.hear(1);
    ground.hear(2);
    ground.wait(3, 10);
    const auto forked = ground.pipeline->forked();
    if (!forked) FAIL(forked.error().message);
    auto parent = ground.texts(first_run);
    parent.resize(*forked);
    CHECK(ground.texts(second_run) == parent);
    REQUIRE(ground.acts(second_run).size() == 2);
    CHECK(ground.pipeline->positions().may_act("command", "Cas"));
    CHECK_FALSE(ground.pipeline->positions().may_act("command", "Fay"));
    CHECK(ground.take(act(PositionActKind::take, "gnc", "Gil", 11), second_run).empty());
    REQUIRE(ground.pipeline->commit());
    CHECK(ground.acts(second_run).back().seq() == *forked + 1);
}

}  // namespace server_positions_test
