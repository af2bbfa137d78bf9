// SPDX-License-Identifier: Apache-2.0
#include "server/venue/message_flow.hpp"

#include "server/rehearsal/rehearsal.hpp"
#include "tests/server/running_server.hpp"

#include <algorithm>

namespace server_message_flow_test {

using namespace aeolis;
using namespace aeolis::server;

namespace {

std::size_t type_named(std::string_view name) {
    const auto found = std::ranges::find(message_names, name);
    REQUIRE(found != message_names.end());
    return static_cast<std::size_t>(found - message_names.begin());
}

}  // namespace

TEST_CASE("who talks to whom is counted as it is sent, and the document says it in the source's own names",
          "[venue][R9][R40]") {
    const auto flow = std::make_shared<MessageFlow>();
    Rehearsal rehearsal{test::shipped_scenario("nominal_auto"), 1, 0, tests::shipped_dictionary(), flow};
    for (int tick = 0; tick < 64 * 60; ++tick) rehearsal.step();
    CHECK(flow->cycles() == 64 * 60);
    using flight::ModuleId;
    CHECK(flow->interrupts(ModuleId::sync, type_named("ClockTick")) == flow->cycles());
    CHECK(flow->sent(ModuleId::sync, ModuleId::edl, type_named("Tick")) == flow->cycles());
    CHECK(flow->sent(ModuleId::edl, ModuleId::sync, type_named("Confirm")) == flow->cycles());
    CHECK(flow->sent(ModuleId::command_dispatcher, ModuleId::edl, type_named("DoEdlCommand")) == 1);
    CHECK(flow->sent(ModuleId::mfsk, ModuleId::edl, type_named("Tick")) == 0);

    const std::string text = flow->document("a landing");
    CHECK_THAT(text, Catch::Contains("| 1 | `sync` | yes | 1.0 ms | 200 us | ClockTick, "));
    CHECK_THAT(text, Catch::Contains("| `command_dispatcher` | `edl` | DoEdlCommand | 1 | 1 | 1.0 |"));
    CHECK_THAT(text, Catch::Contains("| `sync` | `edl` | Tick | 3840 | 60 | 64.0 |"));
    CHECK_THAT(text, Catch::Contains("    command_dispatcher -.-> edl\n"));
    CHECK_THAT(text, Catch::Contains("    sync --> edl\n"));
}

TEST_CASE("counting who talks to whom changes no bit of a landing", "[venue][invariant1]") {
    Rehearsal plain{test::shipped_scenario("nominal_auto"), 1, 0, tests::shipped_dictionary()};
    Rehearsal counted{test::shipped_scenario("nominal_auto"), 1, 0, tests::shipped_dictionary(),
                      std::make_shared<MessageFlow>()};
    for (int tick = 0; tick < 64 * 60; ++tick) {
        plain.step();
        counted.step();
    }
    CHECK(plain.digest() == counted.digest());
}

}  // namespace server_message_flow_test
