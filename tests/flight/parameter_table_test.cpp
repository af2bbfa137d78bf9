// SPDX-License-Identifier: Apache-2.0
#include "flight/edl/parameter_table.hpp"

#include "common/bytes.hpp"
#include "common/crc.hpp"
#include "flight/cross_string/state_exchange.hpp"
#include "tests/support/catch.hpp"

#include <bit>
#include <cmath>
#include <limits>
#include <vector>

namespace flight_parameter_table_test {

using namespace aeolis;
using namespace aeolis::flight;

namespace {

CommandRefusal refused(std::uint16_t row, double value) {
    const auto conditions = conditions_of({.parameter = row, .value = value});
    REQUIRE_FALSE(all_hold(conditions));
    return refusal_of(conditions);
}

/// The rows that ground may change.
std::vector<ParameterId> changeable() {
    std::vector<ParameterId> rows;
    for (std::uint16_t row = 0; row < parameter_count; ++row)
        if (parameter_specs.at(row).member != nullptr) rows.push_back(ParameterId{row});
    return rows;
}

}  // namespace

TEST_CASE("a parameter is staged within its range, and one beyond it or fixed at build is refused",
          "[parameters][R25][R38]") {
    const auto id = parameter::parachute_mach_max;
    const ParameterSpec& spec = parameter_specs.at(id.value);
    for (const double inside : {spec.min, spec.max, 0.5 * (spec.min + spec.max)})
        CHECK(all_hold(conditions_of({.parameter = id.value, .value = inside})));
    for (const double outside : {std::nextafter(spec.min, 0.0), std::nextafter(spec.max, 10.0), 1.0e10, -1.0})
        CHECK(refused(id.value, outside) == CommandRefusal::bad_argument);
    CHECK(refused(id.value, std::numeric_limits<double>::quiet_NaN()) == CommandRefusal::bad_argument);
    const auto fixed = parameter::entry_moved_max_s;
    CHECK(refused(fixed.value, build_parameters.entry_moved_max_s) == CommandRefusal::fixed_at_build);
    CHECK(refused(parameter_count, 1.0) == CommandRefusal::bad_argument);
    CHECK(refused(65535, 1.0) == CommandRefusal::bad_argument);
}

TEST_CASE("the conditions of a staged parameter name it, and its range", "[parameters][R38]") {
    const auto id = parameter::guidance_gain;
    const auto conditions = conditions_of({.parameter = id.value, .value = 11.0});
    REQUIRE(conditions.size() == 4);
    CHECK(conditions[0].quantity == Quantity::staged_parameter);
    CHECK(conditions[0].value == id.value);
    CHECK(conditions[1].quantity == Quantity::parameter_changeable);
    CHECK(conditions[2].bound == parameter_specs.at(id.value).min);
    CHECK(conditions[3].bound == parameter_specs.at(id.value).max);
    CHECK_FALSE(conditions[3].holds);
}

TEST_CASE("staged changes fly only when they are activated, all of them, under ground's version", "[parameters][R25]") {
    ParameterTable table{Parameters{}};
    table.stage(parameter::guidance_gain, 4.0);
    table.stage(parameter::constant_velocity_mps, 30.0);
    CHECK(table.values() == Parameters{});
    CHECK(table.report().parameters_staged == 2);
    CHECK(table.report().parameter_version == 0);
    table.activate(9);
    Parameters wanted;
    wanted.guidance_gain = 4.0;
    wanted.constant_velocity_mps = 30.0;
    CHECK(table.values() == wanted);
    const auto report = table.report();
    CHECK(report.parameter_version == 9);
    CHECK(report.parameter_changes == 2);
    CHECK(report.parameters_changed == 2);
    CHECK(report.parameters_staged == 0);
    table.stage(parameter::guidance_gain, Parameters{}.guidance_gain);
    table.activate(10);
    CHECK(table.report().parameters_changed == 1);
}

TEST_CASE("a parameter that is staged again takes its last value and no second place", "[parameters][R25]") {
    ParameterTable table{Parameters{}};
    table.stage(parameter::guidance_gain, 4.0);
    table.stage(parameter::guidance_gain, 4.5);
    CHECK(table.staged() == 1);
    table.activate(1);
    CHECK(table.values().guidance_gain == 4.5);
}

TEST_CASE("when the staging area is full a further parameter has no room, and one that is there has",
          "[parameters][R25]") {
    const auto rows = changeable();
    REQUIRE(rows.size() > staged_changes_max);
    ParameterTable table{Parameters{}};
    for (std::size_t i = 0; i < staged_changes_max; ++i) {
        REQUIRE(table.has_room(rows[i]));
        table.stage(rows[i], parameter_specs.at(rows[i].value).max);
    }
    CHECK_FALSE(table.has_room(rows[staged_changes_max]));
    CHECK(table.has_room(rows[3]));
    CHECK_THROWS_AS(table.stage(rows[staged_changes_max], 1.0), CheckFailed);
    table.discard();
    CHECK(table.staged() == 0);
    CHECK(table.has_room(rows[staged_changes_max]));
    CHECK(table.values() == Parameters{});
}

TEST_CASE("every parameter is dumped bit for bit, by its id", "[parameters][R25][R30]") {
    Parameters values;
    for (const ParameterId id : changeable()) set_value(values, id, std::nextafter(value_of(values, id), 1.0e12));
    const auto octets = rows_of(values);
    BitReader in{octets};
    for (std::uint16_t row = 0; row < parameter_count; ++row) {
        CHECK(in.get(16) == row);
        CHECK(std::bit_cast<std::uint64_t>(in.get_double()) ==
              std::bit_cast<std::uint64_t>(value_of(values, ParameterId{row})));
    }
    CHECK(value_of(values, parameter::entry_radius_m) == build_parameters.entry_radius_m);
}

TEST_CASE("the CRC reported is that of the table as dumped: it tells one bit of one parameter",
          "[parameters][R25][R30]") {
    const ParameterTable as_built{Parameters{}};
    CHECK(as_built.report().parameter_crc == crc16(rows_of(Parameters{})));
    for (const ParameterId id : changeable()) {
        Parameters other;
        set_value(other, id, std::nextafter(value_of(other, id), 1.0e12));
        CHECK(ParameterTable{other}.report().parameter_crc != as_built.report().parameter_crc);
    }
}

TEST_CASE("the CRC with what is staged is that of the table once it is activated", "[parameters][R25]") {
    ParameterTable table{Parameters{}};
    CHECK(table.crc_with_staged() == table.report().parameter_crc);
    table.stage(parameter::guidance_gain, 4.0);
    const std::uint16_t announced = table.crc_with_staged();
    CHECK(announced != table.report().parameter_crc);
    table.activate(1);
    CHECK(table.report().parameter_crc == announced);
}

TEST_CASE("the table, its version and what is staged go to the other computer", "[parameters][R32][R33]") {
    ParameterTable ours{Parameters{}}, theirs{Parameters{}};
    ours.stage(parameter::guidance_gain, 4.0);
    ours.activate(3);
    ours.stage(parameter::sufr_lead_s, 19.0);
    std::vector<std::uint8_t> octets(4096);
    StateExchange<std::uint8_t> writing{std::span{octets}};
    writing(ours);
    StateExchange<const std::uint8_t> reading{std::span<const std::uint8_t>{octets}};
    reading(theirs);
    REQUIRE(writing.ok());
    CHECK(reading.size() == writing.size());
    CHECK(theirs.values() == ours.values());
    CHECK(theirs.report() == ours.report());
    theirs.activate(4);
    CHECK(theirs.values().sufr_lead_s == 19.0);
}

}  // namespace flight_parameter_table_test
