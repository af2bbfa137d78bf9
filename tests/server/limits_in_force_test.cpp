// SPDX-License-Identifier: Apache-2.0
#include "server/api/limits_in_force.hpp"

#include "server/pipeline/pipeline.hpp"
#include "tests/server/small_mission.hpp"
#include "tests/support/catch.hpp"

namespace server_limits_in_force_test {

using namespace aeolis;
using namespace aeolis::test;

TEST_CASE("the limits that held are those of the phase by every sample received, or by the live ones alone",
          "[http][alarms]") {
    const TemporaryFolder folder;
    auto dictionary = small_dictionary();
    dictionary::ContextAlarms slow;
    slow.context = {{phase, "==", 2.0, ""}};
    slow.alarms.ranges = {{dictionary::Severity::watch, {}, 90.0}, {dictionary::Severity::distress, {}, 120.0}};
    dictionary.channels[speed.value].type.alarms.contexts = {slow};
    auto archive = archive::Archive::open(folder / "a.db");
    REQUIRE(archive);
    pipeline::Pipeline pipeline{*archive, dictionary};
    REQUIRE(pipeline.begin({}));
    const auto accept = [&](auto&& what) { REQUIRE(pipeline.accept(std::forward<decltype(what)>(what)).ok()); };
    accept(live(status_packet(0, 10.0, 1)));
    accept(live(status_packet(2, 30.0, 3)));
    accept(recorded(status_packet(0, 10.0, 1)));
    accept(recorded(status_packet(1, 20.0, 2)));  // it was not heard live
    REQUIRE(pipeline.commit().ok());
    auto reader = archive::Reader::open(folder / "a.db", dictionary);
    REQUIRE(reader);
    const auto limits = [&](bool with_recording) {
        auto answer = server::limits_in_force(*reader, archive::RunId{1}, dictionary, with_recording);
        REQUIRE(answer);
        REQUIRE(answer->channels_size() == 1);
        CHECK(answer->channels(0).name() == "speed_mps");
        REQUIRE(answer->decided_by_size() == 1);
        CHECK(answer->decided_by(0) == phase.value);
        return answer->channels(0);
    };

    const auto live_alone = limits(false);
    REQUIRE(live_alone.stretches_size() == 1);
    CHECK_FALSE(live_alone.stretches(0).has_from_sclk());
    CHECK_FALSE(live_alone.stretches(0).has_to_sclk());
    CHECK(live_alone.stretches(0).context().empty());
    REQUIRE(live_alone.stretches(0).limits_size() == 1);
    CHECK(live_alone.stretches(0).limits(0).above() == 6000.0);

    const auto all = limits(true);
    REQUIRE(all.stretches_size() == 3);
    CHECK(all.stretches(0).to_sclk() == 20.0);
    CHECK(all.stretches(1).from_sclk() == 20.0);
    CHECK(all.stretches(1).to_sclk() == 30.0);
    CHECK(all.stretches(1).context() == "2");
    REQUIRE(all.stretches(1).limits_size() == 2);
    CHECK(all.stretches(1).limits(1).severity() == "distress");
    CHECK(all.stretches(2).from_sclk() == 30.0);
    CHECK_FALSE(all.stretches(2).has_to_sclk());
}

}  // namespace server_limits_in_force_test
