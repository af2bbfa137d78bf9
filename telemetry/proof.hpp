// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "telemetry/packet_identity.hpp"

#include <cstdint>
#include <string>

namespace aeolis::telemetry {

/// The proof that every real-time packet is in the recording, bit for bit.
///
/// It holds once the whole recording is received; before that `realtime_not_recorded` means "not yet".
struct Proof {
    std::uint64_t recorded = 0;
    std::uint64_t realtime = 0;
    std::uint64_t realtime_not_recorded = 0;
    std::uint64_t realtime_differs = 0;
    std::uint64_t never_seen_live = 0;  ///< recorded, but lost on the link or never sent over it
    std::uint64_t unregistered = 0;     ///< not compared: the register was full

    bool holds() const { return realtime_not_recorded == 0 && realtime_differs == 0 && unregistered == 0; }
};

Proof prove(const PacketRegister& register_of_run);

/// "all 4120 packets seen in real time are in the recording, bit for bit; of 65123 packets recorded, 61003 were never
/// seen …"
std::string text_of(const Proof& proof);

}  // namespace aeolis::telemetry
