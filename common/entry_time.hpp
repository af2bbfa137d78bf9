// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace aeolis {

/// Seconds from entry in the notation of controllers, truncated like a clock: "E+4:58", "E−12:06", "E+1:02:03".
std::string from_entry_text(double e_s);
/// The same rounded to a tenth of a second: "E+4:58.3".
std::string from_entry_tenths_text(double e_s);

}  // namespace aeolis
