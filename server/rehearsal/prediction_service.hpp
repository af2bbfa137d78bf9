// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/rehearsal/nominal_flight.hpp"

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

namespace aeolis::server {

/// The nominal flights of scenarios: each is flown once, when it is first asked for, and shared by all runs whose
/// scenarios are expected to go alike.
///
/// Threads  prediction() from any, without waiting; a thread of its own flies, one flight after another
/// Memory   the flights of `kept_max` scenarios, some megabytes each; of those flown, the one asked for longest ago
///          goes first. While that many wait, a further question waits too: it is asked again
class PredictionService {
  public:
    static constexpr std::size_t kept_max = 4;  ///< chosen: a live run, the run compared with it, and two more

    /// The dictionary must outlive this.
    explicit PredictionService(const dictionary::Dictionary& dictionary);
    ~PredictionService();  ///< stops a flight within a second of flight

    struct Answer {
        std::shared_ptr<const NominalFlight> flight;  ///< null: none, or not flown yet
        std::string none;                             ///< why nothing is predicted; empty with a null flight: ask again
    };
    /// The nominal flight of this scenario; if there is none yet, it is flown from now on.
    Answer prediction(const simulation::Scenario& scenario);

    std::uint64_t flown() const;  ///< flights so far

  private:
    struct Kept {
        std::string key;  ///< the expected scenario, as text
        simulation::Scenario expected;
        bool known = false;
        Answer answer;
    };
    void fly();

    const dictionary::Dictionary& dictionary_;
    mutable std::mutex mutex_;  ///< guards the members below
    std::condition_variable changed_;
    std::list<std::shared_ptr<Kept>> kept_;  ///< the one asked for last is the first
    std::uint64_t flown_ = 0;
    bool over_ = false;
    std::thread thread_;  ///< begun with the first question
};

}  // namespace aeolis::server
