// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time_table.hpp"
#include "telemetry/mfsk/carrier_report.hpp"

#include <optional>
#include <span>

namespace aeolis::telemetry {

/// By how much a carrier's frequency follows a Doppler that ought to have been removed: 0 when it was, 1 when it is still
/// in the samples, −1 and −2 when in-phase and quadrature are exchanged. Least squares over the hops with a carrier; none
/// when the Doppler changes by less than 500 Hz over them, or the frequency does not follow a line.
std::optional<double> doppler_slope(std::span<const CarrierReport> carrier, const TimeTable& doppler_hz);

}  // namespace aeolis::telemetry
