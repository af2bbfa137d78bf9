// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/run.pb.h"
#include "aeolis/v1/score.pb.h"
#include "server/api/score_acts.hpp"
#include "server/instruction/inject_plan.hpp"

#include <limits>
#include <string>
#include <vector>

namespace aeolis::server {

/// What a team is judged by.
struct TeamCase {
    const instruction::Rubric& rubric;
    const instruction::InjectPlan* plan = nullptr;  ///< null: the run had none
    const std::vector<v1::Intervention>& interventions;
    const ScoreActs& acts;
    double from_e_s = -std::numeric_limits<double>::infinity();  ///< of a fork: what was done before is another run's
    double until_e_s = std::numeric_limits<double>::infinity();  ///< what takes longer than the run is not judged
    std::vector<v1::Jump> jumps{};                               ///< of time, in which nobody could act
    double light_time_s = 0.0;  ///< an outage of the station is felt on Earth itself, not a light time later
};

/// What the team did, point by point, by skill. What nobody could see, and what nobody could do anything about, is not
/// judged.
struct TeamPoints {
    struct Point {
        instruction::Skill of = instruction::Skill::detection;
        v1::ScorePoint point;
    };
    std::vector<Point> points;             ///< by time
    std::vector<v1::ScoreFact> faults;     ///< each fault that was judged, with its first sign
    std::vector<v1::ScoreFault> injected;  ///< every fault
};
TeamPoints judge_team(const TeamCase& judged);

}  // namespace aeolis::server
