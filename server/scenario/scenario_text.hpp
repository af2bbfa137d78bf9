// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/scenario.pb.h"
#include "common/result.hpp"
#include "simulation/scenario.hpp"

#include <filesystem>
#include <string>
#include <string_view>

// Converts scenarios between Protobuf text (for people), the message (for API and archive) and plain structs (for the
// simulation). An absent field takes the default of simulation/scenario.hpp.
namespace aeolis::server {

/// Parses and checks. The Error has one line per fault: "FILE:LINE:COLUMN: what" for text, "FILE: field: …" for values.
Result<simulation::Scenario> scenario_from_text(std::string_view text, const std::string& file);

/// Parses a file of at most 1 MiB; the Error names the file. A file may be `like` another beside it: its own fields
/// override the other's, and each list in it replaces the other's. Where there is none beside it, `shipped` has it.
/// Tables of air and wind that it names are read from beside it.
Result<simulation::Scenario> scenario_from_file(const std::filesystem::path& file,
                                                const std::filesystem::path& shipped = {});

/// Converts and checks the API's message. The Error names the field.
Result<simulation::Scenario> scenario_from_message(const v1::Scenario& message);

/// The complete message, with every field set, as a run's row in the archive stores it.
v1::Scenario scenario_to_message(const simulation::Scenario& scenario);
std::string scenario_to_text(const simulation::Scenario& scenario);

/// The fault to inject into a landing of this scenario. The Error names the field at fault.
Result<simulation::Fault> fault_from_message(const v1::FaultInjection& message, const simulation::Scenario& scenario);

}  // namespace aeolis::server
