// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/timeline_rule.hpp"
#include "flight/devices/device_messages.hpp"
#include "flight/gnc/edl_gnc.hpp"

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

namespace aeolis::simulation {

/// A short replacement of the timeline: the actions that a landing needs, at the times of timeline.csv.
///
/// It waits for no reply, and reports nothing.
/// In       GNC's triggers, which start anchors          Out   GNC's configuration, commands to devices
/// Rate     64 Hz: act() before GNC and after it         Memory   none beyond itself; a value
class VenueTimeline {
  public:
    explicit VenueTimeline(Sclk entry);

    void act(Sclk now, flight::DeviceOutputs& out);
    void take(const flight::gnc::Output& told, Sclk now);

    struct Line {
        std::string_view timepoint;                 ///< the row of timeline.csv that it replaces
        std::optional<flight::gnc::Trigger> after;  ///< none: entry
        double offset_s = 0.0;
    };
    static std::vector<Line> lines();

    const flight::gnc::Configuration& configuration() const { return configuration_; }

  private:
    static constexpr std::size_t rows_max = 32;

    flight::gnc::Configuration configuration_;
    MaybeTime entry_;
    std::array<MaybeTime, flight::gnc::trigger_count> triggered_{};
    std::array<bool, rows_max> done_{};
};

}  // namespace aeolis::simulation
