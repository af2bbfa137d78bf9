// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "server/instruction/inject_plan.hpp"
#include "server/procedures/condition_watch.hpp"
#include "telemetry/decommutator.hpp"

#include <cstddef>
#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace aeolis::server::instruction {

/// Follows a landing by what it records on board, and says which injects of a plan are due.
///
/// In       what was recorded in each cycle, with Earth's clock at its end; ids of injects that were settled otherwise
/// Out      each inject once: when its conditions all hold and its delay has passed. By these alone: a landing that is
///          flown again has the same injects at the same cycles
/// Time     the vehicle's own: a value counts from when it is recorded, not from when Earth receives it
/// Memory   by the plan
class PlanConductor {
  public:
    /// The dictionary must outlive this.
    PlanConductor(InjectPlan plan, const dictionary::Dictionary& dictionary,
                  const procedures::EntryPrediction& prediction);

    /// The injects that are due at the end of this cycle, in the plan's order. They wait no more.
    std::vector<const Inject*> pass(std::span<const std::uint8_t> recorded, Ert now);

    /// The inject of this id, if it waits. The Error says what else became of it.
    Result<const Inject*> waiting(const std::string& id) const;
    /// It waits no more: it was injected by hand, or skipped, or both were repeated from the archive.
    void settle(const std::string& id);

    const InjectPlan& plan() const { return plan_; }

  private:
    struct Followed {
        std::vector<std::size_t> conditions;  ///< in watch_
        std::optional<Ert> held_since;        ///< they all held first
        bool settled = false;
    };
    void read(std::span<const std::uint8_t> recorded, Ert now);
    void follow_packets_of(const procedures::Condition& condition);

    InjectPlan plan_;
    const dictionary::Dictionary* dictionary_;
    procedures::ConditionWatch watch_;
    std::vector<Followed> followed_;  ///< by inject
    std::set<Apid> apids_;            ///< of the packets that a condition needs
    telemetry::Decommutator decommutator_;
    dictionary::Decoded decoded_;
};

}  // namespace aeolis::server::instruction
