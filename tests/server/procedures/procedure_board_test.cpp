// SPDX-License-Identifier: Apache-2.0
#include "server/procedures/procedure_board.hpp"
#include "tests/server/procedures/written_procedure.hpp"
#include "tests/support/catch.hpp"

namespace server_procedures_procedure_board_test {

using namespace aeolis;
using namespace aeolis::server::procedures;
using tests::WrittenProcedure;

namespace {

constexpr Ert at(double seconds) {
    return {static_cast<std::int64_t>(seconds * 1.0e6)};
}

/// A first step that checks itself by an event since the procedure began.
std::shared_ptr<const Procedure> waiting_for(const std::string& event) {
    WrittenProcedure written;
    written.body = "body:\n  - {step: a, who: gnc, do: A, check: [{event: " + event + ", since: procedure}]}\n";
    return tests::shared_procedure(written);
}

Act tick(double seconds) {
    return {.kind = Act::Kind::tick, .step = "z", .position = Position::gnc, .person = "A. Ng", .at = at(seconds)};
}

StepState state(const ProcedureBoard& board, std::uint32_t number, const char* step) {
    return board.executions().at(number - 1).step(step)->state;
}

}  // namespace

TEST_CASE("several procedures are under way at once, each with its own beginning, states and end", "[procedures]") {
    const auto& dictionary = tests::shipped_dictionary();
    ProcedureBoard board{dictionary};
    CHECK(board.begin(waiting_for("EDL_BEGUN"), at(10.0)).value() == 1);
    CHECK(board.begin(waiting_for("TOUCHDOWN"), at(10.0)).value() == 2);
    board.on(EventReceived{dictionary.event("EDL_BEGUN")->id, at(20.0)});
    CHECK(state(board, 1, "a") == StepState::checked);
    CHECK(state(board, 2, "a") == StepState::active);
    CHECK(board.begin(waiting_for("EDL_BEGUN"), at(30.0)).value() == 3);  // once more: that event was before it
    CHECK(state(board, 3, "a") == StepState::active);
    CHECK(board.on(1, tick(31.0)).ok());
    CHECK(board.executions().at(0).part() == Part::confirmed);
    CHECK(board.on(2, tick(31.0)).error().message == "step z is waiting, not active");
    CHECK(board.on(4, tick(31.0)).error().message == "there is no procedure of the number 4 in this run");
    CHECK(board.on(0, tick(31.0)).error().message == "there is no procedure of the number 0 in this run");
}

TEST_CASE("a procedure that begins later knows what the run has received", "[procedures]") {
    const auto& dictionary = tests::shipped_dictionary();
    WrittenProcedure written;
    written.body =
        "body:\n  - {step: a, who: gnc, do: A, check: [{channel: edl_enabled, is: '==', value: true}, {event: "
        "EDL_BEGUN, since: run}, {from: E-1:00 vehicle}]}\n";
    ProcedureBoard board{dictionary};
    board.on(ChannelSample{dictionary.channel("edl_enabled")->id, 1.0, at(90.0)});
    board.on(EventReceived{dictionary.event("EDL_BEGUN")->id, at(20.0)});
    board.predict({{150'000'000}, 0.0});
    REQUIRE(board.begin(tests::shared_procedure(written), at(100.0)));
    CHECK(state(board, 1, "a") == StepState::checked);
}

TEST_CASE("only so many procedures are under way at once, and only so many begin in a run", "[procedures]") {
    ProcedureBoard board{tests::shipped_dictionary()};
    const auto procedure = tests::shared_procedure(WrittenProcedure{});
    for (std::size_t i = 0; i < under_way_max; ++i) REQUIRE(board.begin(procedure, at(1.0)));
    CHECK(board.begin(procedure, at(1.0)).error().message ==
          "16 procedures are under way, which is as many as there may be");
    const Act stop{.kind = Act::Kind::stop,
                   .position = Position::flight_director,
                   .person = "A. Ng",
                   .reason = "r",
                   .at = at(2.0)};
    for (std::uint32_t number = 1; board.executions().size() < begun_max; ++number) {
        REQUIRE(board.on(number, stop));
        REQUIRE(board.begin(procedure, at(2.0)));
    }
    REQUIRE(board.on(begun_max, stop));
    CHECK(board.begin(procedure, at(2.0)).error().message ==
          "500 procedures were begun in this run, which is as many as there may be");
}

}  // namespace server_procedures_procedure_board_test
