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

/// The content of a packet, which is decoded once. Uplink, score and archive all read it from here.
struct DecodedPacket {
    Decoded content;
    std::string refusal;  ///< why it was not decoded, so that nothing else here is valid; empty: it was
    const dictionary::Event* event = nullptr;  ///< of an event report, in the dictionary; null: not an event report
    std::string text;                          ///< of an event report: its format with the arguments inserted
};

/// Decodes packets of one mission, with the text of event reports.
///
/// In       the octets of one packet, any octets        Out   DecodedPacket
/// Memory   the plans of the decoder that it holds or refers to
class PacketDecoder {
  public:
    /// The dictionary must outlive this and every packet decoded. `other`, if given, is the mission of the dictionary,
    /// and packets are read as its; it must outlive this.
    explicit PacketDecoder(const dictionary::Dictionary& dictionary, const OtherMission* other = nullptr);

    /// Reuses the memory of `into`.
    void decode(std::span<const std::uint8_t> packet, DecodedPacket& into) const;

  private:
    const dictionary::Dictionary* dictionary_;
    const OtherMission* other_;
    std::optional<Decommutator> decommutator_;  ///< none: another mission's packets
};

}  // namespace aeolis::telemetry
