// SPDX-License-Identifier: Apache-2.0
#include "commands/lifecycle.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"
#include "tests/support/small_dictionary.hpp"

namespace commands_lifecycle_test {

using namespace aeolis;
using namespace aeolis::commands;

namespace {

constexpr std::int64_t second = 1'000'000;

/// A command whose own ground stages are done at ERT 0; light takes 800 s.
struct Uplink {
    explicit Uplink(std::string_view name, bool read_back = false)
        : lifecycle(*dictionary.command(name), 12, 800.0, read_back) {
        for (const Stage stage : {Stage::queued, Stage::authorised, Stage::released, Stage::radiated})
            lifecycle.ground_stage(stage, Status::ok, "by test", Ert{0}, changes);
    }
    void answer(EvrId event, std::int64_t ert_s, double sclk = 5000.0, std::uint16_t count = 12) {
        lifecycle.on(Answer{event, dictionary.event(event)->name, "words", lifecycle.command().opcode, count,
                            Sclk{sclk}, Ert{ert_s * second}},
                     changes);
    }
    void report(double sclk, bool equal) {
        ReadBack read_back;
        read_back.compared = 3;
        read_back.held_at = Sclk{sclk};
        if (!equal) read_back.differences.push_back({"solution_id", "7", "8"});
        lifecycle.on(read_back, Ert{1700 * second}, changes);
    }
    std::string evidence(Stage stage) const {
        std::string last;
        for (const auto& change : changes)
            if (change.stage == stage) last = change.evidence;
        return last;
    }

    dictionary::Dictionary dictionary = tests::small_dictionary();
    std::vector<StageChange> changes;
    CommandLifecycle lifecycle;
};

}  // namespace

TEST_CASE("no stage on board is green before its evidence came", "[lifecycle][R44]") {
    Uplink uplink{"NO_OP"};
    uplink.lifecycle.pass(Ert{1609 * second}, uplink.changes);
    for (const Stage stage : {Stage::received, Stage::accepted, Stage::executed})
        CHECK(uplink.lifecycle.status(stage) == Status::pending);
    CHECK_FALSE(uplink.lifecycle.finished());
}

TEST_CASE("acceptance and execution are shown by their events, reception is inferred and says so", "[lifecycle][R44]") {
    Uplink uplink{"NO_OP"};
    uplink.answer(tests::accepted_event, 1601);
    CHECK(uplink.lifecycle.status(Stage::received) == Status::ok);
    CHECK(uplink.evidence(Stage::received) ==
          "inferred from COMMAND_ACCEPTED at SCLK 5000.000: words; not observed itself");
    CHECK(uplink.lifecycle.status(Stage::accepted) == Status::ok);
    CHECK(uplink.lifecycle.status(Stage::executed) == Status::pending);
    uplink.answer(tests::executed_event, 1602);
    CHECK(uplink.evidence(Stage::executed) == "COMMAND_EXECUTED at SCLK 5000.000: words");
    CHECK(uplink.lifecycle.finished());
}

TEST_CASE("an answer to another packet or another command says nothing", "[lifecycle]") {
    Uplink uplink{"NO_OP"};
    uplink.answer(tests::accepted_event, 1601, 5000.0, 13);
    CHECK(uplink.lifecycle.status(Stage::accepted) == Status::pending);
    uplink.lifecycle.on(Answer{tests::accepted_event, "", "", tests::do_edl, 12, {}, {}}, uplink.changes);
    CHECK(uplink.lifecycle.status(Stage::accepted) == Status::pending);
}

TEST_CASE("silence until the window and light time both ways is unknown, in words", "[lifecycle]") {
    Uplink uplink{"NO_OP"};
    uplink.lifecycle.pass(Ert{1610 * second}, uplink.changes);
    CHECK(uplink.lifecycle.status(Stage::accepted) == Status::pending);
    uplink.lifecycle.pass(Ert{1610 * second + 1}, uplink.changes);
    CHECK(uplink.lifecycle.status(Stage::received) == Status::unknown);
    CHECK(uplink.lifecycle.status(Stage::accepted) == Status::unknown);
    CHECK(uplink.evidence(Stage::accepted) == "no answer within 10 s + light time there and back, 2 x 800 s");
    CHECK(uplink.lifecycle.status(Stage::executed) == Status::pending);
    uplink.lifecycle.pass(Ert{1621 * second}, uplink.changes);
    CHECK(uplink.lifecycle.status(Stage::executed) == Status::unknown);
    const auto told = uplink.changes.size();
    uplink.lifecycle.pass(Ert{9999 * second}, uplink.changes);
    CHECK(uplink.changes.size() == told);
}

TEST_CASE("an answer that comes late, with the recording, still counts", "[lifecycle]") {
    Uplink uplink{"NO_OP"};
    uplink.lifecycle.pass(Ert{2000 * second}, uplink.changes);
    uplink.answer(tests::executed_event, 5000);
    CHECK(uplink.lifecycle.status(Stage::executed) == Status::ok);
    CHECK(uplink.lifecycle.status(Stage::accepted) == Status::ok);
    CHECK(uplink.evidence(Stage::accepted).find("inferred from COMMAND_EXECUTED") == 0);
}

TEST_CASE("a refusal fails the stage and all after it, and shows that the command was received", "[lifecycle][R23]") {
    Uplink uplink{"EDL_SET_PARAMETERS", true};
    uplink.answer(tests::refused_event, 1601);
    CHECK(uplink.lifecycle.status(Stage::received) == Status::ok);
    CHECK(uplink.lifecycle.status(Stage::accepted) == Status::failed);
    CHECK(uplink.lifecycle.status(Stage::executed) == Status::failed);
    CHECK(uplink.evidence(Stage::executed) == "not executed, because it was refused on board");
    CHECK(uplink.lifecycle.status(Stage::verified) == Status::failed);
    CHECK(uplink.lifecycle.finished());
}

TEST_CASE("a refusal after acceptance fails the execution only", "[lifecycle]") {
    Uplink uplink{"NO_OP"};
    uplink.answer(tests::accepted_event, 1601);
    uplink.answer(tests::refused_event, 1602);
    CHECK(uplink.lifecycle.status(Stage::accepted) == Status::ok);
    CHECK(uplink.lifecycle.status(Stage::executed) == Status::failed);
}

TEST_CASE("the same answer again, from the recording, changes nothing", "[lifecycle]") {
    Uplink uplink{"NO_OP"};
    uplink.answer(tests::accepted_event, 1601);
    uplink.answer(tests::executed_event, 1602);
    const auto told = uplink.changes.size();
    uplink.answer(tests::accepted_event, 9000);
    uplink.answer(tests::executed_event, 9000);
    CHECK(uplink.changes.size() == told);
}

TEST_CASE("only a report made after the execution verifies", "[lifecycle][R23]") {
    Uplink uplink{"EDL_SET_PARAMETERS", true};
    uplink.report(5010.0, true);
    CHECK(uplink.lifecycle.status(Stage::verified) == Status::pending);
    uplink.answer(tests::executed_event, 1602, 5000.0);
    uplink.report(4999.0, false);
    CHECK(uplink.lifecycle.status(Stage::verified) == Status::pending);
    uplink.report(5000.0, true);
    CHECK(uplink.lifecycle.status(Stage::verified) == Status::ok);
    CHECK(uplink.evidence(Stage::verified) == "read back: 3 of 3 arguments equal bit for bit at SCLK 5000.000");
    uplink.report(6000.0, false);  // of a later command
    CHECK(uplink.lifecycle.status(Stage::verified) == Status::ok);
}

TEST_CASE("a read-back that differs fails, and one that is equal later mends it", "[lifecycle][R23]") {
    Uplink uplink{"EDL_SET_PARAMETERS", true};
    uplink.answer(tests::executed_event, 1602, 5000.0);
    uplink.report(5001.0, false);
    CHECK(uplink.lifecycle.status(Stage::verified) == Status::failed);
    CHECK(uplink.evidence(Stage::verified).find("solution_id sent 7, held 8") != std::string::npos);
    uplink.report(5011.0, true);
    CHECK(uplink.lifecycle.status(Stage::verified) == Status::ok);
}

TEST_CASE("a command that nothing reads back has no stage verified", "[lifecycle]") {
    Uplink uplink{"NO_OP"};
    CHECK_FALSE(uplink.lifecycle.exists(Stage::verified));
    for (const auto& change : uplink.changes) CHECK(change.stage != Stage::verified);
}

TEST_CASE("a command that never left Earth failed on board as well", "[lifecycle]") {
    Uplink uplink{"NO_OP"};
    CommandLifecycle lifecycle{uplink.lifecycle.command(), 1, 0.0, false};
    std::vector<StageChange> changes;
    lifecycle.ground_stage(Stage::queued, Status::ok, "", Ert{0}, changes);
    lifecycle.ground_stage(Stage::authorised, Status::failed, "not armed", Ert{0}, changes);
    CHECK(lifecycle.status(Stage::executed) == Status::failed);
    CHECK(changes.back().evidence == "not executed, never left Earth: not authorised");
    CHECK(lifecycle.finished());
}

TEST_CASE("a stage that no event shows is unknown from the start", "[lifecycle]") {
    Uplink uplink{"NO_OP"};
    dictionary::Command mute = uplink.lifecycle.command();
    mute.verifiers.clear();
    CommandLifecycle lifecycle{mute, 1, 0.0, false};
    std::vector<StageChange> changes;
    lifecycle.ground_stage(Stage::radiated, Status::ok, "", Ert{0}, changes);
    CHECK(lifecycle.status(Stage::accepted) == Status::unknown);
    CHECK(lifecycle.status(Stage::executed) == Status::unknown);
}

TEST_CASE("every command of the shipped dictionary is shown by events, from acceptance to execution",
          "[lifecycle][R44][R48]") {
    const auto& dictionary = tests::shipped_dictionary();
    for (const auto& command : dictionary.commands) {
        INFO(command.name);
        const auto answered = [&](std::initializer_list<const char*> events) {
            CommandLifecycle lifecycle{command, 3, 0.0, false};
            std::vector<StageChange> changes;
            lifecycle.ground_stage(Stage::radiated, Status::ok, "", Ert{0}, changes);
            for (const char* event : events)
                lifecycle.on(Answer{dictionary.event(event)->id, event, "", command.opcode, 3, Sclk{1.0}, Ert{1}},
                             changes);
            return lifecycle;
        };
        CHECK(answered({}).status(Stage::executed) == Status::pending);
        CHECK(answered({"COMMAND_ACCEPTED"}).status(Stage::accepted) == Status::ok);
        CHECK(answered({"COMMAND_ACCEPTED"}).status(Stage::executed) == Status::pending);
        CHECK(answered({"COMMAND_ACCEPTED", "COMMAND_EXECUTED"}).status(Stage::executed) == Status::ok);
        CHECK(answered({"COMMAND_REFUSED"}).status(Stage::accepted) == Status::failed);
        CHECK(answered({"COMMAND_ACCEPTED", "COMMAND_REFUSED"}).status(Stage::executed) == Status::failed);
    }
}

TEST_CASE("what the uplink gives back before it was radiated waits again, and can still be released or fail",
          "[lifecycle][R44]") {
    Uplink uplink{"NO_OP"};
    CommandLifecycle lifecycle{uplink.lifecycle.command(), 1, 0.0, false};
    std::vector<StageChange> changes;
    lifecycle.ground_stage(Stage::released, Status::ok, "to the uplink", Ert{0}, changes);
    lifecycle.taken_back("the pass has ended", Ert{1}, changes);
    CHECK(lifecycle.status(Stage::released) == Status::pending);
    CHECK(changes.back().evidence == "the pass has ended");
    SECTION("released") {
        lifecycle.ground_stage(Stage::released, Status::ok, "to the uplink again", Ert{2}, changes);
        CHECK(changes.back().evidence == "to the uplink again");
    }
    SECTION("failed") {
        lifecycle.ground_stage(Stage::released, Status::failed, "must not be sent", Ert{2}, changes);
        CHECK(lifecycle.status(Stage::executed) == Status::failed);
    }
}

TEST_CASE("a frame that is not radiated again says why, and stays radiated", "[lifecycle]") {
    Uplink uplink{"NO_OP"};
    uplink.lifecycle.radiated_in_doubt("it must not", Ert{second}, uplink.changes);
    CHECK(uplink.evidence(Stage::radiated) == "it must not");
    CHECK(uplink.lifecycle.status(Stage::radiated) == Status::ok);
}

}  // namespace commands_lifecycle_test
