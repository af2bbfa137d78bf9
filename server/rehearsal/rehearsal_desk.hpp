// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/run.pb.h"
#include "aeolis/v1/stream.pb.h"
#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"
#include "server/rehearsal/rehearsal_runner.hpp"
#include "server/rehearsal/timeline_check.hpp"
#include "server/scenario/scenario_library.hpp"

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace aeolis::server {

/// Decides what is ordered of rehearsals: one run at a time, commands in the order in which they came.
///
/// Run       none ──start──► beginning ──begun──► under_way ──its end──► over ──start──► beginning
///                               └────────── could not begin ────────────►┘
/// Commands  received ─────────────────► analysing ──► with the runner ──► answered
///               │  ▲                        └──── refused ──────────────────►┘
///               ▼  │ decided, and still allowed
///            waiting, while an earlier order that changes the timeline is analysing or with the runner; never a
///            hold, which lets nothing leave, nor a dry run
/// Outlook   settled ──timeline moved, run begun──► looking ──known──► settled
///           looking ──moved again──► outdated ──answer──► looking
///           looking ──not known──► unknown ──next state of the run──► looking
/// Thread    the network thread only; Callbacks come through `post`, which brings a function there
class RehearsalDesk {
  public:
    struct Callbacks {
        std::function<void(v1::RunState)> on_state;
        std::function<void(v1::Clocks)> on_clocks;
    };
    using Post = std::function<void(std::function<void()>)>;
    /// Brings a run that was cut off, on any thread; an Error when it was not.
    using ReadCutOff = std::function<void(archive::RunId, std::function<void(Result<archive::CutOffRun>)>)>;
    using Began = std::function<void(Result<v1::RunState>)>;
    /// Says, on any thread, what becomes of the timeline when these commands are taken; empty: none changes it. An
    /// Error refuses them. Run 0: one that has not begun, and these are its script. `only_check`: of a dry run.
    using CheckTimeline = std::function<void(archive::RunId, const std::vector<v1::CommandRequest>&, bool only_check,
                                             std::function<void(Result<std::string>)>)>;
    /// Says, on any thread, what becomes of it now by each of the run's commands that change it and still wait.
    using LookAgain = std::function<void(archive::RunId, std::function<void(Result<TimelineCheck::Look>)>)>;
    struct TimelineQuestions {
        CheckTimeline check;
        LookAgain look_again;
    };
    using Reply = std::function<void(v1::CommandReply)>;
    using Replies = SendCommands::Replies;
    /// Whether the sender may still send a command that has waited, when its turn comes: rights change meanwhile, and
    /// so do the commands that have its number.
    using AuthorityCheck = std::function<Result<void>(const v1::CommandRequest&)>;
    struct Sender {
        AuthorityCheck authority;
        std::string browser{};  ///< without accounts: the one that sends, for the second person
    };

    RehearsalDesk(const ScenarioLibrary& scenarios, const dictionary::Dictionary& dictionary, PipelineThread& pipeline,
                  Post post, ReadCutOff read_cut_off, TimelineQuestions timeline, Callbacks callbacks);
    ~RehearsalDesk();

    /// Fails at once when one goes on, the scenario is unknown or impossible; else `began` comes when the run is in the
    /// archive, or when the analysis refuses what its script does to the timeline.
    void start(const v1::StartRehearsal& request, Began began);
    struct Flight {
        simulation::Scenario scenario;
        std::uint64_t seed = 1;
        double pace = 1.0;
    };
    void start(Flight flight, Began began);
    Result<void> control(const v1::RehearsalControl& control, Began began);
    void command(v1::CommandRequest request, const Sender& sender, const Reply& reply);
    /// A command file: all or none.
    void sequence(std::vector<v1::CommandRequest> requests, bool only_check, const Sender& sender, Replies replies);

    /// From now on none can be started, because of `reason`.
    void close(std::string reason) { closed_ = std::move(reason); }
    const v1::RunState& current() const { return state_; }  ///< run 0: none since the server started
    bool going_on() const { return phase() == Phase::beginning || phase() == Phase::under_way; }
    /// Commands, and command files, that the run has not carried out; those that wait for a change of the timeline.
    std::size_t commands_waiting() const { return runner_ ? runner_->waiting() : 0; }
    std::size_t commands_put_off() const { return waiting_.size(); }
    std::size_t commands_queued() const { return runner_ ? runner_->queued() : 0; }
    std::size_t commands_at_uplink() const { return runner_ ? runner_->at_uplink() : 0; }
    /// Of a command of the run that goes on, by its number; none: it has none of this number yet.
    std::optional<std::string> name_of_command(std::uint64_t number) const {
        return going_on() ? runner_->name_of_command(number) : std::nullopt;
    }

  private:
    enum class Phase : std::uint8_t { none, beginning, under_way, over };
    /// Whether it is known to what the timeline comes by the commands that still wait in the run.
    enum class Outlook : std::uint8_t { settled, looking, outdated, unknown };
    struct Waiting {
        SendCommands order;
        AuthorityCheck authority;
    };

    Phase phase() const { return runner_ && runner_->over() ? Phase::over : phase_; }
    Result<void> refusal_while_going_on() const;
    void fly(Flight flight, Began began);
    void continue_run(archive::CutOffRun cut, double pace, Began began);
    RehearsalRunner::Callbacks callbacks_for(Began began);
    void begun(const Result<v1::RunState>& state, const Began& began);
    Result<void> order_of_run(const v1::RehearsalControl& control);
    /// Why what is asked of this run is not done: another goes on.
    std::string not_going_on(std::uint64_t run) const;

    // The way of a command, in its order.
    void receive(SendCommands order, const AuthorityCheck& authority);
    std::string refusal_of(const SendCommands& order) const;
    bool waits(const SendCommands& order) const;
    void wait(SendCommands order, const AuthorityCheck& authority);
    void analyse(SendCommands order);
    void hand_over(SendCommands order, std::uint64_t run, std::uint64_t moves, const Result<std::string>& timeline);
    void change_decided();

    /// A command that changes the timeline was analysed with those before it. When one of these comes to nothing, it
    /// leaves only once its history says what becomes of the timeline now, or never.
    void look_again();
    void looked(std::uint64_t run, const Result<TimelineCheck::Look>& look);
    void tell(const TimelineCheck::Look& look);

    const ScenarioLibrary& scenarios_;
    const dictionary::Dictionary& dictionary_;
    PipelineThread& pipeline_;
    Post post_;
    ReadCutOff read_cut_off_;
    TimelineQuestions timeline_;
    Callbacks callbacks_;
    v1::RunState state_;
    std::string closed_;
    Phase phase_ = Phase::none;    ///< but for `over`; under_way: the run is in the archive, and state_ is its own
    bool change_pending_ = false;  ///< an order that changes the timeline is analysing or with the runner
    std::deque<Waiting> waiting_;
    Outlook outlook_ = Outlook::settled;
    std::uint64_t moves_ = 0;  ///< of the timeline, by commands that came to nothing
    std::unique_ptr<RehearsalRunner> runner_;
};

}  // namespace aeolis::server
