// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

namespace aeolis {

/// One row of a state machine's table: in the state `from`, `event` leads to the state `to`.
template <typename State, typename Event>
struct Transition {
    State from;
    Event event;
    State to;
};

/// State that changes only as its table permits.
/// The table is not part of the object: the autocoder generates it from state_machines.csv, whose rules ensure that an
/// event leads from one state to at most one other.
///
/// An event is a condition that has become true. It may be offered in every cycle while it holds. Where the table has
/// no row for it from the current state, nothing happens, and that is not a fault. A caller that must not lose an event
/// checks `can` first.
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

    /// Continues from a state reached under the same table elsewhere, or here before a restart.
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
