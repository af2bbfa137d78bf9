// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

namespace aeolis::commands {

/// For whom a command counts: a browser where there are no accounts, else who asks.
inline const std::string& asker_of(const std::string& browser, const std::string& controller) {
    return browser.empty() ? controller : browser;
}

/// Whether one who holds `mine` of the places may take another. Nobody ever holds more places than are free, so that
/// there is room for whoever comes.
constexpr bool may_take(std::size_t mine, std::size_t taken, std::size_t places) {
    return taken < places && mine < places - taken;
}

}  // namespace aeolis::commands
