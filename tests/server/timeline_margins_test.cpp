// SPDX-License-Identifier: Apache-2.0
#include "server/rehearsal/timeline_margins.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <algorithm>

namespace server_timeline_margins_test {

using namespace aeolis;
using namespace aeolis::server;

namespace {

/// The firing of a row of the shipped timeline, by its name.
RecordedFiring fired(const std::string& name, double at_s) {
    const auto& timeline = tests::shipped_dictionary().timeline;
    const auto row = std::ranges::find(timeline, name, &dictionary::TimelineRow::name);
    RecordedFiring firing;
    firing.row = static_cast<std::size_t>(row - timeline.begin());
    firing.name = name;
    firing.triggered_sclk = firing.fired_sclk = at_s;
    return firing;
}

}  // namespace

TEST_CASE("a row that only the landing starts has the time by which it came after what it must wait for",
          "[timeline][R19]") {
    const auto margins = timeline_margins({fired("radar_power", 100.0), fired("heatshield_separation", 107.5)},
                                          tests::shipped_dictionary(), 0.0);
    REQUIRE(margins.size() == 1);
    CHECK(margins[0].timepoint == "heatshield_separation");
    CHECK(margins[0].margin_s == 7.5);
}

TEST_CASE("rows of the clock have no margin to keep: the plan has their distance, and its analysis proves it",
          "[timeline][R19]") {
    CHECK(timeline_margins(
              {fired("pressurant_valve_2", 0.0), fired("cruise_stage_separation", 2.0), fired("gnc_enable", 60.0)},
              tests::shipped_dictionary(), -1.0)
              .empty());
}

}  // namespace server_timeline_margins_test
