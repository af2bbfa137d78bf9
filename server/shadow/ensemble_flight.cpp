// SPDX-License-Identifier: Apache-2.0
#include "server/shadow/ensemble_flight.hpp"

#include "server/campaign/campaign_order.hpp"
#include "server/campaign/case_flights.hpp"
#include "server/shadow/expectations.hpp"

#include <exception>
#include <memory>
#include <utility>

namespace aeolis::server::shadow {

EnsembleFlight::EnsembleFlight(ScriptedLanding landing, const simulation::StateKnowledge& knowledge,
                               simulation::Scenario scenario, const dictionary::Dictionary& dictionary,
                               const ForecastOrder& order, std::uint32_t number)
    : number_(number) {
    auto from = std::make_shared<const ScriptedLanding>(std::move(landing));
    thread_ =
        std::thread{[this, from = std::move(from), knowledge, scenario = std::move(scenario), &dictionary, order] {
            if (order.idle) campaign::use_idle_priority();
            try {
                const auto courses = courses_by_ground(*from, knowledge, scenario, dictionary, order, stop_);
                if (courses)
                    flown_ = ensemble_of(*courses, number_, from->landing().sclk(), scenario.entry_sclk);
                else
                    flown_ = courses.error();
            } catch (const std::exception& error) {
                flown_ = Error{error.what()};
            }
            ready_ = true;
        }};
}

EnsembleFlight::~EnsembleFlight() {
    stop_ = true;
    thread_.join();
}

Result<v1::PlanEnsemble> EnsembleFlight::take() {
    return std::move(*flown_);
}

}  // namespace aeolis::server::shadow
