// SPDX-License-Identifier: Apache-2.0
#include "simulation/limits.hpp"

#include "flight/computer.hpp"
#include "flight/timeline/timepoint.hpp"
#include "telemetry/packet_stream.hpp"
#include "tests/simulation/gale.hpp"
#include "tests/simulation/judged.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/telecommands.hpp"

#include <cstdio>
#include <memory>
#include <random>
#include <string>
#include <vector>

namespace simulation_reset_table_test {

// A reset of the prime computer at any moment: the outcome that the rule foretells, and the one that was flown. The
// rules and the table are in docs/second_chance.md.
using namespace aeolis;
using namespace aeolis::simulation;

namespace {

/// When the reset comes, in the words of the rules.
struct Moment {
    double before_separation_s = 0.0;  ///< from the cruise stage, by the plan
    bool separated = false;            ///< it was fired
    bool touchdown = false;            ///< declared on board
    bool bridle_cut = false;
    double since_flyaway_s = -1.0;  ///< since fly-away started; below 0: not yet
};

constexpr double hold_s = 2.0;            // devices hold their last command for so long [facts-l]
constexpr double thrown_far_s = 2.0;      // flown: with hold_s more the stage has burnt long enough to fall clear
constexpr double repeated_rows_s = 10.0;  // ours: what the rows that a restart goes back over may take, replies and all

struct Expected {
    int rule;
    Verdict verdict;
};

/// The rules, written before the runs, but for the bound of the fifth.
Expected expected(const Moment& at) {
    // Prime starts anew and goes on, in time for separation or late for it.
    if (at.before_separation_s > flight::restart_s + repeated_rows_s) return {1, Verdict::landed};
    if (!at.separated) return {2, Verdict::landed};
    if (!at.touchdown) return {3, Verdict::landed};  // Second Chance takes over
    if (!at.bridle_cut) return {4, Verdict::lost};   // nobody may act: the stage comes down with the rover on it
    if (at.since_flyaway_s < thrown_far_s) return {5, Verdict::lost};  // the stage falls where it stands
    return {6, Verdict::landed};                                       // it is away
}

struct Reset {
    std::string name;
    Moment at;
    Judgement judgement;
    std::string reason;
};

/// A commanded landing that is forked at each moment asked for, so that what comes before is flown once.
class Resets {
  public:
    explicit Resets(double start_before_entry_s) : trunk_(tests::gale_scenario(start_before_entry_s), 1) {
        trunk_.uplink(test::set_parameters(trunk_.solution()));
        for (int cycle = 0; cycle < 64; ++cycle) step();
        trunk_.uplink(test::enable_second_chance());
        trunk_.uplink(test::do_edl());
        for (int cycle = 0; cycle < 64; ++cycle) step();
    }
    bool flying() const { return trunk_.outcome() == Outcome::running; }
    const Landing& trunk() const { return trunk_; }

    void step() {
        const CycleReport& report = trunk_.step();
        fired_.clear();
        telemetry::PacketStream packets{report.recorded};
        while (const auto packet = packets.next()) {
            const auto header = read_tm_packet(*packet);
            if (header->primary.apid != flight::packet::TimepointFired::apid) continue;
            const TimepointId id{static_cast<std::uint16_t>(read_bits(*packet, tm_data_offset_octets * 8, 16))};
            fired_.push_back(id);
            if (id == flight::timepoint::cruise_stage_separation) at_.separated = true;
            if (id == flight::timepoint::touchdown) at_.touchdown = true;
            if (id == flight::timepoint::bridle_cut) at_.bridle_cut = true;
            if (id == flight::timepoint::flyaway) flyaway_ = trunk_.sclk();
        }
    }
    /// Timepoints that fired in the last cycle.
    const std::vector<TimepointId>& fired() const { return fired_; }

    Reset reset_now(std::string name) const {
        Landing fork{trunk_};
        Reset reset{std::move(name), at_, {}, {}};
        reset.at.before_separation_s =
            *flight::anchor_specs[flight::anchor::cruise_stage_separation.value].offset_s - fork.truth().e_s;
        if (flyaway_) reset.at.since_flyaway_s = trunk_.sclk() - *flyaway_;
        fork.reset_prime();
        while (fork.outcome() == Outcome::running) fork.step();
        reset.judgement = tests::judged_held_up(fork);
        reset.reason = reason_of(fork, reset.judgement);
        return reset;
    }

  private:
    Landing trunk_;
    Moment at_;
    std::optional<Sclk> flyaway_;
    std::vector<TimepointId> fired_;
};

void check(const Reset& reset) {
    INFO("reset " << reset.name << ": " << reset.reason);
    CHECK(name_of(reset.judgement.verdict) == std::string{name_of(expected(reset.at).verdict)});
}

/// A line of the table, as docs/second_chance.md has it.
void print(const Reset& reset, double e_s) {
    const std::string exceeded = text_of(reset.judgement.exceeded);
    std::printf("| %s | %.2f | %d | %s | %s%s%s |\n", reset.name.c_str(), e_s, expected(reset.at).rule,
                name_of(expected(reset.at).verdict), name_of(reset.judgement.verdict), exceeded.empty() ? "" : ": ",
                exceeded.c_str());
}

}  // namespace

TEST_CASE("a reset just after any of every sixth timepoint ends as the rule says", "[second_chance][R32][R33]") {
    Resets resets{900.0};
    int boundaries = 0;
    while (resets.flying()) {
        resets.step();
        for (const TimepointId id : resets.fired())
            if (id.value % 6 == 0 && ++boundaries <= 20) check(resets.reset_now(flight::timeline_specs[id.value].name));
    }
    CHECK(boundaries >= 8);
}

TEST_CASE("the table of resets: at every boundary of a timepoint and at 200 random cycles",
          "[.long][second_chance][R32][R33]") {
    std::mt19937 random{2012};
    std::vector<double> at_random(200);
    // Every tenth in the last twenty seconds, in which the outcome changes.
    for (std::size_t i = 0; i < at_random.size(); ++i) {
        const double part = static_cast<double>(random()) / 4294967296.0;
        at_random[i] = i % 10 == 0 ? 420.0 + 20.0 * part : -880.0 + 1320.0 * part;
    }
    std::sort(at_random.begin(), at_random.end());

    for (const double start_before_entry_s : {17000.0, 900.0}) {
        Resets resets{start_before_entry_s};
        std::size_t next = 0;
        while (resets.flying()) {
            resets.step();
            const double e_s = resets.trunk().truth().e_s;
            for (const TimepointId id : resets.fired()) {
                const Reset reset = resets.reset_now(flight::timeline_specs[id.value].name);
                print(reset, e_s);
                check(reset);
            }
            if (start_before_entry_s > 900.0) {
                if (e_s > -10700.0) break;  // what follows is the other run's
                continue;
            }
            for (; next < at_random.size() && at_random[next] <= e_s; ++next) {
                const Reset reset = resets.reset_now("at random");
                print(reset, e_s);
                check(reset);
            }
        }
        if (start_before_entry_s == 900.0) CHECK(next == at_random.size());
    }
}

}  // namespace simulation_reset_table_test
