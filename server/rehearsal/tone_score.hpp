// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/landing.hpp"
#include "telemetry/port.hpp"

#include <cstdint>
#include <vector>

namespace aeolis::server {

/// Compares received tones with those sent.
///
/// In       symbols once they have ended; decisions in order        Memory   symbols without a decision
class ToneScore {
  public:
    struct Figures {
        std::uint64_t sent = 0, decoded = 0, wrong = 0, missed = 0;
    };

    void sent(const simulation::SentSymbol& symbol);
    void heard(const telemetry::ReceivedTone& tone);
    /// The score so far. A symbol without a decision counts as missed.
    Figures figures() const;

  private:
    std::vector<simulation::SentSymbol> undecided_;
    std::uint64_t sent_ = 0, decoded_ = 0, wrong_ = 0;
    std::uint64_t mistaken_ = 0;  ///< those of wrong_ for which another tone was sent
};

}  // namespace aeolis::server
