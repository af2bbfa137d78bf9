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

/// Where rehearsals are started, paced and stopped, and commands are taken to the one that goes on: one at a time.
///
/// Thread   the network thread only; Callbacks are given through `post`, which brings a function there
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
    using Replies = RehearsalRunner::Replies;

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
    /// `may` is asked about what waited for something else, when its turn comes: rights change meanwhile, and so do the
    /// commands that have its number.
    using May = std::function<Result<void>(const v1::CommandRequest&)>;
    void command(v1::CommandRequest request, const May& may, RehearsalRunner::Reply reply);
    /// A command file: all or none.
    void sequence(std::vector<v1::CommandRequest> requests, bool only_check, const May& may, Replies replies);

    /// From now on none can be started, because of `reason`.
    void close(std::string reason) { closed_ = std::move(reason); }
    const v1::RunState& current() const { return state_; }  ///< run 0: none since the server started
    bool going_on() const { return runner_ && !runner_->over(); }
    /// Commands, and command files, that are with the run; those that wait until a change of the timeline is decided.
    std::size_t commands_waiting() const { return runner_ ? runner_->waiting() : 0; }
    std::size_t commands_put_off() const { return later_.size(); }
    std::size_t commands_queued() const { return runner_ ? runner_->queued() : 0; }
    std::size_t commands_at_uplink() const { return runner_ ? runner_->at_uplink() : 0; }
    /// Of a command of the run that goes on, by its number; none: it has none of this number yet.
    std::optional<std::string> name_of_command(std::uint64_t number) const {
        return going_on() ? runner_->name_of_command(number) : std::nullopt;
    }

  private:
    void fly(Flight flight, Began began);
    void continue_run(archive::CutOffRun cut, double pace, Began began);
    RehearsalRunner::Callbacks callbacks_for(Began began);
    /// What waits and changes the timeline was analysed with another that has come to nothing since: it leaves only
    /// once that is told in its history, or never. What nobody knows is asked again.
    void look_again();
    void tell_looks(const TimelineCheck::Look& look);
    Result<void> refusal_while_going_on() const;
    /// Why what is asked of this run is not done: another goes on.
    std::string not_going_on(std::uint64_t run) const;

    const ScenarioLibrary& scenarios_;
    const dictionary::Dictionary& dictionary_;
    PipelineThread& pipeline_;
    Post post_;
    ReadCutOff read_cut_off_;
    TimelineQuestions timeline_;
    Callbacks callbacks_;
    v1::RunState state_;
    std::string closed_;
    bool begun_ = false;     ///< the run that goes on is in the archive, and state_ is its own
    bool changing_ = false;  ///< a change of the timeline is looked at or under way: later orders wait for its reply
    std::deque<std::function<void()>> later_;
    bool looking_again_ = false, once_more_ = false;  ///< the latter: what it looks at has changed meanwhile
    bool not_known_ = false;   ///< of the last look: it is made again with the next state of the run
    std::uint64_t moves_ = 0;  ///< of the timeline, by commands that came to nothing
    std::unique_ptr<RehearsalRunner> runner_;
};

}  // namespace aeolis::server
