// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time_table.hpp"
#include "telemetry/mfsk/carrier_report.hpp"
#include "telemetry/mfsk/tone_receiver.hpp"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace aeolis::server {

/// What was heard in a recording.
struct HeardRecording {
    telemetry::ReceiverStatus status;
    std::size_t tones = 0, erasures = 0;
    double length_s = 0.0;
    std::uint64_t left_over_octets = 0;             ///< behind the last whole sample
    std::vector<telemetry::CarrierReport> carrier;  ///< each second's first, for the slope

    void add(const telemetry::CarrierReport& report) {
        if (carrier.empty() || report.time_s >= carrier.back().time_s + 1.0) carrier.push_back(report);
    }
};

/// What was said of its samples.
struct SampleClaims {
    double rate_hz = 0.0;
    std::string format;
    TimeTable predict_hz, expected_hz;  ///< Doppler removed before sampling, and still in the samples
    double symbol_s = 0.0;
    std::optional<double> frequency_hz = {};  ///< of the middle of the band
    double carrier_hz = 0.0;                  ///< at which tones are sent
};

struct ReceptionRemark {
    std::string text;
    bool fault = true;  ///< the exit code is 1
};

/// What is not as it should be at the end of a recording, though tones may have been decoded: silence, no carrier, a
/// carrier without a tone, a cut file, and whatever contradicts what is said of the samples.
std::vector<ReceptionRemark> check_reception(const HeardRecording& heard, const SampleClaims& claims);

}  // namespace aeolis::server
