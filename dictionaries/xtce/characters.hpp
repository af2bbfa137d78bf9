// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/xtce/packet_model.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace aeolis::dictionary::xtce {

/// Converts a text in a packet to UTF-8, without the zeros that pad its end. None when the octets are not text in this
/// encoding. UTF-16 may begin with a byte order mark. [xtce-1.2]
std::optional<std::string> text_of(std::span<const std::uint8_t> octets, Coding::Characters characters);

}  // namespace aeolis::dictionary::xtce
