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

// What is said to the command path, and what it says.
namespace aeolis::commands {

/// A command that is asked for, or what is to be done about one that waits.
struct Request {
    std::uint64_t request = 0;  ///< the client's own number, given back
    std::string command{};
    std::vector<NamedValue> arguments{};
    bool from_solution = false;  ///< arguments that are not given come from ground's navigation solution
    bool armed = false;          ///< a hazardous command was armed,
    std::string confirmation{};  ///< and its name typed
    std::string service{};       ///< "AD", "BD"; empty: what suits
    bool dry_run = false;        ///< every check, and nothing is sent
    std::string release_at{};    ///< ERT, day-of-year form; empty: at once
    bool hold = false;           ///< it waits until a controller releases it
    std::uint32_t priority = 0;  ///< of those that are due the largest leaves first
    std::string action{};        ///< about a command that waits; then `number` says which
    std::uint64_t number = 0;
    std::string controller{};  ///< who asks
    std::string browser{};     ///< from where, where there are no accounts
};

/// What the server's analysis of the timeline says of a command that waits and changes it: after an earlier change came
/// to nothing it leaves only once its timeline is known to hold, or never.
struct TimelineVerdict {
    std::uint64_t command = 0;  ///< its number in the run
    std::uint64_t undone = 0;   ///< changes that had come to nothing when it was analysed
    bool refuted = false;       ///< its timeline breaks a bound, and it never leaves
    std::string analysis{};     ///< in words, for its history
};

/// What became of a request.
struct Reply {
    std::uint64_t request = 0;
    std::uint64_t command = 0;  ///< its number in the run, 0 when refused
    bool accepted = false;      ///< of a dry run: it would be
    bool dry_run = false;
    std::string reason{};                ///< when refused: which check, with values
    std::vector<std::uint8_t> octets{};  ///< the encoded packet
    std::string arguments{};             ///< as they are sent
    std::vector<PreconditionState> preconditions{};
    std::string service{};
    bool needs_approval = false;
    std::optional<Ert> leaves{};       ///< as far as that is settled
    std::optional<Scet> arrives{};     ///< at the vehicle
    std::optional<Ert> effect_seen{};  ///< before which no effect of it can be seen
    std::string station{};             ///< by which it leaves
    std::optional<Ert> station_until{};
    std::optional<PlannedDeadlines::Deadline> deadline{};  ///< until when it is of use
    std::vector<std::string> too_late_for{};               ///< timepoints
};

/// A change of one command's stage. The first of a command carries its arguments and octets.
struct StageReport : StageChange {
    std::uint64_t command = 0;
    std::string name{};
    std::uint32_t count = 0;
    std::string arguments{};
    std::vector<std::uint8_t> octets{};
    bool held = false, needs_approval = false;  ///< of `released` while pending: what it waits for
    std::string asked_by{};                     ///< of one that needs approval: who may not give it
};

}  // namespace aeolis::commands
