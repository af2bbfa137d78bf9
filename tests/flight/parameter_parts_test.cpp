// SPDX-License-Identifier: Apache-2.0
#include "flight/kernel/parameter_parts.hpp"

#include "tests/support/catch.hpp"

#include <vector>

namespace flight_parameter_parts_test {

using namespace aeolis;
using namespace aeolis::flight;

namespace {

std::vector<ParameterPart> parts_of(const Parameters& sent) {
    std::vector<ParameterPart> parts;
    parameter_parts(sent, [&](const ParameterPart& part) { parts.push_back(part); });
    return parts;
}

/// Each parameter at its largest.
Parameters largest() {
    Parameters parameters;
    for (std::uint16_t row = 0; row < parameter_count; ++row)
        set_value(parameters, ParameterId{row}, parameter_specs.at(row).max);
    return parameters;
}

}  // namespace

TEST_CASE("a table goes over in parts, and is whole with the last", "[parameters][R25]") {
    const auto parts = parts_of(largest());
    CHECK(parts.size() == (parameter_count + part_parameters_max - 1) / part_parameters_max);
    ReceivedParameters received;
    for (const ParameterPart& part : parts) {
        CHECK(received.values() == Parameters{});
        CHECK(received.on(part) == (&part == &parts.back()));
    }
    CHECK(received.values() == largest());
}

TEST_CASE("a table of which a part was lost, came twice or out of order changes nothing, and the next whole one does",
          "[parameters][R4][R25]") {
    const auto parts = parts_of(largest());
    REQUIRE(parts.size() > 2);
    for (std::size_t i = 0; i < parts.size(); ++i) {
        auto lost = parts, doubled = parts, swapped = parts;
        lost.erase(lost.begin() + static_cast<std::ptrdiff_t>(i));
        // The last part doubled comes after the whole table.
        const bool doubles = i > 0 && i + 1 < parts.size();
        if (doubles) doubled.insert(doubled.begin() + static_cast<std::ptrdiff_t>(i), parts[i]);
        std::swap(swapped[i], swapped[(i + 1) % swapped.size()]);
        for (const auto& wrong : {lost, doubles ? doubled : lost, swapped}) {
            ReceivedParameters received;
            for (const ParameterPart& part : wrong) CHECK_FALSE(received.on(part));
            CHECK(received.values() == Parameters{});
            for (const ParameterPart& part : parts) received.on(part);
            CHECK(received.values() == largest());
        }
    }
}

TEST_CASE("a part with more parameters than there are changes nothing", "[parameters][R4]") {
    ReceivedParameters received;
    ParameterPart part{.first = 0, .count = 255, .values = {}};
    part.values.fill(1.0e9);
    CHECK_FALSE(received.on(part));
    for (const std::uint16_t first : {std::uint16_t{parameter_count}, std::uint16_t{65535}})
        CHECK_FALSE(received.on({.first = first, .count = 28, .values = part.values}));
    CHECK(received.values() == Parameters{});
}

}  // namespace flight_parameter_parts_test
