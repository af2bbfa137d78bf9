// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/score.pb.h"
#include "server/archive/reader.hpp"
#include "server/instruction/inject_plan.hpp"

#include <optional>
#include <string>
#include <vector>

namespace aeolis::server {

/// The facts on which the score of a finished rehearsal rests: what was received, and what people did. They contain
/// nothing of the simulation's truth.
struct ScoreFacts {
    struct Landed {
        double e_s = 0.0;
        std::string words;             ///< flight's own
        std::optional<double> miss_m;  ///< from the target, by navigation on board; none: not known
    };
    v1::AsFlownReport report;  ///< with all commands and notes
    std::optional<Landed> landed;
    std::vector<v1::Item> alarms;  ///< changes of alarms and actions on them, in their order
    std::vector<v1::Item> room;    ///< acts on procedures and positions
    std::vector<v1::Item> heard;   ///< event reports and tones as received, recorded ones too
    std::optional<Ert> end;        ///< of the run: what people did from then on does not count
    std::vector<v1::Intervention> interventions;
    std::vector<v1::Jump> jumps;  ///< of time
    std::optional<instruction::InjectPlan> plan;
};

/// The facts in words and the points of each term, by the rubric.
v1::Score score_of(const ScoreFacts& facts, const dictionary::Dictionary& dictionary,
                   const instruction::Rubric& rubric);

inline constexpr std::size_t scored_heard_max = 200'000;   ///< events and tones; chosen as the next
inline constexpr std::size_t scored_alarms_max = 200'000;  ///< chosen, some 40 MB: no landing comes near it

/// The as-flown report with all commands and notes; Reader::as_flown() has only the first page of each.
Result<v1::AsFlownReport> whole_report(archive::Reader& reader, archive::RunId run);

/// Whether a run has a score: it is a rehearsal that has finished.
bool has_score(const v1::RunState& run);
/// What the score of a run rests on, from its whole report. Fails when only a part of it could be had.
Result<ScoreFacts> score_facts(archive::Reader& reader, v1::AsFlownReport report,
                               const dictionary::Dictionary& dictionary);
/// The score of a run with has_score(), from its whole report. Fails when only a part of the run could be scored.
Result<v1::Score> rehearsal_score(archive::Reader& reader, v1::AsFlownReport report,
                                  const dictionary::Dictionary& dictionary, const instruction::Rubric& rubric);

}  // namespace aeolis::server
