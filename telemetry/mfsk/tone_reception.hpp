// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time_table.hpp"
#include "telemetry/mfsk/symbol_sequence.hpp"

#include <cstdint>
#include <optional>
#include <vector>

namespace aeolis::telemetry {

/// A decided tone or an erasure, with its evidence.
struct ToneReception {
    std::optional<std::uint8_t> tone;           ///< none: erased
    double start_s = 0.0;                       ///< in the samples' time, to a hop (1/8 s)
    double total_c_n0_dbhz = 0.0;               ///< total power to noise density
    double doppler_hz = 0.0;                    ///< predicted plus tracked; the symbol's mean
    CarrierLock lock = CarrierLock::searching;  ///< the worst during the symbol
    double seen_fraction = 0.0;                 ///< fraction of the symbol with a carrier
    ToneEvidence evidence;
};

/// The receiver's state after the newest decided hop.
struct ReceiverStatus {
    CarrierLock lock = CarrierLock::searching;
    double total_c_n0_dbhz = 0.0, doppler_hz = 0.0;
    double carrier_s = 0.0, without_s = 0.0;  ///< present times with and without a carrier
    double gap_s = 0.0;                       ///< of those, without usable samples
    int acquisitions = 0;
    double loudest = 0.0;  ///< largest power of a sample
    int contradicted = 0;  ///< tones erased because others lie between the tones' frequencies: a wrong rate
    std::optional<double> clock_error_ppm;  ///< of the samples' clock, from the tones' frequencies; none: not yet known
    std::vector<double> left_out_hz;        ///< lines in the samples that were found not to be the vehicle's carrier
    std::vector<double> standing_hz;        ///< lines near the followed carrier that stand still; it may be one
};

/// What a receiver is told about its samples.
struct ReceiverInput {
    TimeTable predict_hz;                  ///< Doppler removed before sampling
    double start_s = 0.0;                  ///< the first sample's time on the predict's scale
    TimeTable expected_hz;                 ///< Doppler still in the samples, as of a fixed oscillator: removed here
    std::vector<double> excluded_hz;       ///< lines in the samples that are left out; 0 is a DC block
    std::optional<double> symbols_from_s;  ///< symbols begin then, and directly after each other; none: at any time
};

}  // namespace aeolis::telemetry
