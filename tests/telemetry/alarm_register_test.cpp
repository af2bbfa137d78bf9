// SPDX-License-Identifier: Apache-2.0
#include "telemetry/alarm_register.hpp"

#include "tests/support/catch.hpp"

namespace telemetry_alarm_register_test {

using namespace aeolis;
using namespace aeolis::telemetry;
using dictionary::Severity;

namespace {

constexpr Ert at_s(double seconds) {
    return Ert{static_cast<std::int64_t>(seconds * 1e6)};
}

struct Fixture {
    AlarmRegister alarms;
    bool latches = false;

    std::string after(Severity severity) {
        alarms.change("speed", severity, latches);
        return now();
    }
    std::string after(AlarmAct act, Ert at = at_s(1.0), Ert until = {}) {
        alarms.act("speed", act, at, until);
        return now(at);
    }
    std::string refusal(AlarmAct act, Ert at = at_s(1.0)) const {
        const auto may = alarms.may("speed", act, at);
        return may ? "" : may.error().message;
    }
    std::string now(Ert at = at_s(1.0)) const {
        const auto found = alarms.all().find("speed");
        return found == alarms.all().end() ? "never" : name_of(found->second.standing(at));
    }
};

}  // namespace

TEST_CASE("an alarm that came and went unseen stays until someone has seen it", "[alarms]") {
    Fixture alarms;
    CHECK(alarms.after(Severity::warning) == "unacknowledged");
    CHECK(alarms.after(Severity::none) == "returned");
    CHECK(alarms.after(AlarmAct::acknowledge) == "normal");
}

TEST_CASE("an acknowledged alarm is normal as soon as its cause is gone", "[alarms]") {
    Fixture alarms;
    alarms.after(Severity::warning);
    CHECK(alarms.after(AlarmAct::acknowledge) == "acknowledged");
    CHECK(alarms.after(Severity::none) == "normal");
    CHECK(alarms.after(Severity::watch) == "unacknowledged");  // it came again
}

TEST_CASE("an alarm that grows more severe than it was asks again, one that shrinks does not", "[alarms]") {
    Fixture alarms;
    alarms.after(Severity::critical);
    alarms.after(AlarmAct::acknowledge);
    CHECK(alarms.after(Severity::watch) == "acknowledged");
    CHECK(alarms.after(Severity::critical) == "acknowledged");
    CHECK(alarms.after(Severity::severe) == "unacknowledged");
}

TEST_CASE("an alarm that latches goes only when it is acknowledged, its cause gone, and someone resets it",
          "[alarms]") {
    Fixture alarms;
    alarms.latches = true;
    alarms.after(Severity::critical);
    CHECK(alarms.refusal(AlarmAct::reset) == "alarm speed still stands: it can be reset when its cause is gone");
    CHECK(alarms.after(Severity::none) == "latched");
    CHECK(alarms.refusal(AlarmAct::reset) == "alarm speed is not acknowledged: acknowledge it first");
    CHECK(alarms.after(AlarmAct::acknowledge) == "latched");
    CHECK(alarms.after(AlarmAct::reset) == "normal");
    CHECK(alarms.refusal(AlarmAct::reset) == "alarm speed is not latched: there is nothing to reset");
}

TEST_CASE("a shelved alarm is out of sight until its time is up, whatever it does meanwhile", "[alarms]") {
    Fixture alarms;
    alarms.after(Severity::watch);
    CHECK(alarms.after(AlarmAct::shelve, at_s(10.0), at_s(70.0)) == "shelved");
    CHECK(alarms.after(Severity::severe) == "shelved");
    CHECK(alarms.now(at_s(69.999)) == "shelved");
    CHECK(alarms.now(at_s(70.0)) == "unacknowledged");
    CHECK(alarms.refusal(AlarmAct::unshelve, at_s(70.0)) == "alarm speed is not shelved");
    CHECK(alarms.after(AlarmAct::shelve, at_s(80.0), at_s(90.0)) == "shelved");
    CHECK(alarms.after(AlarmAct::unshelve, at_s(81.0)) == "unacknowledged");
}

TEST_CASE("what makes no sense is refused by name and changes nothing", "[alarms]") {
    Fixture alarms;
    CHECK(alarms.refusal(AlarmAct::acknowledge) == "alarm speed is normal: there is nothing to acknowledge");
    CHECK(alarms.after(AlarmAct::acknowledge) == "never");
    alarms.after(Severity::watch);
    alarms.after(AlarmAct::acknowledge);
    CHECK(alarms.refusal(AlarmAct::acknowledge) == "alarm speed has been acknowledged already");
    CHECK(alarms.after(Severity::none) == "normal");
    alarms.alarms.change("altitude", Severity::none, false);
    CHECK(alarms.alarms.all().size() == 1);
}

TEST_CASE("the words of acts read back", "[alarms]") {
    for (const AlarmAct act : {AlarmAct::acknowledge, AlarmAct::shelve, AlarmAct::unshelve, AlarmAct::reset})
        CHECK(alarm_act(name_of(act)) == act);
    CHECK_FALSE(alarm_act("forget").has_value());
}

}  // namespace telemetry_alarm_register_test
