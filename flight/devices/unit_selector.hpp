// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/kernel/outbox.hpp"
#include "flight/load.hpp"

namespace aeolis::flight {

/// Selects between redundant units; the only module that may.
/// Each device manager addresses the unit selected here. No manager changes over by itself. From "do edl" on the choice
/// is fixed: EDL has no time to switch. R2, R5
///
/// In      SelectUnitsCommand; EdlBegun and StandBy from Edl; ClockTick; UnitsSelected (prime's choice, for a computer
///         that takes over)
/// Out     UnitsSelected to every device manager, and to Edl, which forwards it to the other computer; CommandOutcome;
///         channels of the choice every 10 s and on change, but none while this computer only follows or stands by
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

    UnitSelection selected_;  // A of each, until ground commands otherwise
    bool edl_begun_ = false;
    bool reports_;
};

}  // namespace aeolis::flight
