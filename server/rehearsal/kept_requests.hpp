// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/kept.pb.h"
#include "server/archive/records.hpp"
#include "server/rehearsal/rehearsal.hpp"

#include <functional>

namespace aeolis::server {

/// Carries out a request that a run took, once more. `accepted`: what becomes of an accepted command. False: it is
/// refused now.
bool repeat(Rehearsal& rehearsal, const v1::KeptRequest& kept,
            const std::function<void(const v1::CommandReply&)>& accepted = {});

/// Flies a run again from its beginning, with the requests that it took, up to a cycle. The Error says that it ends
/// before, what is refused now, or that it was stopped.
Result<void> fly_again(Rehearsal& rehearsal, const archive::FlownRun& run, std::uint64_t cycle,
                       const std::function<bool()>& stop);

}  // namespace aeolis::server
