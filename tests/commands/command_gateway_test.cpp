// SPDX-License-Identifier: Apache-2.0
#include "commands/command_gateway.hpp"

#include "common/bytes.hpp"
#include "common/cltu.hpp"
#include "common/tc_frame.hpp"
#include "telemetry/decommutator.hpp"
#include "telemetry/text.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <bit>

namespace commands_command_gateway_test {

using namespace aeolis;
using namespace aeolis::commands;

namespace {

constexpr Ert now{1'000'000'000};

std::vector<NamedValue> solution() {
    return {
        {"solution_id", 1.0},
        {"epoch_sclk", 397500515.0},
        {"position_x_m", 2.0e6},
        {"position_y_m", 7.0e6},
        {"position_z_m", 8.0e4},
        {"velocity_x_mps", -3200.0},
        {"velocity_y_mps", -3300.0},
        {"velocity_z_mps", -280.0},
        {"entry_sclk", 397501715.0},
        {"target_latitude_deg", -4.6019},
        {"target_longitude_deg", 137.4102},
        {"target_radius_m", 3391148.0},
        {"parachute_speed_mps", 405.0},
        {"heatshield_speed_mps", 142.0},
        {"backshell_altitude_m", 1660.0},
    };
}

Request request(const std::string& command) {
    Request made;
    made.command = command;
    made.request = 7;
    return made;
}

struct Station {
    std::vector<std::string> second_person{};
    TrackingSchedule passes{};
    std::optional<ClockCorrelation> clock{};
    CommandGateway gateway{tests::shipped_dictionary(), 0.0, solution(), second_person, passes, {}, clock};
    std::vector<StageReport> stages{};

    telemetry::Decommutator decommutator{tests::shipped_dictionary()};

    void hear(const std::vector<std::uint8_t>& packet, bool live, Ert at) {
        const auto& words = tests::shipped_dictionary();
        dictionary::Decoded decoded;
        REQUIRE_FALSE(decommutator.decode(packet, decoded));
        const auto* event = telemetry::event_of(words, decoded);
        const auto text = event == nullptr ? "" : telemetry::event_text(words, *event, decoded);
        gateway.receive({decoded, packet, live, at, event, text}, stages);
    }
    Reply send(const Request& asked) { return gateway.submit(asked, now, stages); }
    /// The packet in the one unit that the station is to radiate.
    std::vector<std::uint8_t> radiated() {
        const auto units = gateway.take_uplinks();
        REQUIRE(units.size() == 1);
        std::vector<std::uint8_t> information(cltu_information_octets_max);
        const auto octets = read_cltu(units[0], information);
        REQUIRE(octets);
        const auto frame = read_tc_frame(std::span{information}.first(*octets));
        REQUIRE(frame);
        return {frame->data.begin(), frame->data.end()};
    }
    std::string refusal(const Request& asked) {
        const auto submitted = send(asked);
        CHECK_FALSE(submitted.accepted);
        CHECK(submitted.command == 0);
        CHECK(submitted.request == 7);
        CHECK(gateway.take_uplinks().empty());
        CHECK(stages.empty());
        return submitted.reason;
    }
    const StageReport* latest(const std::string& stage) const {
        const StageReport* found = nullptr;
        for (const auto& each : stages)
            if (name_of(each.stage) == stage) found = &each;
        return found;
    }
};

/// A packet of the shipped dictionary with these raw values in the named fields, all else zero.
std::vector<std::uint8_t> packet_of(const std::string& name,
                                    const std::vector<std::pair<std::string, std::uint64_t>>& values) {
    const auto& dictionary = tests::shipped_dictionary();
    const auto* packet = dictionary.packet(name);
    REQUIRE(packet != nullptr);
    std::vector<std::uint8_t> octets(packet->octets, 0);
    const auto put = [&](const dictionary::Field& field, std::uint64_t value) {
        for (unsigned bit = 0; bit < field.type.bits; ++bit)
            if ((value >> (field.type.bits - 1 - bit)) & 1) {
                const auto at = field.position_bits + bit;
                octets[at / 8] = static_cast<std::uint8_t>(octets[at / 8] | (0x80U >> (at % 8)));
            }
    };
    for (const auto& field : packet->fields)
        for (const auto& [wanted, value] : values) {
            if (field.name != wanted) continue;
            put(field, value);
            if (const auto defined = field.validity_bit)
                octets[*defined / 8] = static_cast<std::uint8_t>(octets[*defined / 8] | (0x80U >> (*defined % 8)));
        }
    if (packet->event)  // the event's id stands first behind the secondary header
        BitWriter{std::span{octets}.subspan(tm_data_offset_octets)}.put(packet->event->value, 16);
    seal_tm_packet(octets, packet->apid, 0, Sclk{397500600.0}, dictionary.id);
    return octets;
}

}  // namespace

TEST_CASE("the gateway refuses what must not be sent, with the reason", "[gateway][R44]") {
    Station station;
    CHECK_THAT(station.refusal(request("DO_A_BARREL_ROLL")), Catch::Contains("unknown command 'DO_A_BARREL_ROLL'"));
    CHECK_THAT(station.refusal(request("EDL_SET_PARAMETERS")), Catch::Contains("is missing"));
    CHECK_THAT(station.refusal(request("EDL_DO_EDL")), Catch::Contains("armed"));

    auto armed = request("EDL_DO_EDL");
    armed.armed = true;
    armed.confirmation = "edl_do_edl";
    CHECK_THAT(station.refusal(armed), Catch::Contains("EDL_DO_EDL"));

    auto outside = request("EDL_SET_PARAMETERS");
    outside.from_solution = true;
    outside.arguments = {{"parachute_speed_mps", 1000.0}};
    CHECK_THAT(station.refusal(outside), Catch::Contains("parachute_speed_mps") && Catch::Contains("1000"));

    auto unknown_argument = request("NO_OP");
    unknown_argument.arguments = {{"volume", 0.0}};
    CHECK_THAT(station.refusal(unknown_argument), Catch::Contains("volume"));
}

TEST_CASE("parameters come from ground's solution and leave the station as one packet", "[gateway][R44]") {
    Station station;
    auto asked = request("EDL_SET_PARAMETERS");
    asked.from_solution = true;
    const auto submitted = station.send(asked);
    REQUIRE(submitted.accepted);
    CHECK(submitted.command == 1);
    const auto packet = station.radiated();
    CHECK(submitted.octets == packet);
    const auto telecommand = read_tc_packet(packet);
    REQUIRE(telecommand);
    CHECK(telecommand->primary.count == 0);
    const auto held = decode(*tests::shipped_dictionary().command("EDL_SET_PARAMETERS"), packet);
    REQUIRE(held);
    CHECK(std::ranges::find((*held), NamedValue{"entry_sclk", 397501715.0}) != held->end());
    for (const char* stage : {"queued", "authorised", "released", "radiated"}) {
        INFO(stage);
        REQUIRE(station.latest(stage) != nullptr);
        CHECK(station.latest(stage)->status == Status::ok);
    }
    CHECK(station.stages.front().octets == packet);
    CHECK_THAT(station.stages.front().arguments, Catch::Contains("entry_sclk=397501715"));
    for (const char* stage : {"received", "accepted", "executed", "verified"}) {
        INFO(stage);
        REQUIRE(station.latest(stage) != nullptr);
        CHECK(station.latest(stage)->status == Status::pending);  // nothing is green by default
    }
}

TEST_CASE("a stage is reached by the event that shows it, for that command only", "[gateway][R44]") {
    Station station;
    REQUIRE(station.send(request("NO_OP")).accepted);
    REQUIRE(station.send(request("NO_OP")).accepted);
    const auto opcode = tests::shipped_dictionary().command("NO_OP")->opcode.value;
    station.stages.clear();
    station.hear(packet_of("COMMAND_ACCEPTED", {{"opcode", opcode}, {"count", 1}}), true, now);
    REQUIRE(station.latest("accepted") != nullptr);
    CHECK(station.latest("accepted")->status == Status::ok);
    CHECK(station.latest("accepted")->command == 2);
    CHECK(station.latest("received")->status == Status::ok);  // inferred, and says so
    CHECK(std::ranges::none_of(station.stages, [](const auto& stage) { return stage.command == 1; }));
}

TEST_CASE("a precondition that is known not to hold refuses, with the value; what is not known is left to flight",
          "[gateway][R23][R44]") {
    auto go = request("EDL_DO_EDL");
    go.armed = true;
    go.confirmation = "EDL_DO_EDL";
    SECTION("not known") {
        Station station;
        CHECK(station.send(go).accepted);
        CHECK_THAT(station.latest("authorised")->evidence, Catch::Contains("left to flight"));
    }
    SECTION("known") {
        Station station;
        station.hear(packet_of("EdlStatus", {}), true, now);  // no parameters on board
        CHECK_THAT(station.refusal(go), Catch::Contains("parameters_received"));
    }
    SECTION("known from the recording only: that is the past") {
        Station station;
        station.hear(packet_of("EdlStatus", {}), false, now);
        CHECK(station.send(go).accepted);
    }
}

TEST_CASE(
    "once GNC is enabled ground sends no parameters any more, and says why; before, and while it does not know, it "
    "does",
    "[gateway][R23][R25]") {
    auto parameters = request("EDL_SET_PARAMETERS"), stage = request("EDL_STAGE_PARAMETER"),
         activate = request("EDL_ACTIVATE_PARAMETERS");
    parameters.from_solution = true;
    stage.arguments = {{"parameter", 0.0}, {"value", 4.0}};
    activate.arguments = {{"parameter_version", 1.0}, {"parameter_changes", 1.0}, {"parameter_crc", 1.0}};
    for (const auto& asked : {parameters, stage, activate, request("EDL_DISCARD_PARAMETERS")}) {
        INFO(asked.command);
        Station unknown, before, after;
        const auto said = [&](Station& station) { return station.send(asked).reason; };
        CHECK_THAT(said(unknown), !Catch::Contains("gnc_enabled"));
        before.hear(packet_of("GncConfiguration", {{"gnc_enabled", 0}}), true, now);
        CHECK(said(before) == said(unknown));
        after.hear(packet_of("GncConfiguration", {{"gnc_enabled", 1}}), true, now);
        CHECK_THAT(after.refusal(asked), Catch::Contains("gnc_enabled == 0: is 1"));
    }
}

TEST_CASE("do edl wants the parameters on board to be those that were sent: other ones refuse it, equal ones let it go",
          "[gateway][R23][R44]") {
    Station station;
    auto parameters = request("EDL_SET_PARAMETERS");
    parameters.from_solution = true;
    REQUIRE(station.send(parameters).accepted);
    (void)station.radiated();
    const auto& command = *tests::shipped_dictionary().command("EDL_SET_PARAMETERS");
    const auto* report = read_back_packet(tests::shipped_dictionary(), command);
    REQUIRE(report != nullptr);
    auto go = request("EDL_DO_EDL");
    go.armed = true;
    go.confirmation = "EDL_DO_EDL";
    go.dry_run = true;
    const auto said = [&] {
        const auto reply = station.send(go);
        std::string text;
        for (const auto& each : reply.preconditions)
            if (each.text.starts_with("EDL_SET_PARAMETERS held as sent"))
                text = name_of(each.verdict) + (": " + each.text);
        return std::pair{reply.accepted, text};
    };
    CHECK(said() ==
          std::pair{true,
                    std::string{
                        "unknown: EDL_SET_PARAMETERS held as sent (command 1): not read back yet"}});  // left to flight

    station.hear(packet_of("COMMAND_ACCEPTED", {{"opcode", command.opcode.value}, {"count", 0}}), true, now);
    station.hear(packet_of("COMMAND_EXECUTED", {{"opcode", command.opcode.value}, {"count", 0}}), true, now);
    station.hear(packet_of(report->name, {}), true, now);  // all zero: not what was sent
    REQUIRE(station.latest("verified") != nullptr);
    REQUIRE(station.latest("verified")->status == Status::failed);
    const auto [sent, why] = said();
    CHECK_FALSE(sent);
    CHECK(why == "fails: EDL_SET_PARAMETERS held as sent (command 1): the vehicle reports other values");
}

TEST_CASE("parameters that were sent anew are waited for: the vehicle may still hold the ones before",
          "[gateway][R23][R44]") {
    Station station;
    auto parameters = request("EDL_SET_PARAMETERS");
    parameters.from_solution = true;
    REQUIRE(station.send(parameters).accepted);
    (void)station.radiated();
    REQUIRE(station.send(parameters).accepted);
    (void)station.radiated();
    auto go = request("EDL_DO_EDL");
    go.armed = true;
    go.confirmation = "EDL_DO_EDL";
    CHECK_THAT(
        station.send(go).reason,
        Catch::Contains("EDL_SET_PARAMETERS held as sent (command 2): sent anew and not read back yet, wait for it"));
}

TEST_CASE("parameters that were refused on board leave what is known of those before as it was",
          "[gateway][R23][R44]") {
    Station station;
    const auto& command = *tests::shipped_dictionary().command("EDL_SET_PARAMETERS");
    const auto* report = read_back_packet(tests::shipped_dictionary(), command);
    REQUIRE(report != nullptr);
    auto parameters = request("EDL_SET_PARAMETERS");
    parameters.from_solution = true;
    REQUIRE(station.send(parameters).accepted);
    (void)station.radiated();
    station.hear(packet_of("COMMAND_ACCEPTED", {{"opcode", command.opcode.value}, {"count", 0}}), true, now);
    station.hear(packet_of("COMMAND_EXECUTED", {{"opcode", command.opcode.value}, {"count", 0}}), true, now);
    station.hear(packet_of(report->name, {}), true, now);  // all zero: not what was sent
    REQUIRE(station.latest("verified")->status == Status::failed);
    REQUIRE(station.send(parameters).accepted);
    (void)station.radiated();
    auto go = request("EDL_DO_EDL");
    go.armed = true;
    go.confirmation = "EDL_DO_EDL";
    REQUIRE_THAT(station.send(go).reason, Catch::Contains("(command 2): sent anew"));
    station.hear(packet_of("COMMAND_REFUSED", {{"opcode", command.opcode.value}, {"count", 1}}), true, now);
    CHECK_THAT(station.send(go).reason,
               Catch::Contains("EDL_SET_PARAMETERS held as sent (command 1): the vehicle reports other values"));
}

TEST_CASE(
    "a file is looked at as it would go: what a command before does to one behind is known before the first leaves",
    "[gateway][R23][R44]") {
    Station station;
    auto parameters = request("EDL_SET_PARAMETERS");
    parameters.from_solution = true;
    auto go = request("EDL_DO_EDL");
    go.armed = true;
    go.confirmation = "EDL_DO_EDL";
    const std::vector file{parameters, go};
    const auto first = station.gateway.look(file, now);
    CHECK(first.at(1).accepted);  // of the first that is sent flight itself says whether it has it
    REQUIRE(station.send(parameters).accepted);
    (void)station.radiated();
    const auto again = station.gateway.look(file, now);
    CHECK(again.at(0).accepted);
    CHECK_THAT(again.at(1).reason,
               Catch::Contains("EDL_SET_PARAMETERS held as sent (command 2): sent anew and not read back yet"));
    CHECK(station.send(go).accepted);  // looking changed nothing
}

TEST_CASE("do edl is left to flight when the parameters were not read back in their time", "[gateway][R23][R44]") {
    Station station;
    auto parameters = request("EDL_SET_PARAMETERS");
    parameters.from_solution = true;
    REQUIRE(station.send(parameters).accepted);
    (void)station.radiated();
    station.gateway.pass(Ert{now.microseconds + 3600LL * 1'000'000}, station.stages);
    REQUIRE(station.latest("verified")->status == Status::unknown);
    auto go = request("EDL_DO_EDL");
    go.armed = true;
    go.confirmation = "EDL_DO_EDL";
    const auto reply = station.send(go);
    CHECK(reply.accepted);
    CHECK(reply.preconditions.back().text == "EDL_SET_PARAMETERS held as sent (command 1): not read back in its time");
}

TEST_CASE("nobody has more commands under way than places are free, and what is done gives its place back",
          "[gateway][bounds][R63]") {
    Station station;
    const auto ask = [&](const char* who) {
        auto held = request("NO_OP");
        held.hold = true;
        held.controller = who;
        return station.send(held);
    };
    const auto fill = [&](const char* who) {
        std::size_t taken = 0;
        while (ask(who).accepted) ++taken;
        return taken;
    };
    CHECK(fill("greedy") == CommandGateway::commands_max / 2);
    CHECK(ask("greedy").reason == "2048 of the 2048 commands under way are yours: the places left are for others");
    CHECK(fill("greedy too") == CommandGateway::commands_max / 4);
    REQUIRE(ask("careful").accepted);
    auto cancel = request("");
    cancel.action = "cancel";
    cancel.number = 1;
    CHECK_FALSE(ask("greedy").accepted);
    for (cancel.number = 1; cancel.number <= 2048; ++cancel.number) REQUIRE(station.send(cancel).accepted);
    station.gateway.pass(Ert{now.microseconds + 3600LL * 1'000'000}, station.stages);
    CHECK(fill("greedy") > 1000);  // no limit lasts as long as the run
}

TEST_CASE(
    "a director's command among another's thousand leaves before them, and no cycle radiates more than the vehicle "
    "takes",
    "[gateway][bounds][R63]") {
    Station station;
    for (int i = 0; i < 1000; ++i) {
        auto flood = request("NO_OP");
        flood.controller = "greedy";
        flood.priority = 4'000'000'000U;
        REQUIRE(station.send(flood).accepted);
    }
    auto wanted = request("NO_OP");
    wanted.controller = "director";
    wanted.director = true;
    const auto reply = station.send(wanted);
    REQUIRE(reply.accepted);
    CHECK(station.gateway.take_uplinks().size() <= CommandGateway::radiated_a_cycle_max);
    int cycles = 0;
    const auto left = [&] {
        return std::ranges::any_of(station.stages, [&](const StageReport& stage) {
            return stage.command == reply.command && stage.stage == Stage::radiated;
        });
    };
    for (; cycles < 100 && !left(); ++cycles) {
        station.gateway.pass(Ert{now.microseconds + (cycles + 1) * 15'625}, station.stages);
        CHECK(station.gateway.take_uplinks().size() <= CommandGateway::radiated_a_cycle_max);
    }
    // Only those that were at the uplink already left before it.
    CHECK(cycles <= static_cast<int>(CommandGateway::at_uplink_max));
}

TEST_CASE("commands that may wait leave no faster than their answers come down, and a hazardous one leaves at once",
          "[gateway][bounds][R63]") {
    Station station;
    auto flood = request("NO_OP");
    flood.controller = "greedy";
    std::size_t left = 0;
    Ert at = now;
    for (int cycle = 0; cycle < 64 * 60; ++cycle, at.microseconds += 15'625) {
        if (cycle < 1000) REQUIRE(station.gateway.submit(flood, at, station.stages).accepted);
        station.gateway.pass(at, station.stages);
        left += station.gateway.take_uplinks().size();
    }
    const double carried = 60.0 * 1000.0 * ReleasePace::downlink_share / ReleasePace::answer_octets;
    CHECK(static_cast<double>(left) <= ReleasePace::at_once + carried + 1.0);
    CHECK(static_cast<double>(left) >= carried);
    auto wanted = request("EDL_DO_EDL");
    wanted.armed = true;
    wanted.confirmation = wanted.command;
    for (int i = 0; i < 2; ++i) REQUIRE(station.gateway.submit(wanted, at, station.stages).accepted);
    CHECK(station.gateway.take_uplinks().size() == CommandGateway::radiated_a_cycle_max);
}

TEST_CASE("a command that waits for its turn says so, and neither its reply nor a dry run tells when it leaves",
          "[gateway][R63]") {
    Station station;
    Reply reply;
    for (int i = 0; i < 3; ++i) reply = station.send(request("NO_OP"));
    CHECK(reply.accepted);
    CHECK(reply.leaves == now);  // two left in this cycle, and two may stand at the uplink
    for (int i = 0; i < 3; ++i) reply = station.send(request("NO_OP"));
    CHECK(reply.accepted);
    CHECK_FALSE(reply.leaves);
    CHECK_FALSE(reply.arrives);
    const auto* waits = station.latest("released");
    REQUIRE(waits != nullptr);
    CHECK(waits->status == Status::pending);
    CHECK(waits->evidence ==
          "waits for its turn: 2 commands wait, and leave as the downlink has room for their answers");
    auto tried = request("NO_OP");
    tried.dry_run = true;
    CHECK_FALSE(station.send(tried).leaves);
    auto hazardous = request("EDL_DO_EDL");
    hazardous.armed = hazardous.dry_run = true;
    hazardous.confirmation = hazardous.command;
    CHECK(station.send(hazardous).leaves == now);
    for (int cycle = 1; cycle <= 64; ++cycle)
        station.gateway.pass(Ert{now.microseconds + cycle * 15'625}, station.stages);
    CHECK(station.latest("radiated")->status == Status::ok);
    CHECK_FALSE(station.gateway.may_leave(Ert{now.microseconds + 2'000'000}));
    CHECK(station.gateway.queued() == 0);
}

TEST_CASE("silence becomes unknown when the window has passed, never ok", "[gateway][R44]") {
    Station station;
    REQUIRE(station.send(request("NO_OP")).accepted);
    station.gateway.pass(Ert{now.microseconds + 3600LL * 1'000'000}, station.stages);
    CHECK(station.latest("accepted")->status == Status::unknown);
    CHECK(station.latest("executed")->status == Status::unknown);
}

TEST_CASE("a frame that the vehicle misses is radiated again, and the history says so", "[gateway][R44]") {
    Station station;
    const auto report = [&](bool retransmit, std::uint8_t expected, Ert at) {
        std::array<std::uint8_t, clcw_octets> clcw{};
        write_clcw({.retransmit = retransmit, .expected = expected}, clcw);
        station.hear(packet_of("CommStatus", {{"clcw", read_bits(clcw, 0, 32)}}), true, at);
    };
    report(false, 0, now);
    REQUIRE(station.send(request("NO_OP")).accepted);
    CHECK_THAT(station.latest("released")->evidence, Catch::Contains("sequence-controlled"));
    REQUIRE(station.send(request("NO_OP")).accepted);
    CHECK(station.gateway.take_uplinks().size() == 2);
    report(true, 0, Ert{now.microseconds + 5'000'000});
    CHECK(station.gateway.take_uplinks().size() == 2);
    CHECK_THAT(station.latest("radiated")->evidence, Catch::StartsWith("transmission 2"));
    CHECK(station.latest("received")->status == Status::pending);
    report(false, 2, Ert{now.microseconds + 15'000'000});
    CHECK(station.latest("received")->status == Status::ok);
    CHECK_THAT(station.latest("received")->evidence, Catch::Contains("CLCW"));
    CHECK(station.latest("accepted")->status == Status::pending);  // a frame taken is no command accepted
}

TEST_CASE("a frame that either computer reports is received: the backup's report counts when prime is silent",
          "[gateway][R33][R44]") {
    Station station;
    const auto report = [&](std::uint8_t expected, Ert at) {
        std::array<std::uint8_t, clcw_octets> clcw{};
        write_clcw({.expected = expected}, clcw);
        station.hear(packet_of("CommStatusB", {{"clcw_b", read_bits(clcw, 0, 32)}}), true, at);
    };
    report(0, now);
    REQUIRE(station.send(request("NO_OP")).accepted);
    report(1, Ert{now.microseconds + 15'000'000});
    CHECK(station.latest("received")->status == Status::ok);
}

TEST_CASE("a vehicle that is not heard gets the expedited service, unless the controller asks otherwise",
          "[gateway][R44]") {
    Station station;
    REQUIRE(station.send(request("NO_OP")).accepted);
    CHECK_THAT(station.latest("released")->evidence, Catch::Contains("expedited (BD)"));
    auto asked = request("NO_OP");
    asked.service = "AD";
    REQUIRE(station.send(asked).accepted);
    CHECK_THAT(station.latest("released")->evidence, Catch::Contains("sequence-controlled (AD)"));
    asked.service = "XY";
    CHECK_THAT(station.send(asked).reason, Catch::Contains("unknown service 'XY'"));
}

TEST_CASE("a dry run says what would happen, with every check and its values, and leaves all as it is",
          "[gateway][R44]") {
    Station station;
    auto asked = request("EDL_SET_PARAMETERS");
    asked.from_solution = true;
    asked.dry_run = true;
    const auto preview = station.send(asked);
    CHECK(preview.dry_run);
    CHECK(preview.command == 0);
    CHECK(station.stages.empty());
    CHECK(station.gateway.take_uplinks().empty());
    CHECK_THAT(preview.arguments, Catch::Contains("parachute_speed_mps"));
    CHECK(preview.service == "BD");
    CHECK_FALSE(preview.octets.empty());
    CHECK(preview.arrives == Scet{now.microseconds});
    asked.dry_run = false;
    const auto sent = station.send(asked);
    CHECK(sent.octets == preview.octets);
    CHECK(sent.accepted == preview.accepted);
    CHECK(sent.command == 1);

    auto hazardous = request("EDL_DO_EDL");
    hazardous.dry_run = true;
    const auto refused = station.send(hazardous);
    CHECK_FALSE(refused.accepted);
    CHECK_THAT(refused.reason, Catch::Contains("armed"));
    // The dictionary's, and ground's own: that the parameters that have been sent are held.
    CHECK(refused.preconditions.size() == tests::shipped_dictionary().command("EDL_DO_EDL")->preconditions.size() + 1);
}

TEST_CASE("where two persons are wanted a command leaves when another than who asked has approved it, and not before",
          "[gateway][R23][R44]") {
    Station station{.second_person = {"NO_OP"}};
    CHECK_THAT(station.refusal(request("NO_OP")), Catch::Contains("say who you are"));
    auto asked = request("NO_OP");
    asked.controller = "Ann";
    asked.dry_run = true;
    CHECK(station.send(asked).needs_approval);
    asked.dry_run = false;
    REQUIRE(station.send(asked).command == 1);
    CHECK_THAT(station.latest("authorised")->evidence, Catch::Contains("by Ann"));
    CHECK_THAT(station.latest("released")->evidence, Catch::Contains("approval of another controller than Ann"));

    const auto act = [&](const std::string& action, const std::string& controller) {
        Request wanted;
        wanted.action = action;
        wanted.number = 1;
        wanted.controller = controller;
        return station.send(wanted).reason;
    };
    CHECK_THAT(act("approve", " ann "), Catch::Contains("another controller must approve it"));
    CHECK_THAT(act("approve", ""), Catch::Contains("say who approves it"));
    CHECK(act("release", "Ben").empty());  // of a hold that it has not: the approval is still wanted
    CHECK(station.gateway.take_uplinks().empty());
    CHECK(act("approve", "Ben").empty());
    CHECK(station.gateway.take_uplinks().size() == 1);
    CHECK_THAT(station.latest("authorised")->evidence, Catch::Contains("approved by Ben"));
    CHECK_THAT(act("approve", "Eve"), Catch::Contains("no approval"));
    CHECK_THAT(act("approve", "Ann"), Catch::Contains("no approval"));  // nobody else is sent for

    auto other = request("EDL_DO_EDL");
    other.armed = true;
    other.confirmation = "EDL_DO_EDL";
    other.controller = std::string(65, 'x');
    CHECK_THAT(station.send(other).reason, Catch::Contains("at most 64"));
}

TEST_CASE("without accounts the second person is one at another browser, whatever name is typed at the first",
          "[gateway][R23][R44]") {
    Station station{.second_person = {"NO_OP"}};
    auto asked = request("NO_OP");
    asked.controller = "Ann";
    asked.browser = "b1";
    REQUIRE(station.send(asked).command == 1);
    const auto approve = [&](const std::string& controller, const std::string& browser) {
        Request wanted;
        wanted.action = "approve";
        wanted.number = 1;
        wanted.controller = controller;
        wanted.browser = browser;
        return station.send(wanted).reason;
    };
    CHECK_THAT(approve("Ben", "b1"), Catch::Contains("asked for, as Ann, from where it would now be approved") &&
                                         Catch::Contains("a browser of their own"));
    CHECK_THAT(approve("Ann", "b2"), Catch::Contains("another controller must approve it"));
    CHECK(station.gateway.take_uplinks().empty());
    CHECK(approve("Ben", "b2").empty());
    CHECK(station.gateway.take_uplinks().size() == 1);
}

TEST_CASE("what a command of the scenario's script is refused for is its history", "[gateway][R44]") {
    Station station;
    auto scripted = request("EDL_SET_PARAMETERS");
    scripted.from_solution = true;
    station.gateway.note_refused(scripted, "no station sees the vehicle", now, station.stages);
    CHECK(station.stages.front().command == 1);
    CHECK(station.stages.front().stage == Stage::queued);
    CHECK(station.stages.front().status == Status::failed);
    CHECK_THAT(station.stages.front().evidence,
               Catch::Contains("the scenario's script") && Catch::Contains("no station sees the vehicle"));
    CHECK_THAT(station.stages.front().arguments, Catch::Contains("entry_sclk=397501715"));
    CHECK(std::ranges::all_of(station.stages,
                              [](const auto& stage) { return stage.status == Status::failed && stage.command == 1; }));
    CHECK(station.send(request("NO_OP")).command == 2);
    CHECK(station.gateway.take_uplinks().size() == 1);  // of the second: the first never leaves
}

namespace {

Request offset_change() {
    const auto& timeline = tests::shipped_dictionary().timeline;
    auto change = request("EDL_SET_TIMEPOINT_OFFSET");
    for (const auto& [name, value] : std::initializer_list<std::pair<const char*, double>>{
             {"timepoint", static_cast<double>(std::ranges::find(timeline, "detumble", &dictionary::TimelineRow::name) -
                                               timeline.begin())},
             {"desired_offset_s", -516.0},
             {"minimum_offset_s", 0.0}}) {
        change.arguments.push_back({name, value});
    }
    return change;
}

}  // namespace

TEST_CASE("a change of the timeline leaves after those that it was analysed with; when one is cancelled, only once "
          "that is analysed anew",
          "[gateway][R19][R44]") {
    Station station;
    auto held = offset_change();
    held.hold = true;
    REQUIRE(station.send(held).command == 1);
    REQUIRE(station.send(held).command == 2);
    REQUIRE(station.send(held).command == 3);
    std::uint64_t undone = 0;  // when it was analysed
    const auto act = [&](const char* action, std::uint64_t number) {
        Request said;
        said.action = action;
        said.number = number;
        return station.send(said).accepted;
    };
    const auto judge = [&](std::uint64_t number, bool refuted, const std::string& words) {
        return station.gateway.judge({number, undone, refuted, words}, now, station.stages).ok();
    };
    CHECK(act("release", 2));  // it stays behind the first, which is held
    CHECK(station.gateway.take_uplinks().empty());
    CHECK_THAT(station.latest("released")->evidence,
               Catch::Contains("after command 1, with which its timeline was analysed"));
    CHECK_FALSE(judge(2, false, "all bounds hold"));  // nobody doubts it
    CHECK(act("cancel", 1));
    CHECK(station.gateway.take_uplinks().empty());
    CHECK_THAT(station.latest("released")->evidence,
               Catch::Contains("does not leave before its timeline is looked at again"));
    CHECK_FALSE(judge(2, false, "all bounds hold"));  // with the first: that analysis began before it was cancelled
    undone = 1;
    CHECK(judge(2, false, "all bounds hold"));
    CHECK(station.gateway.take_uplinks().size() == 1);
    CHECK(act("release", 3));
    CHECK(station.gateway.take_uplinks().empty());  // of it nothing has been said yet
    CHECK(judge(3, true, "it breaks one"));
    CHECK(station.latest("released")->status == Status::failed);
    CHECK_THAT(station.latest("released")->evidence, Catch::Contains("has changed: it breaks one"));
    undone = 2;
    CHECK_FALSE(judge(3, false, "all bounds hold"));  // it waits no more
    CHECK(station.gateway.take_uplinks().empty());
}

namespace {

/// The vehicle's clock is at E-1000 s when Earth's is at `now`.
ClockCorrelation a_thousand_seconds_before_entry() {
    ClockCorrelation clock;
    clock.sclk = Sclk{397501715.0 - 1000.0};
    clock.scet = Scet{now.microseconds};
    return clock;
}

Request moved_entry(double by_s) {
    auto asked = request("EDL_SET_ANCHOR_OFFSET");
    asked.arguments = {{"anchor", 1.0}, {"offset_s", 397501715.0 + by_s}};
    return asked;
}

Request timepoint_at(const char* name, double desired_s) {
    const auto& timeline = tests::shipped_dictionary().timeline;
    const auto row = std::ranges::find(timeline, name, &dictionary::TimelineRow::name);
    auto asked = request("EDL_SET_TIMEPOINT_OFFSET");
    asked.arguments = {{"timepoint", static_cast<double>(row - timeline.begin())}, {"desired_offset_s", desired_s}};
    return asked;
}

}  // namespace

TEST_CASE(
    "a change that is unsafe on the timeline as it stands is refused, with the reason, by anchor as by parameters",
    "[gateway][R19][R51]") {
    Station station{.clock = a_thousand_seconds_before_entry()};
    const auto says = Catch::Contains("not safe on the timeline as it stands: entry would be 300.000 s later");
    CHECK_THAT(station.refusal(moved_entry(300.0)), says);
    auto parameters = request("EDL_SET_PARAMETERS");
    parameters.from_solution = true;
    parameters.arguments = {{"entry_sclk", 397501715.0 + 300.0}};
    CHECK_THAT(station.refusal(parameters), says);
    parameters.dry_run = true;
    CHECK_THAT(station.send(parameters).reason, says);
    CHECK_THAT(station.refusal(timepoint_at("uhf_start", -1001.0)), Catch::Contains("uhf_start would be overdue by 1"));
    CHECK(station.send(moved_entry(2.0)).accepted);
}

TEST_CASE("do edl is refused on ground when its first timepoint on the clock would be overdue", "[gateway][R23][R51]") {
    auto go = request("EDL_DO_EDL");
    go.armed = true;
    go.confirmation = "EDL_DO_EDL";
    auto clock = a_thousand_seconds_before_entry();
    CHECK(Station{.clock = clock}.send(go).accepted);
    clock.sclk = clock.sclk + 200.0;
    CHECK_THAT(Station{.clock = clock}.refusal(go), Catch::Contains("s too late: timepoints would be overdue"));
}

TEST_CASE("a file is judged change by change: each with those before it", "[gateway][R51]") {
    Station station{.clock = a_thousand_seconds_before_entry()};
    const auto separation = timepoint_at("cruise_stage_separation", 6.046875),
               detumble = timepoint_at("detumble", -516.0);
    const auto alone = station.gateway.look(std::vector{separation}, now);
    CHECK_FALSE(alone.front().accepted);  // no plume on the cruise stage
    const auto both = station.gateway.look(std::vector{detumble, separation}, now);
    CHECK((both[0].accepted && both[1].accepted));
    CHECK_FALSE(station.gateway.look(std::vector{separation}, now).front().accepted);  // nothing of it stays
}

TEST_CASE("a change that waits is judged when it leaves: what has become unsafe by then does not",
          "[gateway][R19][R51]") {
    Station station{.clock = a_thousand_seconds_before_entry()};
    const auto sclk = std::bit_cast<std::uint64_t>(397501715.0 - 1160.0);
    station.hear(packet_of("TimelineStatus", {{"timepoint_index", 3}, {"next_minimum_sclk", sclk}}), true, now);
    auto held = timepoint_at("uhf_start", -801.0);
    held.hold = true;
    REQUIRE(station.send(held).command == 1);
    const Ert later{now.microseconds + 210'000'000};  // E-790 s: the transmitter is on
    Request release;
    release.action = "release";
    release.number = 1;
    CHECK(station.gateway.submit(release, later, station.stages).accepted);
    CHECK(station.gateway.take_uplinks().empty());
    CHECK(station.latest("released")->status == Status::failed);
    CHECK_THAT(station.latest("released")->evidence,
               Catch::Contains("must not be sent now") && Catch::Contains("uhf_start will have been triggered"));
}

TEST_CASE("a reply says until when a command is of use, and what it comes too late for", "[gateway][R44]") {
    const Scet entry{now.microseconds + 1'000'000'000};
    CommandGateway gateway{tests::shipped_dictionary(), 828.0, solution(), {}, {}, entry};
    std::vector<StageReport> stages;
    auto asked = request("NO_OP");
    asked.dry_run = true;
    const auto reply = gateway.submit(asked, now, stages);  // there at E-172 s
    REQUIRE(reply.accepted);
    CHECK(reply.leaves == now);
    REQUIRE(reply.deadline);
    CHECK(reply.deadline->latest > now);
    CHECK(std::ranges::find(reply.too_late_for, "coolant_vent") != reply.too_late_for.end());  // E-826 s
    CHECK(std::ranges::find(reply.too_late_for, reply.deadline->timepoint) == reply.too_late_for.end());
    asked.dry_run = false;
    const auto taken = gateway.submit(asked, now, stages);
    CHECK(taken.deadline == reply.deadline);
}

TEST_CASE("a command with a time leaves then, a held one when it is released, a cancelled one never",
          "[gateway][R44]") {
    Station station;
    const auto later = [](double seconds) {
        return Ert{now.microseconds + static_cast<std::int64_t>(seconds * 1.0e6)};
    };
    const auto act = [&](std::uint64_t number, const std::string& action) {
        Request asked;
        asked.action = action;
        asked.number = number;
        return station.send(asked);
    };
    auto timed = request("NO_OP");
    timed.release_at = later(60.0);
    REQUIRE(station.send(timed).command == 1);
    auto held = request("NO_OP");
    held.hold = true;
    REQUIRE(station.send(held).command == 2);
    REQUIRE(station.send(held).command == 3);
    CHECK(station.gateway.take_uplinks().empty());
    CHECK_THAT(station.latest("released")->evidence, Catch::Contains("held until a controller releases it"));

    station.gateway.pass(later(59.0), station.stages);
    CHECK(station.gateway.take_uplinks().empty());
    station.gateway.pass(later(60.5), station.stages);
    CHECK(station.gateway.take_uplinks().size() == 1);

    for (const char* action : {"release", "approve", "hold", "cancel"}) {
        Request tried;
        tried.action = action;
        tried.number = 2;
        tried.dry_run = true;
        CHECK_THAT(station.send(tried).reason, Catch::Contains("cannot be tried out"));
    }
    CHECK(station.gateway.take_uplinks().empty());
    CHECK(act(2, "release").accepted);
    CHECK(station.gateway.take_uplinks().size() == 1);
    CHECK(act(3, "cancel").accepted);
    CHECK(station.latest("released")->status == Status::failed);
    CHECK_THAT(station.latest("radiated")->evidence, Catch::Contains("never left Earth"));
    CHECK_THAT(act(3, "release").reason, Catch::Contains("does not wait"));
    CHECK_THAT(act(2, "launch").reason, Catch::Contains("unknown action 'launch'"));

    timed.release_at = Ert{now.microseconds - 1'000'000};
    CHECK_THAT(station.send(timed).reason, Catch::Contains("is past"));
}

namespace {

constexpr Ert in_s(double seconds) {
    return Ert{now.microseconds + static_cast<std::int64_t>(seconds * 1.0e6)};
}

/// DSS-43 for a minute from now, and DSS-34 for another after a gap of a minute.
TrackingSchedule with_a_gap() {
    return TrackingSchedule{{{"DSS-43", now, in_s(60.0)}, {"DSS-34", in_s(120.0), in_s(180.0)}}};
}

}  // namespace

TEST_CASE("an uplink says by which station it goes, and one for a time at which none sees the vehicle is refused",
          "[gateway][tracking][R44]") {
    Station station{.passes = with_a_gap()};
    auto asked = request("NO_OP");
    asked.dry_run = true;
    CHECK(station.send(asked).station == "DSS-43");
    CHECK(station.send(asked).station_until == in_s(60.0));
    asked.release_at = in_s(130.0);
    CHECK(station.send(asked).station == "DSS-34");
    asked.release_at = in_s(90.0);
    const auto refused = [](const std::string& reason) {
        CHECK_THAT(reason, Catch::Contains("no station sees the vehicle at " + day_of_year_text(in_s(90.0))) &&
                               Catch::Contains("DSS-43, ended") &&
                               Catch::Contains("the next, of DSS-34, is " + day_of_year_text(in_s(120.0))));
    };
    refused(station.send(asked).reason);
    asked.dry_run = false;
    refused(station.refusal(asked));
    asked.hold = true;  // held, yet with that time
    refused(station.refusal(asked));

    REQUIRE(station.send(request("NO_OP")).station == "DSS-43");
    CHECK_THAT(station.latest("radiated")->evidence, Catch::Contains("left DSS-43"));
    const auto late = station.gateway.submit(request("NO_OP"), in_s(60.0), station.stages);
    CHECK_FALSE(late.accepted);
    CHECK_THAT(late.reason, Catch::Contains("no station sees the vehicle"));
}

TEST_CASE("what waits past a pass is held until the next one begins, or told that none comes",
          "[gateway][tracking][R44]") {
    Station station{.second_person = {"NO_OP"}, .passes = with_a_gap()};
    auto asked = request("NO_OP");
    asked.controller = "Ann";
    REQUIRE(station.send(asked).command == 1);
    REQUIRE(station.send(asked).command == 2);
    const auto approve = [&](std::uint64_t number, Ert at) {
        Request wanted;
        wanted.action = "approve";
        wanted.number = number;
        wanted.controller = "Ben";
        return station.gateway.submit(wanted, at, station.stages);
    };
    const auto in_the_gap = approve(1, in_s(90.0));
    CHECK(in_the_gap.accepted);
    CHECK(in_the_gap.station == "DSS-34");  // by which it leaves, and what follows from when
    CHECK(in_the_gap.station_until == in_s(180.0));
    CHECK(in_the_gap.arrives == Scet{in_s(120.0).microseconds});
    CHECK(in_the_gap.effect_seen == in_s(120.0));
    CHECK(station.gateway.take_uplinks().empty());
    CHECK_THAT(station.latest("released")->evidence,
               Catch::Contains("leaves at " + day_of_year_text(in_s(120.0)) + " by DSS-34"));
    CHECK(std::ranges::none_of(station.stages,
                               [](const auto& stage) { return stage.evidence == "then leaves at once"; }));
    station.gateway.pass(in_s(119.0), station.stages);
    CHECK(station.gateway.take_uplinks().empty());
    station.gateway.pass(in_s(120.0), station.stages);
    CHECK(station.gateway.take_uplinks().size() == 1);
    CHECK_THAT(station.latest("radiated")->evidence, Catch::Contains("left DSS-34"));

    const char* const none_comes = "none comes after it";
    const auto too_late = approve(2, in_s(180.0));
    CHECK_FALSE(too_late.accepted);
    CHECK_THAT(too_late.reason, Catch::Contains("command 2 can no longer leave") && Catch::Contains("DSS-34, ended") &&
                                    Catch::Contains(none_comes));
    station.gateway.pass(in_s(180.5), station.stages);  // nobody can approve it any more: it is not left to wait
    CHECK(station.gateway.take_uplinks().empty());
    CHECK(station.latest("released")->status == Status::failed);
    CHECK(station.latest("released")->command == 2);
    CHECK_THAT(approve(2, in_s(181.0)).reason, Catch::Contains("command 2 does not wait") &&
                                                   Catch::Contains("DSS-34, ended") && Catch::Contains(none_comes));
    CHECK_THAT(station.latest("released")->evidence,
               Catch::Contains("DSS-34, ended") && Catch::Contains("none comes after it"));
}

TEST_CASE("a held command is not released while no station sees the vehicle, and stays held",
          "[gateway][tracking][R44]") {
    Station station{.passes = with_a_gap()};
    auto held = request("NO_OP");
    held.hold = true;
    REQUIRE(station.send(held).accepted);
    Request release;
    release.action = "release";
    release.number = 1;
    const auto refused = station.gateway.submit(release, in_s(90.0), station.stages);
    CHECK_FALSE(refused.accepted);
    CHECK_THAT(refused.reason, Catch::Contains("command 1 stays held: no station sees the vehicle"));
    CHECK(station.gateway.take_uplinks().empty());
    CHECK(station.gateway.submit(release, in_s(130.0), station.stages).accepted);
    CHECK(station.gateway.take_uplinks().size() == 1);
}

TEST_CASE("a frame that is not acknowledged is not sent again before a station sees the vehicle",
          "[gateway][tracking][R44]") {
    Station station{.passes = with_a_gap()};
    auto asked = request("NO_OP");
    asked.service = "AD";
    REQUIRE(station.send(asked).accepted);
    CHECK(station.gateway.take_uplinks().size() == 1);
    station.gateway.pass(in_s(100.0), station.stages);  // long after CommandLink::report_s
    CHECK(station.gateway.take_uplinks().empty());
    station.gateway.pass(in_s(120.0), station.stages);
    CHECK(station.gateway.take_uplinks().size() == 1);
    CHECK_THAT(station.latest("radiated")->evidence, Catch::StartsWith("transmission 2"));
}

namespace {

/// The vehicle's receiver of frames has no room, or has it again: what goes in sequence waits in the uplink meanwhile.
void tell_room(Station& station, bool room, Ert at) {
    std::array<std::uint8_t, clcw_octets> clcw{};
    write_clcw({.wait = !room}, clcw);
    station.hear(packet_of("CommStatus", {{"clcw", read_bits(clcw, 0, 32)}}), true, at);
}

Request do_edl() {
    auto go = request("EDL_DO_EDL");
    go.armed = true;
    go.confirmation = "EDL_DO_EDL";
    go.service = "AD";
    return go;
}

}  // namespace

TEST_CASE("when a change of the timeline is refused on board, what was analysed with it waits again if it is at the "
          "uplink, and is told if it has left",
          "[gateway][R19][R44]") {
    Station station;
    auto change = offset_change();
    change.service = "AD";
    REQUIRE(station.send(change).command == 1);
    REQUIRE(station.send(change).command == 2);
    CHECK(station.gateway.take_uplinks().size() == 2);
    tell_room(station, false, now);
    REQUIRE(station.send(change).command == 3);
    auto other = request("NO_OP");
    other.service = "AD";
    REQUIRE(station.send(other).command == 4);
    CHECK(station.gateway.take_uplinks().empty());
    station.stages.clear();

    const auto& dictionary = tests::shipped_dictionary();
    const auto* refused = dictionary.command("EDL_SET_TIMEPOINT_OFFSET");
    REQUIRE(refused != nullptr);
    station.hear(packet_of("COMMAND_REFUSED", {{"opcode", refused->opcode.value}, {"count", 0}}), true, now);
    const auto told = [&](std::uint64_t number, const std::string& stage) {
        const StageReport* last = nullptr;
        for (const auto& each : station.stages)
            if (each.command == number && name_of(each.stage) == stage) last = &each;
        REQUIRE(last != nullptr);
        return name_of(last->status) + (": " + last->evidence);
    };
    CHECK_THAT(told(1, "accepted"), Catch::StartsWith("failed"));
    CHECK(told(2, "radiated") ==
          "ok: has left Earth, and its timeline was analysed with command 1, which came to nothing");
    CHECK_THAT(told(3, "released"),
               Catch::StartsWith(
                   "pending: taken back from the uplink, which had not radiated it when command 1 came to nothing"));

    const Ert next_cycle{now.microseconds + 15'625};
    tell_room(station, true, next_cycle);
    station.gateway.pass(next_cycle, station.stages);
    CHECK_THAT(told(3, "released"), Catch::Contains("does not leave before its timeline is looked at again"));
    CHECK_THAT(told(4, "released"), Catch::StartsWith("ok"));
    CHECK(station.gateway.take_uplinks().size() == 1);  // the fourth: nobody doubts it
    CHECK(station.gateway.judge({3, 1, false, "all bounds hold"}, next_cycle, station.stages));
    CHECK(station.gateway.take_uplinks().size() == 1);
}

TEST_CASE("what the uplink has not radiated when the last pass ends is told as failed, with the reason",
          "[gateway][tracking][R44]") {
    Station station{.passes = TrackingSchedule{{{"DSS-43", now, in_s(60.0)}}}};
    tell_room(station, false, now);
    auto asked = request("NO_OP");
    asked.service = "AD";
    REQUIRE(station.send(asked).accepted);
    CHECK(station.latest("released")->status == Status::ok);
    CHECK(station.latest("radiated") == nullptr);
    auto held = request("NO_OP");
    held.hold = true;
    REQUIRE(station.send(held).command == 2);

    station.gateway.pass(in_s(59.0), station.stages);
    CHECK(station.latest("radiated") == nullptr);
    station.gateway.pass(in_s(60.0), station.stages);
    REQUIRE(station.latest("radiated") != nullptr);
    const auto first = std::ranges::find_if(
        station.stages, [](const auto& stage) { return stage.command == 1 && stage.stage == Stage::radiated; });
    REQUIRE(first != station.stages.end());
    CHECK(first->status == Status::failed);
    CHECK_THAT(first->evidence, Catch::Contains("DSS-43, ended") && Catch::Contains("none comes after it"));
    CHECK(station.latest("received")->status == Status::failed);
    CHECK_THAT(station.latest("received")->evidence, Catch::Contains("never left Earth"));
    CHECK(station.latest("released")->command == 2);  // what was held can never leave either
    CHECK(station.latest("released")->status == Status::failed);

    tell_room(station, true, in_s(61.0));
    CHECK(station.gateway.take_uplinks().empty());
    CHECK_THAT(station.gateway.submit(held, in_s(61.0), station.stages).reason, Catch::Contains("none comes after it"));
}

TEST_CASE("what waits in the uplink when a pass ends waits for the next, and its preconditions are looked at when that "
          "begins",
          "[gateway][tracking][R23][R44]") {
    Station station{.passes = with_a_gap()};
    tell_room(station, false, now);
    REQUIRE(station.send(do_edl()).accepted);  // what it needs is not known yet
    CHECK(station.latest("released")->status == Status::ok);
    station.gateway.pass(in_s(61.0), station.stages);
    CHECK(station.latest("released")->status == Status::pending);
    CHECK_THAT(station.latest("released")->evidence,
               Catch::Contains("taken back from the uplink") &&
                   Catch::Contains("leaves at " + day_of_year_text(in_s(120.0)) + " by DSS-34"));
    tell_room(station, true, in_s(110.0));
    CHECK(station.gateway.take_uplinks().empty());

    SECTION("nothing speaks against it") {
        station.gateway.pass(in_s(120.0), station.stages);
        CHECK(station.gateway.take_uplinks().size() == 1);
        CHECK(station.latest("released")->status == Status::ok);
        CHECK_THAT(station.latest("radiated")->evidence, Catch::Contains("left DSS-34"));
    }
    SECTION("one does not hold any more") {
        station.hear(packet_of("EdlStatus", {}), true, in_s(119.0));  // no parameters on board
        station.gateway.pass(in_s(120.0), station.stages);
        CHECK(station.gateway.take_uplinks().empty());
        CHECK(station.latest("released")->status == Status::failed);
        CHECK_THAT(station.latest("released")->evidence,
                   Catch::Contains("must not be sent now") && Catch::Contains("parameters_received"));
    }
    SECTION("it is cancelled meanwhile") {
        Request cancel;
        cancel.action = "cancel";
        cancel.number = 1;
        CHECK(station.gateway.submit(cancel, in_s(100.0), station.stages).accepted);
        CHECK(station.latest("released")->status == Status::failed);
        station.gateway.pass(in_s(120.0), station.stages);
        CHECK(station.gateway.take_uplinks().empty());
    }
}

TEST_CASE("what was not acknowledged before a gap is not radiated again when it must not be sent any more",
          "[gateway][tracking][R23][R44]") {
    Station station{.passes = with_a_gap()};
    REQUIRE(station.send(do_edl()).accepted);
    CHECK(station.gateway.take_uplinks().size() == 1);
    station.gateway.pass(in_s(100.0), station.stages);
    station.hear(packet_of("EdlStatus", {}), true, in_s(119.0));  // no parameters on board
    station.stages.clear();
    station.gateway.pass(in_s(120.0), station.stages);
    REQUIRE(station.latest("radiated") != nullptr);
    CHECK_THAT(station.latest("radiated")->evidence,
               Catch::StartsWith("not acknowledged, and not radiated again") && Catch::Contains("parameters_received"));
    // What goes out instead tells the vehicle the sequence anew, and carries no command.
    for (const auto& unit : station.gateway.take_uplinks()) {
        std::vector<std::uint8_t> information(cltu_information_octets_max);
        const auto octets = read_cltu(unit, information);
        REQUIRE(octets);
        const auto frame = read_tc_frame(std::span{information}.first(*octets));
        REQUIRE(frame);
        CHECK(frame->header.control);
    }
}

TEST_CASE("of a command that waits it is said in fields what for, not in words alone", "[gateway][R44]") {
    Station station{.second_person = {"NO_OP"}};
    auto asked = request("NO_OP");
    asked.controller = "Ann";
    asked.hold = true;
    REQUIRE(station.send(asked).accepted);
    CHECK(station.latest("released")->held);
    CHECK(station.latest("released")->needs_approval);
    CHECK(station.latest("released")->asked_by == "Ann");
    Request action;
    action.number = 1;
    action.controller = "Ben";
    action.action = "approve";
    REQUIRE(station.send(action).accepted);
    CHECK(station.latest("released")->held);
    CHECK_FALSE(station.latest("released")->needs_approval);
    action.action = "release";
    REQUIRE(station.send(action).accepted);
    CHECK(station.latest("released")->status == Status::ok);
    CHECK_FALSE(station.latest("released")->held);
}

}  // namespace commands_command_gateway_test
