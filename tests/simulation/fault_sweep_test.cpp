// SPDX-License-Identifier: Apache-2.0
#include "flight/timeline/timepoint.hpp"
#include "generated/dictionary_flight.hpp"
#include "simulation/limits.hpp"
#include "simulation/random.hpp"
#include "telemetry/packet_stream.hpp"
#include "tests/simulation/calm.hpp"
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

// Bounds of docs/faults.md.
constexpr double imu_silence_survived_s = 0.5, imu_silence_in_calm_survived_s = 2.0, radar_silence_survived_s = 20.0,
                 radar_silence_on_parachute_survived_s = 40.0, radar_heard_before_priming_s = 15.0,
                 thrusters_rest_survived_s = 10.0, engines_silence_survived_s = 0.5;

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
    explicit Sound(Landing landing) : calm_(landing) {
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
    double end_s() const { return calm_.end_s(); }
    bool calm(const tests::Silence& silence) const { return calm_.during(silence); }
    /// Whether the fault is there while the row waits for its reply.
    bool meets(const Drawn& drawn, TimepointId id) const {
        const double wait_s = flight::timeline_specs[id.value].reply_timeout_s.value_or(0.0);
        return overlaps(drawn, at(id), at(id) + wait_s);
    }
    static bool overlaps(const Drawn& drawn, double begin_s, double end_s) {
        return drawn.e_s <= end_s + moved_s && drawn.e_s + drawn.length_s >= begin_s - moved_s;
    }
    /// Whether the fault is there as long as the row waits for its reply, and before it.
    bool covers(const Drawn& drawn, TimepointId id) const {
        const double wait_s = flight::timeline_specs[id.value].reply_timeout_s.value_or(0.0);
        return drawn.e_s <= at(id) - moved_s && drawn.e_s + drawn.length_s >= at(id) + wait_s + moved_s;
    }
    /// For how long the fault is there from `begin_s` to `end_s`, at least.
    static double within_s(const Drawn& drawn, double begin_s, double end_s) {
        return std::min(drawn.e_s + drawn.length_s, end_s - moved_s) - std::max(drawn.e_s, begin_s + moved_s);
    }

  private:
    static constexpr double moved_s = 1.0;  // what came before moves what follows by less
    tests::Calm calm_;
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
    case Device::imu:
        return drawn.kind == Kind::silent &&
               drawn.length_s >
                   (sound.calm({drawn.e_s, drawn.length_s}) ? imu_silence_in_calm_survived_s : imu_silence_survived_s);
    case Device::radar: {
        const bool heard_in_time =
            drawn.e_s + drawn.length_s < sound.at(point::engine_priming) - radar_heard_before_priming_s;
        return drawn.length_s > (heard_in_time ? radar_silence_on_parachute_survived_s : radar_silence_survived_s) &&
               Sound::overlaps(drawn, sound.at(point::radar_power), sound.at(point::sky_crane));
    }
    case Device::descent_engines:
        return drawn.length_s > engines_silence_survived_s &&
               Sound::overlaps(drawn, sound.at(point::backshell_separation), sound.at(point::engines_off));
    case Device::thrusters:
        return does_not_act && drawn.length_s > thrusters_rest_survived_s &&
               Sound::overlaps(drawn, sound.at(point::detumble), sound.at(point::backshell_separation));
    case Device::uhf:
    case Device::x_band:
    case Device::rover_imu: return false;
    }
    return false;
}

/// The event that must tell of a fault; none where nothing was asked of the device, or nothing on board can know.
std::optional<EvrId> must_be_told(const Drawn& drawn, const Sound& sound) {
    namespace evr = flight::evr;
    constexpr double told_within_s = 1.0;  // chosen: of what is silent
    constexpr double radar_locks_within_s = 20.0, radar_lost_within_s = 10.0, engines_stop_within_s = 3.0;
    const auto covers = [&](std::initializer_list<TimepointId> rows) {
        return std::ranges::any_of(rows, [&](TimepointId id) { return sound.covers(drawn, id); });
    };
    const auto by_reply = [&](std::initializer_list<TimepointId> rows) -> std::optional<EvrId> {
        if (!covers(rows)) return std::nullopt;
        if (drawn.kind == Kind::silent) return evr::TIMEPOINT_UNVERIFIED::id;
        if (drawn.kind == Kind::refuses || drawn.kind == Kind::denies) return evr::TIMEPOINT_REFUSED::id;
        return std::nullopt;
    };
    switch (drawn.device) {
    case Device::imu:
        if (Sound::within_s(drawn, -880.0, sound.end_s()) < (drawn.kind == Kind::silent ? 0.0 : 2.0)) break;
        if (drawn.kind == Kind::silent) return evr::IMU_SILENT::id;
        if (drawn.kind == Kind::dropout) return evr::IMU_SAMPLES_MISSING::id;
        break;
    case Device::radar:
        if (Sound::within_s(drawn, sound.at(point::heatshield_separation) + radar_locks_within_s,
                            sound.at(point::touchdown)) >= radar_lost_within_s)
            return evr::RADAR_LOST::id;
        break;
    case Device::pyro:
        if (!covers({point::coolant_vent, point::pressurant_valve_1, point::thermal_batteries, point::cruise_cables_cut,
                     point::pressurant_valve_2, point::cruise_stage_separation, point::cruise_balance_1,
                     point::balance_2, point::balance_3, point::parachute_deploy, point::heatshield_separation,
                     point::engine_priming, point::backshell_separation, point::rover_separation, point::bridle_cut}))
            break;
        if (drawn.kind == Kind::silent) return evr::PYRO_CONTROLLER_SILENT::id;
        if (drawn.kind == Kind::refuses || drawn.kind == Kind::denies) return evr::PYRO_CONTROLLER_REFUSED::id;
        break;
    case Device::descent_engines: {
        const double felt_s = Sound::within_s(drawn, sound.at(point::powered_approach), sound.at(point::touchdown));
        if (drawn.kind == Kind::silent && felt_s >= told_within_s) return evr::ENGINES_SILENT::id;
        if (drawn.kind == Kind::refuses && felt_s >= engines_stop_within_s) return evr::REPLY_CONTRADICTS::id;
        break;
    }
    case Device::thrusters:
        if (const auto told = by_reply({point::thrusters_enable, point::detumble, point::thrusters_off})) return told;
        // The vehicle is rolled to lift up, which takes the thrusters.
        if ((drawn.kind == Kind::silent || drawn.kind == Kind::refuses) && drawn.e_s < sound.at(point::sufr) &&
            Sound::within_s(drawn, sound.at(point::sufr), sound.at(point::parachute_deploy)) > 10.0)
            return evr::THRUSTERS_NOT_FELT::id;
        break;
    case Device::power: return by_reply({point::thruster_warm_up, point::radar_power});
    case Device::uhf: return by_reply({point::uhf_start});
    case Device::x_band: return by_reply({point::x_band_tones, point::entry_antenna, point::parachute_antenna});
    case Device::rover_imu: break;
    }
    return std::nullopt;
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
    flown.judgement = tests::judged_held_up(landing);
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
        check(drawn, with(trunk, watch, drawn), may_be_lost(drawn, without), must_be_told(drawn, without));
    }
    CHECK(sound.not_so.empty());
}

/// Returns the number of faults that an event had to tell.
std::size_t check_sweep(std::uint64_t seed, std::size_t count) {
    namespace evr = flight::evr;
    std::size_t flown_ones = 0, excused = 0, demanded = 0;
    sweep(seed, count,
          [&](const Drawn& drawn, const Flown& flown, bool may_be_lost, const std::optional<EvrId>& must_be_told) {
              INFO("seed " << seed << ", " << drawn.text() << ": " << flown.reason);
              const auto told = [&](EvrId id) { return flown.events.contains(id.value); };
              const bool landed = flown.judgement.verdict == Verdict::landed;
              ++flown_ones;
              excused += may_be_lost ? 1U : 0U;
              demanded += must_be_told ? 1U : 0U;
              CHECK_FALSE(told(evr::FATAL_CHECK_FAILED::id));
              CHECK((landed || may_be_lost));
              // What a device claims nobody on board can know better, but of the mortar.
              if (drawn.kind != Kind::claims) CHECK(flown.not_so.empty());
              if (must_be_told) {
                  INFO("event " << must_be_told->value << " must tell it");
                  CHECK(told(*must_be_told));
              }
              if (!landed) return;
              if (drawn.device != Device::thrusters && drawn.device != Device::imu)
                  CHECK_FALSE(told(evr::THRUSTERS_NOT_FELT::id));
              if (drawn.device != Device::descent_engines && drawn.device != Device::pyro)
                  CHECK_FALSE(told(evr::ENGINES_SILENT::id));
          });
    CHECK(2 * excused <= flown_ones);
    return demanded;
}

}  // namespace

TEST_CASE(
    "faults of any unit and kind, at any moment and for any time: what is announced is so, what fails is told, and "
    "the rover lands",
    "[simulation][faults][R27][R50]") {
    check_sweep(1, 8);
}

TEST_CASE("three hundred faults of any unit and kind, at any moment and for any time, end as docs/faults.md says",
          "[.long][simulation][faults][R27][R50]") {
    std::size_t demanded = 0;
    for (std::uint64_t seed = 2; seed <= 4; ++seed) demanded += check_sweep(seed, 100);
    CHECK(demanded > 10);
}

}  // namespace simulation_fault_sweep_test
