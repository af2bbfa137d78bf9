// SPDX-License-Identifier: Apache-2.0
#include "common/time.hpp"
#include "generated/dictionary_flight.hpp"
#include "simulation/landing.hpp"
#include "telemetry/explanation.hpp"
#include "telemetry/packet_stream.hpp"
#include "tests/simulation/gale.hpp"
#include "tests/simulation/judged.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"
#include "tests/support/telecommands.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace simulation_explained_faults_test {

// What a landing with faults explains, held against what the same landing recorded. R38, R50
using namespace aeolis;
using namespace aeolis::simulation;
using flight::Device;
using flight::Unit;
using Kind = DeviceFault::Kind;

namespace {

/// What was recorded, by the ground's own decoder.
class Recorded {
  public:
    explicit Recorded(std::span<const std::uint8_t> octets) {
        telemetry::PacketStream packets{octets};
        while (const auto packet = packets.next()) {
            if (const auto fault = decommutator_.decode(*packet, decoded_)) FAIL("a packet that ground cannot read");
            take();
        }
    }
    struct Told {
        double sclk = 0.0;
        telemetry::Explanation explanation;
    };
    /// Of decisions that only faults cause.
    const std::vector<Told>& of_faults() const { return of_faults_; }

    double triggered(const std::string& timepoint) const { return triggered_.at(timepoint); }
    /// The field of an event that was told in that tick.
    double of_event(const std::string& event, double sclk) const { return events_.at({event, sclk}); }
    /// A channel at or before an instant, and at or after it.
    double before(const std::string& channel, double sclk) const {
        const auto after = samples_.at(channel).upper_bound(sclk);
        REQUIRE(after != samples_.at(channel).begin());
        return std::prev(after)->second;
    }
    double after(const std::string& channel, double sclk) const {
        const auto after = samples_.at(channel).lower_bound(sclk);
        REQUIRE(after != samples_.at(channel).end());
        return after->second;
    }
    /// The largest and least of a channel in the time around an instant in which its samples may stand for it.
    std::pair<double, double> around(const std::string& channel, double sclk) const {
        const auto& samples = samples_.at(channel);
        constexpr double apart_s = 0.125;  // two samples of 16 Hz
        double low = INFINITY, high = -INFINITY;
        for (auto at = samples.lower_bound(sclk - apart_s); at != samples.end() && at->first <= sclk + apart_s; ++at) {
            low = std::min(low, at->second);
            high = std::max(high, at->second);
        }
        return {low, high};
    }

  private:
    void take() {
        const auto& layout = dictionary_.packets[decoded_.packet];
        const double sclk = decoded_.header.time.seconds;
        const auto value = [&](const char* field) {
            const auto index = telemetry::field_index(layout, field);
            return index ? decoded_.value[*index].value_or(NAN) : NAN;
        };
        if (layout.name == "Explanation") {
            auto told = *telemetry::explain(dictionary_, decoded_);
            if ((told.decision == "timepoint" && told.verdict != "held") || told.decision == "device_lost" ||
                told.decision == "stand_by" || told.decision == "take_over")
                of_faults_.push_back({sclk, std::move(told)});
        } else if (layout.name == "TimepointFired") {
            triggered_[dictionary_.timeline.at(static_cast<std::size_t>(value("timepoint"))).name] =
                value("triggered_sclk");
        } else if (layout.name == "GncImu") {
            samples_["sensed_mps2"][sclk] =
                std::hypot(value("acceleration_x_mps2"), value("acceleration_y_mps2"), value("acceleration_z_mps2"));
        } else if (layout.name == "GncDescent") {
            samples_["bridle_m"][sclk] = value("bridle_m");
            samples_["thrust_command_N"][sclk] = value("thrust_command_N");
        } else if (layout.name == "GncRadar") {
            samples_["radar_locked"][sclk] = value("radar_locked");
        } else if (layout.name == "THRUSTERS_NOT_FELT") {
            events_[{layout.name, sclk}] = value("thrusters_felt");
        } else if (layout.name == "ENGINES_SILENT") {
            events_[{layout.name, sclk}] = value("engines_silent_s");
        }
    }

    const dictionary::Dictionary& dictionary_ = tests::shipped_dictionary();
    telemetry::Decommutator decommutator_{dictionary_};
    telemetry::Decoded decoded_;
    std::vector<Told> of_faults_;
    std::map<std::string, double> triggered_;
    std::map<std::pair<std::string, double>, double> events_;
    std::map<std::string, std::map<double, double>> samples_;
};

void check(const Recorded& recorded, const Recorded::Told& told) {
    const flight::Parameters p;
    const auto is = [](double value) { return Approx(value).epsilon(1.0e-6); };
    for (const auto& [quantity, value, comparison, bound, holds] : told.explanation.conditions) {
        INFO(told.sclk << " " << told.explanation.text << ": " << quantity << " " << value << " against " << bound);
        CHECK(holds);
        if (quantity == "reply_wait_s") {
            const auto& rows = tests::shipped_dictionary().timeline;
            const auto row = std::ranges::find(rows, told.explanation.subject, &dictionary::TimelineRow::name);
            REQUIRE(row != rows.end());
            CHECK(value == is(told.sclk - recorded.triggered(told.explanation.subject)));
            CHECK(bound == is(*row->reply_timeout_s));
        } else if (quantity == "sensed_mps2") {
            const auto [low, high] = recorded.around(quantity, told.sclk);
            CHECK(value >= low * 0.9);
            CHECK(value <= high * 1.1);
            CHECK(bound ==
                  is(told.explanation.subject == "parachute_deploy" ? p.parachute_felt_mps2 : p.free_fall_felt_mps2));
        } else if (quantity == "cycles_true") {
            CHECK(bound == is(std::floor(p.action_felt_cycles)));
            CHECK(value == bound);
        } else if (quantity == "radar_locked") {
            CHECK(recorded.after(quantity, told.sclk) == 1.0);
        } else if (quantity == "engines_heard") {
            // What they say is not recorded in a packet of its own; they were primed before.
            CHECK(told.sclk - recorded.triggered("engine_priming") >= 0.0);
            CHECK(told.sclk - recorded.triggered("engine_priming") < 5.0);
        } else if (quantity == "bridle_m") {
            CHECK(value >= recorded.before(quantity, told.sclk - seconds_per_tick));
            CHECK(value <= recorded.after(quantity, told.sclk + seconds_per_tick));
            CHECK(bound == is(p.bridle_felt_m));
        } else if (quantity == "thrusters_felt") {
            CHECK(value == is(recorded.of_event("THRUSTERS_NOT_FELT", told.sclk)));
            CHECK(bound == is(p.thrusters_felt_min));
        } else if (quantity == "judgements_in_a_row") {
            CHECK(bound == is(p.thrusters_unfelt_windows));
        } else if (quantity == "engines_silent_s") {
            CHECK(value == is(recorded.of_event("ENGINES_SILENT", told.sclk)));
            CHECK(bound == is(p.engines_silent_told_s));
        } else {
            FAIL("a quantity that nothing recorded is held against");
        }
    }
}

}  // namespace

TEST_CASE("what a landing with denied pyros, silent thrusters and silent engines explains is what it recorded",
          "[simulation][faults][R38][R50][release]") {
    Scenario scenario = tests::gale_scenario(900.0);
    for (const Unit unit : {Unit::a, Unit::b}) {
        scenario.device_faults.push_back({Device::pyro, unit, Kind::denies, -200.0, 400.0});
        scenario.device_faults.push_back({Device::thrusters, unit, Kind::silent, -95.0, 10.0});
        scenario.device_faults.push_back({Device::descent_engines, unit, Kind::silent, -405.0, 0.375});
    }
    Landing landing{scenario, 1};
    landing.uplink(test::set_parameters(landing.solution()));
    for (int cycle = 0; cycle < 64; ++cycle) landing.step();
    landing.uplink(test::do_edl());
    while (landing.outcome() == Outcome::running) landing.step();
    const auto judgement = tests::judged_held_up(landing, scenario.limits);
    INFO(reason_of(landing, judgement));
    CHECK(judgement.verdict == Verdict::landed);

    const Recorded recorded{landing.recording()};
    std::set<std::string> explained;
    for (const auto& told : recorded.of_faults()) {
        explained.insert(told.explanation.subject + " " + told.explanation.verdict);
        check(recorded, told);
    }
    for (const char* each :
         {"parachute_deploy refused", "parachute_deploy borne_out", "heatshield_separation refused",
          "heatshield_separation borne_out", "engine_priming borne_out", "backshell_separation borne_out",
          "rover_separation borne_out", "thrusters decided", "descent_engines decided"}) {
        INFO(each);
        CHECK(explained.contains(each));
    }
}

TEST_CASE("what a landing says of a prime that stands by and of its backup that takes over is what happened",
          "[simulation][second_chance][R33][R38]") {
    Landing landing{tests::gale_scenario(900.0), 1};
    landing.uplink(test::set_parameters(landing.solution()));
    for (int cycle = 0; cycle < 64; ++cycle) landing.step();
    landing.uplink(test::enable_second_chance());
    landing.uplink(test::do_edl());
    while (landing.truth().e_s < 100.0) landing.step();
    const double reset = landing.sclk().seconds;
    landing.reset_prime();
    while (landing.outcome() == Outcome::running) landing.step();
    CHECK(tests::judged_held_up(landing).verdict == Verdict::landed);

    const Recorded recorded{landing.recording()};
    std::map<std::string, int> decided;
    for (const auto& [sclk, explanation] : recorded.of_faults()) {
        ++decided[explanation.decision];
        for (const auto& [quantity, value, comparison, bound, holds] : explanation.conditions) {
            INFO(sclk - reset << " " << explanation.text << ": " << quantity << " " << value << " against " << bound);
            CHECK(holds);
            if (quantity == "prime_silent_s" || quantity == "state_age_s") {
                // Both are counted from what prime sent last, which was before its reset and not long before.
                CHECK(value >= sclk - reset);
                CHECK(value <= sclk - reset + 1.0);
            } else if (quantity == "cruise_stage_separated" || quantity == "separation_triggered" ||
                       quantity == "edl_enabled") {
                CHECK(value == 1.0);
                CHECK(recorded.triggered("cruise_stage_separation") < reset);
            } else if (quantity == "touchdown_declared") {
                CHECK(value == 0.0);
                CHECK(recorded.triggered("touchdown") > sclk);
            } else {
                FAIL("a quantity that nothing is held against");
            }
        }
    }
    CHECK(decided["take_over"] == 1);
    CHECK(decided["stand_by"] == 1);
}

}  // namespace simulation_explained_faults_test
