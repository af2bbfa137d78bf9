// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace aeolis::commands {

enum class Precedence : std::uint8_t { ordinary, director, hazardous };

/// Authorised commands that wait for their time, a controller or a second person's approval.
///
/// Order    one asker's due commands: the higher priority first, equals by number, as they were requested. Among the
///          next commands of all askers: first the hazardous, then directors', but after `directors_in_a_row_max` of
///          these another's, then the asker served least recently, then the higher priority. Commands that are
///          `in_order` leave by number alone, because each was judged by the effects of those before it
/// Memory   one entry a command; the owner bounds their number
class CommandQueue {
  public:
    static constexpr std::size_t directors_in_a_row_max = 3;  ///< chosen
    static constexpr std::size_t askers_max = 1024;           ///< chosen: more than have an account

    struct Entry {
        std::uint64_t number = 0;
        std::uint32_t priority = 0;
        std::optional<Ert> release_at{};  ///< none: at once
        bool held = false;
        bool needs_approval = false;  ///< by a second person
        bool in_order = false;        ///< leaves after all others of this kind that have a smaller number
        bool doubted = false;         ///< an earlier command in order failed: it waits until it is judged anew
        Precedence precedence{};      ///< over other askers' commands
        std::string asker{};          ///< whose share of the places it takes
    };

    void add(const Entry& entry);

    /// Returns false when no such command waits.
    bool hold(std::uint64_t number) { return set_held(number, true); }
    bool release(std::uint64_t number) { return set_held(number, false); }  ///< from hold; it still waits for its time
    bool cancel(std::uint64_t number);
    /// Returns false when no such command waits, or when it needs no approval.
    bool approve(std::uint64_t number);
    /// Marks as doubted the waiting commands that are in order behind the failed one. Returns their numbers.
    std::vector<std::uint64_t> doubt_after(std::uint64_t number);
    /// Ends a doubt. Returns false when no such command waits, or when it is not doubted.
    bool judged(std::uint64_t number);
    /// The command that must leave before it; none: it waits for none.
    std::optional<std::uint64_t> leaves_after(const Entry& entry) const;

    /// Whether the command waits for nothing else and can be taken out now.
    bool due(std::uint64_t number, Ert now) const;
    /// Takes out the next command to leave; none: none is due.
    /// @param least  only of this precedence and above
    std::optional<std::uint64_t> take_next(Ert now, Precedence least = Precedence::ordinary);
    bool any_due(Ert now) const;
    /// Takes out all commands in the order of leaving.
    std::vector<std::uint64_t> take_all();
    /// Postpones the due commands to `until`; returns their numbers.
    std::vector<std::uint64_t> postpone_due(Ert now, Ert until);

    /// Waiting commands in the order of leaving.
    const std::vector<Entry>& waiting() const { return entries_; }

  private:
    bool is_due(const Entry& entry, Ert now) const;
    bool set_held(std::uint64_t number, bool held);
    Entry* find(std::uint64_t number);

    std::vector<Entry> entries_;
    std::map<std::string, std::uint64_t> last_turn_;  ///< by asker, of the latest `askers_max`
    std::size_t directors_in_a_row_ = 0;
    std::uint64_t turns_ = 0;
};

}  // namespace aeolis::commands
