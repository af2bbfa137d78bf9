// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "common/space_packet.hpp"
#include "dictionaries/dictionary.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace aeolis::commands {

inline constexpr Apid telecommand_apid{0x001};  ///< chosen: one APID for all telecommands; the opcode tells them apart
inline constexpr std::uint16_t count_modulus = 1U << 14;

struct NamedValue {
    std::string name;
    double value = 0.0;  ///< an enumeration's number, a boolean's 0 or 1
    bool operator==(const NamedValue&) const = default;
};

/// Encodes a command with these arguments as a telecommand packet; defaults stand for those not given.
///
/// Fails with one sentence that names the argument, its value, its bounds and unit when an argument is unknown, given
/// twice, missing without a default, not finite, outside its range (also after rounding to the encoding), not a whole
/// number where one is needed, not a value of the enumeration, or too large for its bits.
/// `count`: packet count of the uplink, below count_modulus; flight's answers quote it.
Result<std::vector<std::uint8_t>> encode(const dictionary::Command& command, std::span<const NamedValue> arguments,
                                         std::uint16_t count);

/// Decodes a packet's arguments from its bits: for the preview, the history and tests. Fails when the packet is not
/// this command.
Result<std::vector<NamedValue>> decode(const dictionary::Command& command, std::span<const std::uint8_t> packet);

/// The given arguments, followed by those that only `solution` (ground's navigation solution, by argument name) has.
/// The rest keep their defaults.
std::vector<NamedValue> fill_from_solution(const dictionary::Command& command, std::span<const NamedValue> given,
                                           std::span<const NamedValue> solution);

/// "solution_id=1 epoch_sclk=397500000 …": exact, the shortest digits that give the same double.
std::string arguments_text(std::span<const NamedValue> arguments);

}  // namespace aeolis::commands
