#pragma once

#include "common/ids.hpp"
#include "flight/load.hpp"
#include "generated/dictionary_flight.hpp"

#include <cstdint>

namespace aeolis::flight {

/// What of the recording goes to ground in real time: every n-th packet of an APID in a phase; 0: none. R30
/// Ours; the link's 8 kb/s are about 15 octets a cycle. [facts]
std::uint32_t realtime_every(Plan plan, EdlPhase phase, Apid apid);

/// Packets that are never thinned and go before all channel packets: events, firings, explanations, tones, read-back.
bool goes_first(Apid apid);

}  // namespace aeolis::flight
