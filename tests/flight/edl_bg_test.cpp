// SPDX-License-Identifier: Apache-2.0
#include "flight/edl_bg/edl_bg.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/outbox.hpp"

namespace flight_edl_bg_test {

using namespace aeolis;
using namespace aeolis::flight;

namespace {

struct Fixture {
    EdlBg bg{Load{}};
    test::OutboxRecorder recorder{ModuleId::edl_bg};
    template <typename M>
    void handle(const M& message, double at_s) {
        recorder.begin(ModuleId::edl_bg, Sclk{at_s});
        bg.on(message, recorder.out);
    }
};

command::EDL_SET_PARAMETERS possible_parameters() {
    command::EDL_SET_PARAMETERS p;
    p.epoch_sclk = 900.0;
    p.entry_sclk = 2000.0;
    p.position_x_m = 9.0e6;
    p.velocity_x_mps = -5000.0;
    return p;
}

}  // namespace

TEST_CASE("parameters go on to Edl when they are possible together", "[edl_bg][R25]") {
    Fixture f;
    f.handle(SetParametersCommand{{}, possible_parameters()}, 1000.0);
    CHECK(f.recorder.sent<ParametersUpdate>().size() == 1);
}

TEST_CASE("parameters that cannot be true are refused: under the ground, entry in the past", "[edl_bg][R23]") {
    Fixture f;
    auto underground = possible_parameters();
    underground.position_x_m = 1.0e6;
    f.handle(SetParametersCommand{{}, underground}, 1000.0);
    CHECK(f.recorder.sent<ParametersUpdate>().empty());
    CHECK(f.recorder.sent<CommandOutcome>()[0].refused == CommandRefusal::bad_argument);
    f.handle(SetParametersCommand{{}, possible_parameters()}, 2000.0);
    CHECK(f.recorder.sent<CommandOutcome>()[0].refused == CommandRefusal::bad_argument);
}

TEST_CASE("commands of the table of parameters go on to Edl in their order, and a change beyond its range does not",
          "[edl_bg][parameters][R25]") {
    Fixture f;
    const auto stage = [&](ParameterId id, double value) {
        f.handle(StageParameterCommand{{}, {.parameter = id.value, .value = value}}, 1000.0);
        return !f.recorder.sent<StageParameterCommand>().empty();
    };
    CHECK(stage(parameter::guidance_gain, 4.0));
    CHECK(f.recorder.sent<CommandOutcome>().empty());  // Edl answers
    CHECK_FALSE(stage(parameter::guidance_gain, 11.0));
    CHECK(f.recorder.sent<CommandOutcome>()[0].refused == CommandRefusal::bad_argument);
    CHECK_FALSE(stage(parameter::radar_average_s, 5.0));
    CHECK(f.recorder.sent<CommandOutcome>()[0].refused == CommandRefusal::fixed_at_build);
    f.handle(ActivateParametersCommand{{}, {.parameter_version = 3, .parameter_changes = 1}}, 1000.0);
    CHECK(f.recorder.sent<ActivateParametersCommand>().size() == 1);
    f.handle(DiscardParametersCommand{}, 1000.0);
    CHECK(f.recorder.sent<DiscardParametersCommand>().size() == 1);
    f.handle(DumpParametersCommand{}, 1000.0);
    CHECK(f.recorder.sent<DumpParametersCommand>().size() == 1);
}

TEST_CASE("a solution whose epoch is more than a day away is refused: GNC would fly there in one cycle",
          "[edl_bg][R23]") {
    Fixture f;
    constexpr double solution_age_max_s = build_parameters.solution_age_max_s;
    auto old = possible_parameters();
    old.entry_sclk = old.epoch_sclk + 2.0 * solution_age_max_s;
    f.handle(SetParametersCommand{{}, old}, old.epoch_sclk + solution_age_max_s);
    CHECK(f.recorder.sent<ParametersUpdate>().size() == 1);
    f.handle(SetParametersCommand{{}, old}, old.epoch_sclk + solution_age_max_s + 1.0 / 64);
    CHECK(f.recorder.sent<ParametersUpdate>().empty());
    CHECK(f.recorder.sent<CommandOutcome>()[0].refused == CommandRefusal::bad_argument);
    old.epoch_sclk = old.entry_sclk = 4.0e9;
    f.handle(SetParametersCommand{{}, old}, 1000.0);
    CHECK(f.recorder.sent<CommandOutcome>()[0].refused == CommandRefusal::bad_argument);
}

TEST_CASE("radar solutions go to the filter once a second, and not before the radar gave beams", "[edl_bg][R25]") {
    Fixture f;
    int solutions = 0;
    // Straight down at 80 m/s, six beams in a cone of 20 degrees from 5 km: 0.9397 is cos 20°.
    for (int tick = 0; tick < 64 * 10; ++tick) {
        const double now_s = 1000.0 + tick / 64.0;
        f.handle(ClockTick{Sclk{now_s}}, now_s);
        solutions += static_cast<int>(f.recorder.sent<gnc::RadarSolution>().size());
        if (tick < 64) CHECK(solutions == 0);
        RadarReturns returns{Sclk{now_s}, {}};
        const double along = 0.9396926207859084, across = 0.3420201433256687;
        returns.beams.push_back({0, {across, 0, along}, true, 5000.0 / along, -80.0 * along});
        returns.beams.push_back({1, {-across, 0, along}, true, 5000.0 / along, -80.0 * along});
        returns.beams.push_back({2, {0, across, along}, true, 5000.0 / along, -80.0 * along});
        f.handle(returns, now_s);
        // B's z points down: a half turn about x brings it to M's z, which is up here.
        f.handle(NavigatedAttitude{{0, 1, 0, 0}, {0, 0, 1}, false}, now_s);
    }
    CHECK(solutions >= 8);
    CHECK(solutions <= 10);
}

TEST_CASE("a radar that brings nothing while Edl wants it is reported once, and not when nobody wants it",
          "[edl_bg][R25]") {
    Fixture f;
    const auto losses = [&](double from_s, int seconds, bool wanted) {
        int reports = 0;
        for (int tick = 0; tick < 64 * seconds; ++tick) {
            const double now_s = from_s + tick / 64.0;
            f.handle(ClockTick{Sclk{now_s}}, now_s);
            reports += f.recorder.events<evr::RADAR_LOST>();
            if (wanted) f.handle(NavigatedAttitude{{0, 1, 0, 0}, {0, 0, 1}, true}, now_s);
        }
        return reports;
    };
    CHECK(losses(1000.0, 55, true) == 0);  // the first may take its time
    CHECK(losses(1055.0, 30, true) == 1);
    // By another table it may take less.
    f = {};
    Parameters sooner;
    sooner.radar_patience_s = parameter_specs[parameter::radar_patience_s.value].min;
    parameter_parts(sooner, [&](const ParameterPart& part) { f.handle(part, 1000.0); });
    CHECK(losses(1000.0, static_cast<int>(sooner.radar_patience_s) - 1, true) == 0);
    CHECK(losses(1000.0 + sooner.radar_patience_s - 1.0, 3, true) == 1);
    Fixture quiet;
    std::swap(f, quiet);
    CHECK(losses(1000.0, 3, true) == 0);
    CHECK(losses(1003.0, 30, false) == 0);
}

}  // namespace flight_edl_bg_test
