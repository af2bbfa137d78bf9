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

/// Whether it is the fork of the run, and no request of anybody.
bool is_fork(const archive::RequestRecord& request);

/// How far a run is flown again, and what is looked at on the way.
struct FlyAgain {
    std::uint64_t cycle = 0;
    bool with_requests_of_cycle = false;  ///< what was taken before that cycle's flight, too: of a run that waits there
    std::function<bool()> stop;
    std::function<Result<void>(const telemetry::Received&)> look;  ///< at what ground receives; an Error ends it
};
/// Flies a run again from its beginning, with the requests that it took. The Error says that it ends before, what is
/// refused now, what `look` found, or that it was stopped.
Result<void> fly_again(Rehearsal& rehearsal, const archive::FlownRun& run, const FlyAgain& how);

}  // namespace aeolis::server
