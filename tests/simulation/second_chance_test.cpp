// SPDX-License-Identifier: Apache-2.0
#include "simulation/limits.hpp"

#include "flight/computer.hpp"
#include "flight/timeline/timepoint.hpp"
#include "generated/dictionary_flight.hpp"
#include "telemetry/packet_stream.hpp"
#include "tests/simulation/gale.hpp"
#include "tests/simulation/judged.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"
#include "tests/support/telecommands.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace simulation_second_chance_test {

using namespace aeolis;
using namespace aeolis::simulation;

namespace {

constexpr double light = 1.0;             // s between what a test asks for and what must have been answered
constexpr double repeated_rows_s = 10.0;  // ours: what the rows that a restart goes back over may take, replies and all

/// What a recording says of restarts and of Second Chance.
struct Recorded {
    std::map<std::uint16_t, std::vector<Sclk>> events;
    std::vector<std::pair<std::uint16_t, Sclk>> firings;
    std::vector<Sclk> navigation;
    std::vector<std::uint8_t> tones;
    std::map<std::pair<std::string, Sclk>, int> statements;  ///< of each packet with channels and time

    explicit Recorded(const Landing& landing) {
        telemetry::PacketStream packets{landing.recording()};
        while (const auto packet = packets.next()) {
            const auto header = read_tm_packet(*packet);
            if (!header) continue;
            const Apid apid = header->primary.apid;
            const auto field = [&](unsigned bits) { return read_bits(*packet, tm_data_offset_octets * 8, bits); };
            if (apid == flight::evr::EDL_BEGUN::apid)
                events[static_cast<std::uint16_t>(field(16))].push_back(header->time);
            if (apid == flight::packet::TimepointFired::apid)
                firings.emplace_back(static_cast<std::uint16_t>(field(16)), header->time);
            if (apid == flight::packet::GncNavigation::apid) navigation.push_back(header->time);
            if (const auto* of_channels = packet_with_channels(apid)) ++statements[{of_channels->name, header->time}];
            if (apid == flight::packet::ToneSelected::apid) tones.push_back(static_cast<std::uint8_t>(field(8)));
        }
    }
    static const dictionary::Packet* packet_with_channels(Apid apid) {
        const auto& packets = tests::shipped_dictionary().packets;
        const auto found = std::ranges::find_if(packets, [&](const dictionary::Packet& packet) {
            return packet.apid == apid && std::ranges::any_of(packet.fields, [](const dictionary::Field& field) {
                       return field.channel.has_value();
                   });
        });
        return found == packets.end() ? nullptr : &*found;
    }
    std::ptrdiff_t fired(TimepointId id) const {
        return std::ranges::count(firings, id.value, &std::pair<std::uint16_t, Sclk>::first);
    }
    template <typename Evr>
    std::vector<Sclk> times() const {
        const auto found = events.find(Evr::id.value);
        return found == events.end() ? std::vector<Sclk>{} : found->second;
    }
};

/// The computer that reported an event last: B counts its packets in the upper half of the 14 bits, and reports too few
/// events to leave it.
template <typename Evr>
std::optional<flight::String> reported_by(const Landing& landing) {
    std::optional<flight::String> by;
    telemetry::PacketStream packets{landing.recording()};
    while (const auto packet = packets.next()) {
        const auto header = read_tm_packet(*packet);
        if (!header || header->primary.apid != Evr::apid) continue;
        if (read_bits(*packet, tm_data_offset_octets * 8, 16) != Evr::id.value) continue;
        by = header->primary.count < 0x2000 ? flight::String::a : flight::String::b;
    }
    return by;
}

void fly_on(Landing& landing, double for_s) {
    for (double flown_s = 0.0; flown_s < for_s; flown_s += seconds_per_tick) landing.step();
}

/// By the scenario's limits: what lands outside of them has not passed.
Verdict verdict_on(Landing& landing) {
    while (landing.outcome() == Outcome::running) landing.step();
    const Judgement judgement = tests::judged_held_up(landing);
    UNSCOPED_INFO(reason_of(landing, judgement));
    return judgement.verdict;
}

struct Commanded {
    Landing landing;
    explicit Commanded(double start_before_entry_s, bool second_chance = true)
        : landing(tests::gale_scenario(start_before_entry_s), 1) {
        landing.uplink(test::set_parameters(landing.solution()));
        fly(light);
        if (second_chance) landing.uplink(test::enable_second_chance());
        landing.uplink(test::do_edl());
        fly(light);
    }
    void fly(double for_s) { fly_on(landing, for_s); }
    void fly_to(double e_s) {
        while (landing.truth().e_s < e_s) landing.step();
    }
    Verdict verdict() { return verdict_on(landing); }
};

}  // namespace

TEST_CASE("a reset in guided entry: Second Chance flies within a second, with its own tones, and lands",
          "[second_chance][R1][R33][R35]") {
    Commanded run{900.0};
    run.fly_to(120.0);
    const Sclk reset = run.landing.sclk();
    run.landing.reset_prime();
    REQUIRE(run.verdict() == Verdict::landed);
    const Recorded recorded{run.landing};
    REQUIRE(recorded.times<flight::evr::SECOND_CHANCE_TAKES_OVER>().size() == 1);
    CHECK(recorded.times<flight::evr::SECOND_CHANCE_TAKES_OVER>()[0] - reset <= 1.0);
    double longest_gap_s = 0.0;
    for (std::size_t i = 1; i < recorded.navigation.size(); ++i)
        if (recorded.navigation[i] > reset)
            longest_gap_s = std::max(longest_gap_s, recorded.navigation[i] - recorded.navigation[i - 1]);
    CHECK(longest_gap_s <= 1.0);
    bool handed_over = false;
    for (const std::uint8_t tone : recorded.tones) {
        const bool of_second_chance = tone >= flight::tone::sc_computer_started.value;
        CHECK(of_second_chance >= handed_over);  // never again one of prime's
        handed_over |= of_second_chance;
    }
    CHECK(std::ranges::count(recorded.tones, flight::tone::sc_touchdown.value) == 1);
    CHECK(recorded.times<flight::evr::SECOND_CHANCE_OFF>().size() == 1);
    CHECK(recorded.times<flight::evr::PRIME_STANDS_BY>().size() == 1);
}

TEST_CASE("a channel is of one computer at any time: both speak at once, one takes over, the other starts again on a "
          "whole second",
          "[second_chance][R29][R33]") {
    Commanded run{900.0};
    run.fly_to(120.0);
    while (at_resolution(run.landing.sclk(), 1) != run.landing.sclk()) run.landing.step();
    const Sclk reset = run.landing.sclk();
    run.landing.reset_prime();
    run.fly(60.0);
    const Recorded recorded{run.landing};
    REQUIRE(recorded.times<flight::evr::SECOND_CHANCE_TAKES_OVER>().size() == 1);
    REQUIRE(recorded.times<flight::evr::PRIME_STANDS_BY>().size() == 1);
    std::map<std::string, int> packets;
    for (const auto& [said, times] : recorded.statements) {
        INFO(said.first << " at " << said.second.seconds);
        CHECK(times == 1);
        ++packets[said.first];
    }
    const auto silent_s = static_cast<int>(recorded.times<flight::evr::PRIME_STANDS_BY>()[0] - reset);
    CHECK(packets["CommStatusB"] == packets["CommStatus"] + silent_s);
    CHECK(packets["SyncStatusB"] == packets["SyncStatus"] + silent_s);
}

TEST_CASE(
    "a heatshield that both controllers deny is borne out to the computer that has taken over meanwhile, and it lands",
    "[second_chance][faults][R33][R50]") {
    Commanded run{900.0};
    run.fly_to(255.0);  // the mortar is fired; the heatshield goes twenty seconds later
    while (Recorded{run.landing}.fired(flight::timepoint::radar_power) == 0) run.fly(light);
    for (const auto unit : {flight::Unit::a, flight::Unit::b})
        run.landing.inject(DeviceFault{flight::Device::pyro, unit, DeviceFault::Kind::denies, 0.0, 30.0});
    while (Recorded{run.landing}.fired(flight::timepoint::heatshield_separation) == 0) run.fly(light);
    REQUIRE(Recorded{run.landing}.times<flight::evr::TIMEPOINT_WITNESSED>().empty());
    run.landing.reset_prime();
    CHECK(run.verdict() == Verdict::landed);
    const Recorded recorded{run.landing};
    CHECK(recorded.times<flight::evr::SECOND_CHANCE_TAKES_OVER>().size() == 1);
    CHECK(recorded.times<flight::evr::TIMEPOINT_REFUSED>().size() == 1);
    CHECK(recorded.times<flight::evr::TIMEPOINT_WITNESSED>().size() == 1);
}

TEST_CASE("after a take-over only essential timepoints act", "[second_chance][R33]") {
    Commanded run{900.0};
    run.fly_to(120.0);  // before the antenna of the parachute phase is selected, which is not essential
    run.landing.reset_prime();
    while (run.landing.truth().e_s < 270.0) run.landing.step();
    const Recorded recorded{run.landing};
    CHECK(recorded.times<flight::evr::SECOND_CHANCE_TAKES_OVER>().size() == 1);
    CHECK(recorded.times<flight::evr::PARACHUTE_DEPLOY>().size() == 1);
    CHECK(recorded.times<flight::evr::PARACHUTE_ANTENNA_SELECTED>().empty());
    CHECK(recorded.fired(flight::timepoint::parachute_antenna) == 1);  // passed over, and said so
}

TEST_CASE("a reset that ground did not provide for is not survived, and Second Chance stays still",
          "[second_chance][R34]") {
    Commanded run{900.0, false};
    run.fly_to(120.0);
    run.landing.reset_prime();
    CHECK(run.verdict() == Verdict::lost);
    const Recorded recorded{run.landing};
    CHECK(recorded.times<flight::evr::SECOND_CHANCE_TAKES_OVER>().empty());
}

TEST_CASE("without a reset Second Chance watches, and turns itself off at touchdown", "[second_chance][R1][R34]") {
    Commanded run{900.0};
    REQUIRE(run.verdict() == Verdict::landed);
    const Recorded recorded{run.landing};
    CHECK(recorded.times<flight::evr::SECOND_CHANCE_ENABLED>().size() == 1);
    CHECK(recorded.times<flight::evr::SECOND_CHANCE_TAKES_OVER>().empty());
    REQUIRE(recorded.times<flight::evr::SECOND_CHANCE_OFF>().size() == 1);
    REQUIRE(recorded.times<flight::evr::TOUCHDOWN>().size() == 1);
    CHECK(recorded.times<flight::evr::SECOND_CHANCE_OFF>()[0] - recorded.times<flight::evr::TOUCHDOWN>()[0] < 0.1);
}

TEST_CASE("a reset in pre-EDL: prime starts anew, goes back over the named timepoints and repeats their actions",
          "[second_chance][R32]") {
    Commanded run{17000.0};
    run.fly(20.0);  // the first has fired, the second waits for its moment
    run.landing.reset_prime();
    run.fly(60.0);
    const Recorded recorded{run.landing};
    CHECK(recorded.times<flight::evr::TIMELINE_BACKTRACKED>().size() == 1);
    CHECK(recorded.times<flight::evr::DESCENT_IMU_POWERED>().size() == 2);
    CHECK(recorded.times<flight::evr::EDL_HEATERS_ON>().empty());  // not before E-3 h
    CHECK(recorded.times<flight::evr::COMPUTER_STARTED>().size() == 1);
    CHECK(recorded.times<flight::evr::SECOND_CHANCE_TAKES_OVER>().empty());

    Commanded in_between{17000.0};
    in_between.fly(2.0);  // the first was commanded a moment ago
    in_between.landing.reset_prime();
    in_between.fly(60.0);
    const Recorded repeated{in_between.landing};
    REQUIRE(repeated.times<flight::evr::TIMELINE_BACKTRACKED>().size() == 1);
    CHECK(repeated.times<flight::evr::DESCENT_IMU_POWERED>().size() == 2);
    CHECK(repeated.fired(flight::timepoint::catbed_heaters) == 0);
    CHECK(repeated.times<flight::evr::PRIME_STANDS_BY>().empty());
}

TEST_CASE("ground designates the other computer prime: both start anew, and it is the one that lands",
          "[second_chance][R1]") {
    Landing landing{tests::gale_scenario(1200.0), 1};
    landing.uplink(test::set_parameters(landing.solution()));
    fly_on(landing, light);
    landing.uplink(test::select_prime_b());
    fly_on(landing, 60.0);
    CHECK(landing.counters().resets == 2);
    landing.uplink(test::do_edl());  // parameters were kept over the restart
    CHECK(verdict_on(landing) == Verdict::landed);
    const Recorded recorded{landing};
    CHECK(recorded.times<flight::evr::PRIME_DESIGNATED>().size() == 1);
    CHECK(recorded.times<flight::evr::EDL_BEGUN>().size() == 1);
    CHECK(reported_by<flight::evr::PRIME_DESIGNATED>(landing) == flight::String::a);
    CHECK(reported_by<flight::evr::EDL_BEGUN>(landing) == flight::String::b);
    CHECK(reported_by<flight::evr::TOUCHDOWN>(landing) == flight::String::b);
}

TEST_CASE("prime cannot be designated once EDL has begun", "[second_chance][R1]") {
    Commanded run{900.0};
    run.landing.uplink(test::select_prime_b());
    run.fly(5.0);
    CHECK(run.landing.counters().resets == 0);
    const Recorded recorded{run.landing};
    CHECK(recorded.times<flight::evr::PRIME_DESIGNATED>().empty());
    CHECK(recorded.times<flight::evr::COMMAND_REFUSED>().size() == 1);
}

TEST_CASE("around cruise-stage separation a reset finds one of the two ready, whichever it is",
          "[second_chance][R32][R33]") {
    Commanded run{900.0};
    const double separation_s = *flight::anchor_specs[flight::anchor::cruise_stage_separation.value].offset_s;
    for (const double before_s : {31.0, 15.0, 2.0 / 64, 1.0 / 64, 0.0, -1.0 / 64, -0.25, -1.0}) {
        const double e_s = separation_s - before_s;
        run.fly_to(e_s);
        Commanded fork{run};
        fork.landing.reset_prime();
        fork.fly(60.0);
        const Recorded recorded{fork.landing};
        const auto took_over = recorded.times<flight::evr::SECOND_CHANCE_TAKES_OVER>().size();
        const auto stands_by = recorded.times<flight::evr::PRIME_STANDS_BY>().size();
        INFO("reset at E" << e_s << " s: took over " << took_over << ", prime stands by " << stands_by);
        CHECK(took_over == stands_by);  // exactly one of them flies
        // Ground's time of entry, from which flight counts, is not the truth's to the tick.
        if (before_s > 0.5) CHECK(took_over == 0);
        if (before_s < -0.5) CHECK(took_over == 1);
    }
}

TEST_CASE("the end of pre-EDL is fault protection's alone: prime starts anew before it and after it",
          "[second_chance][R24][R32]") {
    Commanded run{14500.0};
    for (const double e_s : {-14431.0, -14410.0, -14399.0}) {
        run.fly_to(e_s);
        Commanded fork{run};
        fork.landing.reset_prime();
        fork.fly(60.0);
        const Recorded recorded{fork.landing};
        INFO("reset at E" << e_s << " s");
        CHECK(recorded.times<flight::evr::COMPUTER_STARTED>().size() == 1);
        CHECK(recorded.times<flight::evr::TIMELINE_BACKTRACKED>().size() == 1);
        CHECK(recorded.times<flight::evr::PRIME_STANDS_BY>().empty());
        CHECK(recorded.times<flight::evr::SECOND_CHANCE_TAKES_OVER>().empty());
    }
}

TEST_CASE("up to cruise-stage separation prime goes on by itself after a reset at any row, without Second Chance",
          "[second_chance][R32]") {
    Commanded run{900.0, false};
    for (std::size_t row = 0; row < flight::timepoint::cruise_stage_separation.value; ++row) {
        const TimepointId id{static_cast<std::uint16_t>(row)};
        while (Recorded{run.landing}.fired(id) == 0) run.fly(1.0);
        Commanded fork{run};
        fork.landing.reset_prime();
        INFO("reset at E" << run.landing.truth().e_s << " s, after " << flight::timeline_specs[row].name);
        fork.fly_to(-530.0);
        const Recorded recorded{fork.landing};
        CHECK(recorded.times<flight::evr::COMPUTER_STARTED>().size() == 1);
        CHECK(recorded.times<flight::evr::PRIME_STANDS_BY>().empty());
        CHECK(recorded.times<flight::evr::CRUISE_STAGE_SEPARATION>().size() == 1);
        CHECK(recorded.times<flight::evr::GNC_ENABLED>().size() == 1);
        const std::uint16_t next = flight::timeline_specs[row + 1].backtrack->value;
        CHECK(recorded.fired(TimepointId{next}) == (next <= row ? 2 : 1));
    }
}

TEST_CASE("a reset within one restart time of separation: prime separates late by as much, and lands",
          "[second_chance][R32]") {
    Commanded run{900.0};
    const double separation_s = *flight::anchor_specs[flight::anchor::cruise_stage_separation.value].offset_s;
    for (const double before_s : {31.0, 9.0, 0.5}) {
        run.fly_to(separation_s - before_s);
        Commanded fork{run};
        fork.landing.reset_prime();
        INFO("reset " << before_s << " s before separation");
        CHECK(fork.verdict() == Verdict::landed);
        const Recorded recorded{fork.landing};
        CHECK(recorded.times<flight::evr::SECOND_CHANCE_TAKES_OVER>().empty());
        const auto separated = recorded.times<flight::evr::CRUISE_STAGE_SEPARATION>();
        REQUIRE(separated.size() == 1);
        const double late_s = separated[0] - (fork.landing.solution().entry + separation_s);
        CHECK(late_s >= std::max(0.0, flight::restart_s - before_s));
        CHECK(late_s <= flight::restart_s - before_s + repeated_rows_s);
    }
}

TEST_CASE("a second reset while separation is overdue is Second Chance's: it separates and lands",
          "[second_chance][R32][R33]") {
    Commanded run{900.0};
    run.fly_to(-604.0);
    run.landing.reset_prime();
    run.fly(flight::restart_s + 3.0);  // attitude has come from the star scanner again
    run.landing.reset_prime();
    CHECK(run.verdict() == Verdict::landed);
    const Recorded recorded{run.landing};
    CHECK(recorded.times<flight::evr::SECOND_CHANCE_TAKES_OVER>().size() == 1);
    CHECK(recorded.times<flight::evr::PRIME_STANDS_BY>().size() == 1);
}

TEST_CASE("from stand-by ground orders prime on: in the quiet coast it lands, and its tones and channels are back",
          "[second_chance][R32]") {
    Commanded run{900.0, false};
    run.fly_to(-430.0);
    run.landing.reset_prime();
    run.fly(flight::restart_s + 10.0);
    Commanded left_alone{run};
    run.landing.uplink(test::resume_prime());
    CHECK(run.verdict() == Verdict::landed);
    const Recorded recorded{run.landing};
    CHECK(recorded.times<flight::evr::PRIME_STANDS_BY>().size() == 1);
    REQUIRE(recorded.times<flight::evr::PRIME_RESUMES>().size() == 1);
    CHECK(recorded.times<flight::evr::COMMAND_EXECUTED>().size() == 3);
    CHECK(std::ranges::count(recorded.tones, flight::tone::computer_started.value) == 1);
    CHECK(std::ranges::count(recorded.tones, flight::tone::touchdown.value) == 1);
    CHECK(recorded.navigation.back() > recorded.times<flight::evr::PRIME_RESUMES>()[0]);

    CHECK(left_alone.verdict() == Verdict::lost);
}

TEST_CASE("prime is not ordered on while it flies, nor while Second Chance does", "[second_chance][R32][R34]") {
    Commanded run{900.0};
    const auto refused = [](Landing& landing) {
        landing.uplink(test::resume_prime());
        fly_on(landing, 2.0);
        const Recorded recorded{landing};
        CHECK(recorded.times<flight::evr::PRIME_RESUMES>().empty());
        CHECK(recorded.times<flight::evr::COMMAND_REFUSED>().size() == 1);
    };
    run.fly_to(-430.0);
    Commanded flies{run};
    refused(flies.landing);
    run.landing.reset_prime();
    run.fly(flight::restart_s + 10.0);
    refused(run.landing);
    CHECK(run.verdict() == Verdict::landed);
}

TEST_CASE("do edl is refused while the computers are about to change roles", "[second_chance][R1][R23]") {
    Landing landing{tests::gale_scenario(1200.0), 1};
    landing.uplink(test::set_parameters(landing.solution()));
    fly_on(landing, light);
    landing.uplink(test::select_prime_b());
    landing.uplink(test::do_edl());
    fly_on(landing, 60.0);
    const Recorded recorded{landing};
    CHECK(recorded.times<flight::evr::PRIME_DESIGNATED>().size() == 1);
    CHECK(recorded.times<flight::evr::EDL_BEGUN>().empty());
    CHECK(recorded.times<flight::evr::COMMAND_REFUSED>().size() == 1);
    CHECK(landing.counters().resets == 2);
    landing.uplink(test::do_edl());
    fly_on(landing, 5.0);
    const Recorded after{landing};
    CHECK(after.times<flight::evr::EDL_BEGUN>().size() == 1);
    CHECK(after.times<flight::evr::PRIME_STANDS_BY>().empty());
}

}  // namespace simulation_second_chance_test
