// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/run.pb.h"
#include "aeolis/v1/stream.pb.h"
#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"
#include "server/instruction/plan_library.hpp"
#include "server/rehearsal/rehearsal_runner.hpp"
#include "server/rehearsal/timeline_check.hpp"
#include "server/scenario/scenario_library.hpp"

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace aeolis::server {

/// Takes the orders for rehearsals: one run at a time, commands in the order received.
///
/// Run       none ──start──► beginning ──begun──► under_way ──its end──► over ──start──► beginning
///                               └────────── could not begin ────────────►┘
/// Commands  received ─────────────────► analysing ──► with the runner ──► answered
///               │  ▲                        └──── refused ──────────────────►┘
///               ▼  │ decided, and still allowed
///            waiting, while an earlier order that changes the timeline is analysing or with the runner: orders that
///            change it too, in turns by asker, and all that its asker sends after it (decision 0065); never a hold,
///            which lets nothing leave, nor a dry run
/// Analysis  settled ──timeline moved, run begun──► analysing ──known──► settled
///           analysing ──moved again──► outdated ──answer──► analysing
///           analysing ──not known──► unknown ──next state of the run──► analysing
/// Thread    the network thread only; `post` brings functions there, such as the Callbacks
class RehearsalManager {
  public:
    struct Callbacks {
        std::function<void(v1::RunState)> on_state;
        std::function<void(v1::Clocks)> on_clocks;
        MakeCompanion companion{};  ///< see RehearsalRunner::Callbacks
    };
    using Post = std::function<void(std::function<void()>)>;
    /// Reads, on any thread, the run that a request continues or forks: see again_of().
    using ReadAgain =
        std::function<void(const v1::StartRehearsal&, std::function<void(Result<RehearsalRunner::Again>)>)>;
    using Began = std::function<void(Result<v1::RunState>)>;
    /// Analyses, on any thread, the timeline as these commands would change it; empty: none changes it. An Error
    /// refuses them. Run 0: no run yet; the commands are its script. `only_check`: a dry run.
    using CheckTimeline = std::function<void(archive::RunId, const std::vector<v1::CommandRequest>&, bool only_check,
                                             std::function<void(Result<std::string>)>)>;
    /// Analyses, on any thread, the timeline again for each of the run's waiting commands that change it.
    using Reanalyse = std::function<void(archive::RunId, std::function<void(Result<TimelineCheck::Reanalysis>)>)>;
    struct TimelineQuestions {
        CheckTimeline check;
        Reanalyse reanalyse;
    };
    using Reply = std::function<void(v1::CommandReply)>;
    using Replies = SendCommands::Replies;
    /// Whether the sender may still send a waiting command when its turn comes: rights change meanwhile, and so do the
    /// commands that have its number.
    using AuthorityCheck = std::function<Result<void>(const v1::CommandRequest&)>;
    struct Sender {
        AuthorityCheck authority;
        std::string browser{};  ///< without accounts: the one that sends, for the second person
        bool director = false;  ///< may send hazardous commands
    };

    RehearsalManager(const ScenarioLibrary& scenarios, const instruction::PlanLibrary& plans,
                     const dictionary::Dictionary& dictionary, PipelineThread& pipeline, Post post,
                     ReadAgain read_again, TimelineQuestions timeline, Callbacks callbacks);
    ~RehearsalManager();

    /// Checks what an order says by itself, whatever goes on: its pace, the scenario that it names, that it asks for
    /// something. What only the run can tell, as a fault of its devices, is told when it is carried out.
    Result<void> check_form(const v1::StartRehearsal& request) const;
    Result<void> check_form(const v1::RehearsalControl& control) const;

    /// Starts a rehearsal. Fails at once when one is in progress or the scenario is unknown or impossible. Calls
    /// `began` once the run is in the archive, or when the analysis refuses the script's changes of the timeline.
    void start(const v1::StartRehearsal& request, Began began);
    struct Flight {
        simulation::Scenario scenario;
        std::uint64_t seed = 1;
        double pace = 1.0;
        std::optional<PlannedInjects> plan{};  ///< an instructor's
    };
    void start(Flight flight, Began began);
    Result<void> control(const v1::RehearsalControl& control, Began began);
    void command(v1::CommandRequest request, const Sender& sender, const Reply& reply);
    /// Sends a command file: all commands or none.
    void sequence(std::vector<v1::CommandRequest> requests, bool only_check, const Sender& sender, Replies replies);

    /// Refuses all further starts, with `reason`.
    void close(std::string reason) { closed_ = std::move(reason); }
    const v1::RunState& current() const { return state_; }  ///< run 0: none since the server started
    bool going_on() const { return phase() == Phase::beginning || phase() == Phase::under_way; }
    /// Commands and command files that the runner has not yet carried out; commands_deferred(): those waiting for a
    /// change of the timeline.
    std::size_t commands_waiting() const { return runner_ ? runner_->waiting() : 0; }
    std::size_t commands_deferred() const { return waiting_.size(); }
    std::size_t commands_queued() const { return runner_ ? runner_->queued() : 0; }
    std::size_t commands_at_uplink() const { return runner_ ? runner_->at_uplink() : 0; }
    /// The name of a command of the current run, by its number; none: no such number yet.
    std::optional<std::string> name_of_command(std::uint64_t number) const {
        return going_on() ? runner_->name_of_command(number) : std::nullopt;
    }

  private:
    enum class Phase : std::uint8_t { none, beginning, under_way, over };
    /// Whether the timeline's analysis is known for the commands that still wait in the run.
    enum class AnalysisState : std::uint8_t { settled, analysing, outdated, unknown };
    struct Waiting {
        SendCommands order;
        AuthorityCheck authority;
    };

    Phase phase() const { return runner_ && runner_->over() ? Phase::over : phase_; }
    Result<void> refusal_while_going_on() const;
    void fly(Flight flight, Began began);
    void fly_again(RehearsalRunner::Again again, double pace, Began began);
    RehearsalRunner::Callbacks callbacks_for(Began began);
    void begun(const Result<v1::RunState>& state, const Began& began);
    /// Checks what a start says by itself, but for the scenario.
    static Result<void> check_words(const v1::StartRehearsal& request);
    Result<simulation::Scenario> scenario_of(const v1::StartRehearsal& request) const;
    /// The plan that the request names or brings; none: neither.
    Result<std::optional<PlannedInjects>> plan_of(const v1::StartRehearsal& request,
                                                  const simulation::Scenario& scenario) const;
    Result<void> order_of_run(const v1::RehearsalControl& control);
    /// The refusal of an order for a run that is not in progress.
    std::string not_going_on(std::uint64_t run) const;

    // The path of a command, in order.
    void receive(SendCommands order, const AuthorityCheck& authority);
    std::string refusal_of(const SendCommands& order) const;
    /// What the positions of the run say of it.
    Result<void> room_allows(const SendCommands& order) const;
    bool waits(const SendCommands& order) const;
    void wait(SendCommands order, const AuthorityCheck& authority);
    void analyse(SendCommands order);
    void hand_over(SendCommands order, std::uint64_t run, std::uint64_t undone_count,
                   const Result<std::string>& timeline);
    void change_decided(const std::string& asker);

    /// A command that changes the timeline was analysed together with those before it. When one of those has no effect,
    /// the command is released only once its history shows the new analysis, or never.
    void reanalyse();
    void reanalysed(std::uint64_t run, const Result<TimelineCheck::Reanalysis>& reanalysis);
    void tell(const TimelineCheck::Reanalysis& reanalysis);

    const ScenarioLibrary& scenarios_;
    const instruction::PlanLibrary& plans_;
    const dictionary::Dictionary& dictionary_;
    PipelineThread& pipeline_;
    Post post_;
    ReadAgain read_again_;
    TimelineQuestions timeline_;
    Callbacks callbacks_;
    v1::RunState state_;
    std::string closed_;
    Phase phase_ = Phase::none;  ///< except `over`; under_way: the run is in the archive, and state_ is its state
    /// The asker of an order that changes the timeline and is analysing or with the runner.
    std::optional<std::string> change_pending_of_;
    std::deque<Waiting> waiting_;
    AnalysisState analysis_state_ = AnalysisState::settled;
    std::uint64_t timeline_undone_count_ = 0;  ///< changes of the timeline that had no effect
    std::unique_ptr<RehearsalRunner> runner_;
};

}  // namespace aeolis::server
