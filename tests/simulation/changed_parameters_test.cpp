// SPDX-License-Identifier: Apache-2.0
#include "commands/parameter_table.hpp"
#include "common/deviation.hpp"
#include "flight/edl/parameter_table.hpp"
#include "simulation/limits.hpp"
#include "simulation/random.hpp"
#include "tests/simulation/gale.hpp"
#include "tests/simulation/judged.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/recorded_events.hpp"
#include "tests/support/shipped_dictionary.hpp"
#include "tests/support/telecommands.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

namespace simulation_changed_parameters_test {

using namespace aeolis;
using namespace aeolis::simulation;
namespace evr = flight::evr;
namespace parameter = flight::parameter;

// Landings by a table of parameters that ground has changed. R25
namespace {

struct Change {
    ParameterId id;
    double value;
};

void step(Landing& landing, int cycles) {
    for (int i = 0; i < cycles; ++i) landing.step();
}

/// A commanded landing before GNC is enabled, to be forked. Second Chance may take over.
Landing before_gnc(double until_e_s = -600.0, std::uint64_t seed = 1) {
    Landing landing{tests::gale_scenario(900.0), seed};
    landing.uplink(test::set_parameters(landing.solution()));
    step(landing, 64);
    landing.uplink(test::enable_second_chance());
    landing.uplink(test::do_edl());
    while (landing.truth().e_s < until_e_s) landing.step();
    return landing;
}

/// The CRC of the table that the changes make of the one built in, as ground computes it.
std::uint16_t crc_of(const std::vector<Change>& changes) {
    commands::ParameterTable table{tests::shipped_dictionary()};
    for (const Change& one : changes) REQUIRE(table.set(one.id, one.value));
    return table.crc();
}

void change(Landing& landing, const std::vector<Change>& changes) {
    for (const Change& one : changes) {
        landing.uplink(test::stage_parameter(one.id, one.value));
        step(landing, 16);
    }
    landing.uplink(test::activate_parameters(1, static_cast<std::uint16_t>(changes.size()), crc_of(changes)));
    step(landing, 32);
    REQUIRE(tests::count_recorded<evr::PARAMETERS_ACTIVATED>(landing.recording()) == 1);
}

void land(Landing& landing) {
    while (landing.outcome() == Outcome::running) landing.step();
}

std::string text_of(const std::vector<Change>& changes) {
    std::string text;
    for (const Change& one : changes)
        text += tests::shipped_dictionary().parameters[one.id.value].name + "=" + std::to_string(one.value) + " ";
    return text;
}

/// Flies with some parameters changed, and demands that all is as it should be.
void check_lands(const Landing& common, const std::vector<Change>& changes) {
    INFO(text_of(changes));
    Landing landing{common};
    change(landing, changes);
    land(landing);
    const Judgement judgement = tests::judged(landing);
    INFO(reason_of(landing, judgement));
    CHECK(judgement.verdict == Verdict::landed);
    CHECK(tests::count_recorded<evr::SUB_CONSTRAINT_VIOLATED>(landing.recording()) == 0);
}

void check_both_ends(const Landing& common, ParameterId id) {
    const flight::ParameterSpec& spec = flight::parameter_specs.at(id.value);
    for (const double end : {spec.min, spec.max}) check_lands(common, {{id, end}});
}

/// Changes of two to eight parameters, whose deviations add up to as much as a table may have.
std::vector<Change> drawn_together(Random& random) {
    std::vector<Change> changes(2 + random.bits() % 7);
    std::vector<double> parts;
    double sum = 0.0;
    for (std::size_t i = 0; i < changes.size(); ++i) sum += parts.emplace_back(random.uniform());
    for (std::size_t i = 0; i < changes.size();) {
        const ParameterId id{static_cast<std::uint16_t>(random.bits() % flight::parameter_count)};
        const flight::ParameterSpec& spec = flight::parameter_specs.at(id.value);
        if (spec.member == nullptr || std::ranges::count(changes, id, &Change::id) > 0) continue;
        const double built_in = flight::Parameters{}.*spec.member;
        const double end = random.bits() % 2 == 0 ? spec.min : spec.max;
        constexpr double rounding = 1.0e-9;  // the sum is at most 1, also as computed
        changes[i] = {id, built_in + (end - built_in) * (parts[i] / sum - rounding)};
        ++i;
    }
    return changes;
}

void check_together(std::uint64_t seed, int tables) {
    const Landing common = before_gnc();
    Random random{seed, 0, Stream::devices};
    for (int table = 0; table < tables; ++table) {
        INFO("seed " << seed << ", table " << table);
        check_lands(common, drawn_together(random));
    }
}

/// A fault that docs/faults.md has under *Survived*, whenever it is.
struct Survived {
    const char* what;
    flight::Device device;
    bool both;  ///< units
    DeviceFault::Kind kind;
    double from_e_s, to_e_s;  ///< it begins between these
    double length_s;
};
constexpr std::array survived{
    Survived{"IMU", flight::Device::imu, false, DeviceFault::Kind::silent, -500.0, 430.0, 0.5},
    Survived{"radar", flight::Device::radar, true, DeviceFault::Kind::silent, 290.0, 370.0, 15.0},
    Survived{"pyros of A", flight::Device::pyro, false, DeviceFault::Kind::refuses, -500.0, 430.0, 1000.0},
    Survived{"pyros", flight::Device::pyro, true, DeviceFault::Kind::denies, -500.0, 430.0, 1000.0},
    Survived{"thrusters", flight::Device::thrusters, true, DeviceFault::Kind::silent, -500.0, 370.0, 10.0},
    Survived{"engines", flight::Device::descent_engines, true, DeviceFault::Kind::silent, 370.0, 430.0, 0.5},
    Survived{"replies of power", flight::Device::power, true, DeviceFault::Kind::late, -500.0, 250.0, 1000.0},
};

/// Each flight has a table and a fault, each drawn anew, and errors of its own.
void check_with_faults(std::uint64_t seed, int flights) {
    Random random{seed, 1, Stream::devices};
    for (int flight = 0; flight < flights; ++flight) {
        const Survived& fault = survived[static_cast<std::size_t>(flight) % survived.size()];
        const double e_s = fault.from_e_s + (fault.to_e_s - fault.from_e_s) * random.uniform();
        Landing landing = before_gnc(-600.0, seed + static_cast<std::uint64_t>(flight));
        const auto changes = drawn_together(random);
        INFO("seed " << seed << ", flight " << flight << ": " << text_of(changes) << ", " << fault.what << " from E"
                     << e_s);
        change(landing, changes);
        while (landing.truth().e_s < e_s && landing.outcome() == Outcome::running) landing.step();
        for (const auto unit : {flight::Unit::a, flight::Unit::b})
            if (fault.both || unit == flight::Unit::a)
                landing.inject(DeviceFault{fault.device, unit, fault.kind, 0.0, fault.length_s, 0.5});
        land(landing);
        const Judgement judgement = tests::judged_held_up(landing);
        INFO(reason_of(landing, judgement));
        CHECK(judgement.verdict == Verdict::landed);
    }
}

constexpr Change slower_parachute{parameter::parachute_mach_max, 1.6};  // as built it opens at Mach 1.7

}  // namespace

TEST_CASE("a table of the values as built flies as built, bit for bit", "[simulation][parameters][R25][R48]") {
    Landing as_built = before_gnc(), activated{as_built};
    change(activated, {{parameter::guidance_gain, flight::Parameters{}.guidance_gain}});
    land(as_built);
    land(activated);
    CHECK(as_built.truth().p_MoB_M_m == activated.truth().p_MoB_M_m);
    CHECK(as_built.truth().v_MB_M_mps == activated.truth().v_MB_M_mps);
    CHECK(as_built.sclk() == activated.sclk());
}

TEST_CASE("a changed parameter changes the flight, and only once it is activated", "[simulation][parameters][R25]") {
    Landing landing = before_gnc();
    change(landing, {{parameter::parachute_mach_max, 1.69}, {parameter::sky_crane_descent_rate_mps, 0.73}});
    landing.uplink(test::stage_parameter(parameter::parachute_mach_max, 2.2));  // and not activated
    land(landing);
    CHECK(landing.outcome() == Outcome::touchdown);
    REQUIRE(landing.parachute());
    CHECK(landing.parachute()->mach < 1.7);
    REQUIRE(landing.touchdown());
    CHECK(landing.touchdown()->vertical_mps < 0.755);
}

TEST_CASE(
    "once GNC is enabled no parameter is staged, activated or discarded, what is staged is told, and the table can "
    "still be dumped",
    "[simulation][parameters][R25][R30]") {
    Landing landing = before_gnc();
    landing.uplink(test::stage_parameter(slower_parachute.id, slower_parachute.value));
    while (landing.truth().e_s < -500.0) landing.step();
    CHECK(tests::count_recorded<evr::PARAMETER_STAGED>(landing.recording()) == 1);
    CHECK(tests::count_recorded<evr::PARAMETERS_NOT_ACTIVATED>(landing.recording()) == 1);
    int refused = 0;
    for (const auto& command :
         {test::stage_parameter(parameter::guidance_gain, 4.0),
          test::activate_parameters(1, 1, crc_of({slower_parachute})), test::discard_parameters()}) {
        landing.uplink(command);
        step(landing, 32);
        CHECK(tests::count_recorded<evr::COMMAND_REFUSED>(landing.recording()) == ++refused);
    }
    CHECK(tests::count_recorded<evr::PARAMETER_STAGED>(landing.recording()) == 1);
    CHECK(tests::count_recorded<evr::PARAMETERS_ACTIVATED>(landing.recording()) == 0);
    CHECK(tests::count_recorded<evr::PARAMETERS_DISCARDED>(landing.recording()) == 0);
    landing.uplink(test::dump_parameters());
    step(landing, 64);
    CHECK(tests::count_recorded<evr::COMMAND_REFUSED>(landing.recording()) == refused);
    std::size_t parts = 0;
    telemetry::PacketStream packets{landing.recording()};
    while (const auto packet = packets.next())
        if (read_tm_packet(*packet)->primary.apid == flight::packet::DataProduct::apid) ++parts;
    constexpr std::size_t part_octets = std::tuple_size_v<decltype(flight::packet::DataProduct::content)>;
    CHECK(parts == (flight::parameter_rows_octets + part_octets - 1) / part_octets);
}

TEST_CASE("prime that is restarted flies by the table that it had, and so does Second Chance when it takes over",
          "[simulation][parameters][second_chance][R25][R32][R33]") {
    for (const double reset_e_s : {-800.0, 100.0}) {
        INFO("prime is reset at E" << reset_e_s);
        Landing landing = before_gnc(-850.0);
        change(landing, {slower_parachute});
        while (landing.truth().e_s < reset_e_s) landing.step();
        landing.reset_prime();
        land(landing);
        const Judgement judgement = tests::judged(landing);
        INFO(reason_of(landing, judgement));
        CHECK(judgement.verdict == Verdict::landed);
        REQUIRE(landing.parachute());
        CHECK(landing.parachute()->mach < 1.65);
    }
}

TEST_CASE("a few parameters at either end of their ranges land within the limits", "[simulation][parameters][R25]") {
    const Landing common = before_gnc();
    for (const ParameterId id : {parameter::guidance_gain, parameter::constant_velocity_mps})
        check_both_ends(common, id);
}

TEST_CASE("each parameter at either end of its range lands within the limits", "[.long][simulation][parameters][R25]") {
    for (std::uint16_t row = 0; row < flight::parameter_count; ++row)
        if (flight::parameter_specs.at(row).member != nullptr)
            check_both_ends(before_gnc(-600.0, 1 + row), ParameterId{row});  // each with errors of its own
}

TEST_CASE("the sidestep's parameters at either end are safe over twenty landings that differ",
          "[.long][simulation][parameters][R25][R27]") {
    for (std::uint64_t seed = 110; seed < 130; ++seed) {
        INFO("seed " << seed);
        const Landing common = before_gnc(-600.0, seed);
        for (const ParameterId id : {parameter::divert_clearance_min_m, parameter::divert_clearance_for_s,
                                     parameter::divert_velocity_gain_per_s, parameter::divert_position_gain_per_s2})
            check_both_ends(common, id);
    }
}

TEST_CASE("tables of several parameters that use up what they may deviate together land within the limits",
          "[simulation][parameters][R25]") {
    check_together(1, 6);
}

TEST_CASE("a hundred tables of several parameters, each as far from the one built in as it may be, land within the "
          "limits",
          "[.long][simulation][parameters][R25]") {
    check_together(2, 100);
}

TEST_CASE("with a changed table of parameters seven kinds of fault that are survived are survived as well",
          "[simulation][parameters][faults][R25][R27][release]") {
    check_with_faults(3, static_cast<int>(survived.size()));
}

TEST_CASE("with a hundred tables, each with a fault and errors of its own, the rover lands within the limits",
          "[.long][simulation][parameters][faults][R25][R27]") {
    check_with_faults(100, 100);
}

TEST_CASE("a table whose changes are each in range but together too much is refused on board, as on ground",
          "[simulation][parameters][R25]") {
    const std::vector<Change> changes{slower_parachute, {parameter::sky_crane_descent_rate_mps, 0.65}};
    Landing landing = before_gnc();
    for (const Change& one : changes) {
        landing.uplink(test::stage_parameter(one.id, one.value));
        step(landing, 16);
    }
    landing.uplink(test::activate_parameters(1, 2, crc_of(changes)));
    step(landing, 32);
    CHECK(tests::count_recorded<evr::PARAMETERS_ACTIVATED>(landing.recording()) == 0);
    CHECK(tests::count_recorded<evr::COMMAND_REFUSED>(landing.recording()) == 1);
    commands::ParameterTable table{tests::shipped_dictionary()};
    for (const Change& one : changes) REQUIRE(table.set(one.id, one.value));
    CHECK_FALSE(table.check_deviations());
}

}  // namespace simulation_changed_parameters_test
