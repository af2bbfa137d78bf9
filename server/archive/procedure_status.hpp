// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/procedures.pb.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace aeolis::archive {

/// The status of a procedure as the archive keeps it: compressed, since most of it is text that stays.
std::vector<std::uint8_t> packed(const v1::ProcedureStatus& status);
/// None: the octets are damaged.
std::optional<v1::ProcedureStatus> unpacked_status(std::span<const std::uint8_t> octets);

inline constexpr std::size_t status_octets_max = 4U << 20U;  ///< chosen: the longest procedure has some 500 kB of text

}  // namespace aeolis::archive
