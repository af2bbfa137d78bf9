// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/run.pb.h"
#include "commands/request.hpp"

#include <functional>
#include <string>
#include <variant>
#include <vector>

// What can be ordered of a run. RehearsalDesk decides on the network thread whether and when; RehearsalRunner carries
// the orders out between two cycles.
namespace aeolis::server {

struct PauseRun {
    bool paused = true;
};
struct PaceRun {
    double pace = 1.0;  ///< times real time; 0: as fast as it goes
};
struct StopRun {};

/// A fault to inject, or an instructor's note, of which nothing on board or on the ground hears. Kept with the cycle at
/// which it came.
struct Intervene {
    v1::Intervention intervention;
};

/// A command file, or one command: all are checked before the first is taken, and when one is refused none is.
struct SendCommands {
    /// A reply each, in their order. From any thread.
    using Replies = std::function<void(std::vector<v1::CommandReply>)>;

    std::vector<v1::CommandRequest> requests;
    bool only_check = false;  ///< a dry run
    Replies replies;
    std::string browser{};  ///< without accounts: from which they are sent

    /// Gives each the same refusal.
    void refuse(const std::string& reason) const;
};

using RunOrder = std::variant<PauseRun, PaceRun, StopRun, Intervene, SendCommands, commands::TimelineVerdict>;

}  // namespace aeolis::server
