// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/run.pb.h"
#include "common/result.hpp"
#include "common/time.hpp"

#include <string>
#include <string_view>

namespace aeolis::archive {

inline constexpr std::string_view ert_prefix = "ert:";
inline constexpr std::string_view scet_prefix = "scet:";

/// What is needed to find an instant of a run in its clocks.
struct RunClocks {
    ClockCorrelation correlation;  ///< scet 0: nobody knows it
    Sclk entry;                    ///< 0: nobody knows it
    double light_time_s = 0.0;
};
RunClocks clocks_of(const v1::RunState& run);

/// Reads an instant of a run, as people write it: seconds of SCLK; SCET as scet_from_text() reads it, with "scet:"
/// before it or not, converted by the run's clock correlation; "ert:" and the UTC time at which the instant is seen on
/// Earth; or a time from entry, E+4:58, which is an Error where nobody knows when entry is.
/// @param name  of what is read, for the Error
Result<Sclk> instant_of(std::string_view text, const v1::RunState& run, std::string_view name);

/// Whether the text is an instant as people write it, of whatever run. Its Error says how they are written.
Result<void> check_instant(std::string_view text, std::string_view name);

/// Reads the time at which something leaves the station. A UTC time alone, or after "ert:", is the station's own. A
/// time of the vehicle (SCLK, E+4:58, "scet:" and a UTC time) is that of its arrival there: it leaves a light time
/// earlier. Errors as instant_of().
Result<Ert> departure_of(std::string_view text, const RunClocks& clocks, std::string_view name);

/// Reads the time at which something reaches the station, in the same forms: what is at the vehicle at a time of the
/// vehicle reaches it a light time later. Errors as instant_of().
Result<Ert> reception_of(std::string_view text, const RunClocks& clocks, std::string_view name);

}  // namespace aeolis::archive
