// SPDX-License-Identifier: Apache-2.0
#include "flight/kernel/parameter_parts.hpp"

#include "tests/support/catch.hpp"

namespace flight_parameter_parts_test {

using namespace aeolis;
using namespace aeolis::flight;

TEST_CASE("a table goes over in parts, and is whole with the last", "[parameters][R25]") {
    Parameters sent, received;
    for (std::uint16_t row = 0; row < parameter_count; ++row)
        set_value(sent, ParameterId{row}, parameter_specs.at(row).max);
    std::size_t parts = 0, whole = 0;
    parameter_parts(sent, [&](const ParameterPart& part) {
        ++parts;
        if (take(received, part)) whole = parts;
    });
    CHECK(received == sent);
    CHECK(parts == (parameter_count + part_parameters_max - 1) / part_parameters_max);
    CHECK(whole == parts);
}

TEST_CASE("a part with more parameters than there are changes no others", "[parameters][R4]") {
    Parameters received, wanted;
    ParameterPart part{.first = parameter_count - 1, .count = 255, .values = {}};
    part.values.fill(1.0e9);
    set_value(wanted, ParameterId{parameter_count - 1}, 1.0e9);
    take(received, part);
    CHECK(received == wanted);
    for (const std::uint16_t first : {std::uint16_t{parameter_count}, std::uint16_t{65535}}) {
        CHECK_FALSE(take(received, {.first = first, .count = 28, .values = part.values}));
        CHECK(received == wanted);
    }
}

}  // namespace flight_parameter_parts_test
