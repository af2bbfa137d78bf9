// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/kept.pb.h"
#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"
#include "server/rehearsal/scripted_landing.hpp"
#include "server/shadow/forecast.hpp"
#include "simulation/placed_state.hpp"
#include "simulation/scenario.hpp"

#include <atomic>
#include <cstdint>
#include <optional>
#include <thread>

namespace aeolis::server::shadow {

/// Dispersed flights of ground's plan, from a copy of the flight that ground keeps, on threads that run only while
/// nothing else wants the processor.
///
/// In       made with all that it needs      Out   the ensemble, once
/// Thread   one of its own and those of its cases; taken from any
class EnsembleFlight {
  public:
    /// The dictionary must outlive this. @param number  of the ensemble in its run
    EnsembleFlight(ScriptedLanding landing, const simulation::StateKnowledge& knowledge, simulation::Scenario scenario,
                   const dictionary::Dictionary& dictionary, const ForecastOrder& order, std::uint32_t number);
    EnsembleFlight(const EnsembleFlight&) = delete;
    EnsembleFlight& operator=(const EnsembleFlight&) = delete;
    ~EnsembleFlight();  ///< stops it within a second of flight

    std::uint32_t number() const { return number_; }
    bool ready() const { return ready_; }
    /// Once it is ready. The Error says why there is none.
    Result<v1::PlanEnsemble> take();

  private:
    std::uint32_t number_;
    std::atomic<bool> stop_{false}, ready_{false};
    std::optional<Result<v1::PlanEnsemble>> flown_;  ///< of the thread until ready_
    std::thread thread_;
};

}  // namespace aeolis::server::shadow
