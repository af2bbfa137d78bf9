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

/// A controller's action on an alarm.
enum class AlarmAct {
    acknowledge,  ///< "I have seen it": until it grows more severe, or returns
    shelve,       ///< hides it for a limited time
    unshelve,
    reset,  ///< of a latching alarm: its cause is gone, and it may clear
};
/// The actions' names in the API and in the archive.
const char* name_of(AlarmAct act);
std::optional<AlarmAct> alarm_act(std::string_view word);

/// How an alarm stands. [isa-18.2]
enum class AlarmStanding : std::uint8_t {
    normal,
    unacknowledged,
    acknowledged,
    returned,  ///< within limits again, unacknowledged
    latched,   ///< within limits again, held until reset
    shelved,   ///< overrides the others
};
const char* name_of(AlarmStanding standing);

/// An alarm and the actions on it. [isa-18.2]
struct AlarmState {
    dictionary::Severity severity{};  ///< at present; none: within limits
    dictionary::Severity worst{};     ///< since it was last normal
    bool latches = false;
    bool acknowledged = false;
    std::optional<Ert> shelved_until;

    AlarmStanding standing(Ert now) const;
    bool normal() const { return worst == dictionary::Severity::none; }
};

/// The standing alarms and the actions on each.
///
/// It is a fold over changes and actions in the order of their items, so that all readers of the same items have the
/// same states.
/// In       changes of severity of anything with a name (a channel, a packet); actions of controllers
/// Memory   a row for each name that was ever in alarm or shelved
class AlarmRegister {
  public:
    void change(std::string_view name, dictionary::Severity severity, bool latches);

    /// Whether `act` is permitted. Fails with the reason.
    Result<void> may(std::string_view name, AlarmAct act, Ert now) const;
    /// Applies the action. Does nothing when it is not permitted.
    /// @param until  end of a shelving
    void act(std::string_view name, AlarmAct act, Ert now, Ert until);

    const std::map<std::string, AlarmState, std::less<>>& all() const { return states_; }

  private:
    std::map<std::string, AlarmState, std::less<>> states_;
};

}  // namespace aeolis::telemetry
