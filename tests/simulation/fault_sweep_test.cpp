// SPDX-License-Identifier: Apache-2.0
#include "flight/timeline/timepoint.hpp"
#include "generated/dictionary_flight.hpp"
#include "simulation/limits.hpp"
#include "simulation/random.hpp"
#include "telemetry/packet_stream.hpp"
#include "tests/simulation/gale.hpp"
#include "tests/simulation/judged.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/telecommands.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <initializer_list>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace simulation_fault_sweep_test {

// Any unit, any kind of fault, at any moment, for any time: what is announced is so, what fails is told, and the rover
// lands where docs/faults.md does not say why it cannot.
using namespace aeolis;
using namespace aeolis::simulation;
using flight::Device;
using flight::Unit;
using Kind = DeviceFault::Kind;

namespace {

constexpr std::array device_names{"radar", "imu", "pyro", "descent_engines", "thrusters", "power", "uhf", "x_band"};
constexpr std::array kind_names{"silent", "refuses", "late", "dropout", "doubled", "claims", "denies"};

constexpr double imu_silence_survived_s = 0.5, radar_silence_survived_s = 20.0, thrusters_rest_survived_s = 10.0;

struct Drawn {
    Device device{};
    bool both = false;  ///< units; else the one selected
    Kind kind{};
    double e_s = 0.0, length_s = 0.0;

    std::string text() const {
        std::array<char, 120> line{};
        std::snprintf(line.data(), line.size(), "%s %s %s from E%+.2f for %.2f s",
                      device_names[static_cast<std::size_t>(device)], both ? "both" : "a",
                      kind_names[static_cast<std::size_t>(kind)], e_s, length_s);
        return line.data();
    }
};

/// Whether a scenario may have it.
bool possible(const Drawn& drawn) {
    Scenario scenario = tests::gale_scenario(900.0);
    scenario.device_faults = {{drawn.device, Unit::a, drawn.kind, 0.0, 1.0}};
    return impossible_values(scenario).empty();
}

/// Half of the moments at any time, half where the vehicle does most: by cruise-stage separation, and from SUFR on.
std::vector<Drawn> drawn_faults(std::uint64_t seed, std::size_t count) {
    Random random{seed, 0, Stream::devices};
    std::vector<Drawn> all;
    while (all.size() < count) {
        Drawn one;
        one.device = static_cast<Device>(random.bits() % flight::redundant_device_count);
        one.kind = static_cast<Kind>(random.bits() % kind_names.size());
        one.both = random.bits() % 2 == 0;
        const double part = random.uniform();
        one.e_s = random.bits() % 2 == 0   ? -880.0 + 1320.0 * part
                  : random.bits() % 4 == 0 ? -620.0 + 110.0 * part
                                           : 230.0 + 215.0 * part;
        one.e_s = std::floor(64.0 * one.e_s) / 64.0;
        constexpr double shortest_s = 0.125, longest_s = 60.0;
        one.length_s = shortest_s * std::pow(longest_s / shortest_s, random.uniform());
        if (possible(one)) all.push_back(one);
    }
    std::ranges::sort(all, {}, &Drawn::e_s);
    return all;
}

/// When each timepoint is triggered without faults, in seconds from entry.
class Sound {
  public:
    explicit Sound(Landing landing) {
        const double to_e_s = landing.truth().e_s - landing.sclk().seconds;
        while (landing.outcome() == Outcome::running) landing.step();
        telemetry::PacketStream packets{landing.recording()};
        while (const auto packet = packets.next()) {
            if (read_primary_header(*packet)->apid != flight::packet::TimepointFired::apid) continue;
            BitReader in{packet->subspan(tm_data_offset_octets)};
            const auto row = static_cast<std::uint16_t>(in.get(16));
            triggered_[row] = in.get_double() + to_e_s;
        }
    }
    double at(TimepointId id) const { return triggered_.at(id.value); }
    /// Whether the fault is there while the row waits for its reply.
    bool meets(const Drawn& drawn, TimepointId id) const {
        const double wait_s = flight::timeline_specs[id.value].reply_timeout_s.value_or(0.0);
        return overlaps(drawn, at(id), at(id) + wait_s);
    }
    static bool overlaps(const Drawn& drawn, double begin_s, double end_s) {
        constexpr double margin_s = 1.0;  // what came before moves what follows by less
        return drawn.e_s <= end_s + margin_s && drawn.e_s + drawn.length_s >= begin_s - margin_s;
    }

  private:
    std::map<std::uint16_t, double> triggered_;
};

namespace point = flight::timepoint;

/// Whether docs/faults.md, or the table of replies, says that this may not be survived.
bool may_be_lost(const Drawn& drawn, const Sound& sound) {
    const bool does_not_act = drawn.kind == Kind::silent || drawn.kind == Kind::refuses || drawn.kind == Kind::claims;
    const auto meets = [&](std::initializer_list<TimepointId> rows) {
        return std::ranges::any_of(rows, [&](TimepointId id) { return sound.meets(drawn, id); });
    };
    switch (drawn.device) {
    case Device::pyro:
        return drawn.both && does_not_act &&
               meets({point::cruise_stage_separation, point::cruise_balance_1, point::cruise_balance_2,
                      point::parachute_deploy, point::heatshield_separation, point::engine_priming,
                      point::backshell_separation, point::rover_separation, point::bridle_cut});
    case Device::power: return does_not_act && meets({point::radar_power});
    case Device::imu: return drawn.kind == Kind::silent && drawn.length_s > imu_silence_survived_s;
    case Device::radar:
        return drawn.length_s > radar_silence_survived_s &&
               Sound::overlaps(drawn, sound.at(point::radar_power), sound.at(point::sky_crane));
    case Device::descent_engines:
        return Sound::overlaps(drawn, sound.at(point::backshell_separation), sound.at(point::engines_off));
    case Device::thrusters:
        return does_not_act && drawn.length_s > thrusters_rest_survived_s &&
               Sound::overlaps(drawn, sound.at(point::detumble), sound.at(point::backshell_separation));
    case Device::uhf:
    case Device::x_band:
    case Device::rover_imu: return false;
    }
    return false;
}

/// What is announced of a device, and what must have happened by then.
struct Announced {
    std::optional<ToneId> tone;
    std::optional<EvrId> event;
    const char* truth;
};
const std::array announcements{
    Announced{flight::tone::cruise_stage_separation, flight::evr::CRUISE_STAGE_SEPARATION::id,
              "cruise_stage_separation"},
    Announced{flight::tone::parachute_deploy, {}, "parachute_deploy"},
    Announced{flight::tone::heatshield_separation, {}, "heatshield_separation"},
    Announced{flight::tone::engine_priming, {}, "engine_priming"},
    Announced{flight::tone::backshell_separation, {}, "backshell_separation"},
    Announced{flight::tone::rover_separation, {}, "rover_separation"},
    Announced{{}, flight::evr::BRIDLE_CUT::id, "bridle_cut"},
};

struct Flown {
    Judgement judgement;
    std::string reason;
    std::vector<std::string> not_so;  ///< announcements before what they announce
    std::set<std::uint16_t> events;   ///< since the fault
};

class Watch {
  public:
    void step(Landing& landing, Flown& flown) {
        const CycleReport& report = landing.step();
        for (const TruthEvent& event : report.events) happened_.insert(event.name);
        telemetry::PacketStream packets{report.recorded};
        while (const auto packet = packets.next()) {
            const Apid apid = read_primary_header(*packet)->apid;
            const auto first = [&](unsigned bits) { return read_bits(*packet, tm_data_offset_octets * 8, bits); };
            if (apid == flight::packet::ToneSelected::apid) {
                const ToneId tone{static_cast<std::uint8_t>(first(8))};
                judge_announced([&](const Announced& each) { return each.tone == tone; }, flown);
            }
            if (apid != flight::evr::TIMEPOINT_VERIFIED::apid) continue;
            const EvrId id{static_cast<std::uint16_t>(first(16))};
            judge_announced([&](const Announced& each) { return each.event == id; }, flown);
            if (id == flight::evr::TOUCHDOWN::id && !landing.touchdown()) flown.not_so.emplace_back("touchdown");
            flown.events.insert(id.value);
        }
    }

  private:
    template <typename Is>
    void judge_announced(const Is& is, Flown& flown) {
        for (const Announced& each : announcements)
            if (is(each) && !happened_.contains(each.truth)) flown.not_so.emplace_back(each.truth);
    }
    std::set<std::string> happened_;
};

Flown with(Landing landing, Watch watch, const Drawn& drawn) {
    Flown flown;
    for (const Unit unit : {Unit::a, Unit::b})
        if (unit == Unit::a || drawn.both)
            landing.inject(DeviceFault{drawn.device, unit, drawn.kind, 0.0, drawn.length_s});
    while (landing.outcome() == Outcome::running) watch.step(landing, flown);
    flown.judgement = tests::judged(landing);
    flown.reason = reason_of(landing, flown.judgement);
    return flown;
}

template <typename Check>
void sweep(std::uint64_t seed, std::size_t count, const Check& check) {
    Landing trunk{tests::gale_scenario(900.0), seed};
    trunk.uplink(test::set_parameters(trunk.solution()));
    Watch watch;
    Flown sound;
    for (int i = 0; i < 64; ++i) watch.step(trunk, sound);
    trunk.uplink(test::do_edl());
    const Sound without{trunk};
    for (const Drawn& drawn : drawn_faults(seed, count)) {
        while (trunk.truth().e_s < drawn.e_s && trunk.outcome() == Outcome::running) watch.step(trunk, sound);
        if (trunk.outcome() != Outcome::running) break;
        check(drawn, with(trunk, watch, drawn), may_be_lost(drawn, without));
    }
    CHECK(sound.not_so.empty());
}

/// Whether anything was told that a controller would look into.
bool is_told(const Flown& flown) {
    namespace evr = flight::evr;
    constexpr std::array tells{evr::IMU_SILENT::id,
                               evr::IMU_SAMPLES_MISSING::id,
                               evr::ATTITUDE_LOST::id,
                               evr::RADAR_LOST::id,
                               evr::PROPELLANT_LOW::id,
                               evr::DEVICE_REFUSED::id,
                               evr::REPLY_CONTRADICTS::id,
                               evr::PYRO_CONTROLLER_REFUSED::id,
                               evr::PYRO_CONTROLLER_SILENT::id,
                               evr::PYRO_REFUSED::id,
                               evr::TIMEPOINT_REFUSED::id,
                               evr::TIMEPOINT_UNVERIFIED::id,
                               evr::TIMEPOINT_CONTRADICTED::id,
                               evr::THRUSTERS_NOT_FELT::id,
                               evr::ENGINES_SILENT::id};
    return std::ranges::any_of(tells, [&](EvrId id) { return flown.events.contains(id.value); });
}

void check_sweep(std::uint64_t seed, std::size_t count) {
    sweep(seed, count, [&](const Drawn& drawn, const Flown& flown, bool may_be_lost) {
        INFO("seed " << seed << ", " << drawn.text() << ": " << flown.reason);
        CHECK(flown.events.count(flight::evr::FATAL_CHECK_FAILED::id.value) == 0);
        const bool landed = flown.judgement.verdict == Verdict::landed;
        CHECK((landed || may_be_lost));
        // What a device claims nobody on board can know better, but of the mortar.
        if (drawn.kind != Kind::claims) CHECK(flown.not_so.empty());
        if (!landed && drawn.kind != Kind::claims) CHECK(is_told(flown));
    });
}

}  // namespace

TEST_CASE(
    "faults of any unit and kind, at any moment and for any time: what is announced is so, what fails is told, and "
    "the rover lands",
    "[simulation][faults][R27][R50]") {
    check_sweep(1, 16);
}

TEST_CASE("three hundred faults of any unit and kind, at any moment and for any time, end as docs/faults.md says",
          "[.long][simulation][faults][R27][R50]") {
    for (std::uint64_t seed = 2; seed <= 4; ++seed) check_sweep(seed, 100);
}

}  // namespace simulation_fault_sweep_test
