#pragma once

#include "flight/kernel/outbox.hpp"
#include "flight/load.hpp"

namespace aeolis::flight {

/// Takes telecommand packets apart and sends each command to the one module that owns it.
///
/// In      UplinkReceived (any octets), CommandOutcome from the owner, Resume when Second Chance takes over
/// Out     the command as a message; COMMAND_ACCEPTED and COMMAND_EXECUTED, or COMMAND_REFUSED with the reason
/// Faults  whatever cannot be read is refused with its reason; nothing is acted on before it is read whole. R3, R23
class CommandDispatcher {
  public:
    explicit CommandDispatcher(const Load& load) : role_(load.role) {}

    void on(const UplinkReceived& uplink, Outbox& out);
    void on(const CommandOutcome& outcome, Outbox& out);
    void on(const Resume& resume, Outbox& out);

  private:
    bool is_for_this_computer(Opcode opcode) const;

    Role role_;
    bool in_control_ = false;  ///< as Second Chance
    std::uint16_t refused_ = 0;
};

}  // namespace aeolis::flight
