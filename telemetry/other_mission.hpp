// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"
#include "telemetry/container_decoder.hpp"
#include "telemetry/decommutator.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace aeolis::telemetry {

/// Another mission in the words that our ground speaks: a packet a container, a channel a number that its containers
/// hold.
///
/// In       the octets of a packet                       Out   Decoded by the indices of dictionary(), or why not
/// Channels numbers, labels (by their number), flags and times; of what is repeated or sized by the packet the first
///          `elements_max`. Text and octets are no channels: contents() has everything.
/// Names    those of the file; where two are alike the later one has the path of its SpaceSystem before it
/// Time     what the packet says of it as if it were the spacecraft's clock; none: the clock stands at 0
/// Faults   a packet that can be read in part is decoded in part: what is not in it is undefined
/// Many threads may share one.
class OtherMission {
  public:
    static constexpr std::size_t elements_max = 16;  ///< ours: of a list of unknown length
    static constexpr std::size_t channels_max = 0xFFFF;
    static constexpr std::size_t fields_max = std::size_t{1} << 20U;  ///< ours: of all packets together
    /// APID of a packet whose container does not ask for one: no packet has it.
    static constexpr Apid any_apid{0xFFFF};

    /// @param id  of the XTCE text, as our dictionary's id is of ours
    OtherMission(dictionary::xtce::PacketModel model, std::uint16_t id);
    OtherMission(const OtherMission&) = delete;
    OtherMission& operator=(const OtherMission&) = delete;

    const dictionary::Dictionary& dictionary() const { return dictionary_; }
    /// Fields that found no place among channels_max and fields_max.
    std::size_t left_out() const { return left_out_; }

    DecodedContents contents(std::span<const std::uint8_t> packet) const { return decoder_.decode(packet); }
    /// None when at least a part was decoded; `into` is unspecified after a refusal.
    std::optional<std::string> decode(std::span<const std::uint8_t> packet, Decoded& into) const;

  private:
    class Builder;
    using FieldKey = std::pair<std::size_t, std::string>;  ///< parameter, and its name with member and element

    dictionary::xtce::PacketModel model_;
    ContainerDecoder decoder_;
    dictionary::Dictionary dictionary_;
    std::vector<std::map<FieldKey, std::size_t>> fields_;  ///< by packet
    std::size_t left_out_ = 0;
};

}  // namespace aeolis::telemetry
