// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/decoded.hpp"
#include "dictionaries/dictionary.hpp"
#include "telemetry/decommutator.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace aeolis::telemetry {

class OtherMission;

/// What a packet says, from the one decode that it gets. Uplink, score and archive all read this.
struct DecodedPacket {
    Decoded content;
    std::string refusal;                       ///< why it was not decoded: nothing else here holds; empty: it was
    const dictionary::Event* event = nullptr;  ///< of an event report, in the dictionary; null: of no event
    std::string text;                          ///< of an event report: its format with the arguments inserted
};

/// Decodes packets of one mission, with the text of event reports.
///
/// In       the octets of one packet, any octets        Out   DecodedPacket
/// Memory   the plans of the decoder that it holds or refers to
class PacketDecoder {
  public:
    /// The dictionary must outlive this and what it decodes. With `other`, the mission of the dictionary, packets are
    /// read as that mission's; it must outlive this.
    explicit PacketDecoder(const dictionary::Dictionary& dictionary, const OtherMission* other = nullptr);

    /// Reuses the memory of `into`.
    void decode(std::span<const std::uint8_t> packet, DecodedPacket& into) const;

  private:
    const dictionary::Dictionary* dictionary_;
    const OtherMission* other_;
    std::optional<Decommutator> decommutator_;  ///< none: another mission's packets
};

}  // namespace aeolis::telemetry
