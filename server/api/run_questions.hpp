#pragma once

#include "server/api/api.hpp"

#include <string_view>
#include <vector>

namespace aeolis::server {

/// What an answer may need besides the archive.
struct Ground {
    const dictionary::Dictionary& dictionary;
    std::optional<Ert> now; ///< of a run that goes on
};

/// A question to one run: the last part of its path, the parameters it knows, and how it is answered.
struct RunQuestionEntry {
    std::string_view name; ///< "events" of /api/v1/runs/{run}/events; "" for the run itself
    std::vector<std::string_view> parameters;
    HttpResponse (*answer)(const Ground&, archive::Reader&, archive::RunId, const QueryText&);
};

/// Of the parameters "from" and "to", seconds of SCLK.
Result<archive::SclkRange> range_of(const QueryText& query);

/// Null when there is no such question.
const RunQuestionEntry* run_question(std::string_view name);
std::string run_question_names();

} // namespace aeolis::server
