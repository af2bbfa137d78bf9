// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/run.pb.h"
#include "commands/request.hpp"
#include "commands/shares.hpp"

#include <functional>
#include <string>
#include <variant>
#include <vector>

// Orders to a run. RehearsalManager decides on the network thread whether and when; RehearsalRunner carries them out
// between two cycles.
namespace aeolis::server {

struct PauseRun {
    bool paused = true;
};
struct PaceRun {
    double pace = 1.0;  ///< times real time; 0: as fast as possible
};
/// Flies to a time as fast as possible, and holds there: the next act of a rehearsal. Commands are refused meanwhile;
/// pausing ends it where it is.
struct JumpRun {
    double to_e_s = 0.0;  ///< from entry, by the vehicle's clock
};
struct StopRun {};
/// The server ends: nothing more is flown, and the run stays as after a crash, so that it can be continued.
struct LeaveRun {};

/// A fault to inject, or an instructor's note, which neither vehicle nor ground receives; or, with neither, an inject of
/// the run's plan by its id: now, or `skipped`. Stored with the cycle at which it was received.
struct InterveneRun {
    v1::Intervention intervention;
};

/// A command or command file. All commands are checked before the first is taken; one refusal refuses all.
struct SendCommands {
    /// One reply per command, in order. From any thread.
    using Replies = std::function<void(std::vector<v1::CommandReply>)>;

    std::vector<v1::CommandRequest> requests;
    bool only_check = false;  ///< true: a dry run
    Replies replies;
    std::string browser{};  ///< without accounts: from which they are sent
    bool director = false;  ///< the sender may send hazardous commands

    /// The sender against whose share it counts.
    std::string asker() const {
        return requests.empty() ? browser : commands::asker_of(browser, requests.front().controller());
    }

    /// Replies to each command with the same refusal.
    void refuse(const std::string& reason) const;
};

using RunOrder =
    std::variant<PauseRun, PaceRun, JumpRun, StopRun, LeaveRun, InterveneRun, SendCommands, commands::TimelineVerdict>;

}  // namespace aeolis::server
