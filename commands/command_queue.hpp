// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"

#include <cstdint>
#include <optional>
#include <vector>

namespace aeolis::commands {

/// Commands that may be sent and have not left: they wait for their time, for a controller, or for a second one.
///
/// Order    of those that are due, the larger priority first; of equals by their number, as they were asked for. Those
///          that are `in_order` among themselves by their number alone: each was judged by what those before it do
/// Memory   a line a command; whoever adds them bounds their number
class CommandQueue {
  public:
    struct Entry {
        std::uint64_t number = 0;
        std::uint32_t priority = 0;
        std::optional<Ert> release_at;  ///< none: at once
        bool held = false;
        bool needs_approval = false;  ///< by a second person
        bool in_order = false;        ///< leaves after all others of this kind that have a smaller number
        bool doubted = false;         ///< what it was judged by has changed: it does not leave until it is judged anew
    };

    void add(const Entry& entry);

    /// False when no such command waits.
    bool hold(std::uint64_t number) { return set_held(number, true); }
    bool release(std::uint64_t number) { return set_held(number, false); }  ///< it still waits for its time
    bool cancel(std::uint64_t number);
    /// False also when it needs none.
    bool approve(std::uint64_t number);
    /// One that is in order, and was before those that wait, has come to nothing: those behind it are doubted. Their
    /// numbers.
    std::vector<std::uint64_t> doubt_after(std::uint64_t number);
    /// It was judged anew. False also when it was not doubted.
    bool judged(std::uint64_t number);
    /// After which other it leaves; none: it waits for none.
    std::optional<std::uint64_t> leaves_after(const Entry& entry) const;

    /// Whether it waits for nothing but to be taken out.
    bool due(std::uint64_t number, Ert now) const;
    /// Takes out the one that leaves next; none: no other is due.
    std::optional<std::uint64_t> take_next(Ert now);
    /// Takes out all, in that order.
    std::vector<std::uint64_t> take_all();
    /// Those that are due wait until then instead; their numbers.
    std::vector<std::uint64_t> postpone_due(Ert now, Ert until);

    /// In the order in which they would leave.
    const std::vector<Entry>& waiting() const { return entries_; }

  private:
    bool is_due(const Entry& entry, Ert now) const;
    bool set_held(std::uint64_t number, bool held);
    Entry* find(std::uint64_t number);

    std::vector<Entry> entries_;
};

}  // namespace aeolis::commands
