// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/run.pb.h"
#include "common/result.hpp"
#include "common/time.hpp"

#include <string>
#include <string_view>

namespace aeolis::archive {

inline constexpr std::string_view ert_prefix = "ert:";

/// Reads an instant of a run, as people write it: seconds of SCLK; SCET as scet_from_text() reads it, converted by the
/// run's clock correlation; "ert:" and the UTC time at which the instant is seen on Earth; or a time from entry, E+4:58.
/// @param name  of what is read, for the Error
Result<Sclk> instant_of(std::string_view text, const v1::RunState& run, std::string_view name);

}  // namespace aeolis::archive
