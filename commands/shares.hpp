// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace aeolis::commands {

/// Whether one who holds `mine` of the places may take another. Nobody ever holds more places than are free, so that
/// there is room for whoever comes.
constexpr bool may_take(std::size_t mine, std::size_t taken, std::size_t places) {
    return taken < places && mine < places - taken;
}

}  // namespace aeolis::commands
