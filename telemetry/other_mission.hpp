// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"
#include "telemetry/container_decoder.hpp"
#include "telemetry/container_plan.hpp"
#include "telemetry/decommutator.hpp"
#include "telemetry/time_source.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace aeolis::telemetry {

/// Another mission in terms of our dictionary: each container is a packet, each number or text in it a channel.
///
/// In       the octets of a packet                       Out   Decoded by the indices of dictionary(), or the reason
///          for refusal
/// Channels numbers, labels (by their number), flags, times and text; of arrays, and of parameters whose size varies,
///          the first `elements_max`. Octets are not channels; contents() has everything
/// Exact    whole numbers of more than 53 bits and text are in Decoded::texts
/// Alarms   those of the file; unsupported_alarms() names contexts that do not compare channels
/// Names    those of the file; of two equal names the later is prefixed with its SpaceSystem's path
/// Time     the packet's own time, as if from the spacecraft's clock, none beyond 1e12 s; Decoded::timed says whether
///          there is one
/// Rate     containers are compiled where they can be (telemetry/container_plan.hpp); others, packets that are not
///          whole, and every packet where the caller names the place of the time, are looked up in the XTCE
/// Faults   a partly readable packet is decoded in part; the rest is undefined, and Decoded::problem says why
/// Many threads may share one.
class OtherMission {
  public:
    static constexpr std::size_t elements_max = 16;  ///< chosen: of a list of unknown length
    static constexpr std::size_t channels_max = 0xFFFF;
    static constexpr std::size_t fields_max = std::size_t{1} << 20U;  ///< chosen: of all packets together
    /// APID of a packet whose container does not restrict it; no real packet has this one.
    static constexpr Apid unrestricted_apid{0xFFFF};

    /// @param id    of the XTCE text, like the id of our dictionary
    /// @param time  where packets hold their time; none: as ContainerDecoder finds it
    OtherMission(dictionary::xtce::PacketModel model, std::uint16_t id, std::optional<TimeSource> time = {});
    OtherMission(const OtherMission&) = delete;
    OtherMission& operator=(const OtherMission&) = delete;

    const dictionary::Dictionary& dictionary() const { return dictionary_; }
    /// Number of fields beyond channels_max and fields_max.
    std::size_t omitted_fields() const { return omitted_fields_; }
    /// The alarms of the file that are not judged, each described in a line.
    const std::vector<std::string>& unsupported_alarms() const { return unsupported_alarms_; }

    DecodedContents contents(std::span<const std::uint8_t> packet) const;
    /// Decodes a packet. Returns none when at least a part was decoded; after a refusal `into` is unspecified.
    std::optional<std::string> decode(std::span<const std::uint8_t> packet, Decoded& into) const;

  private:
    class Builder;
    using FieldKey = std::pair<std::size_t, std::string>;  ///< parameter, and its name with member and element

    dictionary::xtce::PacketModel model_;
    ContainerDecoder decoder_;
    std::optional<TimeSource> time_;
    dictionary::Dictionary dictionary_;
    std::vector<std::map<FieldKey, std::size_t>> fields_;  ///< by packet
    std::optional<ContainerPlan> plan_;                    ///< none: the caller named the place of a packet's time
    std::size_t omitted_fields_ = 0;
    std::vector<std::string> unsupported_alarms_;
};

}  // namespace aeolis::telemetry
