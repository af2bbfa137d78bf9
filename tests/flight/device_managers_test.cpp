#include "flight/devices/device_managers.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/outbox.hpp"

using namespace aeolis;
using namespace aeolis::flight;

namespace {
template <typename Module, typename M>
void handle(Module& module, test::OutboxRecorder& recorder, ModuleId id, const M& message) {
    recorder.begin(id, Sclk{1.0});
    module.on(message, recorder.out);
}
}  // namespace

TEST_CASE("a pyro fires at its manager's turn, once, and its reply goes to Edl", "[devices][R5][R10][R14]") {
    PyroManager pyro{Load{}};
    test::OutboxRecorder recorder;
    handle(pyro, recorder, ModuleId::pyro, FirePyro{PyroId::parachute_mortar});
    CHECK(recorder.bus->pyros.empty());
    handle(pyro, recorder, ModuleId::pyro, Tick{Sclk{1.0}});
    REQUIRE(recorder.bus->pyros.size() == 1);
    recorder.bus->begin_cycle();
    handle(pyro, recorder, ModuleId::pyro, Tick{Sclk{1.0}});
    CHECK(recorder.bus->pyros.empty());
    handle(pyro, recorder, ModuleId::pyro, PyroReply{PyroId::parachute_mortar, true});
    REQUIRE(recorder.sent<ActionReply>().size() == 1);
    CHECK(recorder.sent<ActionReply>()[0] ==
          ActionReply{ReplyKind::pyro, static_cast<std::uint8_t>(PyroId::parachute_mortar)});
}

TEST_CASE("a pyro that did not fire is reported and does not answer the timeline", "[devices][R14]") {
    PyroManager pyro{Load{}};
    test::OutboxRecorder recorder;
    handle(pyro, recorder, ModuleId::pyro, PyroReply{PyroId::bridle_cutter, false});
    CHECK(recorder.sent<ActionReply>().empty());
    CHECK(recorder.events<evr::PYRO_NOT_FIRED>() == 1);
}

TEST_CASE("every manager of the rate group confirms a tick, idle or not", "[devices][R22]") {
    test::OutboxRecorder recorder;
    const auto confirms = [&](auto module, ModuleId id) {
        handle(module, recorder, id, Tick{Sclk{1.0}});
        return recorder.sent<Confirm>().size() == 1 && recorder.sent<Confirm>()[0].from == id;
    };
    CHECK(confirms(RadarManager{Load{}}, ModuleId::radar));
    CHECK(confirms(ImuManager{Load{}}, ModuleId::imu));
    CHECK(confirms(PyroManager{Load{}}, ModuleId::pyro));
    CHECK(confirms(DescentEngines{Load{}}, ModuleId::descent_engines));
    CHECK(confirms(Thrusters{Load{}}, ModuleId::thrusters));
}

TEST_CASE("IMU samples reach Edl and EdlComm once, in the cycle in which they came", "[devices][R2]") {
    ImuManager imu{Load{}};
    test::OutboxRecorder recorder;
    ImuReadings readings;
    readings.samples.push_back({.count = 5});
    handle(imu, recorder, ModuleId::imu, readings);
    handle(imu, recorder, ModuleId::imu, Tick{Sclk{1.0}});
    REQUIRE(recorder.out.sent().size() == 3); // the third confirms the tick
    CHECK(recorder.out.sent()[0].to == ModuleId::edl);
    CHECK(recorder.out.sent()[1].to == ModuleId::edl_comm);
    for (const auto& readings_sent : recorder.sent<ImuReadings>()) CHECK(readings_sent.samples.size() == 1);
    handle(imu, recorder, ModuleId::imu, Tick{Sclk{1.0}});
    REQUIRE(recorder.sent<ImuReadings>().size() == 1); // to Edl, which has its turn without any too
    CHECK(recorder.sent<ImuReadings>()[0].samples.empty());
}

TEST_CASE("engines answer the timeline when they start to run, once", "[devices][R14]") {
    DescentEngines engines{Load{}};
    test::OutboxRecorder recorder;
    handle(engines, recorder, ModuleId::descent_engines, EngineReply{false, 0.0});
    CHECK(recorder.sent<ActionReply>().empty());
    handle(engines, recorder, ModuleId::descent_engines, EngineReply{true, 9000.0});
    CHECK(recorder.sent<ActionReply>().size() == 1);
    handle(engines, recorder, ModuleId::descent_engines, EngineReply{true, 9000.0});
    CHECK(recorder.sent<ActionReply>().empty());
    CHECK(recorder.sent<EngineReply>().size() == 1);
}

TEST_CASE("switches go to the bus and their replies to Edl", "[devices][R28]") {
    PowerManager power{Load{}};
    test::OutboxRecorder recorder;
    handle(power, recorder, ModuleId::power, SetSwitch{SwitchId::radar, true});
    REQUIRE(recorder.bus->switches.size() == 1);
    CHECK(recorder.bus->switches[0].on);
    handle(power, recorder, ModuleId::power, SwitchReply{SwitchId::radar, true});
    CHECK(recorder.sent<ActionReply>().size() == 1);
}
