// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "commands/command_link.hpp"
#include "commands/command_queue.hpp"
#include "commands/encoder.hpp"
#include "commands/lifecycle.hpp"
#include "commands/planned_deadlines.hpp"
#include "commands/port.hpp"
#include "commands/preconditions.hpp"
#include "commands/request.hpp"
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

/// The command path of one run: the only one. WebSocket, POST and the scenario's own script all come through here.
///
/// In       requests; packets as they reach Earth; Earth's clock     Out   CLTUs to radiate, replies, stages
/// Order    look up → arguments → encode → preconditions → arming and typed confirmation → queued → authorised →
///          released → radiated, as commands/command_link has it; then what telemetry shows, by commands/lifecycle
/// Memory   at most `commands_max` commands a run, a few kilooctets each; the latest value of each channel
/// Faults   a refused request has no number, changes nothing, and the reply names the check and its values
/// Timeline commands that change it leave in the order of their numbers, in which they were analysed; when one comes to
/// nothing those
///          behind it wait until the server has said of each what becomes of the timeline without it
/// One thread owns it, that of the run: a decision depends on what has arrived on Earth by this cycle and never on how
/// far another thread has come, so that the digest of a run does not change with its pace.
class CommandGateway {
  public:
    static constexpr std::size_t commands_max = 4096;  ///< ours: a landing needs two

    /// `second_person`: names of commands that leave only when another controller than the one who asked has approved
    /// them. `stations`: nothing leaves while none of them sees the vehicle. `entry`: as predicted when the run begins;
    /// none: nobody says what a command is too late for.
    CommandGateway(const dictionary::Dictionary& dictionary, double light_time_s, std::vector<NamedValue> solution,
                   std::vector<std::string> second_person = {}, TrackingSchedule stations = {},
                   std::optional<Scet> entry = {});

    /// Ground has another navigation solution from here on.
    void renew_solution(std::vector<NamedValue> solution) { solution_ = std::move(solution); }

    /// The first stage carries the arguments and the octets. A dry run makes every check, says what would happen, and
    /// leaves all as it is.
    enum class Asker : std::uint8_t { person, script };
    Reply submit(const Request& request, Ert now, std::vector<StageReport>& stages, Asker asker = Asker::person);

    /// Refused when the command does not wait for a verdict, or more changes have come to nothing since the analysis:
    /// that was another timeline, and another analysis is on its way.
    Result<void> judge(const TimelineVerdict& verdict, Ert now, std::vector<StageReport>& stages);

    /// Of a file: what would become of each if all before it were taken. Leaves all as it is.
    std::vector<Reply> look(std::span<const Request> file, Ert now);

    /// One of a scenario's script was refused: it gets a number and a history that says so, for nobody waits for its
    /// reply.
    void note_refused(const Request& request, const std::string& reason, Ert now, std::vector<StageReport>& stages);

    /// Whether the run has room for so many more.
    Result<void> takes(std::size_t more) const;
    /// Commands that wait for their time, a controller, a pass or an analysis; and those that the uplink has and has
    /// not radiated.
    std::size_t queued() const { return queue_.waiting().size(); }
    std::size_t at_uplink() const { return link_.waiting(); }

    /// What of the plan a command can still come before.
    const PlannedDeadlines& deadlines() const { return deadlines_; }

    /// What the station is to radiate now, each a CLTU.
    Uplink take_uplinks() { return std::exchange(uplinks_, {}); }

    /// A packet that reached Earth, as it was decoded.
    struct Heard {
        const dictionary::Decoded& decoded;
        std::span<const std::uint8_t> octets;
        bool live = false;  ///< else it tells the past
        Ert ert;
        const dictionary::Event* event = nullptr;  ///< of a packet that is one,
        std::string text{};                        ///< in words
    };
    void receive(const Heard& packet, std::vector<StageReport>& stages);
    /// Whether what comes later than live can still tell it something.
    bool awaits_answers() const { return !underway_.empty(); }

    /// Windows run out by Earth's clock.
    void pass(Ert now, std::vector<StageReport>& stages);

  private:
    struct Underway {
        std::uint64_t number = 0;
        std::vector<std::uint8_t> packet;
        std::string arguments, controller, browser;
        std::string timeline;  ///< what was said of it when it was looked at again; empty: it was not
        std::uint32_t priority = 0;
        std::optional<Fop::Service> wanted;
        const dictionary::Packet* report = nullptr;  ///< in which flight reports what it holds after this command
        CommandLifecycle lifecycle;
    };
    /// A request that can be encoded, before it is authorised.
    struct Prepared {
        const dictionary::Command* command = nullptr;
        std::vector<std::uint8_t> packet;
        std::string arguments;
        std::vector<PreconditionState> preconditions;
        std::optional<Fop::Service> wanted;  ///< none: what suits when it is released
        std::optional<Ert> release_at;
    };
    struct Latest {
        std::optional<double> value;
        std::optional<Ert> at;
    };

    struct FieldPlace {
        std::size_t packet = 0, field = 0;  ///< in the dictionary
    };

    /// What a command that was radiated came to, where flight reports back what it holds.
    struct ReadBack {
        std::uint64_t number = 0;
        Status held = Status::pending;  ///< ok: as sent; failed: something else; unknown: nothing came in its time
        bool renewed = false;           ///< after another one: the vehicle may still hold that
    };

    Result<Prepared> prepare(const Request& request, Ert now) const;
    /// The dictionary's, by what was heard; and where parameters are wanted on board, that they are those that were
    /// sent.
    std::vector<PreconditionState> preconditions(const dictionary::Command& command, Ert now) const;
    void note_read_back(const Underway& underway, const StageChange& change);
    void tell(const Prepared& prepared, Ert now, Reply& reply) const;
    void queue(const Prepared& prepared, const Request& request, Asker asker, Ert now, Reply& reply,
               std::vector<StageReport>& stages);
    /// Whether a second person must approve it; an Error when then nobody says who asks.
    Result<bool> needs_approval(const Request& request) const;
    /// Hold, release, cancel or approval of one that waits.
    Reply act(const Request& request, Ert now, std::vector<StageReport>& stages);
    /// After an action or a verdict: its wait is told anew, and what may leave does.
    void go_on(Underway& underway, Ert now, std::vector<StageReport>& stages);
    /// Why what is asked about a waiting command cannot be: it does not wait.
    std::string does_not_wait(std::uint64_t number, Ert now) const;
    /// Does what is asked; why not, or nothing.
    std::string perform(const Request& asked, const Underway* command, Ert now);
    /// Its line in the queue; null: it does not wait.
    const CommandQueue::Entry* waiting(std::uint64_t number) const;
    /// Why this one may not approve it; empty: they may.
    static std::string not_another_person(const Request& asked, const Underway& command);
    /// When it is at the vehicle, when Earth can see what it does, and what it comes too late for.
    void tell_arrival(const dictionary::Command& command, std::span<const std::uint8_t> packet, Ert now, Ert leaves,
                      Reply& reply) const;
    void tell_station(Ert leaves, Reply& reply) const;
    /// Of one that was acted upon: by which station and when it is there, as far as that is settled.
    void tell_leaving(const Underway& command, Ert now, Reply& reply) const;
    void tell_wait(Underway& underway, Ert now, std::vector<StageReport>& stages);
    /// When it leaves, and by which station, as the queue has it.
    std::string leaving_text(const CommandQueue::Entry& entry) const;
    /// Which of its preconditions are known not to hold now; empty: none.
    std::string failing_now(const dictionary::Command& command, Ert now) const;
    /// Hands those that are due to the uplink: after another look at their preconditions, by what is known now.
    void release_due(Ert now, std::vector<StageReport>& stages);
    /// While no station sees the vehicle: what is due, and what the uplink has not radiated, waits for the next pass.
    /// Where none comes all that waits fails, whatever it waits for.
    void await_pass(Ert now, std::vector<StageReport>& stages);
    /// What the uplink gave back waits again.
    void wait_again(std::uint64_t number, std::optional<Ert> until, const std::string& why, Ert now,
                    std::vector<StageReport>& stages);
    /// A change of the timeline came to nothing: those after it, which were analysed with it, do not leave before they
    /// are analysed anew; of those that have left it is said.
    void doubt_after(std::uint64_t undone, Ert now, std::vector<StageReport>& stages);
    /// When a pass begins: what the vehicle has not acknowledged would be radiated again, so its preconditions are
    /// looked at again.
    void begin_pass(Ert now, std::vector<StageReport>& stages);
    static std::vector<FieldPlace> clcw_places(const dictionary::Dictionary& dictionary);
    Underway* underway(std::optional<std::uint64_t> number);
    void radiate(Ert now, std::vector<StageReport>& stages);
    void hear_clcw(std::uint32_t word, Ert ert, std::vector<StageReport>& stages);
    void note_frames(Ert now, std::vector<StageReport>& stages);
    std::vector<LatestValue> latest(Ert now) const;
    void note_channels(const Heard& packet);
    void note_answer(const Heard& packet, std::vector<StageReport>& stages);
    void note_report(const Heard& packet, std::vector<StageReport>& stages);
    void append(const Underway& underway, const std::vector<StageChange>& changes, std::vector<StageReport>& stages);

    const dictionary::Dictionary& dictionary_;
    double light_time_s_;
    std::vector<FieldPlace> clcw_;  ///< where telemetry has it, of each computer; none in a dictionary without
    CommandQueue queue_;
    CommandLink link_;
    Uplink uplinks_;
    std::vector<NamedValue> solution_;
    std::vector<std::string> second_person_;
    TrackingSchedule stations_;
    PlannedDeadlines deadlines_;
    std::set<std::uint64_t> undone_;      ///< changes of the timeline that came to nothing
    std::vector<std::uint64_t> doubted_;  ///< by what has just come to nothing; their histories do not say so yet
    bool unseen_ = false;                 ///< no station saw the vehicle when it was last looked at
    std::vector<Latest> heard_;           ///< by ChannelId
    std::list<Underway> underway_;
    std::map<std::string, std::vector<ReadBack>>
        read_backs_;  ///< by the command's name, in the order in which they left: those of which the vehicle may hold
                      ///< what was sent
    std::vector<StageChange> changes_;
    std::uint64_t commands_ = 0;
    std::uint16_t count_ = 0;  ///< packet count of the uplink
};

}  // namespace aeolis::commands
