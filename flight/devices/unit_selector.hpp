// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/kernel/outbox.hpp"
#include "flight/load.hpp"

namespace aeolis::flight {

/// The one owner of the choice between redundant units. Each device manager addresses the unit that it is told; none
/// changes over by itself, and from "do edl" on the choice stands: EDL has no time to switch. R2, R5
///
/// In      SelectUnitsCommand; EdlBegun and StandBy from Edl; ClockTick; UnitsSelected (as prime held them, for a
///         computer that takes over)
/// Out     UnitsSelected to every device manager, and to Edl, which tells the other computer; CommandOutcome; channels
///         of the choice, each 10 s and when it changes, but none from a computer that only follows or stands by
/// Faults  a selection after "do edl" is refused (wrong_phase): nothing is changed
class UnitSelector {
  public:
    explicit UnitSelector(const Load& load) : reports_(load.role == Role::prime) {}

    void on(const SelectUnitsCommand& command, Outbox& out);
    void on(const EdlBegun& begun, Outbox& out);
    void on(const StandBy& stand_by, Outbox& out);
    void on(const UnitsSelected& taken_over, Outbox& out);
    void on(const ClockTick& tick, Outbox& out);

    const UnitSelection& selected() const { return selected_; }

  private:
    void select(const UnitSelection& units, Outbox& out);

    UnitSelection selected_;  // A of each, until ground says otherwise
    bool edl_begun_ = false;
    bool reports_;
};

}  // namespace aeolis::flight
