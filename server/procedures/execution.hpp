// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "server/procedures/condition_watch.hpp"
#include "server/procedures/procedure.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// How far people have come with a procedure. Pure: what is received and what people do comes in, states come out.
namespace aeolis::server::procedures {

enum class StepState : std::uint8_t {
    waiting,    ///< its turn has not come
    held,       ///< it may not go on until somebody releases it
    active,     ///< now
    late,       ///< now, and its time limit has passed
    checked,    ///< done: by its conditions or its command, with their evidence
    ticked,     ///< done: by somebody
    skipped,    ///< by the flight director, with a reason
    not_taken,  ///< no way led there before the procedure was over
};
std::string_view name_of(StepState state);
constexpr bool is_over(StepState state) {
    return state != StepState::waiting && state != StepState::held && state != StepState::active &&
           state != StepState::late;
}

enum class Part : std::uint8_t {
    preconditions,
    body,
    confirmation,
    confirmed,  ///< over: each step of the confirmation is checked or ticked
    ended,      ///< over without that
    stopped,    ///< over: the flight director stopped it
};
std::string_view name_of(Part part);

struct Signature {
    Position position{};
    std::string person;
    Ert at;
    bool operator==(const Signature&) const = default;
};

/// A step as it stands. Evidence of a step that is over is what it was then.
struct StepStatus {
    StepState state = StepState::waiting;
    std::optional<Ert> active_since, late_since, over_since;
    std::vector<ConditionState> conditions;            ///< by Step::conditions
    std::vector<std::vector<ConditionState>> choices;  ///< by Step::choices, then by their conditions
    std::vector<Signature> signatures;
    std::string by;      ///< who ticked, chose or skipped it, with the position: "A. Ng (flight_director)"
    std::string reason;  ///< of a skip, or of a tick that its conditions do not bear out
    std::optional<std::size_t> chosen;
    std::optional<std::uint64_t> command;  ///< its number in the run, once it was sent
    std::string command_evidence;          ///< what is known of it: "executed: COMMAND_EXECUTED …"
    bool operator==(const StepStatus&) const = default;
};

struct WatchdogStatus {
    std::vector<ConditionState> conditions;
    std::optional<Ert> tripped;  ///< the first time; it stays
    std::optional<Signature> acknowledged;
    bool operator==(const WatchdogStatus&) const = default;
};

/// What somebody does.
struct Act {
    enum class Kind : std::uint8_t {
        tick,         ///< a step is done
        sign,         ///< a position signs a step
        choose,       ///< the way `choice` of a step is taken
        skip,         ///< a step is left out
        sent,         ///< a step's command was sent as number `command` of the run
        hold,         ///< the procedure is held
        release,      ///< the procedure, or with `step` the hold before that step, is released
        acknowledge,  ///< a watchdog that tripped, named by `step`, was seen
        stop,         ///< the procedure ends here
    };
    Kind kind{};
    std::string step{};
    Position position{};
    std::string person{};
    std::string reason{};
    std::size_t choice = 0;
    std::uint64_t command = 0;
    Ert at{};
};
std::string_view name_of(Act::Kind kind);
std::optional<Act::Kind> act_named(std::string_view name);

/// A stage of a command of the run, as the command path reports it.
struct CommandFate {
    std::uint64_t command = 0;
    std::string name;
    commands::Stage stage{};
    commands::Status status{};
    std::string evidence;
    Ert at;
    std::vector<commands::NamedValue> arguments = {};  ///< as the vehicle gets them; of the stage `queued`
};

inline constexpr std::size_t person_octets_max = 64;          ///< chosen: a name
inline constexpr std::size_t reason_octets_max = 500;         ///< chosen: a sentence or two
inline constexpr std::size_t commands_followed_max = 10'000;  ///< chosen: more than any run sends

/// One execution of a procedure.
///
/// In      what ground receives (live samples, events, stages of commands, the predicted entry, Earth's clock), in the
///         order of receipt, and what people do
/// Out     the state of each step and watchdog
/// Rules   Preconditions are active from the beginning, all at once; then the steps of the main body, one at a time;
///         then the confirmation, all at once. A step with conditions checks itself as soon as all hold, and stays
///         checked. One with nothing to be found is ticked by its position or the flight director, or done by its
///         signatures. Against its conditions it is ticked only with a reason; skipped only by the flight director,
///         with a reason. A command is done by its stage, never by a tick. A branch is chosen by somebody, never by
///         itself. While the procedure is held no step begins or ends, and limit_s does not run
/// Faults  an act that has no place is an Error in one sentence, and changes nothing
/// Memory  by its procedure, and commands_followed_max. A copy is a snapshot: fed the same it stays the same
class Execution {
  public:
    /// @param procedure  not null; its copies share it. The dictionary must outlive them
    /// @param before     what was received before it began
    Execution(std::shared_ptr<const Procedure> procedure, const dictionary::Dictionary& dictionary, Ert begun,
              const ReceivedFacts& before = {});

    /// What no condition asks for only moves the clock; limits and ages are judged at the next pass.
    void on(const ChannelSample& sample);
    void on(const EventReceived& event);
    void on(const CommandFate& fate);
    void predict(const EntryPrediction& prediction);
    void pass(Ert now);

    Result<void> on(const Act& act);

    const Procedure& procedure() const { return *procedure_; }
    Part part() const { return part_; }
    bool over() const { return part_ == Part::confirmed || part_ == Part::ended || part_ == Part::stopped; }
    Ert begun() const { return begun_; }
    /// Who holds the procedure and why; empty: nobody.
    const std::string& held() const { return held_; }
    /// In the order of the procedure: preconditions, main body, confirmation.
    const std::vector<StepStatus>& steps() const { return status_; }
    const std::vector<WatchdogStatus>& watchdogs() const { return watchdogs_; }
    const StepStatus* step(std::string_view id) const;
    /// By when a step that is not over is to be done, or its command sent, as far as that is known.
    std::optional<Ert> limit(std::size_t step) const;
    /// What can be done now with the procedure as a whole, with a step, with a watchdog, by whoever may and gives a
    /// reason.
    std::vector<Act::Kind> acts() const;
    std::vector<Act::Kind> acts_of_step(std::size_t step) const;
    std::vector<Act::Kind> acts_of_watchdog(std::size_t watchdog) const;
    Ert now() const { return watch_.now(); }

  private:
    /// The numbers of a step's conditions in the watch.
    struct Numbers {
        std::vector<std::size_t> conditions;
        std::vector<std::vector<std::size_t>> choices;
    };
    struct Fate {
        std::string name;
        std::array<commands::Status, commands::stage_count> status{};
        std::string text;
        std::optional<std::vector<commands::NamedValue>> sent;  ///< its arguments; none: it was not seen to be queued
    };
    using Range = std::pair<std::size_t, std::size_t>;  ///< of steps: first and end

    void watch_conditions(const std::vector<Condition>& conditions, std::vector<std::size_t>& numbers);
    Range range_of(Part part) const;
    bool stands_open(std::size_t index) const;
    std::vector<ConditionState> judge(const std::vector<Condition>& conditions, const std::vector<std::size_t>& numbers,
                                      Ert step_since) const;

    void settle();
    void look_at_watchdogs();
    void look(std::size_t index);
    bool is_done(std::size_t index) const;
    bool waits_for_release(std::size_t index) const;
    bool command_has(std::size_t index, commands::Status status) const;
    bool command_has(std::size_t index, commands::Stage stage, commands::Status status) const;
    std::optional<Ert> limit_passed(std::size_t index) const;
    bool advance();
    void begin_step(std::size_t index);
    void activate(std::size_t index);
    void end_step(std::size_t index, StepState state);
    void begin_part(Part part);
    void finish(Part part);

    Result<std::size_t> open_step(const Act& act) const;
    Result<void> take(const Act& act);
    Result<void> tick(const Act& act);
    Result<void> sign(const Act& act);
    Result<void> choose(const Act& act);
    Result<void> skip(const Act& act);
    Result<void> sent(const Act& act);
    Result<void> hold(const Act& act);
    Result<void> release(const Act& act);
    Result<void> acknowledge(const Act& act);
    void set_held(std::string why, std::string person);

    std::shared_ptr<const Procedure> procedure_;
    Ert begun_;
    ConditionWatch watch_;
    std::vector<const Step*> steps_;
    std::vector<Numbers> numbers_;
    std::vector<std::vector<std::size_t>> watchdog_numbers_;
    std::vector<StepStatus> status_;
    std::vector<WatchdogStatus> watchdogs_;
    std::vector<std::int64_t> paused_us_;  ///< by step: for how long it was held while it was active
    std::map<std::uint64_t, Fate> fates_;
    Part part_ = Part::preconditions;
    std::size_t current_ = 0;  ///< step of the main body
    std::string held_;
    std::string held_by_;  ///< a person, who may release it again; empty: a watchdog
    Ert held_since_;
};

}  // namespace aeolis::server::procedures
