// SPDX-License-Identifier: Apache-2.0
#include "server/shadow/shadow.hpp"

#include "server/scenario/scenario_text.hpp"
#include "telemetry/decoded_packet.hpp"
#include "telemetry/text.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <thread>
#include <vector>

namespace server_shadow_test {

using namespace aeolis;
using namespace aeolis::server;
using namespace aeolis::server::shadow;

namespace {

simulation::Scenario shipped_scenario_of(const char* name) {
    auto scenario = scenario_from_file(std::string{AEOLIS_SOURCE_DIR "/simulation/scenarios/"} + name + ".textproto");
    REQUIRE(scenario);
    return *scenario;
}

/// The flights of a plan as if they were seventeen times as many, and up to four times as far from their mean: enough to
/// tell departures, in a test that has not the time for as many flights.
v1::KeptRequest widened(const v1::KeptRequest& of) {
    constexpr int copies = 17;
    constexpr double widest = 4.0;
    v1::KeptRequest kept = of;
    auto& ensemble = *kept.mutable_ensemble();
    ensemble.set_cases(of.ensemble().cases() * copies);
    for (auto& row : *ensemble.mutable_firings()) {
        const auto flown = std::vector<std::int32_t>{row.ticks().begin(), row.ticks().end()};
        double mean = 0.0;
        for (const auto ticks : flown) mean += ticks / static_cast<double>(flown.size());
        row.clear_ticks();
        for (int copy = 0; copy < copies; ++copy)
            for (const auto ticks : flown) {
                const double by = widest * (2.0 * copy / (copies - 1) - 1.0);
                const bool never = ticks == std::numeric_limits<std::int32_t>::min();
                row.add_ticks(never ? ticks : static_cast<std::int32_t>(std::lround(mean + by * (ticks - mean))));
            }
    }
    for (auto* range : {ensemble.mutable_altitude_m(), ensemble.mutable_speed_mps(), ensemble.mutable_range_rate_mps()})
        for (int i = 0; i + 2 < range->size(); i += 3)
            for (const int edge : {i, i + 2})
                range->Set(edge,
                           range->Get(i + 1) + static_cast<float>(widest) * (range->Get(edge) - range->Get(i + 1)));
    return kept;
}

/// A landing with ground's flight beside it, and all that this makes.
class Accompanied {
  public:
    /// @param known  what ground knows of it; null: all but its errors
    Accompanied(const simulation::Scenario& scenario, std::uint64_t seed, std::uint64_t plan_flights = 0,
                const simulation::Scenario* known = nullptr)
        : scenario_(scenario), run_(scenario, seed, 0, dictionary_),
          shadow_(known != nullptr ? *known : scenario, run_.landing().solution(), run_.landing().correlation(),
                  dictionary_, {.cases = plan_flights, .jobs = 2}),
          decoder_(dictionary_) {}

    void fly_to(double e_s) {
        while (run_.landing().sclk() < scenario_.entry_sclk + e_s && !run_.landing().flown()) step();
    }
    void step() {
        const auto& received = run_.step();
        for (const auto& packet : received.packets) {
            telemetry::DecodedPacket decoded;
            decoder_.decode(packet.octets, decoded);
            if (decoded.event != nullptr && decoded.event->level <= dictionary::EventLevel::warning_lo) ++warnings;
        }
        auto out = shadow_.hear(received, run_.landing().ert_now());
        for (auto& packet : out.packets) {
            CHECK(packet.link == telemetry::station_link);
            telemetry::DecodedPacket decoded;
            decoder_.decode(packet.octets, decoded);
            REQUIRE(decoded.refusal.empty());
            if (decoded.event != nullptr)
                events.push_back(telemetry::event_text(dictionary_, *decoded.event, decoded.content));
            note(decoded);
            made.push_back(std::move(packet.octets));
        }
        if (out.request) {
            shadow_.take(run_.cycles(), widens ? widened(*out.request) : *out.request);
            kept.push_back(std::move(*out.request));
        }
    }
    void send(const std::string& command) {
        v1::KeptRequest request;
        request.mutable_command()->set_command(command);
        REQUIRE(run_.submit(request.command()).accepted());
        shadow_.take(run_.cycles(), request);
    }
    /// Flies on slowly until the flights of the plan are made, and takes them.
    void await_plan() {
        shadow_.go_live();
        const auto before = kept.size();
        while (kept.size() == before) {
            step();
            std::this_thread::sleep_for(std::chrono::milliseconds{20});  // hardly faster than real time
        }
    }

    const std::vector<double>& values(const std::string& name) { return values_[name]; }
    const Shadow& shadow() const { return shadow_; }
    Shadow& shadow() { return shadow_; }
    Rehearsal& run() { return run_; }

    std::vector<std::vector<std::uint8_t>> made;
    std::vector<std::string> events;
    std::vector<v1::KeptRequest> kept;
    bool widens = true;                                         ///< the flights of the plan
    int warnings = 0;                                           ///< of the vehicle
    std::map<std::size_t, std::vector<ExpectedTime>> expected;  ///< by row: as said, in turn

  private:
    void note(const telemetry::DecodedPacket& decoded) {
        const auto& packet = dictionary_.packets[decoded.content.packet];
        std::map<std::string, double> now;
        for (std::size_t i = 0; i < packet.fields.size(); ++i) {
            if (!decoded.content.value[i]) continue;
            now[packet.fields[i].name] = *decoded.content.value[i];
            values_[packet.fields[i].name].push_back(*decoded.content.value[i]);
        }
        if (packet.name != "ShadowExpects" || now["expected_cases"] == 0.0) return;
        ExpectedTime time;
        time.e_s = now["expected_after_entry_s"];
        if (now["expected_interval_defined"] != 0.0)
            time.interval_99 = ExpectedTime::Interval{now["expected_from_s"], now["expected_to_s"]};
        expected[static_cast<std::size_t>(now["expected_timepoint"])].push_back(time);
    }

    const dictionary::Dictionary& dictionary_ = tests::shipped_dictionary();
    simulation::Scenario scenario_;
    Rehearsal run_;
    Shadow shadow_;
    telemetry::PacketDecoder decoder_;
    std::map<std::string, std::vector<double>> values_;
};

double largest(const std::vector<double>& values) {
    return values.empty() ? -1.0 : *std::ranges::max_element(values);
}

}  // namespace

TEST_CASE("ground's flight goes with the vehicle: it says its state each second and is moved every ten",
          "[shadow][R57][release]") {
    Accompanied flown{shipped_scenario_of("nominal_auto"), 7};
    flown.fly_to(430.0);
    CHECK(flown.values("shadow_stand").size() >= 1600);
    CHECK(largest(flown.values("shadow_stand")) == 1.0);
    CHECK(flown.values("shadow_departures").back() == 0.0);
    const auto moved = flown.values("moved_position_m").size();
    CHECK(moved > 85);  // from E−540 s on
    CHECK(moved < 100);
    CHECK(flown.values("residual_altitude_m").size() > 700);
    CHECK(flown.events.empty());
}

TEST_CASE("what ground's flight makes is the same until what is received differs, whatever is hidden",
          "[shadow][R57][release]") {
    const auto scenario = shipped_scenario_of("nominal_auto");
    auto hidden = scenario;
    hidden.system_faults.push_back({});
    hidden.device_faults.push_back({});
    hidden.system_faults.back().begin_before_entry_s = -300.0;  // at E+300 s
    hidden.device_faults.back().begin_before_entry_s = -310.0;
    hidden.device_faults.back().duration_s = 10.0;
    hidden.computer_resets.push_back({});
    hidden.computer_resets.back().before_entry_s = -320.0;
    Accompanied open{scenario, 3}, planned{hidden, 3};
    open.fly_to(290.0);
    planned.fly_to(290.0);
    CHECK(open.made.size() > 1500);
    CHECK(open.made == planned.made);
}

TEST_CASE("the plan's flights are made once the timeline runs, are kept as a request is, and expect what comes",
          "[shadow][R57][release]") {
    const auto scenario = shipped_scenario_of("nominal_auto");
    Accompanied flown{scenario, 7, 12};
    flown.fly_to(-500.0);
    CHECK(flown.kept.empty());
    CHECK_FALSE(flown.shadow().expectations().known());
    flown.await_plan();
    flown.step();
    REQUIRE(flown.kept.size() == 1);
    CHECK(flown.kept.front().ensemble().cases() == 12);
    CHECK_THAT(flown.events.back(), Catch::StartsWith("204 flights of the plan"));
    CHECK(flown.values("expected_after_entry_s").size() > 30);
    flown.fly_to(440.0);
    CHECK(flown.kept.size() == 1);
    INFO(flown.events.back());
    CHECK(flown.events.size() == 1);  // no departure
    CHECK(flown.values("plan_altitude_m").size() > 400);
    // A flight that is flown again with the same request makes the same.
    CHECK(largest(flown.values("shadow_departures")) == 0.0);
}

TEST_CASE("a parachute that does not open departs from all flights of the plan, and is told",
          "[shadow][R57][release]") {
    auto scenario = shipped_scenario_of("nominal_auto");
    for (const auto unit : {flight::Unit::a, flight::Unit::b})
        scenario.device_faults.push_back(
            {flight::Device::pyro, unit, simulation::DeviceFault::Kind::silent, -200.0, 1000.0});
    Accompanied flown{scenario, 7, 12};
    flown.fly_to(-500.0);
    flown.await_plan();
    flown.fly_to(330.0);
    std::string all;
    for (const auto& text : flown.events) all += text + "\n";
    INFO(all);
    CHECK_THAT(all, Catch::Contains("Departure: "));
    CHECK(std::ranges::count(flown.values("shadow_stand"), 2.0) > 10);
    CHECK(flown.values("shadow_departures").back() >= 1.0);
}

TEST_CASE("air much thinner than published departs by the course, though no event of the vehicle says anything",
          "[shadow][R57][release]") {
    const auto known = shipped_scenario_of("nominal_auto");
    auto thin = known;
    thin.density_scale = {{0.0, 0.6}, {130'000.0, 0.6}};
    Accompanied flown{thin, 7, 12, &known};
    flown.fly_to(-500.0);
    flown.await_plan();
    flown.fly_to(240.0);
    std::string all;
    for (const auto& text : flown.events) all += text + "\n";
    INFO(all);
    CHECK_THAT(all, Catch::Contains("Departure: "));
    CHECK(flown.warnings == 0);
}

TEST_CASE("a command that moves the landing withdraws what was expected; one that does not leaves it",
          "[shadow][R57][release]") {
    Accompanied flown{shipped_scenario_of("nominal_auto"), 7, 4};
    flown.fly_to(-790.0);
    flown.await_plan();
    flown.send("NO_OP");
    flown.step();
    CHECK(flown.shadow().expectations().known());
    v1::KeptRequest parameters;
    parameters.mutable_command()->set_command("EDL_SET_PARAMETERS");
    flown.shadow().take(flown.run().cycles(), parameters);
    flown.step();
    CHECK_FALSE(flown.shadow().expectations().known());
    CHECK_THAT(flown.events.back(), Catch::StartsWith("A command changes the plan"));
    // An ensemble of the plan before is not taken any more.
    flown.shadow().take(flown.run().cycles(), flown.kept.front());
    CHECK_FALSE(flown.shadow().expectations().known());
}

TEST_CASE("in dispersed landings that go as expected, the intervals hold 97 of 100 timepoints and more, shrink, and "
          "nothing departs",
          "[.long][long][shadow][R57]") {
    const auto scenario = shipped_scenario_of("nominal_auto");
    constexpr std::uint64_t landings = 4, plan_flights = 300;
    int fired = 0, within = 0, departures = 0, shrunk = 0, compared = 0;
    for (std::uint64_t seed = 101; seed < 101 + landings; ++seed) {
        Accompanied flown{scenario, seed, plan_flights};
        flown.widens = false;
        flown.fly_to(-500.0);
        flown.await_plan();
        flown.fly_to(460.0);
        std::string all;
        for (const auto& text : flown.events) all += text + "\n";
        INFO("seed " << seed << "\n" << all);
        departures += static_cast<int>(flown.values("shadow_departures").back());
        CHECK(flown.values("shadow_departures").back() == 0.0);
        for (const auto& [row, times] : flown.expected) {
            const auto told = flown.shadow().expectations().told(row);
            if (!told || !times.back().interval_99) continue;
            const double e_s = *told - scenario.entry_sclk;
            const auto& interval = *times.back().interval_99;
            const double tick_s = 0.5 / 64.0;
            ++fired;
            const bool is_within = e_s >= interval.from - tick_s && e_s <= interval.to + tick_s;
            within += is_within ? 1 : 0;
            if (!is_within)
                WARN(tests::shipped_dictionary().timeline[row].name << " fired at " << e_s << ", expected "
                                                                    << interval.from << " to " << interval.to);
            const auto& first = *times.front().interval_99;
            if (first.to - first.from < 1.0) continue;  // the clock's
            ++compared;
            shrunk += interval.to - interval.from <= first.to - first.from ? 1 : 0;
        }
    }
    WARN(within << " of " << fired << " timepoints within their interval; " << shrunk << " of " << compared
                << " intervals no wider at the end; " << departures << " departures");
    CHECK(fired > 25 * static_cast<int>(landings));
    CHECK(within >= 0.97 * fired);
    CHECK(shrunk == compared);
}

TEST_CASE("with light time ground's flight is where the vehicle was when it sent what arrives", "[shadow][R57]") {
    auto scenario = shipped_scenario_of("nominal_auto");
    scenario.radio.light_time_s = 100.0;
    scenario.start_before_entry_s = 700.0;
    for (auto& command : scenario.commands) command.send_before_entry_s = 690.0;
    Accompanied flown{scenario, 7};
    flown.fly_to(-601.0);
    CHECK(flown.made.empty());
    flown.fly_to(-400.0);
    CHECK(flown.shadow().flight().landing().sclk() == scenario.entry_sclk - 500.0);
    CHECK(flown.values("shadow_stand").size() == 200);
}

}  // namespace server_shadow_test
