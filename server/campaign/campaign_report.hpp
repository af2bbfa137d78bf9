// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/campaign/campaign.hpp"
#include "server/campaign/campaign_results.hpp"

#include <string>

namespace aeolis::server::campaign {

/// What this call did, beside what the file holds.
struct Call {
    Progress progress{};
    unsigned jobs = 1;
    std::string scenario{};  ///< as it was given: a file, or a name that ships
    std::string results{};   ///< the file
};

/// A campaign as `aeolis campaign` prints it: one JSON object on one line, or the same for people.
std::string campaign_json(const Summary& summary, const Call& call);
std::string campaign_table(const Summary& summary, const Call& call);

/// "[=====>    ]  512/8001  4.2 cases/s, 29 min 43 s remain"; the cases done, how fast, and how long it takes from
/// here.
std::string progress_line(const Progress& progress);

}  // namespace aeolis::server::campaign
