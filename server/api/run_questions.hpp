// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/api/api.hpp"
#include "server/api/body_parts.hpp"

#include <span>
#include <string_view>
#include <vector>

namespace aeolis::server {

/// What an answer may need besides the archive.
struct AnswerContext {
    const dictionary::Dictionary& dictionary;
    const instruction::PlanLibrary& plans;
    std::optional<Ert> now;  ///< only of the current run
    bool instructor;         ///< the operator may instruct
    /// Of body_parts.hpp, for the client who asks.
    std::function<decltype(HttpResponse::next_part)(ReadPart)> in_parts;
};

/// A route to a question about one run: the last part of its path, its parameters, the formats of its answer, and its
/// handler.
struct RunRoute {
    std::string_view name;  ///< "events" in /api/v1/runs/{run}/events; "" for the run itself
    std::vector<std::string_view> parameters;
    std::span<const std::string_view> formats;  ///< allowed values of the parameter "format"; empty: JSON only
    HttpResponse (*answer)(const AnswerContext&, archive::Reader&, archive::RunId, const QueryText&);
    bool refused_for_instructors = false;  ///< it answers 403 to others while a run goes on, which is audited
};

/// Reads a parameter that names an instant, as archive::instant_of() does. None when absent.
Result<std::optional<Sclk>> instant_of(const QueryText& query, std::string_view name, archive::Reader& reader,
                                       archive::RunId run);
/// The range given by the parameters "from" and "to".
Result<archive::SclkRange> range_of(const QueryText& query, archive::Reader& reader, archive::RunId run);

/// CSV with one row per timepoint, then one row per event.
std::string as_flown_csv(const v1::AsFlownReport& report);

/// Finds a question by name. Null when there is none.
const RunRoute* run_question(std::string_view name);
std::string run_question_names();

}  // namespace aeolis::server
