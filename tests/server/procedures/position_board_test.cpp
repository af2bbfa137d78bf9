// SPDX-License-Identifier: Apache-2.0
#include "server/procedures/position_board.hpp"
#include "tests/support/catch.hpp"

#include <random>

namespace server_procedures_position_board_test {

using namespace aeolis;
using namespace aeolis::server::procedures;
using Kind = PositionAct::Kind;

namespace {

constexpr auto director = Position::flight_director;

PositionAct act(Kind kind, Position position, const char* person) {
    return {.kind = kind, .position = position, .person = person};
}
PositionAct because(PositionAct act, const char* reason) {
    act.reason = reason;
    return act;
}

/// "Fay" directs, "Cas" commands, "Gil" is GNC; all of them hold their positions.
PositionBoard room() {
    PositionBoard board;
    REQUIRE(board.on(act(Kind::take, director, "Fay")));
    REQUIRE(board.on(act(Kind::take, Position::command, "Cas")));
    REQUIRE(board.on(act(Kind::take, Position::gnc, "Gil")));
    return board;
}
PositionBoard polled() {
    auto board = room();
    auto poll = act(Kind::poll, director, "Fay");
    poll.subject = "do edl";
    REQUIRE(board.on(poll));
    return board;
}
PositionBoard gone() {
    auto board = polled();
    REQUIRE(board.on(act(Kind::go, Position::command, "Cas")));
    REQUIRE(board.on(act(Kind::go, Position::gnc, "Gil")));
    REQUIRE(board.on(act(Kind::go, director, "Fay")));
    return board;
}

}  // namespace

TEST_CASE("while nobody has directed, vacant positions bind nobody, and a position that is held is its holder's",
          "[procedures][R59]") {
    PositionBoard board;
    CHECK(board.may_send("Cas"));
    CHECK(board.may_act(Position::gnc, "Cas"));
    CHECK(board.closed().empty());
    REQUIRE(board.on(act(Kind::take, Position::command, "Cas")));
    CHECK(board.may_send("Cas"));
    CHECK(board.may_send("Gil").error().message == "command is held by Cas, not by Gil");
    CHECK(board.may_send("").error().message == "command is held by Cas: say who you are");
    CHECK(board.may_act(Position::gnc, "Gil"));
}

TEST_CASE("with a flight director only who holds a position acts as it, and the director for those that are vacant",
          "[procedures][R59]") {
    const auto board = room();
    CHECK(board.may_act(Position::gnc, "Gil"));
    CHECK(board.may_act(Position::gnc, "Fay").error().message == "gnc is held by Gil, not by Fay");
    CHECK(board.may_act(Position::systems, "Gil").error().message ==
          "systems is vacant: take it first; only the flight director stands in for it");
    CHECK(board.may_act(Position::systems, "Fay"));
}

TEST_CASE("nothing is sent before the flight director's go, and then by command alone", "[procedures][R59]") {
    auto board = room();
    CHECK(board.may_send("Cas").error().message ==
          "nothing is sent before the flight director's go, and no poll was called");
    CHECK_FALSE(board.may_approve("Fay"));  // what is approved leaves
    CHECK(board.may_stop("Fay"));
    board = polled();
    CHECK(board.may_send("Cas").error().message == "nothing is sent before the flight director's go to \"do edl\": "
                                                   "command, gnc have not answered");
    board = gone();
    CHECK(board.may_send("Cas"));
    CHECK(board.closed().empty());
    CHECK_FALSE(board.may_send("Fay"));
    CHECK_FALSE(board.may_send("Gil"));
    CHECK(board.may_approve("Fay"));
    CHECK(board.may_stop("Fay"));
    CHECK(board.may_stop("Cas"));
    CHECK_FALSE(board.may_stop("Gil"));
}

TEST_CASE("a go in spite of a no go or of silence needs a reason, and says what it overrode", "[procedures][R59]") {
    auto board = polled();
    REQUIRE(board.on(because(act(Kind::no_go, Position::gnc, "Gil"), "IMU drifts")));
    CHECK(board.against() == "gnc said no go (IMU drifts), command has not answered");
    const auto go = act(Kind::go, director, "Fay");
    CHECK(board.on(go).error().message ==
          "gnc said no go (IMU drifts), command has not answered: a go in spite of that needs a reason");
    CHECK_FALSE(board.may_send("Cas"));
    REQUIRE(board.on(because(go, "drift is within limits")));
    CHECK(board.poll()->overridden == "gnc said no go (IMU drifts), command has not answered");
    CHECK(board.may_send("Cas"));
}

TEST_CASE("a later no go, a new poll, or a director who leaves ends the go", "[procedures][R59]") {
    SECTION("a position's no go") {
        auto board = gone();
        REQUIRE(board.on(act(Kind::no_go, Position::gnc, "Gil")));
        CHECK(board.closed() == "nothing is sent before the flight director's go to \"do edl\": gnc said no go");
        REQUIRE(board.on(act(Kind::go, Position::gnc, "Gil")));
        CHECK_FALSE(board.may_send("Cas"));
        REQUIRE(board.on(act(Kind::go, director, "Fay")));
        CHECK(board.may_send("Cas"));
        CHECK(board.poll()->overridden.empty());
    }
    SECTION("the director's no go") {
        auto board = gone();
        REQUIRE(board.on(act(Kind::no_go, director, "Fay")));
        CHECK(board.closed() == "nothing is sent: the flight director said no go to \"do edl\"");
    }
    SECTION("a new poll") {
        auto board = gone();
        auto poll = act(Kind::poll, director, "Fay");
        poll.subject = "parameters";
        REQUIRE(board.on(poll));
        CHECK_FALSE(board.may_send("Cas"));
        CHECK_FALSE(board.poll()->answers[static_cast<std::size_t>(Position::gnc)]);
    }
    SECTION("the director leaves") {
        auto board = gone();
        REQUIRE(board.on(act(Kind::leave, director, "Fay")));
        CHECK(board.directed());
        CHECK_FALSE(board.may_send("Cas"));
    }
    SECTION("but who leaves takes no no go back") {
        auto board = gone();
        REQUIRE(board.on(act(Kind::no_go, director, "Fay")));
        REQUIRE(board.on(act(Kind::leave, director, "Fay")));
        CHECK(board.poll()->decision);
        CHECK_FALSE(board.may_send("Cas"));
    }
}

TEST_CASE("a hand-over is complete when the other takes what was offered; until then the first holds it",
          "[procedures][R59]") {
    auto board = gone();
    auto offer = act(Kind::offer, Position::command, "Cas");
    offer.to = "Dee";
    CHECK(board.on(act(Kind::take, Position::command, "Dee")).error().message ==
          "command is held by Cas: Cas has to offer it to Dee first");
    REQUIRE(board.on(offer));
    CHECK(board.may_send("Cas"));
    CHECK_FALSE(board.on(act(Kind::take, Position::command, "Eve")));
    REQUIRE(board.on(act(Kind::take, Position::command, "Dee")));
    CHECK(board.may_send("Dee"));
    CHECK(board.may_send("Cas").error().message == "command is held by Dee, not by Cas");
    CHECK(board.seat(Position::command).offered_to.empty());
}

TEST_CASE("an offer to oneself withdraws it; who leaves takes their go along, and leaves their no go",
          "[procedures][R59]") {
    auto board = polled();
    auto offer = act(Kind::offer, Position::command, "Cas");
    offer.to = "Dee";
    REQUIRE(board.on(offer));
    offer.to = "Cas";
    REQUIRE(board.on(offer));
    CHECK_FALSE(board.on(act(Kind::take, Position::command, "Dee")));
    REQUIRE(board.on(act(Kind::go, Position::command, "Cas")));
    REQUIRE(board.on(act(Kind::no_go, Position::gnc, "Gil")));
    REQUIRE(board.on(act(Kind::leave, Position::command, "Cas")));
    REQUIRE(board.on(act(Kind::leave, Position::gnc, "Gil")));
    REQUIRE(board.on(act(Kind::take, Position::command, "Dee")));
    CHECK(board.against() == "gnc said no go, command has not answered");
}

TEST_CASE("a vacant command sends nothing in a directed room; the director has to take it, too", "[procedures][R59]") {
    auto board = gone();
    REQUIRE(board.on(act(Kind::leave, Position::command, "Cas")));
    CHECK(board.may_send("Fay").error().message == "command is vacant: whoever sends takes it first");
    REQUIRE(board.on(act(Kind::take, Position::command, "Fay")));
    CHECK(board.may_send("Fay"));
}

TEST_CASE("a flight director who is away is relieved with a reason, and nobody else is", "[procedures][R59]") {
    auto board = gone();
    CHECK(board.on(act(Kind::take, director, "Dee")).error().message ==
          "flight_director is held by Fay: Fay has to offer it to Dee first");
    CHECK_FALSE(board.on(because(act(Kind::take, Position::gnc, "Dee"), "went home")));
    REQUIRE(board.on(because(act(Kind::take, director, "Dee"), "lost contact")));
    CHECK(board.seat(director).person == "Dee");
    CHECK(board.may_send("Cas"));
}

TEST_CASE("an answer that says to which poll it is one counts for no other", "[procedures][R59]") {
    auto board = polled();
    auto go = act(Kind::go, Position::gnc, "Gil");
    go.subject = "check-out";
    CHECK(board.on(go).error().message == "the poll is about \"do edl\" now, not about \"check-out\"");
    go.subject = "do edl";
    CHECK(board.on(go));
}

TEST_CASE("a position is left by its holder, or by the flight director with a reason", "[procedures][R59]") {
    auto board = room();
    CHECK(board.on(act(Kind::leave, Position::gnc, "Cas")).error().message ==
          "gnc is held by Gil: only they and the flight director make it vacant");
    CHECK(board.on(act(Kind::leave, Position::gnc, "Fay")).error().message ==
          "gnc is held by Gil: say why it becomes vacant (reason)");
    REQUIRE(board.on(because(act(Kind::leave, Position::gnc, "Fay"), "went home")));
    CHECK(board.seat(Position::gnc).person.empty());
    CHECK(board.on(act(Kind::leave, Position::gnc, "Gil")).error().message == "gnc is vacant");
}

TEST_CASE("what has no place is refused in a sentence, and changes nothing", "[procedures][R59]") {
    auto board = room();
    CHECK(board.on(act(Kind::go, Position::gnc, "Gil")).error().message == "no poll was called");
    CHECK(board.on(act(Kind::go, director, "Fay")).error().message == "no poll was called");
    CHECK(board.on(act(Kind::poll, Position::gnc, "Gil")).error().message ==
          "the flight director calls the poll, not gnc");
    CHECK(board.on(act(Kind::poll, director, "Gil")).error().message == "Gil does not hold flight_director");
    CHECK(board.on(act(Kind::take, Position::gnc, "Gil")).error().message == "Gil holds gnc already");
    CHECK(board.on(act(Kind::offer, Position::gnc, "Cas")).error().message == "Cas does not hold gnc");
    board = polled();
    CHECK(board.on(act(Kind::go, Position::gnc, "Cas")).error().message == "Cas does not hold gnc");
    CHECK(board.against() == "command, gnc have not answered");
}

TEST_CASE("whatever is done in whichever order, a command needs its holder and a director's go that nobody took back",
          "[procedures][R59]") {
    const std::array<const char*, 4> people{"Fay", "Cas", "Gil", "Dee"};
    const std::array places{director, Position::command, Position::gnc};
    for (unsigned seed = 1; seed <= 200; ++seed) {
        CAPTURE(seed);
        std::mt19937 random{seed};  // NOLINT(cert-msc32-c,cert-msc51-cpp): the same sequences on every run
        const auto any = [&random](const auto& of) { return of[random() % of.size()]; };
        PositionBoard board;
        for (int i = 0; i < 60; ++i) {
            auto one = act(static_cast<Kind>(random() % position_act_kinds), any(places), any(people));
            one.to = any(people);
            one.subject = "s";
            if (random() % 2 == 0) one.reason = "r";
            const bool taken = board.on(one).ok();
            const auto& poll = board.poll();
            const bool go = poll && poll->decision && poll->decision->go;
            if (taken && go && one.kind == Kind::no_go) FAIL("a go stands behind a no go");
            if (poll && !go && !poll->overridden.empty()) FAIL("a go that is over still overrides");
            if (go && board.seat(director).person.empty()) FAIL("a go stands that nobody answers for");
            for (const auto* person : people) {
                if (!board.may_send(person)) continue;
                const auto& holder = board.seat(Position::command).person;
                CHECK((holder == person || (holder.empty() && !board.directed())));
                CHECK((go || !board.directed()));
            }
            for (const Position position : places)
                if (const auto can = board.acts(position); board.seat(position).person.empty())
                    CHECK(can == std::vector{Kind::take});
        }
    }
}

}  // namespace server_procedures_position_board_test
