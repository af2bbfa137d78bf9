// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "commands/encoder.hpp"
#include "commands/lifecycle.hpp"
#include "commands/planned_deadlines.hpp"
#include "commands/preconditions.hpp"
#include "common/time.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

// Requests to the command path, and its replies.
namespace aeolis::commands {

/// A request for a command, or for an action on a waiting one.
struct Request {
    std::uint64_t request = 0;  ///< the client's own number, returned in the reply
    std::string client_id{};    ///< the client's own id, for the command's history
    std::string command{};
    std::vector<NamedValue> arguments{};
    bool from_solution = false;       ///< fills arguments that are not given from ground's navigation solution
    bool armed = false;               ///< a hazardous command was armed,
    std::string confirmation{};       ///< and its name typed
    std::string service{};            ///< "AD", "BD"; empty: the default
    bool dry_run = false;             ///< makes every check and sends nothing
    std::optional<Ert> release_at{};  ///< none: at once
    bool hold = false;                ///< it waits until a controller releases it
    std::uint32_t priority = 0;       ///< of due commands the largest leaves first
    std::string action{};             ///< on the waiting command `number`
    std::uint64_t number = 0;
    std::string controller{};  ///< the sender
    std::string browser{};     ///< of the sender, when there are no accounts
    bool director = false;     ///< the sender may send hazardous commands
};

/// The server's verdict on the timeline of a waiting command that changes it.
///
/// After an earlier change has failed, the command leaves once its timeline is known to hold, or never.
struct TimelineVerdict {
    std::uint64_t command = 0;  ///< its number in the run
    std::uint64_t undone = 0;   ///< failed changes at the time of the analysis
    bool refuted = false;       ///< its timeline violates a bound, and it never leaves
    std::string analysis{};     ///< in words, for its history
};

/// The outcome of a request.
struct Reply {
    std::uint64_t request = 0;
    std::uint64_t command = 0;  ///< its number in the run, 0 when refused
    bool accepted = false;      ///< of a dry run: it would be
    bool dry_run = false;
    std::string reason{};                ///< of a refusal: the check and its values
    std::vector<std::uint8_t> octets{};  ///< the encoded packet
    std::string arguments{};             ///< as sent
    std::vector<PreconditionReply> preconditions{};
    std::string service{};
    bool needs_approval = false;
    std::optional<Ert> leaves{};       ///< as far as that is settled
    std::optional<Scet> arrives{};     ///< at the vehicle
    std::optional<Ert> effect_seen{};  ///< no effect can be seen before
    std::string station{};             ///< by which it leaves
    std::optional<Ert> station_until{};
    std::optional<PlannedDeadlines::Deadline> deadline{};  ///< until when it is of use
    std::vector<std::string> too_late_for{};               ///< timepoints
};

/// A change of one command's stage. The first report of a command carries its arguments, octets and client_id.
struct StageReport : StageChange {
    std::uint64_t command = 0;
    std::string name{};
    std::uint32_t count = 0;
    std::string arguments{};
    std::vector<std::uint8_t> octets{};
    bool held = false, needs_approval = false;  ///< of a pending `released`: what it waits for
    std::string asked_by{};                     ///< the sender, who may not approve it
    std::string client_id{};
};

}  // namespace aeolis::commands
