// SPDX-License-Identifier: Apache-2.0
#include "server/api/state_at.hpp"

#include "server/pipeline/pipeline.hpp"
#include "tests/server/small_mission.hpp"
#include "tests/support/catch.hpp"

namespace server_state_at_test {

using namespace aeolis;
using namespace aeolis::test;

namespace {

/// SCET and SCLK meet at (1000 s, 1000 s); light takes 100 s.
archive::RunStart start() {
    archive::RunStart start;
    start.scenario = "nominal";
    start.entry = Sclk{1010.0};
    start.correlation.sclk = Sclk{1000.0};
    start.correlation.scet = Scet{1'000'000'000};
    start.light_time_s = 100.0;
    return start;
}
Ert heard(double sclk_s) {
    return Ert{static_cast<std::int64_t>((sclk_s + 100.0) * 1.0e6)};
}
archive::StageRecord stage(commands::Stage reached, Ert at) {
    archive::StageRecord stage;
    stage.command = 1;
    stage.name = "NO_OP";
    stage.stage = reached;
    stage.status = commands::Status::ok;
    stage.ert = at;
    return stage;
}

}  // namespace

TEST_CASE("the state at an instant is what had happened by then, on board and as Earth sees of it, and nothing later",
          "[http][archive]") {
    const TemporaryFolder folder;
    const auto dictionary = small_dictionary();
    auto archive = archive::Archive::open(folder / "a.db");
    REQUIRE(archive);
    pipeline::Pipeline pipeline{*archive, dictionary};
    REQUIRE(pipeline.begin(start()));
    const auto accept = [&](auto&& what) { REQUIRE(pipeline.accept(std::forward<decltype(what)>(what)).ok()); };
    accept(telemetry::LinkState{telemetry::uhf_live_link, heard(1000.0), true, "nominal"});
    accept(stage(commands::Stage::queued, heard(1000.5)));
    accept(live(navigation_packet(0, 1001.0, 10.0F, 6000.0F)));
    accept(live(fired_packet(0, 1002.0, 2)));
    accept(telemetry::LinkState{telemetry::uhf_live_link, heard(1003.0), false, "plasma blackout"});
    accept(telemetry::LinkState{telemetry::x_band_link, heard(1003.2), false, "ground fault: no signal", true});
    accept(stage(commands::Stage::radiated, heard(1003.5)));
    accept(live(navigation_packet(1, 1004.0, 20.0F, 5000.0F)));
    REQUIRE(pipeline.commit().ok());
    auto reader = archive::Reader::open(folder / "a.db", dictionary);
    REQUIRE(reader);
    const auto at = [&](std::optional<double> sclk_s) {
        auto state = server::state_at(*reader, archive::RunId{1}, dictionary,
                                      sclk_s ? std::optional{Sclk{*sclk_s}} : std::nullopt);
        REQUIRE(state);
        return std::move(*state);
    };
    const auto altitude = [](const v1::StateAt& state) {
        for (const auto& series : state.channels())
            if (series.name() == "altitude_m") return series.value(0);
        return -1.0;
    };

    const auto before = at(999.0);
    CHECK(before.channels().empty());
    CHECK(before.links().empty());
    CHECK(before.commands().empty());

    const auto then = at(1002.0);
    CHECK(altitude(then) == altitude(at(1003.9)));
    CHECK(then.timepoints_size() == 1);
    CHECK(at(1001.9).timepoints().empty());
    REQUIRE(then.links_size() == 1);
    CHECK(then.links(0).link().up());
    REQUIRE(then.commands_size() == 1);
    CHECK(then.commands(0).command_stage().stage() == v1::CommandStage::queued);

    const auto now = at({});
    CHECK(altitude(now) != altitude(then));
    REQUIRE(now.links_size() == 2);
    CHECK_FALSE(now.links(0).link().up());
    CHECK(now.links(0).link().reason() == "plasma blackout");
    REQUIRE(now.alarms_size() == 1);  // a silence that was predicted is none
    CHECK(now.alarms(0).link().link() == "x_band");
    CHECK(at(1003.1).alarms().empty());
    CHECK(now.commands(0).command_stage().stage() == v1::CommandStage::radiated);

    // Beyond what was received stands what was received last, however far.
    for (const double beyond_s : {1004.0, 1004.5, 1010.0, 100'000.0})
        CHECK(at(beyond_s).SerializeAsString() == now.SerializeAsString());
    // Times that no date can have are after everything, or before it.
    for (const double far_s : {1.0e13, 1.0e300}) {
        INFO(far_s);
        CHECK(at(far_s).SerializeAsString() == now.SerializeAsString());
        CHECK(at(-far_s).links().empty());
        CHECK(at(-far_s).commands().empty());
        const auto commands_of = [&](archive::SclkRange range) {
            const auto list = reader->commands(archive::RunId{1}, {range, ""});
            REQUIRE(list);
            return list->commands_size();
        };
        CHECK(commands_of({far_s, {}}) == 0);
        CHECK(commands_of({{}, -far_s}) == 0);
        CHECK(commands_of({-far_s, far_s}) == 1);
    }
}

}  // namespace server_state_at_test
