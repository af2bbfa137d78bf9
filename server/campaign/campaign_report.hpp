// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/campaign/campaign.hpp"
#include "server/campaign/campaign_results.hpp"

#include <string>

namespace aeolis::server::campaign {

/// The work of this call, beside the contents of the file.
struct Call {
    Progress progress{};
    unsigned jobs = 1;       ///< cases flown here at a time
    std::string scenario{};  ///< as given: a file, or the name of a shipped scenario
    std::string results{};   ///< the results file
    std::string queue{};     ///< the engine whose workers flew the cases; empty: flown here
};

std::string ellipse_json(const Ellipse& ellipse);

/// A campaign as `aeolis campaign` prints it: one JSON object on one line, or a table for people.
std::string campaign_json(const Summary& summary, const CampaignVerdict& verdict, const Call& call);
std::string campaign_table(const Summary& summary, const CampaignVerdict& verdict, const Call& call);

/// The progress line: "[=====>    ]  512/8001  4.2 cases/s, 29 min 43 s remain".
std::string progress_line(const Progress& progress);

}  // namespace aeolis::server::campaign
