// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/run.pb.h"
#include "common/result.hpp"
#include "server/archive/reader.hpp"
#include "server/rehearsal/rehearsal_runner.hpp"

namespace aeolis::server {

/// The instant of a run that a fork names. The Error says which it cannot be.
Result<archive::ForkPoint> fork_point_of(const v1::Fork& fork, const v1::RunState& run);

/// Reads the run that the request continues or forks. The Error names the field at fault.
Result<RehearsalRunner::Again> again_of(const v1::StartRehearsal& request, archive::Reader& reader);

}  // namespace aeolis::server
