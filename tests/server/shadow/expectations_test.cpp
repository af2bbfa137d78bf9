// SPDX-License-Identifier: Apache-2.0
#include "server/shadow/expectations.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <cmath>
#include <random>

namespace server_expectations_test {

using namespace aeolis;
using namespace aeolis::server::shadow;

namespace {

constexpr Sclk entry{1000.0};

/// Flights of a plan whose third and fourth timepoints follow the second, which differs from case to case.
struct Plan {
    static constexpr std::size_t by_clock = 0, trigger = 1, after = 2, late = 3;
    std::mt19937 luck{7};
    std::normal_distribution<double> normal{0.0, 1.0};

    Course course() {
        const auto tick = [](double s) { return std::round(s * 64.0) / 64.0; };
        Course course;
        course.first = entry + 10.0;
        const double first_s = 250.0 + 4.0 * normal(luck), second_s = first_s + 20.0 + 0.5 * normal(luck);
        course.fired = {entry + 0.0, entry + tick(first_s), entry + tick(second_s),
                        entry + tick(second_s + 100.0 + 2.0 * normal(luck))};
        for (int i = 0; i < 100; ++i) {
            Course::Second second;
            second.altitude_m = static_cast<float>(1000.0 - 5.0 * i + 10.0 * normal(luck));
            second.speed_mps = 100.0F;
            course.seconds.push_back(second);
        }
        return course;
    }
    v1::PlanEnsemble ensemble(std::size_t cases) {
        std::vector<Course> courses;
        for (std::size_t i = 0; i < cases; ++i) courses.push_back(course());
        return ensemble_of(courses, 0, entry - 100.0, entry);
    }
};

double width(const ExpectedTime& time) {
    REQUIRE(time.interval_99);
    return time.interval_99->to - time.interval_99->from;
}

}  // namespace

TEST_CASE("a timepoint is expected when the flights of the plan fired it, within an interval that holds 99 of 100",
          "[shadow][R57]") {
    Plan plan;
    Expectations expectations{tests::shipped_dictionary(), entry};
    CHECK_FALSE(expectations.expected(Plan::trigger));
    expectations.take(plan.ensemble(300));
    CHECK(expectations.cases() == 300);
    const auto by_clock = expectations.expected(Plan::by_clock);
    REQUIRE(by_clock);
    CHECK(by_clock->e_s == 0.0);
    CHECK(width(*by_clock) == 0.0);
    CHECK_FALSE(expectations.expected(40));  // no case fires it

    int within = 0, tolerated = 0;
    constexpr int flown = 1000;
    const auto trigger = expectations.expected(Plan::trigger);
    REQUIRE(trigger);
    for (int i = 0; i < flown; ++i) {
        const double e_s = *plan.course().fired[Plan::trigger] - entry;
        within += e_s >= trigger->interval_99->from && e_s <= trigger->interval_99->to ? 1 : 0;
        tolerated += e_s >= trigger->tolerated.from && e_s <= trigger->tolerated.to ? 1 : 0;
    }
    CHECK(within >= 970);
    CHECK(tolerated == flown);
}

TEST_CASE("what was told of timepoints before narrows the interval, and it still holds 99 of 100", "[shadow][R57]") {
    Plan plan;
    const auto ensemble = plan.ensemble(300);
    int within = 0;
    constexpr int flown = 500;
    for (int i = 0; i < flown; ++i) {
        Expectations expectations{tests::shipped_dictionary(), entry};
        expectations.take(ensemble);
        const auto course = plan.course();
        const double before_s = width(*expectations.expected(Plan::late));
        expectations.fired(Plan::trigger, *course.fired[Plan::trigger]);
        const double after_trigger_s = width(*expectations.expected(Plan::late));
        expectations.fired(Plan::after, *course.fired[Plan::after]);
        const auto late = expectations.expected(Plan::late);
        CHECK(after_trigger_s < 0.8 * before_s);
        CHECK(width(*late) < before_s);
        const double e_s = *course.fired[Plan::late] - entry;
        within += e_s >= late->interval_99->from && e_s <= late->interval_99->to ? 1 : 0;
    }
    CHECK(within >= 480);
}

TEST_CASE("of fewer cases than an interval takes there is a time, and no interval", "[shadow][R57]") {
    Plan plan;
    Expectations expectations{tests::shipped_dictionary(), entry};
    expectations.take(plan.ensemble(50));
    const auto trigger = expectations.expected(Plan::trigger);
    REQUIRE(trigger);
    CHECK(trigger->cases == 50);
    CHECK(std::abs(trigger->e_s - 250.0) < 2.0);
    CHECK_FALSE(trigger->interval_99);
    CHECK(trigger->tolerated.from < 245.0);
}

TEST_CASE("of what had fired before the flights began nothing is expected", "[shadow][R57]") {
    Plan plan;
    std::vector<Course> courses;
    for (int i = 0; i < 20; ++i) courses.push_back(plan.course());
    Expectations expectations{tests::shipped_dictionary(), entry};
    expectations.take(ensemble_of(courses, 0, entry + 100.0, entry));
    CHECK_FALSE(expectations.expected(Plan::by_clock));
    CHECK(expectations.expected(Plan::trigger));
}

TEST_CASE("of a plan that was changed nothing is expected", "[shadow][R57]") {
    Plan plan;
    Expectations expectations{tests::shipped_dictionary(), entry};
    expectations.take(plan.ensemble(20));
    expectations.fired(Plan::trigger, entry + 251.0);
    expectations.withdraw();
    CHECK_FALSE(expectations.known());
    CHECK_FALSE(expectations.expected(Plan::late));
    CHECK_FALSE(expectations.range(Quantity::altitude_m, entry + 20.0));
    CHECK(expectations.told(Plan::trigger) == entry + 251.0);
}

TEST_CASE("between two seconds of the plan's flights the range lies between theirs, and beyond them there is none",
          "[shadow][R57]") {
    Plan plan;
    Expectations expectations{tests::shipped_dictionary(), entry};
    expectations.take(plan.ensemble(100));
    const auto at = expectations.range(Quantity::altitude_m, entry + 20.5);
    REQUIRE(at);
    CHECK(std::abs(at->median - 947.5) < 5.0);
    CHECK(at->least < at->median);
    CHECK(at->most > at->median);
    CHECK(at->tolerated_from() < at->least);
    CHECK(expectations.range(Quantity::speed_mps, entry + 20.5)->most == 100.0);
    CHECK_FALSE(expectations.range(Quantity::altitude_m, entry + 9.0));
    CHECK_FALSE(expectations.range(Quantity::altitude_m, entry + 110.0));
}

TEST_CASE("a case that ends early ends the ranges for all: what flies longer is no sample of them", "[shadow][R57]") {
    Plan plan;
    std::vector<Course> courses{plan.course(), plan.course(), plan.course()};
    courses[1].seconds.resize(30);
    const auto ensemble = ensemble_of(courses, 4, entry + 5.0, entry);
    CHECK(ensemble.order() == 4);
    CHECK(ensemble.from_e_s() == 5.0);
    CHECK(ensemble.first_e_s() == 10);
    CHECK(ensemble.altitude_m_size() == 3 * 30);
    CHECK(ensemble_of({}, 0, entry, entry).altitude_m().empty());
}

TEST_CASE("a hundredth of the cases that is lost long before the others ends no range, more of them do",
          "[shadow][R57]") {
    Plan plan;
    std::vector<Course> courses;
    for (int i = 0; i < 200; ++i) courses.push_back(plan.course());
    const auto seconds = static_cast<int>(courses.front().seconds.size());
    REQUIRE(seconds > 95);
    courses[3].seconds.resize(30);
    courses[90].seconds.resize(12);
    CHECK(ensemble_of(courses, 0, entry, entry).altitude_m_size() == 3 * seconds);
    courses[120].seconds.resize(30);
    CHECK(ensemble_of(courses, 0, entry, entry).altitude_m_size() == 3 * 12);
    courses.resize(100);
    courses[3] = courses[90] = plan.course();
    courses[50].seconds.resize(90);  // an early touchdown is no loss
    CHECK(ensemble_of(courses, 0, entry, entry).altitude_m_size() == 3 * 90);
}

}  // namespace server_expectations_test
