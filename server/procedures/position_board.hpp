// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "common/time.hpp"
#include "server/procedures/procedure.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

// Who holds which position of the control room, and what the flight director's poll has come to.
namespace aeolis::server::procedures {

inline constexpr std::size_t subject_octets_max = 200;  ///< of a poll; chosen: a line

/// What somebody does with a position.
struct PositionAct {
    enum class Kind : std::uint8_t {
        take,   ///< a position that is vacant, or was offered to this person; with a reason that of the flight director
        offer,  ///< whoever holds it offers it to `to`, to themselves: to nobody; it is theirs when they take it
        leave,  ///< it becomes vacant
        poll,   ///< the flight director asks the room about `subject`
        go,     ///< a position's answer, to the poll about `subject` if that is said; the flight director's decides
        no_go,
    };
    Kind kind{};
    Position position{};
    std::string person{};
    std::string to{};
    std::string subject{};
    std::string reason{};
    Ert at{};
};
inline constexpr std::size_t position_act_kinds = 6;
std::string_view name_of(PositionAct::Kind kind);
std::optional<PositionAct::Kind> position_act_named(std::string_view name);

/// The positions of a run. One that is held acts by its holder alone. From when somebody first took that of the flight
/// director the room is directed: the flight director stands in for a position that is vacant, except to send; only who
/// holds `command` sends, after the flight director's go. Before that whoever has the right by account may act as any
/// position that is vacant.
///
/// In    acts in the order in which they were done; the same acts make the same board
/// Out   seats, the newest poll, and what is refused, in one sentence
class PositionBoard {
  public:
    struct Seat {
        std::string person;  ///< empty: vacant
        Ert since;
        std::string offered_to;  ///< empty: to nobody
    };
    struct Answer {
        bool go = false;
        std::string person, reason;
        Ert at;
    };
    struct Poll {
        std::string subject, person;
        Ert at;
        std::array<std::optional<Answer>, positions.size()>
            answers;  ///< by position; the flight director's is decision
        std::optional<Answer> decision;
        std::string overridden;  ///< what spoke against the decision; empty: nothing
    };

    /// Takes an act. The Error says in a sentence why it has no place; nothing has changed then.
    Result<void> on(const PositionAct& act);

    const Seat& seat(Position position) const { return seats_[static_cast<std::size_t>(position)]; }
    const std::optional<Poll>& poll() const { return poll_; }
    /// Whether somebody has held the position of the flight director.
    bool directed() const { return directed_; }
    /// What can be done now with a position, by whoever may.
    std::vector<PositionAct::Kind> acts(Position position) const;
    /// What speaks against a go now: no goes, and who has not answered. Empty: nothing.
    std::string against() const;
    /// Why nobody may send a command now, in a sentence. Empty: whoever holds `command` may.
    std::string closed() const;

    /// Whether the person may act as the position.
    Result<void> may_act(Position position, std::string_view person) const;
    /// Whether the person may send a command now.
    Result<void> may_send(std::string_view person) const;
    /// Whether the person, as command or as flight director, may approve one, which then leaves.
    Result<void> may_approve(std::string_view person) const;
    /// Whether the person, as command or as flight director, may hold or cancel one.
    Result<void> may_stop(std::string_view person) const;

  private:
    Seat& seat_of(Position position) { return seats_[static_cast<std::size_t>(position)]; }
    bool holds(Position position, std::string_view person) const;
    Result<void> take(const PositionAct& act);
    Result<void> offer(const PositionAct& act);
    Result<void> leave(const PositionAct& act);
    Result<void> call_poll(const PositionAct& act);
    Result<void> of_this_poll(const PositionAct& act) const;
    void end_go();
    Result<void> answer(const PositionAct& act);
    Result<void> decide(const PositionAct& act);

    std::array<Seat, positions.size()> seats_;
    std::optional<Poll> poll_;
    bool directed_ = false;
};

}  // namespace aeolis::server::procedures
