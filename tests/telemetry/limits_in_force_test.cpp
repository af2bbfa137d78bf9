// SPDX-License-Identifier: Apache-2.0
#include "telemetry/limits_in_force.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"
#include "tests/support/small_dictionary.hpp"

#include <cmath>

namespace telemetry_limits_in_force_test {

using namespace aeolis;
using namespace aeolis::telemetry;

namespace {

/// The speed has limits of its own in phase 1, and others while the altitude is below 100 m.
struct Mission {
    dictionary::Dictionary dictionary = tests::small_dictionary();
    ChannelId speed = dictionary.channel("speed_mps")->id, phase = dictionary.channel("edl_phase")->id,
              altitude = dictionary.channel("altitude_m")->id;
    Mission() {
        dictionary::ContextAlarms parachute, low;
        parachute.context = {{phase, "==", 1.0, ""}};
        low.context = {{altitude, "<", 100.0, ""}};
        dictionary.channels[speed.value].type.alarms.contexts = {parachute, low};
    }
    /// The context's place in the dictionary from each stretch's beginning on; -1: none.
    std::vector<std::pair<double, int>> told(const LimitsInForce& limits) const {
        std::vector<std::pair<double, int>> told;
        const auto& contexts = dictionary.channels[speed.value].type.alarms.contexts;
        for (const auto& [from, context] : limits.channels().at(0).stretches)
            told.emplace_back(from ? from->seconds : -1.0, context ? static_cast<int>(context - contexts.data()) : -1);
        return told;
    }
};
using Stretches = std::vector<std::pair<double, int>>;

}  // namespace

TEST_CASE("limits of a context hold from the sample that makes it hold to the one that ends it", "[alarms]") {
    const Mission mission;
    LimitsInForce limits{mission.dictionary};
    CHECK(mission.told(limits) == Stretches{{-1.0, -1}});
    limits.sample(mission.phase, 0.0, Sclk{10.0});
    limits.sample(mission.phase, 1.0, Sclk{20.0});
    limits.sample(mission.phase, 1.0, Sclk{30.0});
    limits.sample(mission.phase, std::nan(""), Sclk{35.0});  // undefined on board: it decides nothing
    limits.sample(mission.phase, 2.0, Sclk{40.0});
    CHECK(mission.told(limits) == Stretches{{-1.0, -1}, {20.0, 0}, {40.0, -1}});
}

TEST_CASE("of two contexts that hold, the limits are those of the first, whichever began first", "[alarms]") {
    const Mission mission;
    LimitsInForce limits{mission.dictionary};
    limits.sample(mission.altitude, 50.0, Sclk{10.0});
    limits.sample(mission.phase, 1.0, Sclk{20.0});
    limits.sample(mission.phase, 2.0, Sclk{30.0});
    CHECK(mission.told(limits) == Stretches{{-1.0, -1}, {10.0, 1}, {20.0, 0}, {30.0, 1}});
}

TEST_CASE("values of one instant decide together, and a change that changes no limit begins no stretch", "[alarms]") {
    const Mission mission;
    LimitsInForce limits{mission.dictionary};
    limits.sample(mission.altitude, 50.0, Sclk{10.0});
    limits.sample(mission.phase, 1.0, Sclk{10.0});
    CHECK(mission.told(limits) == Stretches{{-1.0, -1}, {10.0, 0}});
    limits.sample(mission.altitude, 200.0, Sclk{20.0});
    limits.sample(mission.phase, 2.0, Sclk{30.0});
    limits.sample(mission.phase, 1.0, Sclk{30.0});
    CHECK(mission.told(limits) == Stretches{{-1.0, -1}, {10.0, 0}});
}

TEST_CASE("only channels whose limits have contexts are told of, with the channels that decide", "[alarms]") {
    const Mission mission;
    const LimitsInForce limits{mission.dictionary};
    REQUIRE(limits.channels().size() == 1);
    CHECK(limits.channels()[0].channel == mission.speed);
    CHECK(limits.decided_by().size() == 2);
    const LimitsInForce shipped{tests::shipped_dictionary()};
    CHECK(shipped.channels().size() == 3);
    CHECK(shipped.decided_by() == std::vector{tests::shipped_dictionary().channel("edl_phase")->id});
}

}  // namespace telemetry_limits_in_force_test
