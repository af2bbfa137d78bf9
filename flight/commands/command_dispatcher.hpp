// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/commands/farm.hpp"
#include "flight/kernel/outbox.hpp"
#include "flight/load.hpp"

#include <cstddef>
#include <cstdint>
#include <span>

namespace aeolis::flight {

/// Unpacks uplinked CLTUs, frames and packets, and sends each command to the one module that owns it.
///
/// In      UplinkReceived (any octets), CommandOutcome from the owner, Resume when Second Chance takes over
/// Out     the command as a message; COMMAND_ACCEPTED and COMMAND_EXECUTED, or COMMAND_REFUSED with the reason; an
///         Explanation with the conditions by which the owner decided;
///         UplinkStatus, which tells ground what to retransmit
/// Faults  Unreadable input is refused with its reason; nothing is acted on before all of it has been parsed. R3, R23
///         After a restart of the computer, no sequenced frame is accepted until ground unlocks the channel;
///         UplinkStatus shows the lock. So a retransmitted frame never executes a command twice
class CommandDispatcher {
  public:
    explicit CommandDispatcher(const Load& load) : role_(load.role) {}

    void on(const UplinkReceived& uplink, Outbox& out);
    void on(const CommandOutcome& outcome, Outbox& out);
    void on(const Resume& resume, Outbox& out);

  private:
    void take_frame(const TcFrame& frame, Outbox& out);
    void take_packet(std::span<const std::uint8_t> octets, Outbox& out);
    void unreadable(std::size_t octets, Outbox& out);
    bool is_deaf() const { return role_ == Role::second_chance && !in_control_; }
    bool is_for_this_computer(Opcode opcode) const;

    Role role_;
    Farm farm_{{.spacecraft = spacecraft_id, .virtual_channel = telecommand_channel, .locked_at_start = true}};
    bool in_control_ = false;  ///< as Second Chance
    std::uint16_t refused_ = 0;
};

}  // namespace aeolis::flight
