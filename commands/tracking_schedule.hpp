// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"

#include <optional>
#include <string>
#include <vector>

namespace aeolis::commands {

/// A time in which a station can send to the vehicle: begin and end of track, by the station's clock.
struct TrackingPass {
    std::string station;
    Ert begin, end;
};

/// The times at which stations see the vehicle. Without passes an unnamed station always does.
///
/// Memory   one entry a pass; the owner bounds their number
class TrackingSchedule {
  public:
    TrackingSchedule() = default;
    explicit TrackingSchedule(std::vector<TrackingPass> passes);

    bool always() const { return passes_.empty(); }
    bool sees(Ert at) const { return always() || pass_at(at) != nullptr; }
    /// The pass at that time; of several, the one that ends last. Null: there is none, or no table.
    const TrackingPass* pass_at(Ert at) const;
    /// The first pass to begin after `at`; null: none.
    const TrackingPass* next_after(Ert at) const;
    /// Whether no station sees the vehicle at that time or later.
    bool over(Ert at) const { return !sees(at) && next_after(at) == nullptr; }
    /// States why nothing can leave at that time, and what a controller can do.
    ///
    /// "no station sees the vehicle at …: the last pass, of DSS-43, ended …; the next, of DSS-34, is … to …: give a
    /// release time within it".
    std::string refusal(Ert at) const;

  private:
    std::vector<TrackingPass> passes_;  ///< by begin
};

}  // namespace aeolis::commands
