// SPDX-License-Identifier: Apache-2.0
#include "flight/timeline/timeline.hpp"

#include "flight/timeline/actions.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/outbox.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <random>
#include <vector>

namespace flight_timeline_test {

using namespace aeolis;
using namespace aeolis::flight;

namespace {

Sclk at(double seconds) {
    return Sclk{1000.0 + seconds};
}

void nothing(ActionContext&) {}
void fire_a_pyro(ActionContext& context) {
    context.fire(PyroId::coolant_vent);
}

constexpr AnchorId root{0}, entry_anchor{1}, parachute_anchor{2};
const std::vector<AnchorSpec> anchors{
    {"root", {}, {}}, {"entry", root, MaybeOffset{1100.0}}, {"parachute", root, MaybeOffset{}}};

TimepointSpec row(std::optional<AnchorId> anchor, MaybeOffset desired_s, MaybeOffset minimum_s,
                  ActionFunction action = nothing, std::optional<double> reply_timeout_s = {}) {
    return {"row", anchor, desired_s, minimum_s, action, reply_timeout_s, {}, {}, {}, true, false, {}, nullptr};
}

struct Fixture {
    std::vector<TimepointSpec> rows;
    Timeline timeline;
    test::OutboxRecorder recorder;
    gnc::Configuration configuration;

    explicit Fixture(std::vector<TimepointSpec> its_rows) : rows(std::move(its_rows)), timeline(rows, anchors) {}

    /// One cycle with a single pass.
    std::vector<Firing> cycle(Sclk now) {
        timeline.begin_cycle();
        return pass(now);
    }
    std::vector<Firing> pass(Sclk now) {
        recorder.begin(ModuleId::edl, now);
        ActionContext context{recorder.out, configuration};
        Firings firings;
        timeline.pass(now, context, firings);
        return {firings.begin(), firings.end()};
    }
};

}  // namespace

TEST_CASE("nothing fires before do edl was accepted", "[timeline][R16][R23]") {
    Fixture f{{row({}, 0.0, 0.0)}};
    CHECK(f.cycle(at(0)).empty());
    f.timeline.begin(at(1));
    CHECK(f.cycle(at(1)).size() == 1);
}

TEST_CASE("a timepoint fires at its desired offset from the previous firing, not a tick before", "[timeline][R11]") {
    Fixture f{{row({}, 2.0, 0.0)}};
    f.timeline.begin(at(0));
    CHECK(f.cycle(at(2.0 - 1.0 / 64)).empty());
    const auto fired = f.cycle(at(2.0));
    REQUIRE(fired.size() == 1);
    CHECK(fired[0].fired == at(2.0));
}

TEST_CASE("a timepoint that its anchor makes due still waits for its minimum offset", "[timeline][R11]") {
    Fixture f{{row({}, 0.0, 0.0), row(entry_anchor, -95.0, 8.0)}};  // entry is at 100 s: desired at 5 s
    f.timeline.begin(at(0));
    CHECK(f.cycle(at(0)).size() == 1);
    CHECK(f.cycle(at(7.984375)).empty());
    CHECK(f.cycle(at(8.0)).size() == 1);
}

TEST_CASE("a timepoint with an undefined anchor or offset never fires", "[timeline][R13]") {
    for (const auto& spec :
         {row(parachute_anchor, 0.0, 0.0), row({}, MaybeOffset{}, 0.0), row({}, 0.0, MaybeOffset{})}) {
        Fixture f{{spec}};
        f.timeline.begin(at(0));
        for (int second = 0; second < 1000; ++second) REQUIRE(f.cycle(at(second)).empty());
    }
}

TEST_CASE("what GNC sets now is due in the second pass of the same cycle", "[timeline][R17]") {
    Fixture f{{row(parachute_anchor, 0.0, 0.0), row(parachute_anchor, 2.0, 0.0)}};
    f.timeline.begin(at(0));
    CHECK(f.cycle(at(5)).empty());
    CHECK(f.timeline.state() == TimepointState::undefined);
    f.timeline.set_anchor_now(parachute_anchor, at(5));
    CHECK(f.pass(at(5)).size() == 1);
    CHECK(f.timeline.state() == TimepointState::pending);
    CHECK(f.cycle(at(6.984375)).empty());
    CHECK(f.cycle(at(7)).size() == 1);
}

TEST_CASE("at most five timepoints fire in one cycle, both passes together", "[timeline][R15]") {
    Fixture f{std::vector<TimepointSpec>(7, row({}, 0.0, 0.0))};
    f.timeline.begin(at(0));
    CHECK(f.cycle(at(0)).size() == 5);
    CHECK(f.timeline.limited(at(0)));
    CHECK(f.pass(at(0)).empty());
    CHECK(f.cycle(at(1.0 / 64)).size() == 2);
    CHECK_FALSE(f.timeline.limited(at(1.0 / 64)));
    CHECK(f.timeline.finished());
}

TEST_CASE("a timepoint that waits for a reply is done when the reply comes, and its firing time is then",
          "[timeline][R14]") {
    Fixture f{{row({}, 0.0, 0.0, fire_a_pyro, 1.0), row({}, 0.0, 0.0)}};
    f.timeline.begin(at(0));
    CHECK(f.cycle(at(0)).empty());
    CHECK(f.recorder.sent<FirePyro>().size() == 1);
    CHECK(f.timeline.state() == TimepointState::waiting_reply);
    f.timeline.reply({ReplyKind::pyro, static_cast<std::uint8_t>(PyroId::heatshield_separation)});  // another's
    CHECK(f.cycle(at(0.25)).empty());
    f.timeline.reply({ReplyKind::pyro, static_cast<std::uint8_t>(PyroId::coolant_vent)});
    const auto done = f.cycle(at(0.5));
    REQUIRE(done.size() == 2);
    CHECK(done[0].verdict == FiringVerdict::verified);
    CHECK(done[0].triggered == at(0));
    CHECK(done[0].fired == at(0.5));
    CHECK(done[1].fired == at(0.5));
}

TEST_CASE("a reply that does not come ends the wait at its time-out, not a tick before", "[timeline][R14]") {
    Fixture f{{row({}, 0.0, 0.0, fire_a_pyro, 1.0)}};
    f.timeline.begin(at(0));
    CHECK(f.cycle(at(0)).empty());
    CHECK(f.cycle(at(1.0 - 1.0 / 64)).empty());
    const auto done = f.cycle(at(1));
    REQUIRE(done.size() == 1);
    CHECK(done[0].verdict == FiringVerdict::unverified);
    CHECK(done[0].triggered == at(0));
    CHECK(done[0].fired == at(1));
}

namespace {

constexpr auto vent = static_cast<std::uint8_t>(PyroId::coolant_vent);

void announced(ActionContext& context) {
    context.out().event(evr::COOLANT_VENT{});
}
void fires_the_mortar(ActionContext& context) {
    context.fire(PyroId::parachute_mortar, gnc::Fact::parachute_out);
}

/// Fires the mortar, waits a second for the reply, and announces it by an event and a tone.
TimepointSpec mortar(IfUnverified taken = IfUnverified::done) {
    TimepointSpec spec = row({}, 0.0, 0.0, fires_the_mortar, 1.0);
    spec.if_unverified = taken;
    spec.event = announced;
    spec.tone = tone::parachute_deploy;
    return spec;
}
ActionReply said(Evidence evidence) {
    return {ReplyKind::pyro, static_cast<std::uint8_t>(PyroId::parachute_mortar), evidence};
}

}  // namespace

TEST_CASE("event, tone and GNC's configuration of an action follow its reply, not its triggering",
          "[timeline][R14][R50]") {
    Fixture f{{mortar()}};
    const auto told = [&] {
        return std::pair{f.recorder.events<evr::COOLANT_VENT>(), f.recorder.sent<ToneRequest>().size()};
    };
    f.timeline.begin(at(0));
    f.cycle(at(0));
    CHECK(f.recorder.events<evr::TIMEPOINT_COMMANDED>() == 1);
    CHECK(told() == std::pair{0, std::size_t{0}});
    CHECK_FALSE(f.configuration.parachute_out);
    CHECK(f.timeline.reply(said(Evidence::verified)));
    f.cycle(at(0.25));
    CHECK(told() == std::pair{1, std::size_t{1}});
    CHECK(f.configuration.parachute_out);
    CHECK(f.configuration.parachute_time == at(0));
}

TEST_CASE("a refusal is no end: until the time-out the device may yet do it; then it was refused and not done",
          "[timeline][R14][R50]") {
    for (const bool comes_round : {false, true}) {
        Fixture f{{mortar()}};
        f.timeline.begin(at(0));
        f.cycle(at(0));
        f.timeline.reply(said(Evidence::refused));
        CHECK(f.cycle(at(0.5)).empty());
        if (comes_round) f.timeline.reply(said(Evidence::verified));
        const auto done = f.cycle(at(1));
        REQUIRE(done.size() == 1);
        CHECK(done[0].verdict == (comes_round ? FiringVerdict::verified : FiringVerdict::refused));
        CHECK(done[0].triggered == at(0));
        CHECK(done[0].fired == at(1));
        CHECK(f.configuration.parachute_out == comes_round);
        CHECK(f.recorder.events<evr::COOLANT_VENT>() == comes_round);
    }
}

TEST_CASE("refused, commanded anew and then silent is unverified: nobody knows", "[timeline][R50]") {
    Fixture f{{mortar()}};
    f.timeline.begin(at(0));
    f.cycle(at(0));
    f.timeline.reply(said(Evidence::refused));
    f.timeline.reply(said(Evidence::none));
    const auto done = f.cycle(at(1));
    REQUIRE(done.size() == 1);
    CHECK(done[0].verdict == FiringVerdict::unverified);
}

TEST_CASE("unverified, the configuration has what the row says, and nothing is announced", "[timeline][R50]") {
    for (const auto& [taken, done] : {std::pair{IfUnverified::done, true}, std::pair{IfUnverified::not_done, false},
                                      std::pair{IfUnverified::done_unless_imu, true}}) {
        Fixture f{{mortar(taken)}};
        f.timeline.begin(at(0));
        f.cycle(at(0));
        CHECK(f.cycle(at(1)).size() == 1);
        CHECK(f.configuration.parachute_out == done);
        CHECK(f.recorder.events<evr::COOLANT_VENT>() == 0);
        CHECK(f.recorder.sent<ToneRequest>().empty());
    }
}

TEST_CASE("a row that holds the timeline is commanded again until it is verified or its time-out is over",
          "[timeline][R50]") {
    TimepointSpec held = row({}, 0.0, 0.0, fire_a_pyro, 10.0);
    held.hold_repeat_s = 4.0;
    Fixture f{{held}};
    f.timeline.begin(at(0));
    std::vector<double> commanded_s;
    for (int tick = 0; tick < 64 * 11; ++tick) {
        const auto done = f.cycle(at(tick / 64.0));
        if (!f.recorder.sent<FirePyro>().empty()) commanded_s.push_back(tick / 64.0);
        CHECK(f.recorder.events<evr::TIMEPOINT_HELD>() == (tick == 64 * 4 || tick == 64 * 8));
        for (const Firing& firing : done) CHECK(firing.fired == at(10));
    }
    CHECK(commanded_s == std::vector{0.0, 4.0, 8.0});
    CHECK(f.timeline.finished());

    Fixture answered{{held}};
    answered.timeline.begin(at(0));
    answered.cycle(at(0));
    answered.cycle(at(4));
    answered.timeline.reply({ReplyKind::pyro, vent});
    CHECK(answered.cycle(at(4.25)).size() == 1);
}

TEST_CASE("the shipped timeline is held before separation only, and asks the IMU only of the mortar",
          "[timeline][R20][R50][release]") {
    bool held = false;
    for (const TimepointSpec& spec : timeline_specs) {
        INFO(spec.name);
        if (spec.hold_repeat_s) {
            held = true;
            CHECK(&spec < &timeline_specs[timepoint::cruise_stage_separation.value]);
        }
        CHECK((spec.if_unverified == IfUnverified::done_unless_imu) ==
              (spec.action == action_named<"fire_parachute_mortar">().run));
    }
    CHECK(held);
}

TEST_CASE("an action runs once, however long its reply takes", "[timeline][R14]") {
    Fixture f{{row({}, 0.0, 0.0, fire_a_pyro, 10.0)}};
    f.timeline.begin(at(0));
    int fired = 0;
    for (int tick = 0; tick < 64 * 5; ++tick) {
        f.cycle(at(tick / 64.0));
        fired += static_cast<int>(f.recorder.sent<FirePyro>().size());
    }
    CHECK(fired == 1);
}

TEST_CASE("an offset changed between cycles counts in the next pass", "[timeline][R16]") {
    Fixture f{{row({}, 50.0, 0.0), row(entry_anchor, 0.0, 0.0)}};
    f.timeline.begin(at(0));
    CHECK(f.cycle(at(1)).empty());
    CHECK(f.timeline.set_timepoint_offsets(TimepointId{0}, 1.0, 0.0));
    CHECK(f.cycle(at(1.015625)).size() == 1);
    CHECK(f.timeline.set_anchor_offset(entry_anchor, 1002.0));
    CHECK(f.cycle(at(2)).size() == 1);
}

TEST_CASE("offsets of rows that do not exist, and the root, are refused", "[timeline][R16]") {
    Fixture f{{row({}, 0.0, 0.0)}};
    CHECK_FALSE(f.timeline.set_timepoint_offsets(TimepointId{1}, 0.0, 0.0));
    CHECK_FALSE(f.timeline.set_anchor_offset(AnchorId{3}, 0.0));
    CHECK_FALSE(f.timeline.set_anchor_offset(root, 0.0));
}

TEST_CASE("one sweep computes the whole tree of anchors, and undefined spreads down it", "[timeline][R12][R13]") {
    const std::vector<AnchorSpec> tree{{"root", {}, {}},
                                       {"entry", AnchorId{0}, MaybeOffset{}},
                                       {"before", AnchorId{1}, MaybeOffset{-10.0}},
                                       {"long_before", AnchorId{2}, MaybeOffset{-100.0}}};
    Timeline timeline{{}, tree};
    CHECK_FALSE(timeline.anchor_time(AnchorId{3}).defined());
    REQUIRE(timeline.set_anchor_offset(AnchorId{1}, 500.0));
    timeline.compute_anchors();
    CHECK(timeline.anchor_time(AnchorId{3}).get()->seconds == 390.0);
}

TEST_CASE("firings keep the order of the rows whatever the offsets, and never come before their minimum",
          "[timeline][R19]") {
    std::mt19937 random{11};
    for (int round = 0; round < 300; ++round) {
        std::vector<TimepointSpec> rows;
        std::vector<double> minimum_s;
        for (int i = 0; i < 20; ++i) {
            minimum_s.push_back(static_cast<double>(random() % 64) / 64.0);
            const double desired_s = (static_cast<int>(random() % 256) - 64) / 64.0;
            rows.push_back(random() % 2 ? row({}, desired_s, minimum_s.back())
                                        : row(entry_anchor, desired_s - 95.0, minimum_s.back()));
        }
        Fixture f{rows};
        f.timeline.begin(at(0));
        std::vector<Firing> fired;
        for (int tick = 0; tick < 64 * 60 && !f.timeline.finished(); ++tick)
            for (const Firing& firing : f.cycle(at(tick / 64.0))) fired.push_back(firing);
        REQUIRE(fired.size() == rows.size());
        for (std::size_t i = 1; i < fired.size(); ++i) {
            REQUIRE(fired[i].timepoint.value == i);
            REQUIRE(fired[i].fired - fired[i - 1].fired >= minimum_s[i]);
        }
    }
}

TEST_CASE("the shipped timeline fits the engine, and every row that waits for a reply asks for one",
          "[timeline][R14][R20]") {
    CHECK(timeline_specs.size() >= 45);
    for (const TimepointSpec& spec : timeline_specs) {
        if (!spec.reply_timeout_s) continue;
        INFO(spec.name);
        REQUIRE(spec.action);
        test::OutboxRecorder recorder;
        gnc::Configuration configuration;
        ActionContext context{recorder.out, configuration};
        context.begin(spec);
        spec.action(context);
        CHECK(context.awaited().kind != ReplyKind::none);
    }
}

TEST_CASE("the engine's rows are those of the spreadsheet, cell by cell", "[timeline][R20]") {
    const auto& sheets = tests::shipped_dictionary();
    REQUIRE(timeline_specs.size() == sheets.timeline.size());
    for (std::size_t i = 0; i < sheets.timeline.size(); ++i) {
        const TimepointSpec& spec = timeline_specs.at(i);
        const auto& written = sheets.timeline[i];
        INFO(written.name);
        CHECK(spec.name == written.name);
        CHECK(spec.anchor == written.anchor);
        CHECK(spec.desired_offset_s == written.desired_offset_s);
        CHECK(spec.minimum_offset_s == written.minimum_offset_s);
        CHECK((spec.action == nullptr) == written.action.empty());
        CHECK(spec.reply_timeout_s == written.reply_timeout_s);
        CHECK(static_cast<int>(spec.if_unverified) == static_cast<int>(written.if_unverified));
        CHECK(spec.hold_repeat_s == written.hold_repeat_s);
        CHECK((spec.backtrack ? timeline_specs.at(spec.backtrack->value).name : "") == written.backtrack);
        CHECK(spec.essential == written.essential);
        CHECK(spec.tone == written.tone);
        CHECK((spec.event == nullptr) == written.event.empty());
    }
    REQUIRE(anchor_specs.size() == sheets.anchors.size());
    for (std::size_t i = 0; i < sheets.anchors.size(); ++i) {
        INFO(sheets.anchors[i].name);
        CHECK(anchor_specs.at(i).name == sheets.anchors[i].name);
        CHECK(anchor_specs.at(i).parent == sheets.anchors[i].parent);
        CHECK(anchor_specs.at(i).offset_s == sheets.anchors[i].offset_s);
    }
}

TEST_CASE("what is announced of a device waits for its reply, and a decision on a pyro says that it was decided",
          "[timeline][R50]") {
    const auto is_said_at_once = [](const TimepointSpec& spec) {  // by the clock, not of the device
        return &spec == &timeline_specs[timepoint::entry_interface.value];
    };
    for (const TimepointSpec& spec : timeline_specs) {
        if (!spec.action || !(spec.tone || spec.event)) continue;
        test::OutboxRecorder recorder;
        gnc::Configuration configuration;
        ActionContext context{recorder.out, configuration};
        context.begin(spec);
        spec.action(context);
        if (context.awaited().kind == ReplyKind::none) continue;
        INFO(spec.name);
        CHECK(spec.reply_timeout_s.has_value() != is_said_at_once(spec));
    }
    for (const char* decided :
         {"PARACHUTE_DEPLOY", "HEATSHIELD_SEPARATION", "ENGINE_PRIMING", "BACKSHELL_SEPARATION", "ROVER_SEPARATION"}) {
        const auto* event = tests::shipped_dictionary().event(decided);
        INFO(decided);
        REQUIRE(event != nullptr);
        CHECK_THAT(event->format, Catch::Contains(" decided at "));
    }
}

TEST_CASE("for Second Chance a row that is not essential does, announces and awaits nothing; an essential one acts",
          "[timeline][R33]") {
    std::vector<TimepointSpec> rows(2, row({}, 0.0, 0.0, fire_a_pyro, 4.0));
    rows[0].essential = false;
    rows[0].event = announced;
    rows[0].tone = tone::coolant_vent;
    Timeline timeline{rows, anchors, true};
    timeline.begin(at(0));
    timeline.begin_cycle();
    test::OutboxRecorder recorder{ModuleId::edl, at(0)};
    gnc::Configuration configuration;
    ActionContext context{recorder.out, configuration};
    Firings firings;
    timeline.pass(at(0), context, firings);
    REQUIRE(firings.size() == 1);
    CHECK(firings[0].verdict == FiringVerdict::no_operation);
    CHECK(firings[0].fired == at(0));
    CHECK(recorder.events<evr::COOLANT_VENT>() == 0);
    CHECK(recorder.sent<ToneRequest>().empty());
    CHECK(recorder.sent<FirePyro>().size() == 1);  // the second row's
    CHECK(timeline.waiting());
}

TEST_CASE("each row of the shipped timeline does something: none waits for what is only said", "[timeline][R31]") {
    for (const TimepointSpec& spec : timeline_specs) {
        INFO(spec.name);
        CHECK((spec.action != nullptr || spec.essential));  // an essential row without an action keeps a time
    }
}

TEST_CASE("each row up to cruise-stage separation says where a restart goes back to, at or before itself",
          "[timeline][R32]") {
    for (std::size_t row = 0; row <= timepoint::cruise_stage_separation.value; ++row) {
        INFO(timeline_specs[row].name);
        REQUIRE(timeline_specs[row].backtrack);
        CHECK(timeline_specs[row].backtrack->value <= row);
    }
}

TEST_CASE("a timepoint counts as triggered from its action on, before its reply came", "[timeline][R14][R32]") {
    Fixture f{{row({}, 1.0, 0.0, fire_a_pyro, 4.0), row({}, 10.0, 0.0)}};
    f.timeline.begin(at(0));
    f.cycle(at(0.5));
    CHECK_FALSE(f.timeline.triggered(TimepointId{0}));
    f.cycle(at(1.0));
    REQUIRE(f.timeline.waiting());
    CHECK(f.timeline.triggered(TimepointId{0}));
    f.timeline.reply({ReplyKind::pyro, static_cast<std::uint8_t>(PyroId::coolant_vent)});
    f.cycle(at(2.0));
    CHECK(f.timeline.triggered(TimepointId{0}));
    CHECK_FALSE(f.timeline.triggered(TimepointId{1}));
}

}  // namespace flight_timeline_test
