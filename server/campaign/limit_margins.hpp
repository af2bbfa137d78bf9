// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/campaign/case_table.hpp"
#include "simulation/scenario.hpp"

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

// Whether a campaign passes by its scenario's limits, and by how much.
namespace aeolis::server::campaign {

/// Of a figure that no landing has, or too few for it.
inline constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// A limit, and the case that came nearest to it or exceeded it most.
struct LimitMargin {
    std::string limit;  ///< of the scenario's field: "touchdown_vertical_max_mps"
    double bound = 0.0;
    double value = unknown;      ///< of the worst landing; no number: no landing has a figure
    double margin = unknown;     ///< in the limit's unit; negative: exceeded
    std::uint64_t number = 0;    ///< of that case; 0: none
    std::uint64_t exceeded = 0;  ///< landings that did
};

struct CampaignVerdict {
    std::uint64_t cases = 0;
    std::uint64_t within = 0;  ///< landed within all limits
    double fraction_min = 1.0;
    std::vector<LimitMargin> limits;  ///< all of them, in the scenario's order
    bool passes() const;
    double fraction() const;
};
CampaignVerdict verdict_of(const CaseTable& table, const simulation::Limits& limits);

/// A table for people, with the verdict in its last line.
std::string verdict_table(const CampaignVerdict& verdict);
std::string verdict_json(const CampaignVerdict& verdict);
std::string limit_json(const LimitMargin& one);  ///< without figures where no landing has one

}  // namespace aeolis::server::campaign
