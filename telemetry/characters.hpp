// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/xtce/packet_model.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace aeolis::telemetry {

/// Text of a packet in UTF-8, without the zeros that fill it up at its end; none when the octets are no text in these
/// characters. UTF-16 may begin with a mark of its octets' order. [xtce-1.2]
std::optional<std::string> text_of(std::span<const std::uint8_t> octets,
                                   dictionary::xtce::Coding::Characters characters);

}  // namespace aeolis::telemetry
