// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/run.pb.h"
#include "common/result.hpp"
#include "server/archive/reader.hpp"
#include "server/rehearsal/rehearsal_runner.hpp"

namespace aeolis::server {

/// The instant of a run that a fork names. The Error says which it cannot be.
/// @param name  of the field, for the Error
Result<archive::ForkPoint> fork_point_of(const v1::Fork& fork, const v1::RunState& run,
                                         std::string_view name = "fork.at");

/// Whether a run that does not go on was flown to that instant. The Error says when its record ends.
Result<void> check_flown(archive::Reader& reader, const v1::RunState& run, const archive::ForkPoint& at,
                         std::string_view name);

/// Reads the run that the request continues or forks. The Error names the field at fault.
Result<RehearsalRunner::Again> again_of(const v1::StartRehearsal& request, archive::Reader& reader);

}  // namespace aeolis::server
