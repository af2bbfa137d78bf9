// SPDX-License-Identifier: Apache-2.0
#include "server/procedures/step_order.hpp"
#include "tests/support/catch.hpp"

#include <algorithm>
#include <random>
#include <set>

namespace server_procedures_step_order_test {

using namespace aeolis::server::procedures;

namespace {

/// A main body of which each step follows, jumps, or branches, to anywhere.
std::vector<Step> any_body(std::mt19937& random) {
    const auto any = [&](std::size_t below) { return random() % below; };
    std::vector<Step> body(1 + any(8));
    const auto target = [&]() -> Target {
        const auto to = any(body.size() + 2);
        if (to == body.size()) return {Target::Kind::confirmation, 0};
        if (to > body.size()) return {Target::Kind::end, 0};
        return {Target::Kind::step, to};
    };
    for (Step& step : body) {
        if (any(3) == 0) step.next = target();
        if (any(3) == 0)
            for (int i = 0; i < 2; ++i) step.choices.push_back({{}, {}, target()});
    }
    return body;
}

/// By brute force: the steps to which `from` leads in any number of steps.
std::set<std::size_t> reached_from(const std::vector<Step>& body, std::size_t from) {
    std::set<std::size_t> reached;
    for (std::size_t rounds = 0; rounds <= body.size(); ++rounds) {
        std::set<std::size_t> next = reached;
        next.insert(from);
        for (const std::size_t step : next)
            for (const Target& way : ways_on(body, step))
                if (way.kind == Target::Kind::step) reached.insert(way.step);
    }
    return reached;
}

}  // namespace

TEST_CASE("circles and steps that nothing leads to are found as by trying every way, in 2000 bodies from a seed",
          "[procedures]") {
    std::mt19937 random{59};
    std::size_t with_circle = 0, with_unreachable = 0;
    for (int trial = 0; trial < 2000; ++trial) {
        const auto body = any_body(random);
        const auto order = follow(body);
        auto reached = reached_from(body, 0);
        reached.insert(0);
        for (std::size_t step = 0; step < body.size(); ++step) {
            INFO("trial " << trial << ", step " << step);
            const bool named = std::ranges::find(order.unreachable, step) != order.unreachable.end();
            REQUIRE(named == !reached.contains(step));
        }
        const bool circular =
            std::ranges::any_of(reached, [&](std::size_t step) { return reached_from(body, step).contains(step); });
        INFO("trial " << trial);
        REQUIRE(order.circles.empty() == !circular);
        for (const auto& circle : order.circles) {
            REQUIRE(circle.size() >= 2);
            REQUIRE(circle.front() == circle.back());
            for (std::size_t i = 0; i + 1 < circle.size(); ++i) {
                const auto ways = ways_on(body, circle[i]);
                REQUIRE(std::ranges::find(ways, Target{Target::Kind::step, circle[i + 1]}) != ways.end());
            }
        }
        with_circle += circular ? 1 : 0;
        with_unreachable += order.unreachable.empty() ? 0 : 1;
    }
    CHECK(with_circle > 200);
    CHECK(with_circle < 1800);
    CHECK(with_unreachable > 200);
}

TEST_CASE("after the last step of the main body comes the confirmation", "[procedures]") {
    const std::vector<Step> body(2);
    CHECK(ways_on(body, 0) == std::vector{Target{Target::Kind::step, 1}});
    CHECK(ways_on(body, 1) == std::vector{Target{Target::Kind::confirmation, 0}});
}

}  // namespace server_procedures_step_order_test
