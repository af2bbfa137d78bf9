// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "common/tc_frame.hpp"

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

namespace aeolis::commands {

/// FOP-1 without timers: sends telecommand frames of one virtual channel until the vehicle acknowledges them.
/// [ccsds-232.1-b-2]
///
/// In       data to send, each with a tag of the caller's; CLCWs as received; repeat() when the caller's time-out ends
///          (longer than the light time there and back)
/// Out      frames to radiate, one by one; for each tag, once, its fate
/// Limit    at most `frames_max` wait or are outstanding; a frame is radiated at most `transmissions_max` times
/// Faults   lockout, a report that contradicts what was sent, or too many transmissions halt the service: radiated
///          frames without acknowledgement are reported as such, the others wait for restart()
class Fop {
  public:
    static constexpr std::size_t frames_max = 1024;  ///< chosen: far more than a person sends

    struct Settings {
        std::uint16_t spacecraft = 0;
        std::uint8_t virtual_channel = 0;
        std::uint8_t window = 32;  ///< outstanding at most; less than half of the receiver's window
        unsigned transmissions_max = 8;
    };
    enum class Service {
        sequence_controlled,  ///< AD: in order, acknowledged, retransmitted
        expedited,            ///< BD: once, without acknowledgement
    };
    enum class State {
        active,
        retransmitting,  ///< retransmission was requested; a repeated request is ignored
        waiting,         ///< the vehicle has no room
        halted,          ///< no sequence-controlled frame goes out until restart()
        restarting,      ///< the receiver's next sequence number is being set
    };
    enum class Halt { none, lockout, contradiction, too_many_transmissions };
    enum class Fate {
        acknowledged,
        radiated,            ///< by the expedited service: nothing more will be known
        never_acknowledged,  ///< radiated; the vehicle may or may not have taken it
    };
    struct Report {
        std::uint64_t tag = 0;
        Fate fate{};
        unsigned transmissions = 0;
        bool operator==(const Report&) const = default;
    };
    struct Outgoing {
        std::vector<std::uint8_t> frame;
        std::optional<std::uint64_t> tag;  ///< none: a control command to the frame receiver
        unsigned transmission = 1;
    };

    explicit Fop(const Settings& settings);

    /// Queues `data` (1 … 1017 octets). Fails when it does not fit a frame or too many wait.
    Result<void> send(std::uint64_t tag, std::span<const std::uint8_t> data, Service service);

    /// The next frame to radiate; none when there is nothing to send or the window is full. Of both services the frame
    /// that was sent first goes first. A sequence-controlled one that cannot go yet, or was radiated before, holds up
    /// no expedited one.
    std::optional<Outgoing> next();

    void on(const Clcw& clcw);

    /// Handles the time-out of the outstanding frames: sends them again, or gives up.
    void repeat();

    /// Unlocks the receiver and sets its next sequence number; waiting frames go out once it has confirmed.
    void restart();

    /// Takes back data that were never radiated; returns their tags in the order of sending.
    std::vector<std::uint64_t> take_back();
    /// Tags of radiated frames that are not acknowledged, in that order.
    std::vector<std::uint64_t> unacknowledged() const;

    /// Reports since the last call, in order.
    std::vector<Report> take_reports();

    State state() const { return state_; }
    Halt why_halted() const { return why_halted_; }
    std::size_t outstanding() const { return outstanding_.size(); }
    std::size_t waiting() const { return waiting_.size() + expedited_.size(); }
    /// Whether another sequence-controlled frame could go before one is acknowledged.
    bool has_window() const { return outstanding_.size() + waiting_.size() < settings_.window; }

  private:
    struct Item {
        std::uint64_t tag = 0;
        std::uint64_t order = 0;  ///< of sending, by either service
        std::vector<std::uint8_t> data;
        std::uint8_t sequence = 0;
        unsigned transmissions = 0;
        bool due = true;  ///< to be radiated, for the first time or again
    };

    /// The sequence-controlled frame that could go now; null: none.
    Item* next_sequenced();
    Outgoing radiate(Item& item, bool bypass);
    Outgoing control(std::vector<std::uint8_t> command) const;
    std::vector<std::uint8_t> frame_of(const TcFrameHeader& header, std::span<const std::uint8_t> data) const;
    void acknowledge(std::size_t frames);
    void send_again();
    void halt(Halt why);
    std::uint8_t first_outstanding() const;

    Settings settings_;
    std::deque<Item> expedited_, waiting_, outstanding_;
    std::deque<std::vector<std::uint8_t>> controls_;
    std::vector<Report> reports_;
    std::uint64_t sent_ = 0;
    std::uint8_t next_sequence_ = 0;  ///< V(S)
    State state_ = State::active;
    Halt why_halted_ = Halt::none;
};

}  // namespace aeolis::commands
