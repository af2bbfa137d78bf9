// SPDX-License-Identifier: Apache-2.0
#include "telemetry/alarm_desk.hpp"

#include "tests/support/catch.hpp"

namespace telemetry_alarm_desk_test {

using namespace aeolis;
using namespace aeolis::telemetry;
using dictionary::Severity;

namespace {

constexpr Ert at_s(double seconds) {
    return Ert{static_cast<std::int64_t>(seconds * 1e6)};
}

struct Desk {
    AlarmDesk desk;
    bool latches = false;

    std::string after(Severity severity) {
        desk.change("speed", severity, latches);
        return now();
    }
    std::string after(AlarmAct act, Ert at = at_s(1.0), Ert until = {}) {
        desk.act("speed", act, at, until);
        return now(at);
    }
    std::string refusal(AlarmAct act, Ert at = at_s(1.0)) const {
        const auto may = desk.may("speed", act, at);
        return may ? "" : may.error().message;
    }
    std::string now(Ert at = at_s(1.0)) const {
        const auto found = desk.all().find("speed");
        return found == desk.all().end() ? "never" : name_of(found->second.standing(at));
    }
};

}  // namespace

TEST_CASE("an alarm that came and went unseen stays until someone has seen it", "[alarms]") {
    Desk desk;
    CHECK(desk.after(Severity::warning) == "unacknowledged");
    CHECK(desk.after(Severity::none) == "returned");
    CHECK(desk.after(AlarmAct::acknowledge) == "normal");
}

TEST_CASE("an acknowledged alarm is normal as soon as its cause is gone", "[alarms]") {
    Desk desk;
    desk.after(Severity::warning);
    CHECK(desk.after(AlarmAct::acknowledge) == "acknowledged");
    CHECK(desk.after(Severity::none) == "normal");
    CHECK(desk.after(Severity::watch) == "unacknowledged");  // it came again
}

TEST_CASE("an alarm that grows more severe than it was asks again, one that shrinks does not", "[alarms]") {
    Desk desk;
    desk.after(Severity::critical);
    desk.after(AlarmAct::acknowledge);
    CHECK(desk.after(Severity::watch) == "acknowledged");
    CHECK(desk.after(Severity::critical) == "acknowledged");
    CHECK(desk.after(Severity::severe) == "unacknowledged");
}

TEST_CASE("an alarm that latches goes only when it is acknowledged, its cause gone, and someone resets it",
          "[alarms]") {
    Desk desk;
    desk.latches = true;
    desk.after(Severity::critical);
    CHECK(desk.refusal(AlarmAct::reset) == "alarm speed still stands: it can be reset when its cause is gone");
    CHECK(desk.after(Severity::none) == "latched");
    CHECK(desk.refusal(AlarmAct::reset) == "alarm speed is not acknowledged: acknowledge it first");
    CHECK(desk.after(AlarmAct::acknowledge) == "latched");
    CHECK(desk.after(AlarmAct::reset) == "normal");
    CHECK(desk.refusal(AlarmAct::reset) == "alarm speed is not latched: there is nothing to reset");
}

TEST_CASE("a shelved alarm is out of sight until its time is up, whatever it does meanwhile", "[alarms]") {
    Desk desk;
    desk.after(Severity::watch);
    CHECK(desk.after(AlarmAct::shelve, at_s(10.0), at_s(70.0)) == "shelved");
    CHECK(desk.after(Severity::severe) == "shelved");
    CHECK(desk.now(at_s(69.999)) == "shelved");
    CHECK(desk.now(at_s(70.0)) == "unacknowledged");
    CHECK(desk.refusal(AlarmAct::unshelve, at_s(70.0)) == "alarm speed is not shelved");
    CHECK(desk.after(AlarmAct::shelve, at_s(80.0), at_s(90.0)) == "shelved");
    CHECK(desk.after(AlarmAct::unshelve, at_s(81.0)) == "unacknowledged");
}

TEST_CASE("what makes no sense is refused by name and changes nothing", "[alarms]") {
    Desk desk;
    CHECK(desk.refusal(AlarmAct::acknowledge) == "alarm speed is normal: there is nothing to acknowledge");
    CHECK(desk.after(AlarmAct::acknowledge) == "never");
    desk.after(Severity::watch);
    desk.after(AlarmAct::acknowledge);
    CHECK(desk.refusal(AlarmAct::acknowledge) == "alarm speed has been acknowledged already");
    CHECK(desk.after(Severity::none) == "normal");
    desk.desk.change("altitude", Severity::none, false);
    CHECK(desk.desk.all().size() == 1);
}

TEST_CASE("the words of acts read back", "[alarms]") {
    for (const AlarmAct act : {AlarmAct::acknowledge, AlarmAct::shelve, AlarmAct::unshelve, AlarmAct::reset})
        CHECK(alarm_act(name_of(act)) == act);
    CHECK_FALSE(alarm_act("forget").has_value());
}

}  // namespace telemetry_alarm_desk_test
