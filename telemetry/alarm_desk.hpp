// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "common/time.hpp"
#include "dictionaries/dictionary.hpp"

#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace aeolis::telemetry {

/// What a controller does about an alarm.
enum class AlarmAct {
    acknowledge,  ///< "I have seen it": until it grows more severe, or comes again
    shelve,       ///< out of sight for a limited time
    unshelve,
    reset,  ///< of one that latches: its cause is gone, and it may go
};
/// Their words in the API and in the archive.
const char* name_of(AlarmAct act);
std::optional<AlarmAct> alarm_act(std::string_view word);

/// An alarm and what has been done about it. [isa-18.2]
struct AlarmState {
    dictionary::Severity severity{};  ///< of what is so now; none: within limits
    dictionary::Severity worst{};     ///< since it last was normal
    bool latches = false;
    bool acknowledged = false;
    std::optional<Ert> shelved_until;

    /// normal, unacknowledged, acknowledged, returned (within limits again, unacknowledged), latched (within limits
    /// again, and it stays until it is reset), shelved (whatever else it is)
    const char* name(Ert now) const;
    bool normal() const { return worst == dictionary::Severity::none; }
};

/// Which alarms stand, and what was done about each: a fold over changes and acts in the order of their items, so that
/// every reader of the same items has the same states.
///
/// In       changes of severity of anything that has a name (a channel, a packet); acts of controllers
/// Memory   a row for each name that ever was in alarm or shelved
class AlarmDesk {
  public:
    void change(std::string_view name, dictionary::Severity severity, bool latches);

    /// Whether `act` may be done: an Error says why not.
    Result<void> may(std::string_view name, AlarmAct act, Ert now) const;
    /// Does it. What may not be done does nothing.
    /// @param until  of shelve
    void act(std::string_view name, AlarmAct act, Ert now, Ert until);

    const std::map<std::string, AlarmState, std::less<>>& all() const { return states_; }

  private:
    std::map<std::string, AlarmState, std::less<>> states_;
};

}  // namespace aeolis::telemetry
