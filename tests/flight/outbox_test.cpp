// SPDX-License-Identifier: Apache-2.0
#include "flight/kernel/outbox.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/outbox.hpp"

namespace flight_outbox_test {

using namespace aeolis;
using namespace aeolis::flight;

TEST_CASE("sending returns nothing, and what finds no room is counted", "[kernel][R6]") {
    static_assert(std::is_void_v<decltype(std::declval<Outbox>().send(ModuleId::edl, Tick{}))>);
    test::OutboxRecorder recorder;
    for (int i = 0; i < 80; ++i) recorder.out.send(ModuleId::edl, Tick{Sclk{1.0}});
    CHECK(recorder.out.sent().size() + recorder.out.dropped() == 80);
    CHECK(recorder.out.dropped() > 0);
}

TEST_CASE("messages hold only data", "[kernel][R3]") {
    STATIC_REQUIRE(std::is_trivially_copyable_v<Message>);
}

TEST_CASE("an event goes to EdlComm as a record with its id and its time", "[kernel][R29]") {
    test::OutboxRecorder recorder{ModuleId::edl, Sclk{42.5}};
    recorder.out.event(evr::EDL_BEGUN{});
    REQUIRE(recorder.sent<Record>().size() == 1);
    CHECK(recorder.out.sent()[0].to == ModuleId::edl_comm);
    CHECK(recorder.sent<Record>()[0].time == Sclk{42.5});
    CHECK(recorder.events<evr::EDL_BEGUN>() == 1);
}

}  // namespace flight_outbox_test
