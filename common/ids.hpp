// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>

namespace aeolis {

/// A number that names one kind of thing. Two kinds do not mix; none converts to a plain number by itself.
template <typename Tag, typename Rep>
struct Id {
    Rep value{};
    constexpr auto operator<=>(const Id&) const = default;
};

using ChannelId = Id<struct ChannelTag, std::uint16_t>;      ///< index of a channel in the dictionary
using EvrId = Id<struct EvrTag, std::uint16_t>;              ///< event report id
using Opcode = Id<struct OpcodeTag, std::uint16_t>;          ///< command opcode
using Apid = Id<struct ApidTag, std::uint16_t>;              ///< CCSDS application process id, 11 bits
using ToneId = Id<struct ToneTag, std::uint8_t>;             ///< one of the 256 MFSK tones
using TimepointId = Id<struct TimepointTag, std::uint16_t>;  ///< row of the timeline, from 0
using AnchorId = Id<struct AnchorTag, std::uint16_t>;        ///< row of the anchors in topological order, 0 the root

/// How links name the vehicle, and its one channel of telecommand frames: 10 bits and 6. The number is ours, a name and
/// no more.
inline constexpr std::uint16_t spacecraft_id = 76;
inline constexpr std::uint8_t telecommand_channel = 0;
/// The end of file deliveries on the ground; the vehicle's end has the spacecraft's number. Chosen.
inline constexpr std::uint16_t ground_entity = 1;

}  // namespace aeolis

template <typename Tag, typename Rep>
struct std::hash<aeolis::Id<Tag, Rep>> {
    std::size_t operator()(const aeolis::Id<Tag, Rep>& id) const noexcept { return std::hash<Rep>{}(id.value); }
};
