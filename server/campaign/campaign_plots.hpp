// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "server/campaign/campaign_results.hpp"

#include <filesystem>

namespace aeolis::server::campaign {

/// Writes touchdown.svg (places, 99 % ellipse, target), parachute.svg (the air that it opened into, and the box that
/// it is meant for) and touchdown_speed.svg (histograms) into `directory`, which is made.
Result<void> write_plots(CampaignResults& results, const Summary& summary, const std::filesystem::path& directory);

}  // namespace aeolis::server::campaign
