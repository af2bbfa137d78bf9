// SPDX-License-Identifier: Apache-2.0
#include "flight/timeline/constraint_monitor.hpp"

#include "flight/computer.hpp"
#include "flight/timeline/actions.hpp"
#include "simulation/entry_reference.hpp"
#include "simulation/world.hpp"
#include "telemetry/packet_stream.hpp"
#include "tests/simulation/gale.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/outbox.hpp"
#include "tests/support/telecommands.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace flight_constraint_monitor_test {

using namespace aeolis;
using namespace aeolis::flight;

namespace {

constexpr TimepointId first{0}, second{1};
constexpr AnchorId root{0}, entry{1};

struct Fixture {
    std::vector<ConstraintSpec> rows;
    ConstraintMonitor monitor;
    test::OutboxRecorder recorder;

    explicit Fixture(std::vector<ConstraintSpec> its_rows) : rows(std::move(its_rows)), monitor(rows) {}

    /// Violations reported after `moment` came at `at_s`.
    int note(const Moment& moment, double at_s) {
        monitor.note(moment, Sclk{at_s});
        return report();
    }
    int report() {
        recorder.begin(ModuleId::edl, Sclk{5000.0});
        monitor.report(recorder.out);
        // It tells, by packets and a tone, and does nothing else.
        for (const Envelope& envelope : recorder.out.sent())
            CHECK(envelope.to ==
                  (std::holds_alternative<Record>(envelope.message) ? ModuleId::edl_comm : ModuleId::mfsk));
        for (const ToneRequest& request : recorder.sent<ToneRequest>())
            CHECK(request.tone == tone::constraint_violated);
        CHECK(recorder.sent<Record>().size() + recorder.sent<ToneRequest>().size() == recorder.out.sent().size());
        return recorder.events<evr::SUB_CONSTRAINT_VIOLATED>();
    }
};

/// What the report of a violation says: row, seconds that passed, bound.
struct Told {
    std::uint64_t row;
    double elapsed_s, bound_s;
    bool operator==(const Told&) const = default;
};
Told told(const test::OutboxRecorder& recorder) {
    for (const auto& record : recorder.sent<Record>()) {
        if (record.apid != evr::SUB_CONSTRAINT_VIOLATED::apid) continue;
        BitReader in{std::span{record.data}.first(record.size)};
        if (in.get(16) != evr::SUB_CONSTRAINT_VIOLATED::id.value) continue;
        const std::uint64_t row = in.get(16);
        const double elapsed_s = in.get_double();
        return {row, elapsed_s, in.get_double()};
    }
    return {};
}

/// A computer in a world; what it fired when, and which sub-constraints it reported.
struct Flight {
    simulation::World world;
    Computer computer;
    std::unique_ptr<DeviceOutputs> out = std::make_unique<DeviceOutputs>();
    std::vector<std::pair<std::int64_t, PyroCommand>> pyros;
    std::vector<std::uint64_t> violated;
    std::size_t explained = 0, judged = 0;

    explicit Flight(const simulation::Scenario& scenario) : world(scenario, 1), computer(load(scenario), world.sclk()) {
        world.set_nvm(0, 1U << 30);
        world.receive(test::set_parameters(world.solution()));
        for (int cycle = 0; cycle < 64; ++cycle) step();
        world.receive(test::do_edl());
    }
    static Load load(const simulation::Scenario& scenario) {
        Load load;
        load.entry_reference = simulation::make_entry_reference(scenario);
        return load;
    }
    void step() {
        const DeviceInputs& in = world.sense();
        computer.step(in, *out);
        for (const PyroCommand& pyro : out->pyros) pyros.emplace_back(in.now.ticks(), pyro);
        telemetry::PacketStream packets{out->nvm.span()};
        while (const auto packet = packets.next()) {
            const Apid apid = read_primary_header(*packet)->apid;
            const auto word = [&](unsigned at) { return read_bits(*packet, tm_data_offset_octets * 8 + at, 16); };
            if (apid == evr::SUB_CONSTRAINT_VIOLATED::apid && word(0) == evr::SUB_CONSTRAINT_VIOLATED::id.value)
                violated.push_back(word(16));
            if (apid == evr::SUB_CONSTRAINTS_JUDGED::apid && word(0) == evr::SUB_CONSTRAINTS_JUDGED::id.value)
                judged = word(16);
            if (apid == packet::Explanation::apid && word(0) == static_cast<unsigned>(Decision::sub_constraint))
                ++explained;
        }
        world.advance(*out);
    }
    void land() {
        while (world.outcome() == simulation::Outcome::running) step();
    }
};

}  // namespace

TEST_CASE("a minimum holds at its bound and not a tick before, a maximum not a tick after", "[timeline][R39]") {
    const ConstraintSpec within{Moment::of_fired(first), Moment::of_triggered(second), 2.0, 4.0};
    for (const auto& [elapsed_s, violations] :
         {std::pair{2.0 - 1.0 / 64, 1}, std::pair{2.0, 0}, std::pair{4.0, 0}, std::pair{4.0 + 1.0 / 64, 1}}) {
        INFO(elapsed_s);
        Fixture f{{within}};
        CHECK(f.note(Moment::of_fired(first), 1000.0) == 0);
        CHECK(f.note(Moment::of_triggered(second), 1000.0 + elapsed_s) == violations);
        if (violations == 1) CHECK(told(f.recorder) == Told{0, elapsed_s, elapsed_s < 2.0 ? 2.0 : 4.0});
        CHECK(f.recorder.packets<packet::Explanation>() == violations);
        CHECK(f.report() == 0);  // told once
    }
}

TEST_CASE("each kind of moment is noted: do edl, anchor, triggered, fired", "[timeline][R39]") {
    const std::vector<Moment> moments{Moment::of_do_edl(), Moment::of_anchor(entry), Moment::of_triggered(first),
                                      Moment::of_fired(first)};
    for (const Moment& from : moments)
        for (const Moment& to : moments) {
            if (from == to) continue;
            Fixture f{{{from, to, 10.0, {}}}};
            CHECK(f.note(from, 1000.0) == 0);
            CHECK(f.note(to, 1009.0) == 1);
        }
}

TEST_CASE("an undefined bound is no bound", "[timeline][R13][R39]") {
    Fixture f{{{Moment::of_do_edl(), Moment::of_fired(first), {}, {}},
               {Moment::of_do_edl(), Moment::of_fired(second), {}, 5.0}}};
    f.note(Moment::of_do_edl(), 1000.0);
    CHECK(f.note(Moment::of_fired(first), 1.0e6) == 0);
    CHECK(f.note(Moment::of_fired(second), -1.0e6) == 0);
}

TEST_CASE("what never comes is never judged, and what comes in the other order is", "[timeline][R13][R39]") {
    Fixture f{{{Moment::of_fired(first), Moment::of_fired(second), 1.0, {}}}};
    CHECK(f.note(Moment::of_fired(second), 1000.0) == 0);
    CHECK(f.note(Moment::of_fired(first), 1003.0) == 1);
    CHECK(told(f.recorder) == Told{0, -3.0, 1.0});
}

TEST_CASE("an anchor that is set anew is judged anew; one that did not move is not", "[timeline][R39]") {
    Fixture f{{{Moment::of_do_edl(), Moment::of_anchor(entry), 831.0, {}}}};
    f.note(Moment::of_do_edl(), 1000.0);
    CHECK(f.note(Moment::of_anchor(entry), 1800.0) == 1);
    CHECK(f.note(Moment::of_anchor(entry), 1800.0) == 0);
    CHECK(f.note(Moment::of_anchor(entry), 1900.0) == 0);
    CHECK(f.note(Moment::of_anchor(entry), 1830.0) == 1);
}

TEST_CASE("violations beyond what the outbox can take wait for the next cycles, and none is lost", "[timeline][R39]") {
    std::vector<ConstraintSpec> rows;
    for (std::uint16_t i = 0; i < 30; ++i)
        rows.push_back({Moment::of_fired(TimepointId{i}), Moment::of_fired(TimepointId{100}), 5.0, {}});
    Fixture f{rows};
    for (std::uint16_t i = 0; i < 30; ++i) f.monitor.note(Moment::of_fired(TimepointId{i}), Sclk{1000.0});
    int reported = f.note(Moment::of_fired(TimepointId{100}), 1001.0);
    CHECK(reported < 10);
    for (int cycle = 0; cycle < 30; ++cycle) reported += f.report();
    CHECK(reported == 30);
    CHECK(f.monitor.violations() == 30);
}

TEST_CASE("the monitor takes its moments from the timeline: anchors, the triggering while a reply is due, the firing",
          "[timeline][R39]") {
    const std::vector<AnchorSpec> anchors{{"root", {}, {}}, {"entry", root, MaybeOffset{1000.0}}};
    const ActionFunction wait = [](ActionContext& context) { context.fire(PyroId::coolant_vent); };
    const std::vector<TimepointSpec> timepoints{
        {"first", entry, MaybeOffset{2.0}, MaybeOffset{0.0}, wait, 4.0, {}, {}, {}, true, false, {}, nullptr}};
    Timeline timeline{timepoints, anchors};
    timeline.begin(Sclk{990.0});
    Fixture f{{{Moment::of_anchor(entry), Moment::of_triggered(first), 3.0, {}},
               {Moment::of_triggered(first), Moment::of_fired(first), {}, 1.0}}};
    gnc::Configuration configuration;
    const auto cycle = [&](double at_s) {
        ActionContext context{f.recorder.out, configuration};
        Firings firings;
        timeline.begin_cycle();
        timeline.pass(Sclk{at_s}, context, firings);
        f.monitor.watch(timeline, firings.span());
        return f.report();
    };
    CHECK(cycle(1001.0) == 0);
    CHECK(cycle(1002.0) == 1);
    CHECK(told(f.recorder) == Told{0, 2.0, 3.0});
    CHECK(cycle(1005.0) == 0);
    CHECK(cycle(1006.0) == 1);  // by its time-out
    CHECK(told(f.recorder) == Told{1, 4.0, 1.0});
}

TEST_CASE("a nominal landing judges every shipped sub-constraint and finds none violated", "[timeline][R39][release]") {
    Flight flight{tests::gale_scenario(900.0)};
    flight.land();
    CHECK(flight.world.outcome() == simulation::Outcome::touchdown);
    CHECK(flight.violated.empty());
    CHECK(flight.explained == 0);
    CHECK(flight.judged == constraint_count);
}

TEST_CASE("a violation planted by command is reported, explained, and changes nothing else",
          "[timeline][R39][release]") {
    Flight nominal{tests::gale_scenario(900.0)};
    Flight planted{tests::gale_scenario(900.0)};
    // Safed 3 s after the stage goes, says constraints.csv; by command it is 4 s. The next timepoint is 14 s away.
    planted.world.receive(test::set_timepoint_offset(timepoint::pyros_safe_cruise_stage, 4.0, 1.0));
    nominal.land();
    planted.land();
    REQUIRE(planted.violated.size() == 1);
    const ConstraintSpec& row = constraint_specs.at(planted.violated[0]);
    CHECK(row.from == Moment::of_fired(timepoint::cruise_stage_separation));
    CHECK(row.to == Moment::of_triggered(timepoint::pyros_safe_cruise_stage));
    CHECK(planted.explained == 1);
    CHECK(planted.world.outcome() == simulation::Outcome::touchdown);
    CHECK(planted.pyros == nominal.pyros);
    CHECK(planted.computer.counters().resets == 0);
    CHECK(planted.computer.counters().mailbox_overflows == 0);
}

}  // namespace flight_constraint_monitor_test
