// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "commands/encoder.hpp"
#include "commands/lifecycle.hpp"
#include "common/ids.hpp"
#include "common/time.hpp"
#include "server/procedures/yaml_document.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

// A procedure as data: what people do, in which order, and what has to be true. Its parts are those of
// [ecss-e-st-70-32c]: preconditions, main body, watchdogs, confirmation.
namespace aeolis::server::procedures {

/// A seat in the control room. The instructor has no part in a procedure.
enum class Position : std::uint8_t {
    flight_director,
    command,  ///< the only one that radiates
    edl_communications,
    gnc,
    navigation,
    relay_and_station,
    systems,
};
inline constexpr std::array positions{
    Position::flight_director,   Position::command, Position::edl_communications, Position::gnc, Position::navigation,
    Position::relay_and_station, Position::systems};
std::string_view name_of(Position position);
std::optional<Position> position_named(std::string_view name);

/// An instant that counts from entry, by the clock on Earth: "E-47:00 sent".
struct EntryTime {
    enum class Where : std::uint8_t {
        vehicle,   ///< UTC is then that long after entry at the vehicle
        sent,      ///< what leaves Earth then arrives there at that time
        received,  ///< what happens there at that time is then received
    };
    double e_s = 0.0;
    Where where = Where::vehicle;
    bool operator==(const EntryTime&) const = default;
};
std::string_view name_of(EntryTime::Where where);
std::string text_of(const EntryTime& time);  ///< "E−47:00 sent"

enum class Comparison : std::uint8_t { equal, unequal, less, at_most, greater, at_least };
std::string_view name_of(Comparison comparison);  ///< "==", "!=", "<", "<=", ">", ">="
std::optional<Comparison> comparison_named(std::string_view name);
bool holds(Comparison comparison, double left, double right);

/// From when on what was received counts.
enum class Since : std::uint8_t {
    run,        ///< from its beginning
    procedure,  ///< since the procedure was begun
    step,       ///< since the step became active; of a watchdog: since the procedure was begun
};
std::string_view name_of(Since since);

/// The latest value received of a channel compares so, and has for so long.
struct ChannelCondition {
    ChannelId channel;
    Comparison comparison = Comparison::equal;
    double value = 0.0;
    double for_s = 0.0;
    Since since = Since::run;
};
/// An event report was received.
struct EventCondition {
    EvrId event;
    Since since = Since::step;
};
/// The instant has come.
struct TimeCondition {
    EntryTime from;
};
using Condition = std::variant<ChannelCondition, EventCondition, TimeCondition>;

/// A command that a step holds ready.
struct PreparedCommand {
    std::string name;
    std::vector<commands::NamedValue> arguments;
    std::vector<commands::NamedValue> fixed;            ///< these and the defaults, as the vehicle gets them
    std::vector<std::string> to_fill;                   ///< arguments that whoever sends it gives
    bool from_solution = false;                         ///< arguments not given come from ground's navigation solution
    commands::Stage until = commands::Stage::executed;  ///< the stage at which the step is done
};

/// Where a branch leads, or a step that names the next.
struct Target {
    enum class Kind : std::uint8_t {
        step,          ///< of the main body
        confirmation,  ///< the main body is over
        end,           ///< the procedure is over, not confirmed
    };
    Kind kind = Kind::confirmation;
    std::size_t step = 0;  ///< its index in the main body
    bool operator==(const Target&) const = default;
};

/// One way on from a step. A person chooses; the conditions only show what speaks for it.
struct Choice {
    std::string words;
    std::vector<Condition> conditions;
    Target target;
};

struct Step {
    std::string id;
    Position who = Position::flight_director;
    std::string text;
    std::vector<Condition> conditions;  ///< all must hold; with nothing else to do the step then checks itself
    std::vector<Position> signatures;   ///< each of them signs
    std::optional<PreparedCommand> command;
    std::vector<Choice> choices;       ///< one of them is taken
    std::optional<Position> hold;      ///< who lets it begin
    std::optional<double> limit_s;     ///< from when it becomes active
    std::optional<EntryTime> limit_e;  ///< the instant by which it is to be done; `sent`: by which its command is sent
    std::optional<Target> next;        ///< of the main body, instead of the step that follows
    Mark mark;
};

/// Watched from the beginning of the procedure to its end.
struct Watchdog {
    std::string id;
    Position who = Position::flight_director;
    std::string text;                   ///< what to do when it trips
    std::vector<Condition> conditions;  ///< it trips when all hold
    std::string begin;                  ///< the procedure to begin then; empty: none
    bool hold = false;                  ///< it holds this procedure
    Mark mark;
};

struct Approval {
    Position position = Position::flight_director;
    std::string name;
    std::string on;  ///< "2026-11-27"
};

/// A change of a step's text by hand, before the next revision.
struct Redline {
    std::string step;
    std::string text;  ///< what stands now
    std::string reason;
    std::string by;
    std::string on;
    std::string approved_by;  ///< empty: by nobody yet
};

struct Procedure {
    std::string id;  ///< the name of its file
    std::string title;
    unsigned revision = 0;
    std::vector<Approval> approvals;  ///< none: a draft
    std::string purpose;
    std::string begin_when;
    std::string source;
    std::vector<Step> preconditions, body, confirmation;
    std::vector<Watchdog> watchdogs;
    std::vector<Redline> redlines;  ///< oldest first
};

/// The step's text as it stands: that of its last redline that was approved, else its own.
const std::string& text_now(const Procedure& procedure, const Step& step);

inline constexpr std::size_t steps_max = 100;              ///< of each part; chosen: a longer one is two procedures
inline constexpr std::size_t conditions_max = 16;          ///< of a step or watchdog; chosen
inline constexpr std::size_t text_characters_max = 2'000;  ///< chosen: a page is read, not more
inline constexpr double limit_s_max = 7.0 * 86'400.0;      ///< chosen: no step takes longer than a week
inline constexpr double condition_for_s_max = 86'400.0;    ///< chosen

}  // namespace aeolis::server::procedures
