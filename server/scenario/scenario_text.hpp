// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/scenario.pb.h"
#include "common/result.hpp"
#include "simulation/scenario.hpp"

#include <filesystem>
#include <string>
#include <string_view>

// A scenario as a person writes it (Protobuf text), as the API and the archive hold it (the message), and as the
// simulation flies it (plain structs). A field left out takes the default of simulation/scenario.hpp.
namespace aeolis::server {

/// Parses and checks. Errors are one line a fault: "FILE:LINE:COLUMN: what" for the text, "FILE: field: …" for values.
Result<simulation::Scenario> scenario_from_text(std::string_view text, const std::string& file);

/// The same from a file of at most 1 MiB; an error names the file. A file may be `like` another beside it: what it sets
/// counts over what that one sets, its lists come after that one's.
Result<simulation::Scenario> scenario_from_file(const std::filesystem::path& file);

/// From the API's message. Checked; an error names the field.
Result<simulation::Scenario> scenario_from_message(const v1::Scenario& message);

/// Complete: every field is set. What a run's row in the archive keeps.
v1::Scenario scenario_to_message(const simulation::Scenario& scenario);
std::string scenario_to_text(const simulation::Scenario& scenario);

/// What is to break, in a landing of this scenario. An error names what of it cannot be.
Result<simulation::Fault> fault_from_message(const v1::FaultInjection& message, const simulation::Scenario& scenario);

/// UTC "2012-08-06T05:10:47.4" or by day of year "2012-219T05:10:47.4"; up to microseconds.
Result<Scet> scet_from_text(std::string_view text);

}  // namespace aeolis::server
