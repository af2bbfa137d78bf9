// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "commands/command_link.hpp"
#include "commands/command_queue.hpp"
#include "commands/encoder.hpp"
#include "commands/lifecycle.hpp"
#include "commands/planned_deadlines.hpp"
#include "commands/port.hpp"
#include "commands/preconditions.hpp"
#include "commands/release_pace.hpp"
#include "commands/request.hpp"
#include "commands/solution_judge.hpp"
#include "commands/timeline_judge.hpp"
#include "commands/tracking_schedule.hpp"
#include "common/time.hpp"
#include "dictionaries/decoded.hpp"
#include "dictionaries/dictionary.hpp"

#include <cstdint>
#include <list>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace aeolis::commands {

/// The only command path of a run: WebSocket, POST and the scenario's script all submit here.
///
/// In       requests; packets as they reach Earth; Earth's clock     Out   CLTUs to radiate, replies, stages
/// Order    look up → arguments → encode → preconditions → arming and typed confirmation → queued → authorised →
///          released → radiated (commands/command_link); from then on commands/lifecycle follows the evidence in
///          telemetry
/// Memory   at most `commands_max` commands under way, a few kilooctets each; the latest value of each channel
/// Shares   nobody has more commands under way than places are free: commands/shares. All but the hazardous leave no
///          faster than their answers can come down: commands/release_pace
/// Faults   a refused request has no number, changes nothing, and the reply names the check and its values
/// Timeline commands that change the timeline leave in the order of their numbers, as they were analysed. When one
///          fails, those behind it wait until the server has analysed the timeline without it. Each is judged when it
///          is asked for and whenever it leaves, on the timeline as it will stand on arrival: commands/timeline_judge
///
/// The run's thread owns it: a decision depends on what has reached Earth by this cycle and never on another thread's
/// progress, so the digest of a run does not change with its pace.
class CommandGateway {
  public:
    static constexpr std::size_t commands_max = 4096;  ///< under way at a time. Our assumption: a landing needs two
    /// Limits of commands at the uplink and of CLTUs radiated in a cycle: the vehicle's receiver holds eight, and hands
    /// two a cycle to the flight software. Of those that are not hazardous only as many are handed over as leave in a
    /// cycle, so that a hazardous one finds no more before it.
    static constexpr std::size_t at_uplink_max = 8, radiated_a_cycle_max = 2;

    /// `second_person`: names of commands that need the approval of a controller other than the one who asked.
    /// `stations`: nothing leaves while none of them sees the vehicle. `entry`: predicted when the run begins; without
    /// it no deadlines are reported. `clock`: the vehicle's; without it, arrival in SCLK is unknown. `downlink_bps`:
    /// what carries the vehicle's answers.
    CommandGateway(const dictionary::Dictionary& dictionary, double light_time_s, std::vector<NamedValue> solution,
                   std::vector<std::string> second_person = {}, TrackingSchedule stations = {},
                   std::optional<Scet> entry = {}, std::optional<ClockCorrelation> clock = {},
                   double downlink_bps = 8000.0);

    /// Replaces ground's navigation solution.
    void renew_solution(std::vector<NamedValue> solution) { solutions_.renew(std::move(solution)); }

    enum class Asker : std::uint8_t { person, script };
    /// Checks and queues a request. The first stage reported carries the arguments and the octets. A dry run makes
    /// every check, reports the outcome, and changes nothing.
    Reply submit(const Request& request, Ert now, std::vector<StageReport>& stages, Asker asker = Asker::person);

    /// Applies a verdict to a waiting command. Fails when the command waits for none, or when more changes have failed
    /// since the analysis: that verdict is outdated, and a newer analysis is on its way.
    Result<void> judge(const TimelineVerdict& verdict, Ert now, std::vector<StageReport>& stages);

    /// Replies to each request of a file as if all before it had been accepted. Changes nothing.
    std::vector<Reply> look(std::span<const Request> file, Ert now);

    /// Records a refused command of the scenario's script with a number and a history. Nobody waits for its reply.
    void note_refused(const Request& request, const std::string& reason, Ert now, std::vector<StageReport>& stages);

    /// Fails when this asker has no place for `more` commands.
    Result<void> takes(std::size_t more, const std::string& asker) const;
    /// Counts of commands: waiting for a time, a controller, a pass or an analysis; and handed to the uplink, not yet
    /// radiated.
    std::size_t queued() const { return queue_.waiting().size(); }
    std::size_t at_uplink() const { return link_.waiting(); }

    /// The next planned timepoint that a command could still precede.
    const PlannedDeadlines& deadlines() const { return deadlines_; }

    /// Hands over the CLTUs that the station is to radiate now.
    Uplink take_uplinks() { return std::exchange(uplinks_, {}); }

    /// A decoded packet that reached Earth.
    struct DownlinkedPacket {
        const dictionary::Decoded& decoded;
        std::span<const std::uint8_t> octets;
        bool live = false;  ///< false: from a recording
        Ert ert;
        const dictionary::Event* event = nullptr;  ///< of an event report,
        std::string text{};                        ///< in words
    };
    void receive(const DownlinkedPacket& packet, std::vector<StageReport>& stages);
    /// Whether packets of a recording could still change a command's stages.
    bool awaits_answers() const { return !underway_.empty(); }

    /// Lets Earth's clock advance: ends the windows that have run out.
    void pass(Ert now, std::vector<StageReport>& stages);
    /// Whether something could leave that waits for the uplink or for room in the downlink: then call release_due().
    bool may_leave(Ert now) { return link_.waiting() > 0 || (waits_for_room_ && pace_.has_room(now)); }
    /// Hands due commands to the uplink after checking their preconditions again with the latest values.
    void release_due(Ert now, std::vector<StageReport>& stages);

  private:
    struct Underway {
        std::uint64_t number = 0;
        std::vector<std::uint8_t> packet;
        std::string arguments, controller, browser, client_id;
        std::string timeline;  ///< verdict of a later analysis; empty: not analysed again
        std::uint32_t priority = 0;
        Precedence precedence{};
        std::optional<Fop::Service> wanted;
        const dictionary::Packet* report = nullptr;  ///< the packet in which flight reads back this command
        CommandLifecycle lifecycle;
    };
    /// An encoded request that is not yet authorised.
    struct Prepared {
        const dictionary::Command* command = nullptr;
        std::vector<std::uint8_t> packet;
        std::string arguments;
        std::vector<PreconditionReply> preconditions;
        std::optional<Fop::Service> wanted;  ///< none: chosen at release
        std::optional<Ert> release_at;
    };
    struct Latest {
        std::optional<double> value;
        std::optional<Ert> at;
    };

    struct FieldPlace {
        std::size_t packet = 0, field = 0;  ///< in the dictionary
    };

    /// The read-back of a radiated command.
    struct ReadBack {
        std::uint64_t number = 0;
        Status held = Status::pending;  ///< ok: as sent; failed: different; unknown: no report in time
        bool renewed = false;           ///< follows an earlier one, whose values the vehicle may still hold
    };

    Result<Prepared> prepare(const Request& request, Ert now) const;
    /// Evaluates the dictionary's preconditions against the latest values. Where parameters must be on board, also
    /// checks that they are the ones sent.
    std::vector<PreconditionReply> preconditions(const dictionary::Command& command, Ert now) const;
    void note_read_back(const Underway& underway, const StageChange& change);
    void tell(const Prepared& prepared, Ert now, Reply& reply) const;
    void queue(const Prepared& prepared, const Request& request, Asker asker, Ert now, Reply& reply,
               std::vector<StageReport>& stages);
    /// Whether the command is due and waits for its turn; when it leaves is not settled then.
    bool waits_for_turn(const Underway& underway, Ert now) const {
        return stations_.sees(now) && queue_.due(underway.number, now);
    }
    void tell_turn(Underway& underway, Ert now, std::vector<StageReport>& stages);
    /// Whether a second person must approve it. Fails when approval is needed and the request names no controller.
    Result<bool> needs_approval(const Request& request) const;
    /// Holds, releases, cancels or approves a waiting command.
    Reply act(const Request& request, Ert now, std::vector<StageReport>& stages);
    /// Reports a command's new wait after an action or a verdict, and releases what is due.
    void go_on(Underway& underway, Ert now, std::vector<StageReport>& stages);
    /// Why an action on a waiting command is impossible: the command does not wait.
    std::string does_not_wait(std::uint64_t number, Ert now) const;
    /// Performs an action that check_action() has passed. Returns why it could not, or an empty string.
    std::string perform(const Request& asked, const Underway* command, Ert now);
    /// The command's entry in the queue; null: it does not wait.
    const CommandQueue::Entry* waiting(std::uint64_t number) const;
    /// Why this controller may not approve the command; empty: they may.
    static std::string not_another_person(const Request& asked, const Underway& command);
    /// Fills in when the command arrives, when Earth can see its effect, and which timepoints it would miss.
    void tell_arrival(const dictionary::Command& command, std::span<const std::uint8_t> packet, Ert now, Ert leaves,
                      Reply& reply) const;
    void tell_station(Ert leaves, Reply& reply) const;
    /// Fills in by which station a command leaves and when it arrives, as far as that is settled.
    void tell_leaving(const Underway& command, Ert now, Reply& reply) const;
    void tell_wait(Underway& underway, Ert now, std::vector<StageReport>& stages);
    /// Text: when the command leaves and by which station, as queued.
    std::string leaving_text(const CommandQueue::Entry& entry) const;
    /// The preconditions that are known not to hold now, and what the command would do to the timeline; empty: none.
    std::string failing_now(const Underway& underway, Ert now) const;
    /// Why the command's parameters do not come from ground's solutions; empty: they do, or it has none.
    std::string unlike_solutions(const dictionary::Command& command, std::span<const std::uint8_t> packet) const;
    /// Why the command must not leave at that time, because of its effect on the timeline; empty: it may leave, or has
    /// no such effect.
    /// @param number  of the command, where it has one
    std::string unsafe_on_timeline(const dictionary::Command& command, std::span<const std::uint8_t> packet, Ert leaves,
                                   std::uint64_t number = 0) const;
    std::optional<timeline::Change> timeline_change(const dictionary::Command& command,
                                                    std::span<const std::uint8_t> packet) const;
    /// Applies the rule for times when no station sees the vehicle. Due commands, and those that the uplink has not
    /// radiated, wait for the next pass. Without a next pass every waiting command fails.
    void await_pass(Ert now, std::vector<StageReport>& stages);
    /// Queues again a command that the uplink gave back.
    void wait_again(std::uint64_t number, std::optional<Ert> until, const std::string& why, Ert now,
                    std::vector<StageReport>& stages);
    /// A timeline change failed: later changes, which were analysed with it, wait for a new analysis. The histories of
    /// those already sent say so.
    void doubt_after(std::uint64_t undone, Ert now, std::vector<StageReport>& stages);
    /// Starts a pass. Commands that the vehicle has not acknowledged would be radiated again, so their preconditions
    /// are checked again.
    void begin_pass(Ert now, std::vector<StageReport>& stages);
    static std::vector<FieldPlace> clcw_places(const dictionary::Dictionary& dictionary);
    Underway* underway(std::optional<std::uint64_t> number);
    void forget_finished();  ///< frees their places
    void radiate(Ert now, std::vector<StageReport>& stages);
    void hear_clcw(std::uint32_t word, Ert ert, std::vector<StageReport>& stages);
    void note_frames(Ert now, std::vector<StageReport>& stages);
    std::vector<LatestValue> latest(Ert now) const;
    void note_channels(const DownlinkedPacket& packet);
    void note_answer(const DownlinkedPacket& packet, std::vector<StageReport>& stages);
    void note_report(const DownlinkedPacket& packet, std::vector<StageReport>& stages);
    void append(const Underway& underway, const std::vector<StageChange>& changes, std::vector<StageReport>& stages);

    const dictionary::Dictionary& dictionary_;
    double light_time_s_;
    std::vector<FieldPlace> clcw_;  ///< places of the CLCW in telemetry, one a computer; none in a dictionary without
    CommandQueue queue_;
    ReleasePace pace_;
    bool waits_for_room_ = false;  ///< a due command stayed behind when those that could were released
    CommandLink link_;
    Uplink uplinks_;
    SolutionJudge solutions_;
    std::vector<std::string> second_person_;
    TrackingSchedule stations_;
    PlannedDeadlines deadlines_;
    TimelineJudge judge_;
    std::optional<ClockCorrelation> clock_;
    std::set<std::uint64_t> undone_;      ///< timeline changes that failed
    std::vector<std::uint64_t> doubted_;  ///< by the latest failure; their histories do not say so yet
    bool unseen_ = false;                 ///< no station saw the vehicle at the last check
    std::vector<Latest> heard_;           ///< latest values by ChannelId
    std::list<Underway> underway_;
    std::map<std::string, std::vector<ReadBack>>
        read_backs_;  ///< by the command's name, in the order of sending: those whose values the vehicle may hold
    std::vector<StageChange> changes_;
    std::uint64_t commands_ = 0;
    Ert radiated_at_;                ///< the last cycle in which CLTUs were radiated,
    std::size_t radiated_then_ = 0;  ///< and their number
    std::uint16_t count_ = 0;        ///< packet count of the uplink
};

}  // namespace aeolis::commands
