// SPDX-License-Identifier: Apache-2.0
#include "telemetry/station/expected_values.hpp"

#include "tests/support/catch.hpp"

#include <vector>

namespace telemetry_expected_values_test {

using namespace aeolis;
using namespace aeolis::telemetry;

TEST_CASE("values that ground's flight has come back from their octets, with their ticks, undefined ones too",
          "[station][R57]") {
    std::vector<ExpectedValue> values;
    for (std::uint16_t i = 0; i < expected_values_max; ++i)
        values.push_back({ChannelId{i}, Sclk{100.0} + i / 64.0, i % 5 == 0 ? std::nullopt : std::optional{i * 1.5}});
    std::vector<ExpectedValue> back;
    const auto take = [&](const ExpectedValue& each) { back.push_back(each); };
    unpack_expected_values(pack_expected_values(values, Sclk{100.0}), Sclk{100.0}, take);
    REQUIRE(back.size() == values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
        INFO(i);
        CHECK(back[i].channel == values[i].channel);
        CHECK(back[i].at == values[i].at);
        CHECK(back[i].value == values[i].value);
    }
    back.clear();
    unpack_expected_values(pack_expected_values(std::span{values}.first(3), Sclk{100.0}), Sclk{100.0}, take);
    CHECK(back.size() == 3);
    back.clear();
    unpack_expected_values(std::vector<std::uint8_t>(703, 0), Sclk{100.0}, take);
    CHECK(back.empty());
}

}  // namespace telemetry_expected_values_test
