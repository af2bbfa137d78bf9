// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/tone_evidence.hpp"

namespace aeolis::telemetry {

/// The carrier in an eighth of a second.
struct CarrierReport {
    double time_s = 0.0;  ///< of the middle, in the samples' time
    CarrierLock lock = CarrierLock::searching;
    double frequency_hz = 0.0, frequency_deviation_hz = 0.0;  ///< Doppler less what was removed
    double rate_hzps = 0.0;
    double total_c_n0_dbhz = 0.0;  ///< running mean; NaN without a carrier
    double fit_c_n0_dbhz = 0.0;    ///< of only the window in which it was found; NaN without a carrier
};

}  // namespace aeolis::telemetry
