// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time_table.hpp"
#include "telemetry/mfsk/carrier_report.hpp"

#include <optional>
#include <span>

namespace aeolis::telemetry {

/// The slope of a carrier's frequency over a Doppler that should have been removed.
///
/// It is 0 when the Doppler was removed and 1 when it is still in the samples; −1 and −2 when in-phase and quadrature
/// are exchanged. It is found by least squares over the hops with a carrier; none when the Doppler changes by less than
/// 500 Hz over them, or the frequency does not follow a line.
std::optional<double> doppler_slope(std::span<const CarrierReport> carrier, const TimeTable& doppler_hz);

}  // namespace aeolis::telemetry
