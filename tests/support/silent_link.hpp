// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "telemetry/port.hpp"

#include <string>
#include <utility>

namespace aeolis::tests {

/// A link that is down, its silence and its words taken from the reason that people read.
inline telemetry::LinkState silent_link(telemetry::Link link, Ert ert, const std::string& reason, bool lost = false,
                                        std::optional<Ert> until = {}) {
    telemetry::LinkState state{std::move(link), ert, false, reason, lost, until, {}};
    const auto colon = reason.find(':');
    for (std::size_t i = 0; i < telemetry::silence_classes; ++i) {
        const auto silence = static_cast<telemetry::SilenceClass>(i);
        if (reason.substr(0, colon) != telemetry::title_of(silence)) continue;
        state.silence = silence;
        state.words = colon == std::string::npos ? "" : reason.substr(colon + 2);
    }
    return state;
}

}  // namespace aeolis::tests
