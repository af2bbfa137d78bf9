// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"

#include <optional>
#include <string>
#include <vector>

namespace aeolis::commands {

/// When a station can send to the vehicle: begin and end of track, by the station's own clock.
struct TrackingPass {
    std::string station;
    Ert begin, end;
};

/// Which station sees the vehicle when. Without passes some station, unnamed, always does.
///
/// Memory   a line a pass; whoever makes them bounds their number
class TrackingSchedule {
  public:
    TrackingSchedule() = default;
    explicit TrackingSchedule(std::vector<TrackingPass> passes);

    bool always() const { return passes_.empty(); }
    bool sees(Ert at) const { return always() || pass_at(at) != nullptr; }
    /// Of those under way the one that lasts longest; null: none, or no table.
    const TrackingPass* pass_at(Ert at) const;
    /// The first to begin after `at`; null: none.
    const TrackingPass* next_after(Ert at) const;
    /// None sees the vehicle then, nor ever after.
    bool over(Ert at) const { return !sees(at) && next_after(at) == nullptr; }
    /// Why nothing can leave at that time, with what a controller can do: "no station sees the vehicle at …: the last
    /// pass, of DSS-43, ended …; the next, of DSS-34, is … to …: give a release time within it".
    std::string refusal(Ert at) const;

  private:
    std::vector<TrackingPass> passes_;  ///< by begin
};

}  // namespace aeolis::commands
