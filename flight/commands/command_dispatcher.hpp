#pragma once

#include "flight/kernel/outbox.hpp"

namespace aeolis::flight {

/// Takes telecommand packets apart and sends each command to the one module that owns it.
///
/// In      UplinkReceived (any octets), CommandOutcome from the owner
/// Out     the command as a message; COMMAND_ACCEPTED and COMMAND_EXECUTED, or COMMAND_REFUSED with the reason
/// Faults  whatever cannot be read is refused with its reason; nothing is acted on before it is read whole. R3, R23
class CommandDispatcher {
  public:
    void on(const UplinkReceived& uplink, Outbox& out);
    void on(const CommandOutcome& outcome, Outbox& out);

  private:
    std::uint16_t refused_ = 0;
};

}  // namespace aeolis::flight
