// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/api/api.hpp"

#include <span>
#include <string_view>
#include <vector>

namespace aeolis::server {

/// What an answer may need besides the archive.
struct Ground {
    const dictionary::Dictionary& dictionary;
    std::optional<Ert> now;  ///< of a run that goes on
    bool instructor;         ///< who asks may rehearse
};

/// A question to one run: the last part of its path, the parameters it knows, the formats of its answer, and how it is
/// answered.
struct RunQuestionEntry {
    std::string_view name;  ///< "events" of /api/v1/runs/{run}/events; "" for the run itself
    std::vector<std::string_view> parameters;
    std::span<const std::string_view> formats;  ///< of the parameter "format", which is one of them; empty: JSON only
    HttpResponse (*answer)(const Ground&, archive::Reader&, archive::RunId, const QueryText&);
};

/// A parameter that names an instant: seconds of SCLK, or SCET as day_of_year_text() writes it, by the run's clock.
/// None: left out.
Result<std::optional<Sclk>> instant_of(const QueryText& query, std::string_view name, archive::Reader& reader,
                                       archive::RunId run);
/// Of the parameters "from" and "to".
Result<archive::SclkRange> range_of(const QueryText& query, archive::Reader& reader, archive::RunId run);

/// A row a timepoint, then a row an event.
std::string as_flown_csv(const v1::AsFlownReport& report);

/// Null when there is no such question.
const RunQuestionEntry* run_question(std::string_view name);
std::string run_question_names();

}  // namespace aeolis::server
