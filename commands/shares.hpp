// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

namespace aeolis::commands {

/// The asker whose share of the places a command takes: the controller, or the browser where there are no accounts.
inline const std::string& asker_of(const std::string& browser, const std::string& controller) {
    return browser.empty() ? controller : browser;
}

/// Whether an asker who holds `mine` of the places may take another. No asker ever holds more places than are free, so
/// that there is room for a newcomer.
constexpr bool may_take(std::size_t mine, std::size_t taken, std::size_t places) {
    return taken < places && mine < places - taken;
}

}  // namespace aeolis::commands
