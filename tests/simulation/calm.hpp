// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/landing.hpp"

#include <cmath>
#include <cstddef>
#include <deque>

namespace aeolis::tests {

struct Silence {
    double e_s, length_s;
};

/// Whether navigation can know what turns the vehicle, tick by tick of one landing: not in a turn (a reversal, the
/// swing under the parachute), not while the parachute opens, not on engines.
class Calm {
  public:
    explicit Calm(simulation::Landing landing) {
        begin_s_ = landing.truth().e_s;
        double mortar_s = 1.0e9;
        bool on_engines = false;
        while (landing.outcome() == simulation::Outcome::running) {
            for (const simulation::TruthEvent& event : landing.step().events) {
                if (event.name == "parachute_deploy") mortar_s = event.e_s;
                on_engines |= event.name == "backshell_separation";
            }
            const auto& rate = landing.inspect().rate_B_rps;
            const bool turns = std::hypot(rate[0], rate[1], rate[2]) > turning_rps;
            const double since_mortar_s = landing.truth().e_s - mortar_s;
            calm_.push_back(!turns && !on_engines && !(since_mortar_s >= 0.0 && since_mortar_s < opens_within_s));
        }
    }
    bool during(const Silence& silence) const {
        const auto first = static_cast<std::size_t>((silence.e_s - begin_s_) * 64.0);
        const auto ticks = static_cast<std::size_t>(silence.length_s * 64.0) + 2;
        for (std::size_t i = first; i < first + ticks; ++i)
            if (i >= calm_.size() || !calm_[i]) return false;
        return true;
    }
    double end_s() const { return begin_s_ + static_cast<double>(calm_.size()) / 64.0; }

  private:
    static constexpr double turning_rps = 0.05, opens_within_s = 5.0;
    double begin_s_ = 0.0;
    std::deque<bool> calm_;
};

}  // namespace aeolis::tests
