// SPDX-License-Identifier: Apache-2.0
#include "simulation/buses/device_faults.hpp"

#include "common/space_packet.hpp"
#include "generated/dictionary_flight.hpp"
#include "simulation/devices/recorder.hpp"
#include "simulation/limits.hpp"
#include "tests/simulation/gale.hpp"
#include "tests/simulation/judged.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/telecommands.hpp"

#include <algorithm>
#include <map>

namespace simulation_device_faults_test {

using namespace aeolis;
using namespace aeolis::simulation;
using flight::Device;
using flight::Unit;
using Kind = DeviceFault::Kind;

// Landings with broken devices: what the vehicle makes of them is told by its own recording.
namespace {

using Selection = std::array<std::uint8_t, flight::redundant_device_count>;
constexpr Selection all_a{};
constexpr Selection all_b{1, 1, 1, 1, 1, 1, 1, 1};

constexpr Selection only(Device device) {
    Selection units{};
    units[static_cast<std::size_t>(device)] = 1;
    return units;
}

struct Landed {
    Judgement judgement;  ///< by the scenario's limits
    std::string reason;
    std::vector<std::uint8_t> recording;
    std::map<std::uint16_t, flight::TimepointVerdict> verdicts;  ///< by timepoint
    std::map<std::uint16_t, int> events;

    flight::TimepointVerdict verdict(TimepointId timepoint) const { return verdicts.at(timepoint.value); }
    int count(EvrId id) const {
        const auto found = events.find(id.value);
        return found == events.end() ? 0 : found->second;
    }
    /// Timepoints whose reply did not say that they were done.
    std::vector<std::uint16_t> not_verified() const {
        std::vector<std::uint16_t> rows;
        for (const auto& [row, verdict] : verdicts)
            if (verdict == flight::TimepointVerdict::unverified || verdict == flight::TimepointVerdict::refused)
                rows.push_back(row);
        return rows;
    }
};

void read(Landed& landed) {
    std::span<const std::uint8_t> octets{landed.recording};
    for (auto packet = take_packet(octets); !packet.empty(); packet = take_packet(octets)) {
        const Apid apid = read_primary_header(packet)->apid;
        const auto field = [&](std::size_t bit, unsigned bits) {
            return read_bits(packet, tm_data_offset_octets * 8 + bit, bits);
        };
        if (apid == flight::packet::TimepointFired::apid)
            landed.verdicts[static_cast<std::uint16_t>(field(0, 16))] =
                static_cast<flight::TimepointVerdict>(field(16 + 64 + 64, 8));
        if (apid == flight::evr::EDL_BEGUN::apid) ++landed.events[static_cast<std::uint16_t>(field(0, 16))];
    }
}

Landed land(const std::vector<DeviceFault>& faults, const Selection& units = all_a,
            double bus_message_error_fraction = 1.0e-4) {
    Scenario scenario = tests::gale_scenario(900.0);
    scenario.device_faults = faults;
    scenario.bus_message_error_fraction = bus_message_error_fraction;
    REQUIRE(impossible_values(scenario).empty());
    Landing landing{scenario, 1, 0};
    landing.uplink(test::set_parameters(landing.solution()));
    if (units != all_a) landing.uplink(test::select_units(units));
    for (int i = 0; i < 64; ++i) landing.step();
    landing.uplink(test::do_edl());
    while (landing.outcome() == Outcome::running) landing.step();
    Landed landed;
    landed.judgement = tests::judged_held_up(landing, scenario.limits);
    landed.reason = reason_of(landing, landed.judgement);
    landed.recording.assign(landing.recording().begin(), landing.recording().end());
    read(landed);
    return landed;
}

DeviceFault all_the_time(Device device, Kind kind, Unit unit = Unit::a) {
    return {device, unit, kind, 900.0, 2000.0};
}

/// UHF unit A, from before uhf_start at E-800 s to after it; not when the timeline stops UHF in the end.
DeviceFault at_its_start(Kind kind) {
    return {Device::uhf, Unit::a, kind, 810.0, 60.0};
}

}  // namespace

TEST_CASE("a landing without faults has every reply in time, and no device module has anything to report",
          "[simulation][faults][R2][R14][R50]") {
    const Landed landed = land({});
    CHECK(landed.judgement.verdict == Verdict::landed);
    CHECK(landed.not_verified().empty());
    for (const EvrId id : {flight::evr::REPLY_UNEXPECTED::id,
                           flight::evr::DEVICE_REFUSED::id,
                           flight::evr::PYRO_REFUSED::id,
                           flight::evr::PYRO_NOT_ARMED::id,
                           flight::evr::PYRO_CONTROLLER_REFUSED::id,
                           flight::evr::PYRO_CONTROLLER_SILENT::id,
                           flight::evr::REPLY_CONTRADICTS::id,
                           flight::evr::TIMEPOINT_HELD::id,
                           flight::evr::IMU_SAMPLES_MISSING::id,
                           flight::evr::RADAR_LOST::id,
                           flight::evr::CRUISE_ATTITUDE_UNUSABLE::id,
                           flight::evr::IMU_SILENT::id,
                           flight::evr::ATTITUDE_LOST::id,
                           flight::evr::TIMEPOINT_CONTRADICTED::id,
                           flight::evr::TIMEPOINT_WITNESSED::id,
                           flight::evr::TIMEPOINT_FELT::id,
                           flight::evr::PROPELLANT_LOW::id,
                           flight::evr::THRUSTERS_NOT_FELT::id,
                           flight::evr::THRUSTERS_FELT_AGAIN::id,
                           flight::evr::THRUSTERS_NOT_JUDGED::id,
                           flight::evr::ENGINES_SILENT::id,
                           flight::evr::ENGINES_HEARD_AGAIN::id})
        CHECK(landed.count(id) == 0);
}

TEST_CASE("the timeline is held for a UHF unit that does not answer, commanding it again, and goes on unverified",
          "[simulation][faults][R2][R14][R50]") {
    const Landed landed = land({at_its_start(Kind::silent)});
    CHECK(landed.judgement.verdict == Verdict::landed);
    CHECK(landed.verdict(flight::timepoint::uhf_start) == flight::TimepointVerdict::unverified);
    CHECK(landed.not_verified() == std::vector<std::uint16_t>{flight::timepoint::uhf_start.value});
    CHECK(landed.count(flight::evr::TIMEPOINT_UNVERIFIED::id) == 1);
    CHECK(landed.count(flight::evr::TIMEPOINT_HELD::id) == 2);
    CHECK(landed.count(flight::evr::UHF_STARTED::id) == 0);
}

TEST_CASE("a UHF unit that refuses ends uhf_start as refused; one that answers within the hold verifies it",
          "[simulation][faults][R2][R14][R50]") {
    const Landed refused = land({at_its_start(Kind::refuses)});
    CHECK(refused.judgement.verdict == Verdict::landed);
    CHECK(refused.verdict(flight::timepoint::uhf_start) == flight::TimepointVerdict::refused);
    CHECK(refused.count(flight::evr::DEVICE_REFUSED::id) == 3);  // commanded, and twice again
    CHECK(refused.count(flight::evr::TIMEPOINT_REFUSED::id) == 1);
    CHECK(refused.count(flight::evr::UHF_STARTED::id) == 0);

    const Landed late = land({at_its_start(Kind::late)});
    CHECK(late.judgement.verdict == Verdict::landed);
    CHECK(late.verdict(flight::timepoint::uhf_start) == flight::TimepointVerdict::verified);
    CHECK(late.count(flight::evr::DEVICE_REFUSED::id) == 0);
    CHECK(late.count(flight::evr::UHF_STARTED::id) == 1);
}

TEST_CASE("faults of units that are not selected change nothing, to the last bit", "[simulation][faults][R2][R50]") {
    const Landed sound = land({});
    std::vector<DeviceFault> faults;
    for (std::size_t device = 0; device < flight::redundant_device_count; ++device)
        if (static_cast<Device>(device) != Device::pyro)
            faults.push_back(all_the_time(static_cast<Device>(device), Kind::silent, Unit::b));
    CHECK(land(faults).recording == sound.recording);
}

TEST_CASE("with all B units selected the vehicle lands as well, by other sensors", "[simulation][faults][R2]") {
    std::vector<DeviceFault> faults;
    for (std::size_t device = 0; device < flight::redundant_device_count; ++device)
        faults.push_back(all_the_time(static_cast<Device>(device), Kind::silent, Unit::a));
    const Landed landed = land(faults, all_b);
    INFO(landed.reason);
    CHECK(landed.judgement.verdict == Verdict::landed);
    CHECK(landed.not_verified().empty());
    CHECK(landed.count(flight::evr::UNITS_SELECTED::id) == 1);
    CHECK(landed.recording != land({}).recording);
}

TEST_CASE("a pyro controller that is silent or refuses costs nothing and is told of each pyro, whichever is selected",
          "[simulation][faults][R2][R50]") {
    const Landed sound = land({});
    for (const auto& [kind, told] : {std::pair{Kind::silent, flight::evr::PYRO_CONTROLLER_SILENT::id},
                                     std::pair{Kind::refuses, flight::evr::PYRO_CONTROLLER_REFUSED::id}})
        for (const Selection& units : {all_a, only(Device::pyro)}) {
            const Landed landed = land({all_the_time(Device::pyro, kind)}, units);
            INFO(landed.reason);
            CHECK(landed.judgement.verdict == Verdict::landed);
            CHECK(landed.verdicts == sound.verdicts);
            CHECK(landed.count(told) == flight::pyro_count);
            CHECK(landed.count(flight::evr::PYRO_REFUSED::id) == 0);
        }
}

TEST_CASE("both pyro controllers silent: separation is unverified, nothing says that it happened, and it is lost",
          "[simulation][faults][R2][R50]") {
    const Landed lost =
        land({all_the_time(Device::pyro, Kind::silent), all_the_time(Device::pyro, Kind::silent, Unit::b)});
    CHECK(lost.judgement.verdict == Verdict::lost);
    CHECK(lost.reason == "entered with the cruise stage attached: it was commanded to separate, and did not");
    CHECK(lost.verdict(flight::timepoint::cruise_stage_separation) == flight::TimepointVerdict::unverified);
    CHECK(lost.count(flight::evr::CRUISE_STAGE_SEPARATION::id) == 0);
}

TEST_CASE("EDL does not switch units over: a selection after do edl is refused and changes nothing",
          "[simulation][faults][R2]") {
    Landing landing{tests::gale_scenario(900.0), 1, 0};
    const auto fly_on = [&] {
        for (int i = 0; i < 64; ++i) landing.step();
    };
    landing.uplink(test::set_parameters(landing.solution()));
    fly_on();
    landing.uplink(test::do_edl());
    fly_on();
    landing.uplink(test::select_units(all_b));
    fly_on();
    Landed landed;
    landed.recording.assign(landing.recording().begin(), landing.recording().end());
    read(landed);
    CHECK(landed.count(flight::evr::EDL_BEGUN::id) == 1);
    CHECK(landed.count(flight::evr::UNITS_SELECTED::id) == 0);
    CHECK(landed.count(flight::evr::COMMAND_REFUSED::id) == 1);
}

TEST_CASE("a radar that loses its ground under the parachute is reported, and the vehicle lands by what it knew",
          "[simulation][faults][R2]") {
    // Heatshield separation is at about E+278 s, backshell separation at about E+375 s.
    const Landed landed = land({{Device::radar, Unit::a, Kind::dropout, -300.0, 20.0}});
    INFO(landed.reason);
    CHECK(landed.count(flight::evr::RADAR_LOST::id) == 1);
    CHECK(landed.judgement.verdict == Verdict::landed);
}

TEST_CASE("IMU samples that are lost are counted in flight", "[simulation][faults][R2]") {
    const Landed landed = land({{Device::imu, Unit::a, Kind::dropout, 700.0, 5.0}});
    INFO(landed.reason);
    // Both computers listen to the IMU, and each reports the seconds of the fault.
    CHECK(landed.count(flight::evr::IMU_SAMPLES_MISSING::id) >= 10);
    CHECK(landed.count(flight::evr::IMU_SAMPLES_MISSING::id) <= 12);
    CHECK(landed.judgement.verdict == Verdict::landed);
}

TEST_CASE("with one message in twenty garbled on both buses the vehicle still lands", "[simulation][faults][R2]") {
    const Landed landed = land({}, all_a, 0.05);
    INFO(landed.reason);
    CHECK(landed.judgement.verdict == Verdict::landed);
    CHECK(landed.not_verified().empty());
}

TEST_CASE("a fault holds from its beginning for its duration, and only for its unit", "[simulation][faults]") {
    const DeviceFault fault{Device::uhf, Unit::b, Kind::late, 100.0, 10.0, 3.0};
    DeviceFaults faults{{fault}, Sclk{1000.0}};
    const auto holds = [&](double sclk_s) {
        faults.at(Sclk{sclk_s});
        return faults.has(Kind::late, Device::uhf, Unit::b);
    };
    CHECK_FALSE(holds(899.984375));
    CHECK(holds(900.0));
    CHECK(faults.late_ticks(Device::uhf, Unit::b) == 192);
    CHECK(faults.late_ticks(Device::uhf, Unit::a) == 0);
    CHECK(faults.answers(Device::uhf, Unit::b));
    CHECK(holds(909.984375));
    CHECK_FALSE(holds(910.0));
}

TEST_CASE("faults that a device cannot have are refused with the scenario", "[simulation][faults]") {
    Scenario scenario = tests::gale_scenario();
    const auto refused = [&](Device device, Kind kind) {
        scenario.device_faults = {{device, Unit::a, kind, 10.0, 5.0}};
        return !impossible_values(scenario).empty();
    };
    CHECK(refused(Device::radar, Kind::refuses));
    CHECK(refused(Device::pyro, Kind::dropout));
    CHECK(refused(Device::descent_engines, Kind::late));
    CHECK_FALSE(refused(Device::radar, Kind::dropout));
    CHECK_FALSE(refused(Device::uhf, Kind::late));
    scenario.device_faults = {{Device::uhf, Unit::a, Kind::silent, 10.0, 0.0}};
    CHECK(impossible_values(scenario).size() == 1);
}

TEST_CASE("a fault that is injected in mid-flight is the scenario's fault that begins then, to the last bit",
          "[simulation][faults]") {
    constexpr double begins_s = 700.0, for_s = 40.0;
    const auto flown = [&](bool injected, const std::optional<Fault>& fault) {
        Scenario scenario = tests::gale_scenario(900.0);
        if (fault && !injected) {
            if (const auto* device = std::get_if<DeviceFault>(&*fault)) scenario.device_faults = {*device};
            if (const auto* system = std::get_if<SystemFault>(&*fault)) scenario.system_faults = {*system};
            if (const auto* reset = std::get_if<ComputerReset>(&*fault)) scenario.computer_resets = {*reset};
            REQUIRE(impossible_values(scenario).empty());
        }
        Landing landing{scenario, 1, 0};
        landing.uplink(test::set_parameters(landing.solution()));
        for (int i = 0; i < 64; ++i) landing.step();
        landing.uplink(test::do_edl());
        while (scenario.entry_sclk - landing.sclk() > begins_s) landing.step();
        if (injected) landing.inject(*fault);
        while (scenario.entry_sclk - landing.sclk() > begins_s - 2.0 * for_s) landing.step();
        return std::vector<std::uint8_t>{landing.recording().begin(), landing.recording().end()};
    };
    const auto sound = flown(false, std::nullopt);
    const Fault faults[] = {DeviceFault{Device::imu, Unit::a, Kind::dropout, begins_s, for_s},
                            SystemFault{begins_s, for_s}, ComputerReset{begins_s}};
    for (const Fault& fault : faults) {
        INFO("fault " << fault.index());
        const auto planned = flown(false, fault), injected = flown(true, fault);
        const auto differ = std::ranges::mismatch(planned, injected);
        INFO("they differ from octet " << differ.in1 - planned.begin() << " of " << planned.size() << " on, "
                                       << injected.size() << " were injected");
        CHECK((planned == injected));
        CHECK((injected != sound));
    }
}

}  // namespace simulation_device_faults_test
