// SPDX-License-Identifier: Apache-2.0
#include "commands/encoder.hpp"
#include "server/rehearsal/scripted_landing.hpp"
#include "simulation/limits.hpp"
#include "telemetry/packet_stream.hpp"
#include "tests/simulation/gale.hpp"
#include "tests/simulation/judged.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"
#include "tests/support/telecommands.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace simulation_changed_timeline_test {

// Changes of the timeline at any moment, judged on ground and on board, and flown where they were accepted. R51
using namespace aeolis;
using namespace aeolis::simulation;
using server::ScriptedLanding;

namespace {

constexpr double start_before_entry_s = 1200.0;

/// As nominal_auto: parameters ten seconds after the start, and "do edl" twenty seconds later.
Scenario commanded(double start_s = start_before_entry_s) {
    Scenario scenario = tests::gale_scenario(start_s);
    scenario.commands.push_back({start_s - 10.0, "EDL_SET_PARAMETERS", {}, true});
    scenario.commands.push_back({start_s - 30.0, "EDL_DO_EDL", {}, false});
    return scenario;
}

/// A landing with what ground knows of it, to be forked.
struct Trunk {
    explicit Trunk(const Scenario& scenario) : landing(scenario, 1, 0, tests::shipped_dictionary()) {}

    bool flying() const { return landing.landing().outcome() == Outcome::running; }
    double e_s() const { return landing.landing().sclk() - entry; }
    void fly_until(double then_e_s) {
        while (flying() && e_s() < then_e_s) {
            landing.hear(landing.step());
            telemetry::PacketStream packets{landing.landing().report().recorded};
            while (const auto packet = packets.next())
                if (read_tm_packet(*packet)->primary.apid == flight::packet::TimepointFired::apid)
                    next = 1 + static_cast<std::size_t>(read_bits(*packet, tm_data_offset_octets * 8, 16));
        }
    }

    ScriptedLanding landing;
    Sclk entry = commanded().entry_sclk;
    std::size_t next = 0;  ///< timepoint that has not fired
};

/// Why a landing was unsafe, by the limits of its scenario; empty: it was safe.
std::string unsafe(const Landing& landing) {
    const auto judgement = tests::judged(landing, commanded().limits);
    return judgement.verdict == Verdict::landed ? "" : reason_of(landing, judgement);
}

/// Commands sent past ground, and what the vehicle made of the last.
struct OnBoard {
    Landing landing;
    bool executed = false, refused = false;
    int said_why = 0;  ///< events that name the reason

    OnBoard(const Landing& fork, const commands::Request& request) : landing(fork) { send(request); }
    void send(const commands::Request& request) {
        executed = refused = false;
        const auto& command = *tests::shipped_dictionary().command(request.command);
        const auto packet = commands::encode(command, request.arguments, 7);
        REQUIRE(packet);
        landing.uplink(test::cltu_of(*packet));
        for (int cycle = 0; cycle < 64 && !executed && !refused; ++cycle) {
            telemetry::PacketStream packets{landing.step().recorded};
            while (const auto recorded = packets.next()) read(*recorded, command.opcode);
        }
        REQUIRE(executed != refused);
    }
    void fly(double for_s) {
        for (int cycle = 0; cycle < static_cast<int>(64.0 * for_s) && flying(); ++cycle) landing.step();
    }
    bool flying() const { return landing.outcome() == Outcome::running; }
    void land() {
        while (flying()) landing.step();
    }

  private:
    void read(std::span<const std::uint8_t> packet, Opcode opcode) {
        using namespace flight;
        if (read_tm_packet(packet)->primary.apid != evr::COMMAND_EXECUTED::apid) return;
        const auto word = [&](unsigned at) { return read_bits(packet, tm_data_offset_octets * 8 + at, 16); };
        const bool ours = word(16) == opcode.value && word(32) == 7;
        executed = executed || (word(0) == evr::COMMAND_EXECUTED::id.value && ours);
        refused = refused || (word(0) == evr::COMMAND_REFUSED::id.value && ours);
        said_why +=
            word(0) == evr::ANCHOR_CHANGE_REFUSED::id.value || word(0) == evr::TIMELINE_CHANGE_REFUSED::id.value;
    }
};

double to_tick(double seconds) {
    return std::round(seconds * 64.0) / 64.0;
}

/// Before the heaters of the catalyst beds, which are the first row on the clock.
constexpr double early_start_s = 11'400.0;

/// Draws changes of every kind: of timepoints, anchors and parameters, from a tick to a thousand seconds, or anywhere
/// in the range of an argument.
class Changes {
  public:
    explicit Changes(std::uint32_t seed) : random_(seed) {}

    double part() { return static_cast<double>(random_()) / 4294967296.0; }
    /// Somewhere from after "do edl" until fly-away.
    double moment_e_s() { return -1165.0 + 1605.0 * part(); }
    /// Somewhere before that, as often in each factor of time to entry.
    double early_moment_e_s() { return -1200.0 * std::pow(early_start_s / 1200.0 - 0.01, part()); }

    commands::Request draw(const Trunk& trunk) {
        const double kind = part();
        if (kind < 0.5) return of_timepoint(part() < 0.15 ? 0 : trunk.next);
        if (kind < 0.7) return of_anchor(flight::anchor::entry, trunk.entry.seconds + difference_s());
        if (kind < 0.8) return of_other_anchor(trunk);
        return of_parameters(trunk);
    }

  private:
    double difference_s() {
        constexpr std::array scales_s{0.05, 1.0, 8.0, 60.0, 1000.0};
        return to_tick(scales_s[random_() % scales_s.size()] * (2.0 * part() - 1.0));
    }
    commands::Request of_timepoint(std::size_t from) {
        const std::size_t first = std::min(from, flight::timepoint_count - 1);
        const auto& row = tests::shipped_dictionary().timeline[first + random_() % (flight::timepoint_count - first)];
        const double minimum_s = *row.minimum_offset_s + (random_() % 4 == 0 ? difference_s() : 0.0);
        commands::Request request;
        request.command = "EDL_SET_TIMEPOINT_OFFSET";
        request.arguments = {{"timepoint", static_cast<double>(row.id.value)},
                             {"desired_offset_s", *row.desired_offset_s + difference_s()},
                             {"minimum_offset_s", minimum_s}};
        return request;
    }
    static commands::Request of_anchor(AnchorId id, double offset_s) {
        commands::Request request;
        request.command = "EDL_SET_ANCHOR_OFFSET";
        request.arguments = {{"anchor", static_cast<double>(id.value)}, {"offset_s", offset_s}};
        return request;
    }
    commands::Request of_other_anchor(const Trunk& trunk) {
        const auto& anchors = tests::shipped_dictionary().anchors;
        const auto& row = anchors[1 + random_() % (anchors.size() - 1)];
        const double base_s = row.offset_s ? *row.offset_s : trunk.landing.landing().sclk().seconds;
        return of_anchor(row.id, base_s + difference_s());
    }
    commands::Request of_parameters(const Trunk& trunk) {
        const auto known = server::solution_arguments(trunk.landing.landing().solution());
        commands::Request request;
        request.command = "EDL_SET_PARAMETERS";
        request.arguments =
            commands::fill_from_solution(*tests::shipped_dictionary().command(request.command), {}, known);
        for (const auto& argument : tests::shipped_dictionary().command(request.command)->arguments)
            if (std::ranges::find(request.arguments, argument.name, &commands::NamedValue::name) ==
                request.arguments.end())
                request.arguments.push_back({argument.name, argument.default_value.value()});
        const auto some = 1 + random_() % 3;
        for (std::uint32_t i = 0; i < some; ++i) {
            auto& [name, value] = request.arguments[1 + random_() % (request.arguments.size() - 1)];
            if (name == "entry_sclk" || name == "epoch_sclk")
                value += difference_s();
            else if (name.starts_with("position") || name.starts_with("velocity") || part() < 0.3)
                value += std::pow(10.0, 7.0 * part() - 1.0) * (part() < 0.5 ? -1.0 : 1.0);
            else
                value = anywhere(name);
        }
        return request;
    }
    /// In the valid range of an argument.
    double anywhere(const std::string& name) {
        const auto& arguments = tests::shipped_dictionary().command("EDL_SET_PARAMETERS")->arguments;
        const auto& type = std::ranges::find(arguments, name, &dictionary::Argument::name)->type;
        return *type.valid_min + (*type.valid_max - *type.valid_min) * part();
    }

    std::mt19937 random_;
};

std::string text_of(const commands::Request& request, double e_s) {
    return request.command + " " + commands::arguments_text(request.arguments) + " at E" + std::to_string(e_s);
}

/// Whether flight can judge a command without ground: a position and a target it has to take as they come.
bool is_judged_by_flight_alone(const commands::Request& request) {
    return request.command != "EDL_SET_PARAMETERS";
}

/// What became of changes that were tried.
struct Tried {
    std::size_t accepted = 0;         ///< on ground and on board
    std::size_t by_ground_alone = 0;  ///< the board refused what ground let leave
    std::size_t parameters = 0;       ///< accepted ones that set parameters
    std::size_t second = 0;           ///< accepted changes behind another
};

/// Flies each change that the board accepts, whatever ground says; parameters only if ground does too. On every other
/// such flight a second change follows, within ten seconds or two minutes.
Tried try_changes(const Scenario& scenario, std::uint32_t seed, std::size_t count, double (Changes::*moment_e_s)()) {
    Changes changes{seed}, seconds{seed + 1};
    std::vector<double> moments(count);
    for (double& moment : moments) moment = (changes.*moment_e_s)();
    std::sort(moments.begin(), moments.end());
    Trunk trunk{scenario};
    Tried tried;
    for (const double moment : moments) {
        trunk.fly_until(moment);
        if (!trunk.flying()) continue;
        auto request = changes.draw(trunk);
        INFO("seed " << seed << ": " << text_of(request, trunk.e_s()));
        request.armed = true;
        request.dry_run = true;
        const bool ground_accepts = trunk.landing.submit(request).accepted;
        const auto& command = *tests::shipped_dictionary().command(request.command);
        if (!commands::encode(command, request.arguments, 7)) {
            CHECK_FALSE(ground_accepts);  // an argument out of its range
            continue;
        }
        OnBoard board{trunk.landing.landing(), request};
        tried.accepted += ground_accepts && board.executed;
        tried.parameters += ground_accepts && board.executed && !is_judged_by_flight_alone(request);
        tried.by_ground_alone += ground_accepts && !board.executed;
        if (!board.executed || (!ground_accepts && !is_judged_by_flight_alone(request))) continue;
        std::string second;
        if (seconds.part() < 0.5) {
            board.fly((seconds.part() < 0.5 ? 10.0 : 120.0) * seconds.part());
            const auto follows = seconds.draw(trunk);
            const auto& of = *tests::shipped_dictionary().command(follows.command);
            if (board.flying() && is_judged_by_flight_alone(follows) && commands::encode(of, follows.arguments, 7)) {
                board.send(follows);
                second = text_of(follows, trunk.e_s());
                tried.second += board.executed;
            }
        }
        board.land();
        INFO("then: " << second);
        CHECK(unsafe(board.landing) == "");
    }
    trunk.fly_until(1.0e6);
    CHECK(unsafe(trunk.landing.landing()) == "");
    INFO(tried.accepted << " of " << count << " were accepted on ground and on board, " << tried.by_ground_alone
                        << " more on ground alone; " << tried.second << " second changes");
    CHECK(tried.accepted >= count / 4);
    CHECK(tried.by_ground_alone <= count / 20);
    return tried;
}

void check_changes(std::uint32_t seed, std::size_t count) {
    const Tried tried = try_changes(commanded(), seed, count, &Changes::moment_e_s);
    CHECK(tried.second >= count / 20);
    CHECK(tried.parameters > 0);
}

commands::Request entry_at(double sclk) {
    commands::Request request;
    request.command = "EDL_SET_ANCHOR_OFFSET";
    request.arguments = {{"anchor", 1.0}, {"offset_s", sclk}};
    return request;
}

}  // namespace

TEST_CASE("no change that is accepted makes an unsafe landing of a safe one: 40 of any kind at any time",
          "[timeline][R19][R51][release]") {
    check_changes(24, 40);
}

TEST_CASE("no change that is accepted makes an unsafe landing of a safe one: 2000 of any kind at any time",
          "[.long][timeline][R51]") {
    check_changes(2012, 2000);
}

TEST_CASE("no change that is accepted in the hours before entry makes an unsafe landing of a safe one, 2 of any kind",
          "[timeline][R19][R51][release]") {
    try_changes(commanded(early_start_s), 3, 2, &Changes::early_moment_e_s);
}

TEST_CASE("no change that is accepted in the hours before entry makes an unsafe landing of a safe one, 200 of any kind",
          "[.long][timeline][R51]") {
    const Tried tried = try_changes(commanded(early_start_s), 2013, 200, &Changes::early_moment_e_s);
    CHECK(tried.second > 0);
    CHECK(tried.parameters > 0);
}

TEST_CASE("a vehicle to which nobody sends a command, or only what ground refuses, was not commanded",
          "[simulation][R32][R51]") {
    for (const bool refused : {false, true}) {
        Scenario scenario = tests::gale_scenario(60.0);
        if (refused) scenario.commands.push_back({50.0, "EDL_DO_EDL", {}, false});  // without parameters
        Trunk trunk{scenario};
        trunk.fly_until(1.0e6);
        CHECK(trunk.landing.script_refusals().size() == (refused ? 1 : 0));
        CHECK(trunk.landing.landing().outcome() == Outcome::not_commanded);
    }
}

TEST_CASE("a target out of reach, and a backshell altitude that leaves no room, are refused on board by themselves",
          "[timeline][R23][R51]") {
    Trunk trunk{commanded()};
    trunk.fly_until(-1000.0);
    const auto with = [&](std::string_view name, double value) {
        commands::Request request;
        request.command = "EDL_SET_PARAMETERS";
        request.arguments =
            commands::fill_from_solution(*tests::shipped_dictionary().command(request.command), {},
                                         server::solution_arguments(trunk.landing.landing().solution()));
        std::erase_if(request.arguments, [&](const auto& each) { return each.name == name; });
        request.arguments.push_back({std::string{name}, value});
        return OnBoard{trunk.landing.landing(), request}.executed;
    };
    CHECK(with("solution_id", 9.0));
    CHECK(with("target_latitude_deg", -5.6));
    CHECK(with("backshell_speed_mps", 90.0));
    CHECK_FALSE(with("target_latitude_deg", 10.0));
    CHECK_FALSE(with("target_latitude_deg", -9.0));
    CHECK_FALSE(with("target_longitude_deg", 140.0));
    CHECK_FALSE(with("target_longitude_deg", 100.0));
    CHECK_FALSE(with("backshell_speed_mps", 100.0));
}

TEST_CASE("a parachute at 433 m/s, as a sister mission had it, is within what is taken, and lands within the limits",
          "[simulation][R23][release]") {
    Scenario scenario = tests::gale_scenario(start_before_entry_s);
    scenario.commands.push_back({1190.0, "EDL_SET_PARAMETERS", {{"parachute_speed_mps", 433.0}}, true});
    scenario.commands.push_back({1170.0, "EDL_DO_EDL", {}, false});
    Trunk trunk{scenario};
    trunk.fly_until(1.0e6);
    CHECK(trunk.landing.script_refusals().empty());
    CHECK(unsafe(trunk.landing.landing()) == "");
    REQUIRE(trunk.landing.landing().parachute());
}

TEST_CASE("entry moved by 300 s is refused on ground, by a script as by a person, and past ground on board",
          "[timeline][R51]") {
    Scenario scenario = commanded();
    const Sclk late = scenario.entry_sclk + 300.0;
    scenario.commands.push_back(
        {1000.0, "EDL_SET_ANCHOR_OFFSET", {{"anchor", 1.0}, {"offset_s", late.seconds}}, false});
    scenario.commands.push_back({990.0, "EDL_SET_PARAMETERS", {{"entry_sclk", late.seconds}}, true});
    Trunk trunk{scenario};
    trunk.fly_until(-1001.0);
    CHECK(trunk.landing.script_refusals().empty());
    trunk.fly_until(-985.0);
    REQUIRE(trunk.landing.script_refusals().size() == 2);
    for (const auto& refusal : trunk.landing.script_refusals())
        CHECK_THAT(refusal, Catch::Contains("not safe on the timeline as it stands: entry would be 300"));
    const auto by_a_person = trunk.landing.submit(entry_at(late.seconds));
    CHECK_FALSE(by_a_person.accepted);
    CHECK(by_a_person.reason == trunk.landing.script_refusals().front());
    const auto in_a_file = trunk.landing.look(std::vector{entry_at(late.seconds)});
    CHECK(in_a_file.front().reason == by_a_person.reason);

    const OnBoard board{trunk.landing.landing(), entry_at(late.seconds)};
    CHECK(board.refused);
    CHECK(board.said_why == 1);
}

TEST_CASE("entry moved to a time past fires no burst of timepoints: refused, and the timeline goes on by the plan",
          "[timeline][R51]") {
    Trunk trunk{commanded()};
    trunk.fly_until(-1000.0);
    const double past = trunk.entry.seconds - 1100.0;
    CHECK_FALSE(trunk.landing.submit(entry_at(past)).accepted);
    OnBoard board{trunk.landing.landing(), entry_at(past)};
    CHECK(board.refused);
    int fired = 0;
    for (int cycle = 0; cycle < 64 * 30; ++cycle) {
        telemetry::PacketStream packets{board.landing.step().recorded};
        while (const auto packet = packets.next())
            fired += read_tm_packet(*packet)->primary.apid == flight::packet::TimepointFired::apid;
    }
    CHECK(fired == 0);
}

TEST_CASE("the touchdown anchor moved under the parachute or on the bridle is refused on ground and on board",
          "[timeline][R51]") {
    Trunk trunk{commanded()};
    for (const double e_s : {300.0, 425.0}) {
        trunk.fly_until(e_s);
        REQUIRE(trunk.flying());
        commands::Request request;
        request.command = "EDL_SET_ANCHOR_OFFSET";
        request.arguments = {{"anchor", static_cast<double>(flight::anchor::touchdown.value)},
                             {"offset_s", trunk.landing.landing().sclk().seconds}};
        request.armed = true;
        request.confirmation = request.command;
        CHECK_THAT(trunk.landing.submit(request).reason, Catch::Contains("touchdown is decided in flight"));
        const OnBoard board{trunk.landing.landing(), request};
        CHECK(board.refused);
        CHECK(board.said_why == 1);
    }
}

}  // namespace simulation_changed_timeline_test
