// SPDX-License-Identifier: Apache-2.0
#include "flight/devices/pyro.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/device_module.hpp"

namespace flight_pyro_test {

using namespace aeolis;
using namespace aeolis::flight;

namespace {
constexpr auto mortar = static_cast<std::uint8_t>(PyroId::parachute_mortar);
}

TEST_CASE("a pyro fires at its manager's turn, once, and its reply goes to Edl", "[devices][R5][R10][R14]") {
    test::Spoken<PyroManager> pyro{ModuleId::pyro};
    pyro.on(FirePyro{PyroId::parachute_mortar});
    CHECK(pyro.recorder.bus->pyros.empty());
    pyro.on(Tick{Sclk{1.0}});
    REQUIRE(pyro.recorder.bus->pyros.size() == 1);
    pyro.recorder.bus->begin_cycle();
    pyro.on(Tick{Sclk{1.0}});
    CHECK(pyro.recorder.bus->pyros.empty());
    const auto replies = pyro.on(PyroReply{PyroId::parachute_mortar, true}).sent<ActionReply>();
    REQUIRE(replies.size() == 1);
    CHECK(replies[0] == ActionReply{ReplyKind::pyro, mortar});
}

TEST_CASE("a pyro that did not fire is reported and does not answer the timeline", "[devices][R14]") {
    test::Spoken<PyroManager> pyro{ModuleId::pyro};
    pyro.on(FirePyro{PyroId::bridle_cutter});
    pyro.on(PyroReply{PyroId::bridle_cutter, false});
    CHECK(pyro.recorder.sent<ActionReply>().empty());
    CHECK(pyro.recorder.events<evr::PYRO_NOT_FIRED>() == 1);
}

TEST_CASE("a pyro reply that is not due, comes twice or from the other unit is reported and goes no further",
          "[devices][R2][R4]") {
    test::Spoken<PyroManager> pyro{ModuleId::pyro};
    const auto unexpected = [&](const PyroReply& reply) {
        pyro.on(reply);
        return pyro.recorder.events<evr::REPLY_UNEXPECTED>() == 1 && pyro.recorder.sent<ActionReply>().empty();
    };
    CHECK(unexpected({PyroId::parachute_mortar, true}));
    pyro.on(FirePyro{PyroId::parachute_mortar});
    CHECK(unexpected({PyroId::parachute_mortar, true, Unit::b}));
    CHECK(pyro.on(PyroReply{PyroId::parachute_mortar, true}).sent<ActionReply>().size() == 1);
    CHECK(unexpected({PyroId::parachute_mortar, true}));
    CHECK(unexpected({static_cast<PyroId>(200), true}));
}

TEST_CASE("more pyros at once than the bus takes are reported one by one", "[devices][R4]") {
    test::Spoken<PyroManager> pyro{ModuleId::pyro};
    for (int i = 0; i < 8; ++i) CHECK(pyro.on(FirePyro{PyroId::coolant_vent}).events<evr::PYRO_QUEUE_FULL>() == 0);
    CHECK(pyro.on(FirePyro{PyroId::coolant_vent}).events<evr::PYRO_QUEUE_FULL>() == 1);
    CHECK(pyro.on(FirePyro{static_cast<PyroId>(77)}).events<evr::PYRO_QUEUE_FULL>() == 1);
}

TEST_CASE("the pyro manager confirms each tick and addresses the selected controller", "[devices][R2][R22]") {
    CHECK(test::confirms_and_addresses<PyroManager>(ModuleId::pyro, Device::pyro));
}

}  // namespace flight_pyro_test
