// SPDX-License-Identifier: Apache-2.0
#include "flight/fault_protection/system_fault_protection.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/outbox.hpp"

namespace flight_system_fault_protection_test {

using namespace aeolis;
using namespace aeolis::flight;

TEST_CASE("each report of a fault asks EDL to hold, and the end of the fault to go on", "[faults][R24]") {
    SystemFaultProtection protection{Load{}};
    test::OutboxRecorder recorder{ModuleId::system_fault_protection};
    for (const bool present : {true, true, false}) {
        recorder.begin(ModuleId::system_fault_protection, Sclk{1000.0});
        protection.on(SystemFaultReport{present}, recorder.out);
        const auto wishes = recorder.sent<InhibitEdl>();
        REQUIRE(wishes.size() == 1);
        CHECK(wishes[0].inhibited == present);
    }
}

}  // namespace flight_system_fault_protection_test
