// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/run.pb.h"
#include "commands/command_link.hpp"
#include "commands/command_queue.hpp"
#include "commands/encoder.hpp"
#include "commands/lifecycle.hpp"
#include "commands/preconditions.hpp"
#include "commands/tracking_schedule.hpp"
#include "common/time.hpp"
#include "dictionaries/dictionary.hpp"
#include "server/archive/records.hpp"
#include "server/gateway/planned_deadlines.hpp"
#include "telemetry/decommutator.hpp"

#include <cstdint>
#include <list>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace aeolis::server {

/// What the server itself does about a command that waits, by what CommandRequest::analysis says of the timeline it was
/// analysed on and that now is another: it may leave again, and its history says why; or it never does.
/// CommandRequest::request says how many changes had come to nothing when it was analysed: when there are more by now,
/// that was another timeline, and another analysis is on its way.
inline constexpr const char* timeline_holds_action = "timeline holds";
inline constexpr const char* timeline_refuted_action = "timeline refuted";

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
/// One thread owns it. It decodes what it needs by itself, so that a decision depends on what has arrived on Earth by
/// this cycle and never on how far another thread has come: the digest of a run does not change with its pace.
class CommandGateway {
  public:
    static constexpr std::size_t commands_max = 4096;  ///< ours: a landing needs two

    /// `second_person`: names of commands that leave only when another controller than the one who asked has approved
    /// them. `stations`: nothing leaves while none of them sees the vehicle. `entry`: as predicted when the run begins;
    /// none: nobody says what a command is too late for.
    CommandGateway(const dictionary::Dictionary& dictionary, double light_time_s,
                   std::vector<commands::NamedValue> solution, std::vector<std::string> second_person = {},
                   commands::TrackingSchedule stations = {}, std::optional<Scet> entry = {});

    /// Ground has another navigation solution from here on.
    void renew_solution(std::vector<commands::NamedValue> solution) { solution_ = std::move(solution); }

    /// The first stage carries the arguments and the octets. A dry run makes every check, says what would happen, and
    /// leaves all as it is.
    enum class Asker : std::uint8_t { person, script };
    v1::CommandReply submit(const v1::CommandRequest& request, Ert now, std::vector<archive::StageRecord>& stages,
                            Asker asker = Asker::person);

    /// Of a file: what would become of each if all before it were taken. Leaves all as it is.
    std::vector<v1::CommandReply> look(std::span<const v1::CommandRequest> file, Ert now);

    /// One of a scenario's script was refused: it gets a number and a history that says so, for nobody waits for its
    /// reply.
    void note_refused(const v1::CommandRequest& request, const std::string& reason, Ert now,
                      std::vector<archive::StageRecord>& stages);

    /// Whether the run has room for so many more.
    Result<void> takes(std::size_t more) const;
    /// Commands that wait for their time, a controller, a pass or an analysis; and those that the uplink has and has
    /// not radiated.
    std::size_t queued() const { return queue_.waiting().size(); }
    std::size_t at_uplink() const { return link_.waiting(); }

    /// What of the plan a command can still come before.
    const PlannedDeadlines& deadlines() const { return deadlines_; }

    /// What the station is to radiate now, each a CLTU.
    std::vector<std::vector<std::uint8_t>> take_uplinks() { return std::exchange(uplinks_, {}); }

    /// A packet reached Earth, live or later.
    void receive(std::span<const std::uint8_t> packet, bool live, Ert ert, std::vector<archive::StageRecord>& stages);

    /// Windows run out by Earth's clock.
    void pass(Ert now, std::vector<archive::StageRecord>& stages);

  private:
    struct Underway {
        std::uint64_t number = 0;
        std::vector<std::uint8_t> packet;
        std::string arguments, controller, browser;
        std::string timeline;  ///< what was said of it when it was looked at again; empty: it was not
        std::uint32_t priority = 0;
        std::optional<commands::Fop::Service> wanted;
        const dictionary::Packet* report = nullptr;  ///< in which flight reports what it holds after this command
        commands::CommandLifecycle lifecycle;
    };
    /// A request that can be encoded, before it is authorised.
    struct Prepared {
        const dictionary::Command* command = nullptr;
        std::vector<std::uint8_t> packet;
        std::string arguments;
        std::vector<commands::PreconditionState> preconditions;
        std::optional<commands::Fop::Service> wanted;  ///< none: what suits when it is released
        std::optional<Ert> release_at;
    };
    struct Heard {
        std::optional<double> value;
        std::optional<Ert> at;
    };

    struct FieldPlace {
        std::size_t packet = 0, field = 0;  ///< in the dictionary
    };

    /// What a command that was radiated came to, where flight reports back what it holds.
    struct ReadBack {
        std::uint64_t number = 0;
        commands::Status held =
            commands::Status::pending;  ///< ok: as sent; failed: something else; unknown: nothing came in its time
        bool renewed = false;           ///< after another one: the vehicle may still hold that
    };

    Result<Prepared> prepare(const v1::CommandRequest& request, Ert now) const;
    /// The dictionary's, by what was heard; and where parameters are wanted on board, that they are those that were
    /// sent.
    std::vector<commands::PreconditionState> preconditions(const dictionary::Command& command, Ert now) const;
    void note_read_back(const Underway& underway, const commands::StageChange& change);
    void tell(const Prepared& prepared, Ert now, v1::CommandReply& reply) const;
    void queue(const Prepared& prepared, const v1::CommandRequest& request, Asker asker, Ert now,
               v1::CommandReply& reply, std::vector<archive::StageRecord>& stages);
    /// Whether a second person must approve it; an Error when then nobody says who asks.
    Result<bool> needs_approval(const v1::CommandRequest& request) const;
    /// Hold, release, cancel or approval of one that waits.
    v1::CommandReply act(const v1::CommandRequest& request, Ert now, std::vector<archive::StageRecord>& stages);
    /// Does what is asked; why not, or nothing.
    std::string perform(const v1::CommandRequest& asked, const Underway* command, Ert now);
    /// Its line in the queue; null: it does not wait.
    const commands::CommandQueue::Entry* waiting(std::uint64_t number) const;
    /// Why this one may not approve it; empty: they may.
    static std::string not_another_person(const v1::CommandRequest& asked, const Underway& command);
    /// When it is at the vehicle, when Earth can see what it does, and what it comes too late for.
    void tell_arrival(const dictionary::Command& command, std::span<const std::uint8_t> packet, Ert now, Ert leaves,
                      v1::CommandReply& reply) const;
    void tell_station(Ert leaves, v1::CommandReply& reply) const;
    /// Of one that was acted upon: by which station and when it is there, as far as that is settled.
    void tell_leaving(const Underway& command, Ert now, v1::CommandReply& reply) const;
    void tell_wait(Underway& underway, Ert now, std::vector<archive::StageRecord>& stages);
    /// When it leaves, and by which station, as the queue has it.
    std::string leaving_text(const commands::CommandQueue::Entry& entry) const;
    /// Which of its preconditions are known not to hold now; empty: none.
    std::string failing_now(const dictionary::Command& command, Ert now) const;
    /// Hands those that are due to the uplink: after another look at their preconditions, by what is known now.
    void release_due(Ert now, std::vector<archive::StageRecord>& stages);
    /// While no station sees the vehicle: what is due, and what the uplink has not radiated, waits for the next pass.
    /// Where none comes all that waits fails, whatever it waits for.
    void await_pass(Ert now, std::vector<archive::StageRecord>& stages);
    /// What the uplink gave back waits again.
    void wait_again(std::uint64_t number, std::optional<Ert> until, const std::string& why, Ert now,
                    std::vector<archive::StageRecord>& stages);
    /// A change of the timeline came to nothing: those after it, which were analysed with it, do not leave before they
    /// are analysed anew; of those that have left it is said.
    void doubt_after(std::uint64_t undone, Ert now, std::vector<archive::StageRecord>& stages);
    /// When a pass begins: what the vehicle has not acknowledged would be radiated again, so its preconditions are
    /// looked at again.
    void begin_pass(Ert now, std::vector<archive::StageRecord>& stages);
    static std::vector<FieldPlace> clcw_places(const dictionary::Dictionary& dictionary);
    Underway* underway(std::optional<std::uint64_t> number);
    void radiate(Ert now, std::vector<archive::StageRecord>& stages);
    void hear_clcw(std::uint32_t word, Ert ert, std::vector<archive::StageRecord>& stages);
    void note_frames(Ert now, std::vector<archive::StageRecord>& stages);
    std::vector<commands::LatestValue> latest(Ert now) const;
    void note_channels(const dictionary::Packet& packet, Ert ert);
    void note_answer(Ert ert, std::vector<archive::StageRecord>& stages);
    void note_report(const dictionary::Packet& packet, std::span<const std::uint8_t> octets, Ert ert,
                     std::vector<archive::StageRecord>& stages);
    void append(const Underway& underway, const std::vector<commands::StageChange>& changes,
                std::vector<archive::StageRecord>& stages);

    const dictionary::Dictionary& dictionary_;
    telemetry::Decommutator decommutator_;
    telemetry::Decoded decoded_;
    double light_time_s_;
    std::vector<FieldPlace> clcw_;  ///< where telemetry has it, of each computer; none in a dictionary without
    commands::CommandQueue queue_;
    commands::CommandLink link_;
    std::vector<std::vector<std::uint8_t>> uplinks_;
    std::vector<commands::NamedValue> solution_;
    std::vector<std::string> second_person_;
    commands::TrackingSchedule stations_;
    PlannedDeadlines deadlines_;
    std::set<std::uint64_t> undone_;      ///< changes of the timeline that came to nothing
    std::vector<std::uint64_t> doubted_;  ///< by what has just come to nothing; their histories do not say so yet
    bool unseen_ = false;                 ///< no station saw the vehicle when it was last looked at
    std::vector<Heard> heard_;            ///< by ChannelId
    std::list<Underway> underway_;
    std::map<std::string, std::vector<ReadBack>>
        read_backs_;  ///< by the command's name, in the order in which they left: those of which the vehicle may hold
                      ///< what was sent
    std::vector<commands::StageChange> changes_;
    std::uint64_t commands_ = 0;
    std::uint16_t count_ = 0;  ///< packet count of the uplink
};

}  // namespace aeolis::server
