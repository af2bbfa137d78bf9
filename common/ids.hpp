// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>

namespace aeolis {

/// Number that identifies one kind of thing.
/// Two kinds do not mix, and none converts to a plain number implicitly.
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
using ParameterId = Id<struct ParameterTag, std::uint16_t>;  ///< row of the parameters, from 0

/// The vehicle's spacecraft id (10 bits), and its only telecommand virtual channel (6 bits).
/// The number is chosen and has no further meaning.
inline constexpr std::uint16_t spacecraft_id = 76;
inline constexpr std::uint8_t telecommand_channel = 0;
/// CFDP entity id of the ground, chosen. The vehicle's entity id is `spacecraft_id`.
inline constexpr std::uint16_t ground_entity = 1;

}  // namespace aeolis

template <typename Tag, typename Rep>
struct std::hash<aeolis::Id<Tag, Rep>> {
    std::size_t operator()(const aeolis::Id<Tag, Rep>& id) const noexcept { return std::hash<Rep>{}(id.value); }
};
