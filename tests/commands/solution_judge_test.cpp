// SPDX-License-Identifier: Apache-2.0
#include "commands/solution_judge.hpp"
#include "tests/support/catch.hpp"

#include <algorithm>

namespace commands_solution_judge_test {

using namespace aeolis;
using namespace aeolis::commands;

namespace {

const std::vector<NamedValue> solution{{"solution_id", 1.0},
                                       {"epoch_sclk", 397'500'000.0},
                                       {"position_x_m", 3.0e6},
                                       {"position_y_m", -2.0e6},
                                       {"position_z_m", 1.0e5},
                                       {"velocity_x_mps", 100.0},
                                       {"velocity_y_mps", -5000.0},
                                       {"velocity_z_mps", 20.0},
                                       {"target_latitude_deg", -4.6},
                                       {"target_longitude_deg", 137.4},
                                       {"target_radius_m", 3'391'148.0}};

std::vector<NamedValue> with(std::string_view name, double more) {
    auto values = solution;
    std::ranges::find(values, name, &NamedValue::name)->value += more;
    return values;
}

}  // namespace

TEST_CASE("parameters are sent that are ground's own: position, velocity and target near one of its solutions",
          "[commands][R51]") {
    SolutionJudge judge{solution};
    CHECK(judge.judge(solution).empty());
    const auto refused = [&](std::string_view name, double inside, double beyond, const std::string& why) {
        INFO(name);
        for (const double sign : {-1.0, 1.0}) {
            CHECK(judge.judge(with(name, sign * inside)).empty());
            CHECK_THAT(judge.judge(with(name, sign * beyond)), Catch::Contains(why));
        }
    };
    for (const char* axis : {"position_x_m", "position_y_m", "position_z_m"})
        refused(axis, 999.0, 1001.0, "the position is 1.0 km from ground's own solution");
    for (const char* axis : {"velocity_x_mps", "velocity_y_mps", "velocity_z_mps"})
        refused(axis, 0.99, 1.01, "the velocity differs by 1.01 m/s");
    refused("target_latitude_deg", 0.5, 0.51, "the target is 30.2 km");
    refused("target_longitude_deg", 0.5, 0.52, "the target is 30.7 km");
    refused("target_radius_m", 2999.0, 3001.0, "target_radius_m is 3.0 km");
    refused("epoch_sclk", 0.007, 0.5, "of no navigation solution that ground has");
    CHECK(judge.judge(with("target_longitude_deg", 360.0)).empty());
    CHECK(judge.judge(with("solution_id", 7.0)).empty());
}

TEST_CASE("a command with an older solution of ground's may still leave; without a solution ground does not judge",
          "[commands][R51]") {
    SolutionJudge judge{std::vector<NamedValue>{}};
    CHECK(judge.latest().empty());
    CHECK(judge.judge(with("position_x_m", 1.0e9)).empty());
    judge.renew(solution);
    auto newer = with("epoch_sclk", 3600.0);
    newer[2].value += 50'000.0;
    judge.renew(newer);
    CHECK(judge.latest() == newer);
    CHECK(judge.judge(solution).empty());
    CHECK(judge.judge(newer).empty());
    CHECK_THAT(judge.judge(with("position_x_m", 50'000.0)), Catch::Contains("50.0 km"));
    // Determined anew at the same epoch: both are ground's, what lies between them is not.
    judge.renew(with("position_x_m", 50'000.0));
    CHECK(judge.judge(solution).empty());
    CHECK(judge.judge(with("position_x_m", 50'000.0)).empty());
    CHECK_THAT(judge.judge(with("position_x_m", 20'000.0)), Catch::Contains("30.0 km"));
    CHECK(judge.judge(std::vector<NamedValue>{{"opcode", 1.0}}).empty());  // no parameters of navigation
}

}  // namespace commands_solution_judge_test
