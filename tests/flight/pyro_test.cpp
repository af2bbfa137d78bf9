// SPDX-License-Identifier: Apache-2.0
#include "flight/devices/pyro.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/device_module.hpp"

#include <map>
#include <vector>

namespace flight_pyro_test {

using namespace aeolis;
using namespace aeolis::flight;

namespace {

constexpr auto mortar = PyroId::parachute_mortar;

ActionReply answer(Evidence evidence, PyroId pyro = mortar) {
    return {ReplyKind::pyro, static_cast<std::uint8_t>(pyro), evidence};
}

/// A manager whose pyros are armed, at time 1000 s and `now_s` later.
struct Armed {
    test::Spoken<PyroManager> pyro{ModuleId::pyro};
    double now_s = 0.0;
    std::vector<ActionReply> answers;
    std::map<std::uint16_t, int> events;
    std::vector<PyroState> mortar_states;  ///< as recorded

    Armed() { say(ArmPyros{true}); }
    template <typename M>
    void say(const M& message) {
        const test::OutboxRecorder& recorder = pyro.on(message, Sclk{1000.0 + now_s});
        for (const ActionReply& reply : recorder.sent<ActionReply>())
            if (reply.kind == ReplyKind::pyro) answers.push_back(reply);
        for (const Record& record : recorder.sent<Record>()) {
            if (record.apid == evr::PYRO_REFUSED::apid)
                ++events[static_cast<std::uint16_t>(read_bits(record.data, 0, 16))];
            if (record.apid == packet::PyroStatus::apid)
                mortar_states.push_back(static_cast<PyroState>(record.data[static_cast<std::size_t>(mortar)]));
        }
    }
    void fire(double within_s = 1.0) { say(FirePyro{mortar, Sclk{1000.0 + now_s + within_s}}); }
    /// What goes out at its turn.
    std::vector<PyroCommand> turn() {
        pyro.recorder.bus->begin_cycle();
        say(Tick{Sclk{1000.0 + now_s}});
        const auto out = pyro.recorder.bus->pyros.span();
        now_s += seconds_per_tick;
        return {out.begin(), out.end()};
    }
    /// How often both controllers were told within so many seconds.
    int turns_that_fire(double for_s) {
        int fired = 0;
        for (double s = 0.0; s < for_s; s += seconds_per_tick) fired += turn().empty() ? 0 : 1;
        return fired;
    }
    template <typename Evr>
    int count() const {
        const auto found = events.find(Evr::id.value);
        return found == events.end() ? 0 : found->second;
    }
};

}  // namespace

TEST_CASE("a pyro goes out over both controllers at its manager's turn, the selected one first",
          "[devices][R5][R10][R50]") {
    Armed f;
    f.fire();
    CHECK(f.pyro.recorder.bus->pyros.empty());
    CHECK(f.turn() == std::vector<PyroCommand>{{mortar, Unit::a}, {mortar, Unit::b}});
    CHECK(f.turn().empty());
    f.say(test::all_b());
    f.fire();
    CHECK(f.turn() == std::vector<PyroCommand>{{mortar, Unit::b}, {mortar, Unit::a}});
}

TEST_CASE("one controller's word that the pyro fired verifies it, once", "[devices][R14][R50]") {
    Armed f;
    f.fire();
    f.turn();
    f.say(PyroReply{mortar, true, Unit::b});
    CHECK(f.answers == std::vector{answer(Evidence::verified)});
    f.say(PyroReply{mortar, true, Unit::a});
    CHECK(f.answers.size() == 1);
    CHECK(f.turns_that_fire(2.0) == 0);
    CHECK(f.events.empty());
}

TEST_CASE("what becomes of a pyro is recorded when it changes, and each second while armed", "[devices][R52]") {
    Armed f;
    f.now_s = seconds_per_tick;
    f.turn();
    f.fire();
    for (int i = 0; i < 5; ++i) f.turn();
    f.say(PyroReply{mortar, true, Unit::b});
    for (int i = 0; i < 5; ++i) f.turn();
    using enum PyroState;
    CHECK(f.mortar_states == std::vector{not_commanded, commanded, fired});
    while (f.now_s < 3.5) f.turn();
    CHECK(f.mortar_states.size() == 3 + 3);
    f.say(ArmPyros{false});
    while (f.now_s < 6.5) f.turn();
    CHECK(f.mortar_states.size() == 3 + 3 + 1);
}

TEST_CASE("a pyro that both controllers refuse is recorded as refused, one that neither answers as unanswered",
          "[devices][R52]") {
    Armed refused;
    refused.fire();
    while (refused.now_s < 1.5)
        for (const PyroCommand& command : refused.turn()) refused.say(PyroReply{mortar, false, command.unit});
    CHECK(refused.mortar_states.back() == PyroState::refused);
    Armed silent;
    silent.fire();
    while (silent.now_s < 1.5) silent.turn();
    CHECK(silent.mortar_states.back() == PyroState::unanswered);
}

TEST_CASE("before it is armed nothing fires, and that is told and refused", "[devices][R50]") {
    Armed f;
    f.say(ArmPyros{false});
    f.fire();
    CHECK(f.turns_that_fire(2.0) == 0);
    CHECK(f.count<evr::PYRO_NOT_ARMED>() == 1);
    CHECK(f.answers == std::vector{answer(Evidence::refused)});

    test::Spoken<PyroManager> never_armed{ModuleId::pyro};
    never_armed.on(FirePyro{mortar, Sclk{1001.0}});
    never_armed.on(Tick{Sclk{1000.0}}, Sclk{1000.0});
    CHECK(never_armed.recorder.bus->pyros.empty());
}

TEST_CASE("arming and safing answer the timeline, each as what it is", "[devices][R14][R50]") {
    test::Spoken<PyroManager> pyro{ModuleId::pyro};
    CHECK(pyro.on(ArmPyros{true}).sent<ActionReply>() == std::vector{ActionReply{ReplyKind::arming, 1}});
    CHECK(pyro.on(ArmPyros{false}).sent<ActionReply>() == std::vector{ActionReply{ReplyKind::arming, 0}});
}

TEST_CASE("safed while it still tries, it tries no more", "[devices][R50]") {
    Armed f;
    f.fire();
    CHECK(f.turn().size() == 2);
    f.say(ArmPyros{false});
    CHECK(f.turns_that_fire(2.0) == 0);
}

TEST_CASE("a controller that refuses costs nothing and is told once", "[devices][R50]") {
    Armed f;
    f.fire();
    f.turn();
    f.say(PyroReply{mortar, false, Unit::a});
    CHECK(f.answers.empty());
    f.say(PyroReply{mortar, true, Unit::b});
    CHECK(f.answers == std::vector{answer(Evidence::verified)});
    CHECK(f.turns_that_fire(2.0) == 0);
    CHECK(f.count<evr::PYRO_CONTROLLER_REFUSED>() == 1);
    CHECK(f.count<evr::PYRO_CONTROLLER_SILENT>() == 0);
    CHECK(f.count<evr::PYRO_REFUSED>() == 0);
}

TEST_CASE("a controller that is silent costs nothing and is told once, at the time-out", "[devices][R50]") {
    Armed f;
    f.fire();
    f.turn();
    f.say(PyroReply{mortar, true, Unit::b});
    CHECK(f.turns_that_fire(0.9) == 0);
    CHECK(f.events.empty());
    f.turns_that_fire(0.2);
    CHECK(f.count<evr::PYRO_CONTROLLER_SILENT>() == 1);
    CHECK(f.answers == std::vector{answer(Evidence::verified)});
}

TEST_CASE("both controllers refuse: refused, tried again each eighth of a second, and told once", "[devices][R50]") {
    Armed f;
    f.fire();
    int tries = 0;
    for (int tick = 0; tick < 80; ++tick) {
        if (f.turn().empty()) continue;
        ++tries;
        f.say(PyroReply{mortar, false, Unit::a});
        f.say(PyroReply{mortar, false, Unit::b});
        REQUIRE(f.answers.back() == answer(Evidence::refused));
    }
    CHECK(tries == 8);  // at 0, 1/8 … 7/8 s
    CHECK(f.count<evr::PYRO_CONTROLLER_REFUSED>() == 2);
    CHECK(f.count<evr::PYRO_REFUSED>() == 1);
    CHECK(f.count<evr::PYRO_CONTROLLER_SILENT>() == 0);
}

TEST_CASE("commanded anew after a refusal it is open again, until the reply", "[devices][R50]") {
    Armed f;
    f.fire(0.25);
    f.turn();
    f.say(PyroReply{mortar, false, Unit::a});
    f.say(PyroReply{mortar, false, Unit::b});
    CHECK(f.turns_that_fire(0.5) == 1);
    CHECK(f.answers == std::vector{answer(Evidence::refused), answer(Evidence::none)});
    CHECK(f.count<evr::PYRO_REFUSED>() == 0);  // nobody knows
}

TEST_CASE("one refuses and the other is silent: nobody knows, and no answer goes to the timeline", "[devices][R50]") {
    Armed f;
    f.fire(0.125);
    f.turn();
    f.say(PyroReply{mortar, false, Unit::a});
    f.turns_that_fire(0.5);
    for (const ActionReply& reply : f.answers) CHECK(reply.evidence == Evidence::none);
    CHECK(f.count<evr::PYRO_CONTROLLER_REFUSED>() == 1);
    CHECK(f.count<evr::PYRO_CONTROLLER_SILENT>() == 1);
    CHECK(f.count<evr::PYRO_REFUSED>() == 0);
}

TEST_CASE("a reply that comes after the time-out still says that it fired", "[devices][R50]") {
    Armed f;
    f.fire(0.125);
    f.turns_that_fire(3.0);
    f.say(PyroReply{mortar, true, Unit::a});
    CHECK(f.answers.back() == answer(Evidence::verified));
    CHECK(f.count<evr::REPLY_UNEXPECTED>() == 0);
}

TEST_CASE("a pyro reply that is not due, or one more than commands, is reported and goes no further",
          "[devices][R2][R4]") {
    Armed f;
    f.say(PyroReply{mortar, true});
    CHECK(f.count<evr::REPLY_UNEXPECTED>() == 1);
    f.fire();
    f.turn();
    f.say(PyroReply{mortar, true});
    f.say(PyroReply{mortar, true});
    CHECK(f.count<evr::REPLY_UNEXPECTED>() == 2);
    CHECK(f.answers.size() == 1);
    f.say(PyroReply{static_cast<PyroId>(200), true});
    f.say(PyroReply{mortar, true, static_cast<Unit>(7)});
    CHECK(f.count<evr::REPLY_UNEXPECTED>() == 4);
}

TEST_CASE("more pyros at once than the bus takes wait for the next cycle; one that there is not is reported",
          "[devices][R4]") {
    Armed f;
    for (std::size_t pyro = 0; pyro < pyro_count; ++pyro) f.say(FirePyro{static_cast<PyroId>(pyro), Sclk{1001.0}});
    std::vector<std::size_t> fired;
    for (int turn = 0; turn < 4; ++turn) fired.push_back(f.turn().size());
    CHECK(fired == std::vector<std::size_t>{16, 16, 2 * pyro_count - 32, 0});
    f.say(FirePyro{static_cast<PyroId>(77), Sclk{1001.0}});
    CHECK(f.count<evr::PYRO_UNKNOWN>() == 1);
}

TEST_CASE("the pyro manager confirms each tick and addresses the selected controller", "[devices][R2][R22]") {
    CHECK(test::confirms_and_addresses<PyroManager>(ModuleId::pyro, Device::pyro));
}

}  // namespace flight_pyro_test
