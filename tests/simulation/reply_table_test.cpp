// SPDX-License-Identifier: Apache-2.0
#include "simulation/limits.hpp"

#include "common/space_packet.hpp"
#include "flight/timeline/actions.hpp"
#include "generated/dictionary_flight.hpp"
#include "telemetry/packet_stream.hpp"
#include "tests/simulation/gale.hpp"
#include "tests/simulation/judged.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/telecommands.hpp"

#include <array>
#include <cstdio>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace simulation_reply_table_test {

// An action whose device refuses it, says nothing, answers too late or answers twice: what the vehicle tells of it, and
// how the landing ends. Both units of the device fail. The rules and the table are in docs/refused_and_late_replies.md.
using namespace aeolis;
using namespace aeolis::simulation;
using flight::Device;
using flight::Unit;
using Kind = DeviceFault::Kind;
using flight::TimepointVerdict;

namespace {

constexpr Verdict lands = Verdict::landed;
constexpr Verdict lost = Verdict::lost;
constexpr std::array kinds{Kind::refuses, Kind::silent, Kind::late, Kind::doubled, Kind::claims, Kind::denies};

/// An action of the timeline, the device that carries it out, and the ends that were written before the runs. Of a
/// reply that is late, doubled or denies it the action is done: it lands, since what GNC waits for has a witness. Where
/// the device says that it is done and it is not, it ends as where it refuses.
struct Row {
    TimepointId timepoint;
    Device device{};
    Verdict refused = lands;  ///< also when it claims that it is done
    Verdict silent = lands;
    bool commanded_again = false;  ///< each cycle, or by a later action, whose reply verifies it
};

namespace point = flight::timepoint;
const std::vector<Row> rows{
    {point::descent_imu_power, Device::power},
    {point::catbed_heaters, Device::power},
    {point::coolant_vent, Device::pyro},
    {point::uhf_start, Device::uhf},
    {point::x_band_tones, Device::x_band},
    {point::entry_antenna, Device::x_band},
    {point::pressurant_valve_1, Device::pyro},
    {point::thermal_batteries, Device::pyro},
    {point::cruise_cables_cut, Device::pyro},
    {point::pressurant_valve_2, Device::pyro},
    {point::cruise_stage_separation, Device::pyro, lost, lost},
    {point::thruster_warm_up, Device::power},
    {point::thrusters_enable, Device::thrusters},
    {point::detumble, Device::thrusters},
    {point::cruise_balance_1, Device::pyro, lost, lost},
    {point::cruise_balance_2, Device::pyro, lost, lost},
    {point::balance_1, Device::pyro},
    {point::balance_2, Device::pyro},
    {point::balance_3, Device::pyro},
    {point::parachute_antenna, Device::x_band},
    {point::parachute_deploy, Device::pyro, lost, lost},
    {point::thrusters_off, Device::thrusters},
    {point::radar_power, Device::power, lost, lost},
    {point::heatshield_separation, Device::pyro, lost, lost},
    {point::thrusters_on, Device::thrusters},
    {point::engine_priming, Device::pyro, lost, lost},
    {point::backshell_separation, Device::pyro, lost, lost},
    {point::engine_ignition, Device::descent_engines, lands, lands, true},
    {point::rover_separation, Device::pyro, lost, lost},
    {point::bridle_release, Device::descent_engines, lands, lands, true},
    {point::bridle_cut, Device::pyro, lost, lost},
    {point::engines_off, Device::descent_engines, lands, lands, true},
    {point::uhf_stop, Device::uhf},
};

const char* name_of(Kind kind) {
    switch (kind) {
    case Kind::refuses: return "refuses";
    case Kind::silent: return "silent";
    case Kind::late: return "late";
    case Kind::doubled: return "doubled";
    case Kind::claims: return "claims";
    case Kind::denies: return "denies";
    case Kind::dropout: break;
    }
    return "";
}

/// Descent engines say how they are each cycle, whatever they were told: they neither answer late nor twice.
bool possible(const Row& row, Kind kind) {
    return row.device != Device::descent_engines || kind == Kind::refuses || kind == Kind::silent;
}

Verdict expected(const Row& row, Kind kind) {
    switch (kind) {
    case Kind::refuses:
    case Kind::claims: return row.refused;
    case Kind::silent: return row.silent;
    default: return lands;
    }
}

/// How the row ends. Engines that refuse do not say so.
TimepointVerdict expected_verdict(const Row& row, Kind kind) {
    if (kind == Kind::doubled || kind == Kind::claims) return TimepointVerdict::verified;
    if (kind == Kind::denies) return TimepointVerdict::refused;
    return kind == Kind::refuses && row.device != Device::descent_engines ? TimepointVerdict::refused
                                                                          : TimepointVerdict::unverified;
}

/// What was recorded of one timepoint since the fault began.
struct Told {
    std::map<std::uint16_t, int> of_timepoint;  ///< events that name it
    std::set<std::uint16_t> all;                ///< events of any kind
    std::set<std::uint8_t> tones;
    std::optional<TimepointVerdict> verdict;

    void read(std::span<const std::uint8_t> recorded, TimepointId timepoint) {
        telemetry::PacketStream packets{recorded};
        while (const auto packet = packets.next()) {
            const Apid apid = read_primary_header(*packet)->apid;
            const auto field = [&](unsigned at, unsigned bits) {
                return read_bits(*packet, tm_data_offset_octets * 8 + at, bits);
            };
            if (apid == flight::packet::ToneSelected::apid) tones.insert(static_cast<std::uint8_t>(field(0, 8)));
            if (apid == flight::packet::TimepointFired::apid && field(0, 16) == timepoint.value)
                verdict = static_cast<TimepointVerdict>(field(16 + 64 + 64, 8));
            if (apid != flight::evr::TIMEPOINT_VERIFIED::apid) continue;
            const auto id = static_cast<std::uint16_t>(field(0, 16));
            all.insert(id);
            if (packet->size() >= tm_overhead_octets + 4 && field(16, 16) == timepoint.value) ++of_timepoint[id];
        }
    }
    template <typename Evr>
    int count() const {
        const auto found = of_timepoint.find(Evr::id.value);
        return found == of_timepoint.end() ? 0 : found->second;
    }
    template <typename Evr>
    bool told() const {
        return all.contains(Evr::id.value);
    }
};

struct Flown {
    Judgement judgement;
    std::string reason;
    Told told;
};

/// A commanded landing that is forked shortly before each action, so that what comes before is flown once.
class Trunk {
  public:
    Trunk() : landing_(tests::gale_scenario(910.0), 1) {
        landing_.uplink(test::set_parameters(landing_.solution()));
        for (int cycle = 0; cycle < 64; ++cycle) landing_.step();
        landing_.uplink(test::do_edl());
    }
    Landing& landing() { return landing_; }

    void fly_to(Sclk when) {
        while (landing_.sclk() < when) landing_.step();
    }
    Flown with(const std::vector<DeviceFault>& faults, TimepointId timepoint) const {
        Landing fork{landing_};
        const std::size_t before = fork.recording().size();
        for (const DeviceFault& fault : faults) fork.inject(fault);
        while (fork.outcome() == Outcome::running) fork.step();
        const Judgement judgement = tests::judged_held_up(fork);
        // What is told after the landing, as of the stop of UHF, is told too.
        for (int cycle = 0; cycle < 64 * 30; ++cycle) fork.step();
        Flown flown{judgement, reason_of(fork, judgement), {}};
        flown.told.read(fork.recording().subspan(before), timepoint);
        return flown;
    }

  private:
    Landing landing_;
};

/// When each timepoint is triggered in a landing without faults, by its row.
std::map<std::uint16_t, Sclk> triggered_without_faults() {
    Trunk trunk;
    Landing& landing = trunk.landing();
    std::map<std::uint16_t, Sclk> triggered;
    for (int after = 0; after < 64 * 30; after += landing.outcome() == Outcome::running ? 0 : 1) landing.step();
    telemetry::PacketStream packets{landing.recording()};
    while (const auto packet = packets.next()) {
        if (read_primary_header(*packet)->apid != flight::packet::TimepointFired::apid) continue;
        BitReader in{packet->subspan(tm_data_offset_octets)};
        const auto row = static_cast<std::uint16_t>(in.get(16));
        triggered[row] = Sclk{in.get_double()};
    }
    REQUIRE(triggered.size() == flight::timepoint_count);
    return triggered;
}

constexpr double before_s = 0.25;

std::vector<DeviceFault> both_units(const Row& row, Kind kind) {
    const double wait_s = *flight::timeline_specs[row.timepoint.value].reply_timeout_s;
    std::vector<DeviceFault> faults;
    for (const Unit unit : {Unit::a, Unit::b})
        faults.push_back({row.device, unit, kind, 0.0, before_s + wait_s + 0.1, wait_s + 0.5});
    return faults;
}

void check(const Row& row, Kind kind, const Flown& flown) {
    const auto& spec = flight::timeline_specs[row.timepoint.value];
    INFO(spec.name << " " << name_of(kind) << ": " << flown.reason);
    CHECK(simulation::name_of(flown.judgement.verdict) == std::string{simulation::name_of(expected(row, kind))});
    const Told& told = flown.told;
    const TimepointVerdict verdict = expected_verdict(row, kind);
    CHECK(told.verdict == verdict);
    CHECK(told.count<flight::evr::TIMEPOINT_COMMANDED>() >= 1);
    CHECK(told.count<flight::evr::TIMEPOINT_VERIFIED>() == (verdict == TimepointVerdict::verified));
    CHECK(told.count<flight::evr::TIMEPOINT_REFUSED>() == (verdict == TimepointVerdict::refused));
    CHECK(told.count<flight::evr::TIMEPOINT_UNVERIFIED>() == (verdict == TimepointVerdict::unverified));
    const bool verified_late = kind == Kind::late || (row.commanded_again && verdict == TimepointVerdict::unverified);
    // A late reply to the stop of UHF comes while the recording is being closed: in time for it or not.
    if (row.timepoint == point::uhf_stop && kind == Kind::late)
        CHECK(told.count<flight::evr::TIMEPOINT_VERIFIED_LATE>() <= 1);
    else
        CHECK(told.count<flight::evr::TIMEPOINT_VERIFIED_LATE>() == verified_late);
    if (kind == Kind::doubled) CHECK(told.told<flight::evr::REPLY_UNEXPECTED>());
    // The tone of what was done is asked for only when it was, as far as anything on board can tell: the device of a
    // claim says so, and a witness bears out what is denied.
    const bool mortar = row.timepoint == point::parachute_deploy;
    const bool witnessed = row.timepoint == point::heatshield_separation || row.timepoint == point::engine_priming ||
                           row.timepoint == point::backshell_separation || row.timepoint == point::rover_separation;
    CHECK(told.count<flight::evr::TIMEPOINT_CONTRADICTED>() ==
          (mortar && (kind == Kind::claims || (kind == Kind::silent))));
    CHECK(told.count<flight::evr::TIMEPOINT_FELT>() == (mortar && (kind == Kind::late || kind == Kind::denies)));
    if (kind != Kind::late)  // there the reply may come first
        CHECK(told.count<flight::evr::TIMEPOINT_WITNESSED>() == (witnessed && kind == Kind::denies));
    const bool done = kind == Kind::late || verified_late || kind == Kind::doubled || kind == Kind::claims ||
                      ((mortar || witnessed) && kind == Kind::denies);
    // Thrusters that the timeline has switched off need not obey, whatever follows.
    const bool landed = flown.judgement.verdict == lands;
    if (row.device != Device::thrusters && (landed || mortar))
        CHECK_FALSE(told.told<flight::evr::THRUSTERS_NOT_FELT>());
    if (landed && row.device != Device::descent_engines && row.timepoint != point::engine_priming)
        CHECK_FALSE(told.told<flight::evr::ENGINES_SILENT>());
    if (spec.tone && !done) CHECK_FALSE(told.tones.contains(spec.tone->value));
    if ((kind != Kind::refuses && kind != Kind::denies) || row.device == Device::descent_engines) return;
    if (row.device == Device::pyro)
        CHECK(told.told<flight::evr::PYRO_REFUSED>());
    else
        CHECK(told.told<flight::evr::DEVICE_REFUSED>());
    if (flown.judgement.verdict == lands && row.device == Device::pyro)
        CHECK(told.tones.contains(flight::tone::pyro_refused.value));
}

/// A line of the table, as the document has it.
void print(const Row& row, Kind kind, const Flown& flown) {
    std::printf("| %s | %s | %s | %s | %s |\n", flight::timeline_specs[row.timepoint.value].name, name_of(kind),
                simulation::name_of(expected(row, kind)), simulation::name_of(flown.judgement.verdict),
                flown.reason.c_str());
}

/// Flies those of the table that `takes(row, kind)` wants, in the order of the timeline.
template <typename Takes>
int fly_table(const Takes& takes, bool printed) {
    const auto triggered = triggered_without_faults();
    Trunk trunk;
    int flown = 0;
    for (const Row& row : rows) {
        trunk.fly_to(triggered.at(row.timepoint.value) - before_s);
        for (const Kind kind : kinds) {
            if (!possible(row, kind) || !takes(row, kind)) continue;
            const Flown one = trunk.with(both_units(row, kind), row.timepoint);
            if (printed) print(row, kind, one);
            check(row, kind, one);
            ++flown;
        }
    }
    return flown;
}

}  // namespace

TEST_CASE("the table of replies has every action for which a device replies", "[faults][R50]") {
    std::set<std::uint16_t> in_table;
    for (const Row& row : rows) in_table.insert(row.timepoint.value);
    for (std::uint16_t i = 0; i < flight::timepoint_count; ++i) {
        const flight::TimepointSpec& spec = flight::timeline_specs[i];
        // Arming is a state of the manager itself, and the recording is EdlComm's: no device can refuse either.
        const bool by_device = spec.reply_timeout_s && spec.action != flight::action_named<"arm_pyros">().run &&
                               spec.action != flight::action_named<"safe_pyros">().run &&
                               spec.action != flight::action_named<"close_recording">().run;
        INFO(spec.name);
        CHECK(in_table.contains(i) == by_device);
    }
}

TEST_CASE("replies that are refused, absent, late, doubled or contradict what was done around the parachute end as the "
          "table says",
          "[faults][R14][R50][release]") {
    const int flown = fly_table(
        [](const Row& row, Kind) {
            return row.timepoint == point::uhf_start || row.timepoint == point::parachute_deploy ||
                   row.timepoint == point::heatshield_separation || row.timepoint == point::backshell_separation ||
                   row.timepoint == point::bridle_cut;
        },
        false);
    CHECK(flown == 30);
}

TEST_CASE("the table of refused and late replies: every action in every way that it can go",
          "[.long][faults][R14][R50]") {
    CHECK(fly_table([](const Row&, Kind) { return true; }, true) >= 160);
}

}  // namespace simulation_reply_table_test
