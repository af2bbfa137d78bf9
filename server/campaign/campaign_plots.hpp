// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "server/campaign/campaign_results.hpp"

#include <filesystem>

namespace aeolis::server::campaign {

/// Writes three plots into `directory`, which is created: touchdown.svg (places, 99 % ellipse, target), parachute.svg
/// (Mach and dynamic pressure at deployment, and the design box) and touchdown_speed.svg (histograms).
Result<void> write_plots(CampaignResults& results, const Summary& summary, const std::filesystem::path& directory);

}  // namespace aeolis::server::campaign
