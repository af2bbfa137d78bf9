// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

namespace aeolis {

/// One row of a state machine's table: in `from`, `event` leads to `to`.
template <typename State, typename Event>
struct Transition {
    State from;
    Event event;
    State to;
};

/// A state that changes only as its table says. The table is not its own: the autocoder makes it from
/// state_machines.csv, whose rules see to it that an event leads from a state to one state at most.
///
/// An event is a condition that has come true. It may be offered for as long as it is true, each cycle: where the table
/// has no row for it from the present state nothing happens, and that is no fault. Whoever must not lose an event asks
/// `can` first.
template <typename State, typename Event>
class StateMachine {
  public:
    using Table = std::span<const Transition<State, Event>>;

    constexpr StateMachine(Table table, State initial) : table_(table), state_(initial) {}

    constexpr State state() const { return state_; }

    /// Whether the event would change the state.
    constexpr bool can(Event event) const { return row_of(event) != nullptr; }

    /// True when the event changed the state.
    constexpr bool take(Event event) {
        const Transition<State, Event>* row = row_of(event);
        if (row == nullptr) return false;
        state_ = row->to;
        return true;
    }

    /// Goes on from a state that another computer, or this one before a restart, had reached by the same table.
    template <typename Exchange>
    void carry(Exchange& exchange) {
        exchange(state_);
    }

  private:
    constexpr const Transition<State, Event>* row_of(Event event) const {
        for (const auto& row : table_)
            if (row.from == state_ && row.event == event) return &row;
        return nullptr;
    }

    Table table_;
    State state_;
};

}  // namespace aeolis
