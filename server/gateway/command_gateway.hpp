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
#include "simulation/landing.hpp"
#include "telemetry/decommutator.hpp"

#include <cstdint>
#include <list>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace aeolis::server {

/// Ground's navigation solution as arguments of "set edl parameters", by argument name.
std::vector<commands::NamedValue> solution_arguments(const simulation::NavigationSolution& solution);

/// The command path of one run: the only one. WebSocket, POST and the scenario's own script all come through here.
///
/// In       requests; packets as they reach Earth; Earth's clock     Out   CLTUs to radiate, replies, stages
/// Order    look up → arguments → encode → preconditions → arming and typed confirmation → queued → authorised →
///          released → radiated, as commands/command_link has it; then what telemetry shows, by commands/lifecycle
/// Memory   at most `commands_max` commands a run, a few kilooctets each; the latest value of each channel
/// Faults   a refused request has no number, changes nothing, and the reply names the check and its values
/// One thread owns it. It decodes what it needs by itself, so that a decision depends on what has arrived on Earth by
/// this cycle and never on how far another thread has come: the digest of a run does not change with its pace.
class CommandGateway {
  public:
    static constexpr std::size_t commands_max = 4096; ///< ours: a landing needs two

    /// `second_person`: names of commands that leave only when another controller than the one who asked has approved them.
    /// `stations`: nothing leaves while none of them sees the vehicle.
    CommandGateway(const dictionary::Dictionary& dictionary, double light_time_s,
                   std::vector<commands::NamedValue> solution, std::vector<std::string> second_person = {},
                   commands::TrackingSchedule stations = {});

    /// Ground has another navigation solution from here on.
    void renew_solution(std::vector<commands::NamedValue> solution) { solution_ = std::move(solution); }

    /// The first stage carries the arguments and the octets. A dry run makes every check, says what would happen, and leaves all
    /// as it is.
    v1::CommandReply submit(const v1::CommandRequest& request, Ert now, std::vector<archive::StageRecord>& stages);

    /// What the station is to radiate now, each a CLTU.
    std::vector<std::vector<std::uint8_t>> take_uplinks() { return std::exchange(uplinks_, {}); }

    /// A packet reached Earth, live or later.
    void receive(std::span<const std::uint8_t> packet, bool live, Ert ert,
                 std::vector<archive::StageRecord>& stages);

    /// Windows run out by Earth's clock.
    void pass(Ert now, std::vector<archive::StageRecord>& stages);

  private:
    struct Underway {
        std::uint64_t number = 0;
        std::vector<std::uint8_t> packet;
        std::string arguments, controller;
        std::optional<commands::Fop::Service> wanted;
        const dictionary::Packet* report = nullptr; ///< in which flight reports what it holds after this command
        commands::CommandLifecycle lifecycle;
    };
    /// A request that can be encoded, before it is authorised.
    struct Prepared {
        const dictionary::Command* command = nullptr;
        std::vector<std::uint8_t> packet;
        std::string arguments;
        std::vector<commands::PreconditionState> preconditions;
        std::optional<commands::Fop::Service> wanted; ///< none: what suits when it is released
        std::optional<Ert> release_at;
    };
    struct Heard {
        std::optional<double> value;
        std::optional<Ert> at;
    };

    struct FieldPlace {
        std::size_t packet = 0, field = 0; ///< in the dictionary
    };

    Result<Prepared> prepare(const v1::CommandRequest& request, Ert now) const;
    void tell(const Prepared& prepared, Ert now, v1::CommandReply& reply) const;
    void queue(const Prepared& prepared, const v1::CommandRequest& request, Ert now, v1::CommandReply& reply,
               std::vector<archive::StageRecord>& stages);
    /// Whether a second person must approve it; an Error when then nobody says who asks.
    Result<bool> needs_approval(const v1::CommandRequest& request) const;
    /// Hold, release, cancel or approval of one that waits.
    v1::CommandReply act(const v1::CommandRequest& request, Ert now, std::vector<archive::StageRecord>& stages);
    /// Does what is asked; why not, or nothing.
    std::string perform(const v1::CommandRequest& asked, const Underway* command, Ert now);
    /// Its line in the queue; null: it does not wait.
    const commands::CommandQueue::Entry* waiting(std::uint64_t number) const;
    void tell_station(Ert leaves, v1::CommandReply& reply) const;
    void tell_wait(Underway& underway, Ert now, std::vector<archive::StageRecord>& stages);
    /// Hands those that are due to the uplink: after another look at their preconditions, by what is known now.
    void release_due(Ert now, std::vector<archive::StageRecord>& stages);
    /// Those that are due while no station sees the vehicle wait for the next pass, or fail where none comes.
    void await_pass(Ert now, std::vector<archive::StageRecord>& stages);
    static std::optional<FieldPlace> clcw_place(const dictionary::Dictionary& dictionary);
    Underway* underway(std::optional<std::uint64_t> number);
    void radiate(Ert now, std::vector<archive::StageRecord>& stages);
    void hear_clcw(Ert ert, std::vector<archive::StageRecord>& stages);
    void note_frames(Ert now, std::vector<archive::StageRecord>& stages);
    std::vector<commands::LatestValue> latest(Ert now) const;
    void note_channels(const dictionary::Packet& packet, Ert ert);
    void note_answer(Ert ert, std::vector<archive::StageRecord>& stages);
    void note_report(const dictionary::Packet& packet, std::span<const std::uint8_t> octets, Ert ert,
                     std::vector<archive::StageRecord>& stages);
    void append(const Underway& underway, const std::vector<commands::StageChange>& changes,
                std::vector<archive::StageRecord>& stages) const;

    const dictionary::Dictionary& dictionary_;
    telemetry::Decommutator decommutator_;
    telemetry::Decoded decoded_;
    double light_time_s_;
    std::optional<FieldPlace> clcw_; ///< where telemetry has it; none in a dictionary without
    commands::CommandQueue queue_;
    commands::CommandLink link_;
    std::vector<std::vector<std::uint8_t>> uplinks_;
    std::vector<commands::NamedValue> solution_;
    std::vector<std::string> second_person_;
    commands::TrackingSchedule stations_;
    std::vector<Heard> heard_; ///< by ChannelId
    std::list<Underway> underway_;
    std::vector<commands::StageChange> changes_;
    std::uint64_t commands_ = 0;
    std::uint16_t count_ = 0; ///< packet count of the uplink
};

} // namespace aeolis::server
