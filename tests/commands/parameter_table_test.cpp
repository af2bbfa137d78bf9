// SPDX-License-Identifier: Apache-2.0
#include "commands/parameter_table.hpp"

#include "common/deviation.hpp"
#include "flight/edl/parameter_table.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <limits>
#include <utility>
#include <vector>

namespace commands_parameter_table_test {

using namespace aeolis;
namespace parameter = flight::parameter;

TEST_CASE("ground's CRC of a parameter table is flight's: as built, and with any one parameter changed",
          "[commands][parameters][R25][R48]") {
    const commands::ParameterTable as_built{tests::shipped_dictionary()};
    CHECK(as_built.crc() == flight::ParameterTable{flight::Parameters{}}.report().parameter_crc);
    for (const dictionary::ParameterRow& row : tests::shipped_dictionary().parameters) {
        if (row.change == dictionary::ParameterRow::Change::build) continue;
        INFO(row.name);
        const double value = row.min < row.default_value ? row.min : row.max;
        commands::ParameterTable ground{tests::shipped_dictionary()};
        REQUIRE(ground.set(row.id, value));
        flight::ParameterTable table{flight::Parameters{}};
        table.stage(row.id, value);
        CHECK(ground.crc() == table.crc_with_staged());
        CHECK(ground.crc() != as_built.crc());
    }
}

TEST_CASE("of a vehicle that is loaded with parameters of its own ground and flight count from those",
          "[commands][parameters][R25]") {
    const std::vector<std::pair<ParameterId, double>> loaded{{parameter::guidance_gain, 9.0},
                                                             {parameter::constant_velocity_mps, 26.0}};
    flight::Parameters vehicle;
    for (const auto& [id, value] : loaded) flight::set_value(vehicle, id, value);
    flight::ParameterTable table{vehicle};
    CHECK(table.report().parameters_changed == 0);
    commands::ParameterTable ground{tests::shipped_dictionary(), loaded};
    CHECK(ground.crc() == table.report().parameter_crc);
    CHECK(ground.check_deviations());  // by the defaults they would be too far apart
    REQUIRE(ground.set(parameter::sufr_lead_s, 20.0));
    table.stage(parameter::sufr_lead_s, 20.0);
    CHECK(ground.crc() == table.crc_with_staged());
    CHECK(ground.check_deviations());
    CHECK(table.deviation_with_staged() == Approx(2.0 / 12.0));
}

TEST_CASE("ground refuses the changes of parameters that flight would refuse, and says why",
          "[commands][parameters][R25]") {
    commands::ParameterTable table{tests::shipped_dictionary()};
    const std::uint16_t before = table.crc();
    const auto why = [&](ParameterId id, double value) {
        const auto set = table.set(id, value);
        REQUIRE_FALSE(set);
        return set.error().message;
    };
    CHECK_THAT(why(parameter::guidance_gain, 1.0e9), Catch::StartsWith("guidance_gain: 1e+09 is outside "));
    CHECK_THAT(why(parameter::guidance_gain, std::numeric_limits<double>::quiet_NaN()), Catch::Contains("is outside"));
    CHECK(why(parameter::entry_moved_max_s, 10.0) == "entry_moved_max_s is fixed when flight is built");
    CHECK(why(ParameterId{60000}, 1.0) == "parameters.csv has no row 60000");
    CHECK(table.crc() == before);
}

TEST_CASE("ground and flight agree which tables may fly: of several parameters their deviations add up",
          "[commands][parameters][R25]") {
    const auto agree = [](const std::vector<std::pair<ParameterId, double>>& changes) {
        commands::ParameterTable ground{tests::shipped_dictionary()};
        flight::ParameterTable table{flight::Parameters{}};
        for (const auto& [id, value] : changes) {
            REQUIRE(ground.set(id, value));
            table.stage(id, value);
        }
        const bool may_fly = static_cast<bool>(ground.check_deviations());
        CHECK(may_fly == (table.deviation_with_staged() <= table_deviation_max));
        return may_fly;
    };
    const auto& gain = flight::parameter_specs.at(parameter::guidance_gain.value);  // 1 … 10, 5 as built
    CHECK(agree({}));
    CHECK(agree({{parameter::guidance_gain, gain.max}}));
    CHECK(agree({{parameter::guidance_gain, 3.0}, {parameter::guidance_saturation, 0.975}}));
    CHECK_FALSE(agree({{parameter::guidance_gain, 3.0}, {parameter::guidance_saturation, 0.976}}));
    CHECK_FALSE(agree({{parameter::guidance_gain, 1.0}, {parameter::tilt_max_deg, 60.0001}}));
    CHECK(agree({{parameter::guidance_gain, 1.0}, {parameter::guidance_gain, 9.0}}));  // the last one counts
    commands::ParameterTable ground{tests::shipped_dictionary()};
    REQUIRE(ground.set(parameter::guidance_gain, 1.0));
    REQUIRE(ground.set(parameter::guidance_saturation, 0.975));
    CHECK(
        ground.check_deviations().error().message ==
        "the changes together are too large: as fractions of their ranges they add up to 1.5, at most 1; the largest, "
        "guidance_gain, has 1");
}

}  // namespace commands_parameter_table_test
