#pragma once

#include "common/time.hpp"

#include <cstdint>
#include <optional>
#include <vector>

namespace aeolis::commands {

/// Commands that may be sent and have not left: they wait for their time, for a controller, or for a second one.
///
/// Order    of those that are due, the larger priority first; of equals as they came
/// Memory   a line a command; whoever adds them bounds their number
class CommandQueue {
  public:
    struct Entry {
        std::uint64_t number = 0;
        std::uint32_t priority = 0;
        std::optional<Ert> release_at; ///< none: at once
        bool held = false;
        bool needs_approval = false; ///< by a second person
    };

    void add(const Entry& entry);

    /// False when no such command waits.
    bool hold(std::uint64_t number) { return set_held(number, true); }
    bool release(std::uint64_t number) { return set_held(number, false); } ///< it still waits for its time
    bool cancel(std::uint64_t number);
    /// False also when it needs none.
    bool approve(std::uint64_t number);

    /// Takes out those that are due, in the order in which they leave.
    std::vector<std::uint64_t> take_due(Ert now);
    /// Those that are due wait until then instead; their numbers.
    std::vector<std::uint64_t> postpone_due(Ert now, Ert until);

    /// In the order in which they would leave.
    const std::vector<Entry>& waiting() const { return entries_; }

  private:
    static bool is_due(const Entry& entry, Ert now) {
        return !entry.held && !entry.needs_approval && (!entry.release_at || *entry.release_at <= now);
    }
    bool set_held(std::uint64_t number, bool held);

    std::vector<Entry> entries_;
};

} // namespace aeolis::commands
