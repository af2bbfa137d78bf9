// SPDX-License-Identifier: Apache-2.0
// What a whole landing records and radiates, read back by the ground's own functions.
#include "dictionaries/state_machine_events.hpp"
#include "flight/computer.hpp"
#include "flight/gnc/entry/lateral_logic.hpp"
#include "flight/gnc/mars.hpp"
#include "flight/gnc/navigation/wind_estimate.hpp"
#include "flight/gnc/powered_descent/divert.hpp"
#include "flight/gnc/powered_descent/vertical_profile.hpp"
#include "flight/gnc/triggers/triggers.hpp"
#include "generated/dictionary_flight.hpp"
#include "simulation/entry_reference.hpp"
#include "simulation/landing.hpp"
#include "simulation/world.hpp"
#include "telemetry/explanation.hpp"
#include "telemetry/packet_stream.hpp"
#include "telemetry/product_assembler.hpp"
#include "telemetry/text.hpp"
#include "tests/simulation/gale.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/radiated.hpp"
#include "tests/support/shipped_dictionary.hpp"
#include "tests/support/telecommands.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <set>
#include <vector>

namespace flight_recorded_landing_test {

using namespace aeolis;
using namespace aeolis::flight;

namespace {

using Octets = std::vector<std::uint8_t>;

struct Flown {
    std::vector<Octets> recorded;
    std::vector<Octets> radiated;
    std::vector<ImuSample> imu;
    std::map<std::uint32_t, Sclk> cycle_of_imu;  ///< by the count of the last sample of each cycle
    std::vector<std::pair<Sclk, RadarBeam>> beams;
    std::map<Sclk, ThrusterCommand> pulses;   ///< of the cycles that have any
    std::map<Sclk, EngineCommand> throttles;  ///< while ignited
    std::map<std::string, Sclk> fired;        ///< pyros by channel: when their controller told it
    bool landed = false;
    Computer::Counters counters;
};

/// The channel of PyroStatus that tells a pyro's state: they stand in the order of PyroId.
std::string channel_of(PyroId pyro) {
    return tests::shipped_dictionary().packet("PyroStatus")->fields.at(static_cast<std::size_t>(pyro)).name;
}

void take(std::span<const std::uint8_t> octets, std::vector<Octets>& into) {
    telemetry::PacketStream stream{octets};
    while (const auto packet = stream.next()) into.emplace_back(packet->begin(), packet->end());
    REQUIRE(stream.unreadable_octets() == 0);
}

/// One landing and the half minute after it, flown once for all tests of this file.
const Flown& flown() {
    static const Flown once = [] {
        Flown flown;
        const auto scenario = tests::gale_scenario(900.0);
        simulation::World world{scenario, 1};
        Load load;
        load.entry_reference = simulation::make_entry_reference(scenario);
        Computer computer{load, world.sclk()};
        const auto out = std::make_unique<DeviceOutputs>();
        constexpr std::uint32_t nvm_capacity_octets = 1U << 30;
        std::uint32_t nvm_octets = 0;
        world.set_nvm(nvm_octets, nvm_capacity_octets);
        world.receive(test::set_parameters(world.solution()));
        int after = 0;
        for (int cycle = 0; after < 64 * 30 && cycle < 64 * 1500; ++cycle) {
            if (cycle == 64) world.receive(test::do_edl());
            const DeviceInputs& in = world.sense();
            flown.imu.insert(flown.imu.end(), in.imu.begin(), in.imu.end());
            if (!in.imu.empty()) flown.cycle_of_imu.emplace(in.imu.back().count, in.now);
            for (const RadarBeam& beam : in.radar) flown.beams.emplace_back(in.now, beam);
            for (const PyroReply& reply : in.pyro_replies)
                if (reply.fired) flown.fired.try_emplace(channel_of(reply.pyro), in.now);
            const Sclk now = in.now;
            computer.step(in, *out);
            if (out->thrusters != ThrusterCommand{}) flown.pulses[now] = out->thrusters;
            if (out->engines.ignited) flown.throttles[now] = out->engines;
            take(out->nvm.span(), flown.recorded);
            nvm_octets += static_cast<std::uint32_t>(out->nvm.size());
            world.set_nvm(nvm_octets, nvm_capacity_octets);
            for (auto& packet : test::packets_in_pltus(out->uhf.span())) flown.radiated.push_back(std::move(packet));
            world.advance(*out);
            after += world.outcome() != simulation::Outcome::running;
        }
        flown.landed = world.outcome() == simulation::Outcome::touchdown;
        flown.counters = computer.counters();
        return flown;
    }();
    REQUIRE(once.landed);
    return once;
}

struct Ground {
    const dictionary::Dictionary& dictionary = tests::shipped_dictionary();
    telemetry::Decommutator decommutator{dictionary};
    telemetry::Decoded decoded;

    const std::string& name(const Octets& packet) {
        REQUIRE_FALSE(decommutator.decode(packet, decoded));
        return dictionary.packets[decoded.packet].name;
    }
    double value(const char* field) const {
        const auto index = telemetry::field_index(dictionary.packets[decoded.packet], field);
        REQUIRE(index);
        return decoded.value[*index].value_or(-1.0);
    }
    /// The rows of the recorded tables of one name; each is a packet for name() and value().
    std::vector<Octets> rows(const char* table) {
        std::vector<Octets> all;
        for (const Octets& packet : flown().recorded) {
            if (name(packet) != table) continue;
            const auto rows = telemetry::rows_in(dictionary, decoded, packet);
            REQUIRE(rows);
            all.insert(all.end(), rows->begin(), rows->end());
        }
        return all;
    }
    telemetry::ProductAssembler products(const std::vector<Octets>& packets) {
        telemetry::ProductAssembler assembler;
        for (const Octets& packet : packets)
            if (name(packet) == "DataProduct") {
                const auto part = telemetry::part_of(dictionary, decoded, packet);
                REQUIRE(part);
                CHECK(assembler.add(*part) == telemetry::PartStanding::taken);
            }
        return assembler;
    }
};

float f(double value) {
    return static_cast<float>(value);
}

std::string numbered(const char* before, int number, const char* after) {
    return before + std::to_string(number) + after;
}

}  // namespace

TEST_CASE("all that a landing radiates is in its recording, bit for bit, and nothing waited in vain",
          "[edl_comm][R29][R30]") {
    const std::set<Octets> recorded(flown().recorded.begin(), flown().recorded.end());
    CHECK(recorded.size() == flown().recorded.size());
    for (const Octets& packet : flown().radiated) REQUIRE(recorded.contains(packet));
    Ground ground;
    double dropped = -1.0;
    for (const Octets& packet : flown().recorded)
        if (ground.name(packet) == "CommStatus") dropped = ground.value("uhf_dropped_packets");
    CHECK(dropped == 0.0);  // what the mission's telemetry plan selects fits into 8 kb/s
    CHECK(flown().counters.mailbox_overflows == 0);
    CHECK(flown().counters.unexpected_messages == 0);
}

TEST_CASE("UHF carries channels, events and products, chosen by the state of the vehicle", "[edl_comm][R30][release]") {
    Ground ground;
    // Packets of each name, by the phase in which flight made them.
    std::map<EdlPhase, std::map<std::string, int>> live;
    std::map<double, EdlPhase> phases{{0.0, EdlPhase::pre_edl}};
    for (const Octets& packet : flown().recorded)
        if (ground.name(packet) == "EDL_PHASE_CHANGED")
            phases[ground.decoded.header.time.seconds] = static_cast<EdlPhase>(ground.value("phase"));
    int events = 0;
    for (const Octets& packet : flown().radiated) {
        const std::string& name = ground.name(packet);
        const auto phase = std::prev(phases.upper_bound(ground.decoded.header.time.seconds))->second;
        ++live[phase][name];
        events += ground.dictionary.packets[ground.decoded.packet].event.has_value();
    }
    CHECK(events > 40);
    CHECK(live[EdlPhase::range_control]["GncEntry"] > 50);
    CHECK(live[EdlPhase::range_control]["GncDescent"] == 0);
    CHECK(live[EdlPhase::powered_descent]["GncDescent"] > 50);
    CHECK(live[EdlPhase::powered_descent]["GncEntry"] == 0);
    CHECK(live[EdlPhase::parachute_descent]["DataProduct"] > 90);
    CHECK(live[EdlPhase::range_control]["DataProduct"] == 0);
    CHECK(live[EdlPhase::landed]["GncNavigation"] == 0);
    CHECK(live[EdlPhase::landed]["EdlStatus"] > 0);
    for (const EdlPhase phase : {EdlPhase::range_control, EdlPhase::parachute_descent, EdlPhase::sky_crane}) {
        CHECK(live[phase]["GncNavigation"] > 10);  // attitude among it
        CHECK(live[phase]["GncConfiguration"] > 5);
        CHECK(live[phase]["PyroStatus"] > 5);
        CHECK(live[phase]["ImuTable"] == 0);
    }
}

TEST_CASE("each reading of the IMU, from separation to the end of fly-away, is in the recording bit for bit",
          "[edl_comm][R52]") {
    Ground ground;
    const auto rows = ground.rows("ImuTable");
    REQUIRE(rows.size() > 200 * 1000);
    CHECK(ground.name(rows.front()) == "ImuIncrements");
    auto sensed =
        std::ranges::find(flown().imu, static_cast<std::uint32_t>(ground.value("imu_count")), &ImuSample::count);
    REQUIRE(flown().imu.end() - sensed >= static_cast<std::ptrdiff_t>(rows.size()));
    const auto cycle_of = [](const ImuSample& sample) {
        return flown().cycle_of_imu.lower_bound(sample.count)->second;
    };
    const Sclk first = cycle_of(*sensed), last = cycle_of(*(sensed + static_cast<std::ptrdiff_t>(rows.size()) - 1));
    for (const Octets& row : rows) {
        static_cast<void>(ground.name(row));
        const ImuSample& sample = *sensed++;
        REQUIRE(ground.value("imu_count") == sample.count);
        REQUIRE(f(ground.value("delta_v_x_mps")) == f(sample.delta_v_mps[0]));
        REQUIRE(f(ground.value("delta_v_y_mps")) == f(sample.delta_v_mps[1]));
        REQUIRE(f(ground.value("delta_v_z_mps")) == f(sample.delta_v_mps[2]));
        REQUIRE(f(ground.value("delta_angle_x_rad")) == f(sample.delta_angle_rad[0]));
        REQUIRE(f(ground.value("delta_angle_y_rad")) == f(sample.delta_angle_rad[1]));
        REQUIRE(f(ground.value("delta_angle_z_rad")) == f(sample.delta_angle_rad[2]));
    }
    std::map<std::string, Sclk> told;
    for (const Octets& packet : flown().recorded) told.emplace(ground.name(packet), ground.decoded.header.time);
    INFO(first - told.at("CRUISE_STAGE_SEPARATION") << " " << last - told.at("FLYAWAY_END"));
    // Events are told a few ticks apart from the change of phase that begins and ends the table.
    constexpr double edl_cycle_s = 0.125;
    CHECK(first - told.at("CRUISE_STAGE_SEPARATION") < edl_cycle_s);
    CHECK(told.at("FLYAWAY_END") - last < edl_cycle_s);
}

TEST_CASE("each reading of a radar beam is in the recording, with its tick", "[edl_comm][R52]") {
    Ground ground;
    const auto rows = ground.rows("RadarTable");
    REQUIRE(rows.size() == flown().beams.size());
    REQUIRE(rows.size() > 120 * 60);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        static_cast<void>(ground.name(rows[i]));
        const auto& [at, beam] = flown().beams[i];
        REQUIRE(ground.value("beam_sclk") == at.seconds);
        REQUIRE(ground.value("beam") == beam.beam);
        REQUIRE((ground.value("beam_valid") != 0.0) == beam.valid);
        REQUIRE(f(ground.value("beam_range_m")) == f(beam.range_m));
        REQUIRE(f(ground.value("beam_range_rate_mps")) == f(beam.range_rate_mps));
        REQUIRE(f(ground.value("beam_direction_x")) == f(beam.direction_B[0]));
        REQUIRE(f(ground.value("beam_direction_y")) == f(beam.direction_B[1]));
        REQUIRE(f(ground.value("beam_direction_z")) == f(beam.direction_B[2]));
    }
}

TEST_CASE("each pulse of a thruster and each throttle setting is recorded in its cycle", "[thrusters][edl][R52]") {
    Ground ground;
    std::map<Sclk, std::vector<double>> pulses, throttles;
    Sclk closed;
    for (const Octets& packet : flown().recorded) {
        const std::string& name = ground.name(packet);
        if (name == "RECORDING_CLOSED") closed = ground.decoded.header.time;
        if (name != "ThrusterPulses" && name != "GncDescent") continue;
        std::vector<double> eight;
        for (int i = 1; i <= 8; ++i)
            eight.push_back(ground.value(
                (name == "GncDescent" ? numbered("throttle_", i, "_percent") : numbered("thruster_", i, "_on_us"))
                    .c_str()));
        (name == "GncDescent" ? throttles : pulses)[ground.decoded.header.time] = eight;
    }
    REQUIRE(closed > Sclk{});
    CHECK(flown().pulses.size() > 1000);
    std::size_t compared = 0;
    for (const auto& [at, command] : flown().pulses) {
        if (at >= closed) break;
        ++compared;
        INFO(at.seconds << ", closed at " << closed.seconds);
        REQUIRE(pulses.contains(at));
        for (std::size_t i = 0; i < 8; ++i) REQUIRE(pulses[at][i] == std::round(command.on_s[i] * 1e6));
    }
    CHECK(compared > 1000);
    CHECK(flown().throttles.size() > 64 * 40);
    for (const auto& [at, command] : flown().throttles) {
        REQUIRE(throttles.contains(at));
        for (std::size_t i = 0; i < 8; ++i) REQUIRE(f(throttles[at][i]) == f(command.throttle[i] * 100.0));
    }
}

TEST_CASE(
    "the recording tells what has become of each pyro, switch and valve and when, and as what GNC flew the vehicle",
    "[pyro][edl][R52]") {
    Ground ground;
    std::map<std::string, double> last;
    std::map<std::string, Sclk> fired;
    std::map<std::string, std::map<Sclk, SwitchState>> switched;
    for (const Octets& packet : flown().recorded) {
        const std::string& name = ground.name(packet);
        if (name != "PyroStatus" && name != "PowerStatus" && name != "TelecomStatus" && name != "GncConfiguration" &&
            name != "ThrusterPulses")
            continue;
        const Sclk at = ground.decoded.header.time;
        const auto& fields = ground.dictionary.packets[ground.decoded.packet].fields;
        for (std::size_t i = 0; i < fields.size(); ++i) {
            const std::string& field = fields[i].name;
            const double value = *ground.decoded.value[i];
            last[field] = value;
            if (name == "PyroStatus" && field != "pyro_manager_armed" &&
                static_cast<PyroState>(value) == PyroState::fired)
                fired.try_emplace(field, at);
            if (field.starts_with("switch_")) switched[field][at] = static_cast<SwitchState>(value);
        }
    }
    CHECK(fired.size() == pyro_count);
    CHECK(fired == flown().fired);  // by name and tick
    // Each switch as the timeline leaves it.
    const std::map<std::string, SwitchState> left{{"switch_radar", SwitchState::off},
                                                  {"switch_uhf", SwitchState::off},
                                                  {"switch_descent_imu", SwitchState::on},
                                                  {"switch_entry_antenna", SwitchState::on},
                                                  {"switch_parachute_antenna", SwitchState::on},
                                                  {"switch_thruster_heaters", SwitchState::on},
                                                  {"switch_x_band_tones", SwitchState::on}};
    REQUIRE(left.size() == switch_count);
    for (const auto& [name, state] : left) {
        INFO(name);
        CHECK(static_cast<SwitchState>(last.at(name)) == state);
    }
    const auto first_on = [&](const char* name) {
        for (const auto& [at, state] : switched.at(name))
            if (state == SwitchState::on) return at;
        return Sclk{};
    };
    CHECK(first_on("switch_entry_antenna") < fired.at("pyro_cruise_stage_separation"));
    CHECK(first_on("switch_radar") > fired.at("pyro_parachute_mortar"));
    CHECK(first_on("switch_radar") < fired.at("pyro_heatshield_separation"));
    CHECK(last.contains("thrusters_enabled"));
    for (const char* name : {"cruise_stage_gone", "parachute_out", "heatshield_gone", "backshell_gone",
                             "rover_separated", "touchdown_declared", "bridle_gone", "engines_off"})
        CHECK(last.at(name) == 1.0);
}

TEST_CASE("a pyro that both controllers refuse, or that neither answers, is recorded as that",
          "[pyro][faults][R50][R52]") {
    using Kind = simulation::DeviceFault::Kind;
    for (const auto& [kind, state] :
         {std::pair{Kind::refuses, PyroState::refused}, {Kind::silent, PyroState::unanswered}}) {
        auto scenario = tests::gale_scenario(860.0);
        for (const Unit unit : {Unit::a, Unit::b})
            scenario.device_faults.push_back({Device::pyro, unit, kind, 827.0, 6.0});
        simulation::Landing landing{scenario, 1};
        landing.uplink(test::set_parameters(landing.solution()));
        for (int cycle = 0; cycle < 64; ++cycle) landing.step();
        landing.uplink(test::do_edl());
        while (landing.truth().e_s < -815.0) landing.step();
        std::vector<Octets> packets;
        take(landing.recording(), packets);
        Ground ground;
        PyroState last = PyroState::not_commanded;
        for (const Octets& packet : packets)
            if (ground.name(packet) == "PyroStatus")
                last = static_cast<PyroState>(ground.value(channel_of(PyroId::coolant_vent).c_str()));
        CHECK(last == state);
    }
}

TEST_CASE("a landing records no packet more often than the telemetry plan says, and keeps its budget",
          "[telemetry_plan][R52]") {
    constexpr std::uint64_t periodic_octets_max = 32'000;  // a second; chosen: half of NVM in a quarter of an hour
    constexpr std::uint64_t others_octets_max = 20'000;    // a second; chosen: a part of a data product a cycle, events
    constexpr std::uint64_t landing_octets_max = std::uint64_t{16} << 20;  // chosen: a quarter of NVM
    Ground ground;
    std::map<std::string, std::uint32_t> hz;
    std::uint64_t planned_octets = 0;
    for (const auto& row : ground.dictionary.telemetry_plan) {
        if (row.plan == "wideband") continue;
        hz[row.packet] = row.recorded_hz;
        if (const auto* packet = ground.dictionary.packet(row.packet))
            planned_octets += std::uint64_t{row.recorded_hz} * packet->octets;
    }
    CHECK(planned_octets < periodic_octets_max);
    std::map<std::pair<std::string, double>, std::uint32_t> packets;
    std::map<double, std::uint64_t> periodic_octets, others_octets;
    std::uint64_t octets = 0;
    for (const Octets& packet : flown().recorded) {
        const std::string& name = ground.name(packet);
        const bool event = ground.dictionary.packets[ground.decoded.packet].event.has_value();
        const double second = std::floor(ground.decoded.header.time.seconds);
        const std::uint32_t planned = event ? 0 : hz.at(name);
        (planned > 0 ? periodic_octets : others_octets)[second] += packet.size();
        if (planned > 0) ++packets[{name, second}];
        octets += packet.size();
    }
    constexpr std::uint32_t on_change_max = 4;  // of one second: pyros armed, commanded, fired
    for (const auto& [key, count] : packets) {
        INFO(key.first);
        CHECK(count <= hz.at(key.first) + on_change_max);
    }
    const auto most = [](const std::map<double, std::uint64_t>& by_second) {
        std::uint64_t found = 0;
        for (const auto& [second, recorded] : by_second) found = std::max(found, recorded);
        return found;
    };
    CHECK(most(periodic_octets) <= planned_octets);
    CHECK(most(others_octets) <= others_octets_max);
    CHECK(octets < landing_octets_max);
    CHECK(octets > landing_octets_max / 4);  // the limit says something
}

TEST_CASE("the products of a landing are what flight put in: every firing, and the IMU around the mortar",
          "[products][R30]") {
    Ground ground;
    std::vector<Octets> firings;
    double mortar_s = 0.0;
    for (const Octets& packet : flown().recorded) {
        const std::string& name = ground.name(packet);
        if (name == "TimepointFired")
            firings.emplace_back(packet.begin() + tm_data_offset_octets, packet.end() - packet_crc_octets);
        if (name == "PARACHUTE_DEPLOY") mortar_s = ground.decoded.header.time.seconds;
    }
    const auto recorded = ground.products(flown().recorded);
    REQUIRE(recorded.products().size() == 3);
    std::size_t as_flown_rows = 0;
    bool imu_seen = false;
    for (const auto& [identity, product] : recorded.products()) {
        INFO(telemetry::text_of(identity, product));
        const auto content = product.content(identity);
        REQUIRE(content);
        const auto rows = telemetry::rows_of(ground.dictionary, product.row_apid, *content);
        REQUIRE(rows);
        if (product.kind == "as_flown") {
            as_flown_rows = rows->size();
            Octets flat;
            for (std::size_t i = 0; i < rows->size(); ++i)
                flat.insert(flat.end(), firings[i].begin(), firings[i].end());
            CHECK(*content == flat);
            continue;
        }
        imu_seen = true;
        REQUIRE(product.kind == "imu_burst");
        REQUIRE(rows->size() == 800);
        CHECK(ground.name(rows->front()) == "ImuIncrements");
        const auto first = static_cast<std::uint32_t>(ground.value("imu_count"));
        const auto sensed = std::ranges::find(flown().imu, first, &ImuSample::count);
        REQUIRE(flown().imu.end() - sensed > 800);
        for (std::size_t i = 0; i < rows->size(); ++i) {
            static_cast<void>(ground.name((*rows)[i]));
            const ImuSample& sample = sensed[static_cast<std::ptrdiff_t>(i)];
            REQUIRE(ground.value("imu_count") == sample.count);
            REQUIRE(f(ground.value("delta_v_z_mps")) == f(sample.delta_v_mps[2]));
            REQUIRE(f(ground.value("delta_angle_x_rad")) == f(sample.delta_angle_rad[0]));
        }
    }
    CHECK(imu_seen);
    CHECK(as_flown_rows == timepoint_count);  // of the last product, which was made after the last firing
    CHECK(mortar_s > 0.0);

    // UHF loses nothing here. Products 1 (the IMU burst) and 2 (the firings up to touchdown) come down whole over it.
    const auto live = ground.products(flown().radiated);
    REQUIRE(live.products().size() >= 2);
    for (const auto& [identity, product] : live.products())
        if (identity.id <= 2) CHECK(product.content(identity));
}

TEST_CASE("a landing tells what holds its decisions, live and without flooding the link",
          "[explanation][R38][release]") {
    Ground ground;
    std::map<std::string, int> held;
    std::map<double, int> in_second;
    std::string parachute;
    for (const Octets& packet : flown().radiated) {
        if (ground.name(packet) != "Explanation") continue;
        const auto explanation = telemetry::explain(ground.dictionary, ground.decoded);
        REQUIRE(explanation);
        if (explanation->verdict != "held") continue;
        ++held[explanation->decision];
        CHECK(++in_second[std::floor(ground.decoded.header.time.seconds)] <= 2);
        if (explanation->decision == "parachute_deploy") parachute = explanation->text;
    }
    INFO(parachute);
    CHECK(held["parachute_deploy"] >= 1);
    CHECK_THAT(parachute, Catch::StartsWith("parachute deploy held: speed 4"));
    CHECK_THAT(parachute, Catch::Contains(" m/s > 405.0 m/s"));
    CHECK(held["heatshield"] >= 1);
    int all = 0;
    for (const auto& [decision, count] : held) all += count;
    CHECK(all < 60);  // in a whole landing: only decisions that are near are explained
}

namespace {

struct Range {
    double low = 0.0, high = 0.0;
};
Range exactly(double value) {
    return {value - 1.0e-9, value + 1.0e-9};
}
Range within(double value, double part) {
    return {value - part * std::abs(value), value + part * std::abs(value)};
}

/// What a whole recording tells, by which the conditions of its decisions are judged.
class Recorded {
  public:
    explicit Recorded(const std::vector<Octets>& packets) {
        for (const Octets& packet : packets) take(packet);
    }

    struct Told {
        double sclk = 0.0;
        telemetry::Explanation explanation;
    };
    const std::vector<Told>& decisions() const { return decisions_; }

    /// The mode or phase before a decision; empty before the first change.
    std::string label_before(const std::string& channel, double sclk) const {
        const auto& series = labels_.at(channel);
        const auto after = series.lower_bound(sclk);
        return after == series.begin() ? std::string{} : std::prev(after)->second;
    }

    /// The values that the recording allows for a quantity of a decision; none where it records nothing like it.
    std::optional<Range> allowed(const Told& told, const std::string& quantity) const {
        const double at = told.sclk;
        if (quantity == "time_in_mode_s") return exactly(at - latest(moments_.at("GNC_MODE_CHANGED"), at));
        if (quantity == "time_since_backshell_s") return exactly(at - triggered_.at("backshell_separation"));
        if (quantity == "time_since_parachute_s") return exactly(at - triggered_.at("parachute_deploy"));
        if (quantity == "time_since_reversal_s") return exactly(at - latest(moments_.at("BANK_REVERSAL"), at));
        if (quantity == "reply_wait_s") return exactly(at - triggered_.at(told.explanation.subject));
        if (quantity == "time_since_previous_timepoint_s") return exactly(at - latest(fired_, at));
        // A command's owner decides a cycle or two before the dispatcher explains; entry is kept in ticks.
        const auto nearly = [](double value) { return Range{value - 0.04, value + 0.04}; };
        if (quantity == "time_to_uplinked_entry_s") return nearly(held_.at("entry_sclk") - at);
        if (quantity == "time_to_first_timepoint_s") return nearly(held_.at("entry_sclk") - at - first_on_clock_s);
        if (quantity == "solution_age_s") return nearly(std::abs(held_.at("epoch_sclk") - at));
        if (quantity == "entry_apart_from_navigation_s") return Range{0.0, 1.0 / 64};  // both are ground's, in ticks
        if (quantity == "time_to_backshell_s") {
            const double height_m = near("altitude_m", at).low - held_.at("backshell_altitude_m");
            return within(height_m / near("descent_rate_mps", at).low, 1.0e-4);
        }
        if (quantity == "time_to_parachute_s") {
            const double slowing_mps2 = near("speed_mps", at - 0.5).low - near("speed_mps", at + 0.5).low;
            return within((near("speed_mps", at).low - held_.at("parachute_speed_mps")) / slowing_mps2, 0.05);
        }
        // Touchdown is judged before this cycle's thrust is commanded: by that of the one before.
        if (quantity == "thrust_N") return near("thrust_command_N", at - seconds_per_tick);
        if (quantity == "sidestep_as_planned") return of_sidestep(Quantity::sidestep_as_planned, at);
        if (quantity == "wind_known") return of_sidestep(Quantity::wind_known, at);
        if (quantity == "backshell_nearest_m") return of_sidestep(Quantity::backshell_nearest_m, at);
        if (quantity == "backshell_nearest_opposite_m") return of_sidestep(Quantity::backshell_nearest_opposite_m, at);
        if (facts.contains(quantity)) return exactly(fact_before(quantity, at));
        if (values_.contains(quantity)) return near(quantity, at);
        return std::nullopt;
    }

    /// The bounds that a condition of a decision may have: of parameters as built, of ground's solution, of the sheets,
    /// or what these make of recorded values. Empty: nobody has said which.
    std::vector<Range> bounds(const Told& told, const std::string& quantity) const {
        const Parameters p;
        const auto& b = build_parameters;
        const std::string& decision = told.explanation.decision;
        const double at = told.sclk;
        const auto any = [](std::initializer_list<double> values) {
            std::vector<Range> ranges;
            for (const double value : values) ranges.push_back(exactly(value));
            return ranges;
        };
        if (quantity == "drag_mps2") return any({p.guidance_start_drag_mps2});
        if (quantity == "dynamic_pressure_Pa") return any({p.parachute_pressure_max_Pa});
        if (quantity == "mach") return any({p.parachute_mach_max});
        if (quantity == "time_to_parachute_s") return any({p.sufr_lead_s});
        if (quantity == "sidestep_as_planned" || quantity == "wind_known") return any({0.0, 1.0});
        if (quantity == "backshell_nearest_m") return any({p.divert_clearance_min_m});
        if (quantity == "backshell_nearest_opposite_m")  // the one is compared with the other
            for (const telemetry::Condition& condition : told.explanation.conditions)
                if (condition.quantity == "backshell_nearest_m") return any({condition.value});
        if (quantity == "time_to_backshell_s") return any({p.priming_lead_s});
        if (quantity == "time_since_backshell_s") return any({p.powered_approach_delay_s});
        if (quantity == "time_since_parachute_s") return any({p.heatshield_delay_min_s, p.heatshield_patience_s});
        if (quantity == "time_since_reversal_s") return any({p.reversal_interval_min_s});
        if (quantity == "time_in_mode_s")
            return any({decision == "rover_separation" ? p.sky_crane_settle_s : p.sufr_duration_s});
        if (quantity == "radar_altitude_m") return any({p.radar_altitude_max_m});
        if (quantity == "bank_deg") return any({0.0});
        if (quantity == "bank_command_deg") return any({p.reversal_settled_below_deg});
        if (quantity == "time_to_uplinked_entry_s")
            return any({told.explanation.subject == "EDL_SET_PARAMETERS" ? 0.0 : b.late_cruise_before_entry_s});
        if (quantity == "time_to_first_timepoint_s") return any({b.do_edl_margin_s});
        if (quantity == "solution_age_s") return any({b.solution_age_max_s});
        if (quantity == "entry_apart_from_navigation_s") return any({b.entry_moved_max_s});
        if (quantity == "time_overdue_s") return any({p.held_worth_telling_after_s});
        if (quantity == "parameters_received") return any({1.0});
        if (facts.contains(quantity)) return any({0.0});
        if (quantity == "speed_mps") {
            if (decision == "heading_alignment") return any({p.heading_alignment_speed_mps});
            if (decision == "sufr_start") return any({held_.at("parachute_speed_mps") + p.sufr_near_mps});
            if (decision == "parachute_deploy") return any({held_.at("parachute_speed_mps")});
            if (decision == "heatshield") return any({held_.at("heatshield_speed_mps")});
        }
        if (quantity == "descent_rate_mps") {
            if (decision == "constant_velocity") return any({p.constant_velocity_mps});
            if (decision == "sky_crane") return any({p.sky_crane_descent_rate_mps + p.sky_crane_rate_tolerance_mps});
            return any({1.0});  // guards a division
        }
        if (quantity == "cycles_true") {
            if (decision == "parachute_deploy") return any({p.parachute_cycles});
            if (decision == "backshell") return any({p.backshell_cycles});
            return any({p.touchdown_settle_s * 64.0});
        }
        if (quantity == "altitude_m") {
            if (decision == "sufr_start") return any({p.sufr_altitude_last_m});
            if (decision == "parachute_deploy") return any({held_.at("parachute_altitude_min_m")});
            if (decision == "heatshield") return any({p.heatshield_altitude_min_m});
            if (decision == "constant_velocity") return any({gnc::powered_descent::approach_end_altitude_m(p)});
            const double sinking_mps = near("descent_rate_mps", at).low;
            if (decision == "constant_deceleration")
                return {within(gnc::powered_descent::constant_deceleration_altitude_m(p, sinking_mps), 1.0e-4)};
            if (decision == "backshell")
                return {within(gnc::triggers::backshell_altitude_needed_m(
                                   p, {held_.at("backshell_altitude_m"), held_.at("backshell_speed_mps")}, sinking_mps),
                               1.0e-4)};
        }
        if (quantity == "crossrange_m") {
            std::vector<Range> ranges;
            for (const double sign : {-1.0, 1.0})
                for (const bool saturated : {false, true})
                    ranges.push_back(
                        within(sign * gnc::crossrange_deadband_m(p, near("speed_mps", at).low, saturated), 1.0e-5));
            return ranges;
        }
        if (quantity == "thrust_N") {
            const double stage_kg = near("mass_estimate_kg", at).low - Load{}.rover_mass_kg;
            std::vector<Range> ranges;
            for (const double sign : {-1.0, 1.0})
                ranges.push_back(
                    within((1.0 + sign * p.touchdown_thrust_tolerance) * stage_kg * gnc::mars_weight_mps2, 0.01));
            return ranges;
        }
        const dictionary::TimelineRow* row = nullptr;
        for (const auto& each : ground_.dictionary.timeline)
            if (each.name == told.explanation.subject) row = &each;
        if (row != nullptr && quantity == "reply_wait_s") return any({row->reply_timeout_s.value_or(-1.0)});
        if (row != nullptr && quantity == "time_since_previous_timepoint_s")
            return any({row->minimum_offset_s.value_or(-1.0)});
        return {};
    }

    /// The request of a tone that was sent at that tick; none: it was not.
    struct Request {
        double sclk = 0.0, priority = 0.0;
    };
    std::optional<Request> sent(const std::string& tone, double at) const {
        const auto found = sent_.find({tone, at});
        return found == sent_.end() ? std::nullopt : std::optional{found->second};
    }
    /// Whether some tone that was sent was asked for at that tick.
    bool asked_for(const std::string& tone, double at) const {
        return std::ranges::any_of(
            sent_, [&](const auto& each) { return each.first.first == tone && each.second.sclk == at; });
    }

    /// What a number of the modes or phases is called.
    std::string label(const std::string& channel, double number) const {
        return telemetry::number_text(types_.at(channel), number);
    }

  private:
    void take(const Octets& packet) {
        const std::string& name = ground_.name(packet);
        const double sclk = ground_.decoded.header.time.seconds;
        if (name == "Explanation") {
            decisions_.push_back({sclk, *telemetry::explain(ground_.dictionary, ground_.decoded)});
        } else if (name == "TimepointFired") {
            const auto row = static_cast<std::size_t>(ground_.value("timepoint"));
            triggered_[ground_.dictionary.timeline.at(row).name] = ground_.value("triggered_sclk");
            fired_.insert(ground_.value("fired_sclk"));
        } else if (name == "ToneSelected") {
            const auto& tone = ground_.dictionary.tones.at(static_cast<std::size_t>(ground_.value("tone")));
            sent_[{tone.name, ground_.value("started_sclk")}] = {ground_.value("requested_sclk"),
                                                                 ground_.value("priority")};
        } else if (name == "BANK_REVERSAL" || name == "GNC_MODE_CHANGED") {
            moments_[name].insert(sclk);
        }
        const auto& fields = ground_.dictionary.packets[ground_.decoded.packet].fields;
        for (std::size_t i = 0; i < fields.size(); ++i) {
            const std::optional<double> value = ground_.decoded.value[i];
            if (!value) continue;
            if (name == "GncNavigation" || name == "GncEntry" || name == "GncDescent" || name == "GncRadar" ||
                name == "GncImu" || name == "EdlStatus" || name == "GncConfiguration")
                values_[fields[i].name][sclk] = *value;
            if (name == "ParametersHeld") held_[fields[i].name] = *value;
            if (name == "GNC_MODE_CHANGED" && fields[i].name == "gnc_mode")
                note("gnc_mode", sclk, fields[i].type, *value);
            if (name == "EDL_PHASE_CHANGED" && fields[i].name == "phase")
                note("edl_phase", sclk, fields[i].type, *value);
        }
    }
    void note(const char* channel, double sclk, const dictionary::Type& type, double value) {
        types_[channel] = type;
        labels_[channel][sclk] = telemetry::number_text(type, value);
    }

    gnc::Vector3 vector_at(const std::string& name, const char* unit, double at) const {
        gnc::Vector3 v;
        for (const int i : {0, 1, 2})
            v[i] = std::prev(values_.at(name + "_" + "xyz"[i] + unit).upper_bound(at))->second;
        return v;
    }

    /// The wind that the recording shows: of the pull of the parachute it holds every fourth cycle.
    std::optional<gnc::Vector3> wind_M(double at) const {
        gnc::WindEstimate wind;
        const auto& locked = values_.at("radar_locked");
        const auto first = std::ranges::find_if(locked, [](const auto& each) { return each.second == 1.0; });
        REQUIRE(first != locked.end());
        const auto& ticks = values_.at("nav_velocity_x_mps");
        for (auto tick = ticks.lower_bound(first->first); tick->first < at; ++tick) {
            const double sclk = tick->first;
            if (label_before("gnc_mode", sclk) != "parachute_descent") continue;
            const auto part = [&](const char* of) { return values_.at(std::string{"nav_attitude_"} + of).at(sclk); };
            const gnc::Quaternion q_MB{part("w"), part("x"), part("y"), part("z")};
            wind.on(Parameters{}, vector_at("nav_position", "_m", sclk).normalized(),
                    vector_at("nav_velocity", "_mps", sclk), q_MB * vector_at("acceleration", "_mps2", sclk));
        }
        return wind.wind_M(Parameters{}, vector_at("nav_position", "_m", at).normalized());
    }

    static constexpr double wind_recorded_within = 4.0e-3;  ///< of the backshell's distance, by that wind

    /// What the choice of the sidestep's side compares, by the navigated state of that cycle and the wind.
    std::optional<Range> of_sidestep(Quantity quantity, double at) const {
        namespace powered_descent = gnc::powered_descent;
        const gnc::Vector3 p_M = vector_at("nav_position", "_m", at), v_M = vector_at("nav_velocity", "_mps", at);
        const gnc::Vector3 up = p_M.normalized();
        const double sinking_mps = near("descent_rate_mps", at).low;
        const Parameters p;
        const Load load;
        powered_descent::ApproachProfile approach;
        approach.start(p, near("altitude_m", at).low, sinking_mps);
        const auto chosen = powered_descent::choose_sidestep(
            p, load.divert_m * powered_descent::azimuth_direction(p_M, load.divert_azimuth_deg * gnc::degree),
            v_M - v_M.dot(up) * up, wind_M(at), (sinking_mps - p.constant_velocity_mps) / approach.deceleration_mps2());
        for (const auto& condition : chosen.conditions)
            if (condition.quantity == quantity) return within(condition.value, wind_recorded_within);
        return std::nullopt;
    }

    static double latest(const std::set<double>& moments, double before) {
        const auto after = moments.lower_bound(before);
        REQUIRE(after != moments.begin());
        return *std::prev(after);
    }

    /// A fact as it was recorded last before a command about it came. Nothing is recorded of what has not begun.
    double fact_before(const std::string& fact, double at) const {
        const auto series = values_.find(fact);
        if (series == values_.end()) return 0.0;
        const auto after = series->second.lower_bound(at);
        return after == series->second.begin() ? 0.0 : std::prev(after)->second;
    }

    /// The value of that cycle, recorded in single precision; where it has none, between the samples around it.
    Range near(const std::string& channel, double at) const {
        const auto& series = values_.at(channel);
        const auto after = series.lower_bound(at);
        const bool same = after != series.end() && after->first == at;
        REQUIRE((same || after != series.begin()));
        const double before = same ? after->second : std::prev(after)->second;
        const double next = after != series.end() ? after->second : before;
        const double slack = (same ? 1.0e-6 : 0.02) * std::max(std::abs(before), std::abs(next)) + 1.0e-6;
        return {std::min(before, next) - slack, std::max(before, next) + slack};
    }

    /// Facts that a command is judged by.
    static inline const std::set<std::string> facts{"parameters_received", "edl_enabled", "fault_inhibit",
                                                    "gnc_enabled"};
    /// From entry: the first row on the clock, at 828 s, and before it two rows of 2 s that wait for a reply of 4 s.
    static constexpr double first_on_clock_s = 840.0;

    Ground ground_;
    std::vector<Told> decisions_;
    std::map<std::string, std::map<double, double>> values_;
    std::map<std::string, double> held_, triggered_;
    std::map<std::string, std::set<double>> moments_;
    std::map<std::string, std::map<double, std::string>> labels_;
    std::map<std::string, dictionary::Type> types_;
    std::map<std::pair<std::string, double>, Request> sent_;
    std::set<double> fired_;
};

/// Counts of cycles, which the recording does not hold, and what is a name.
const std::set<std::string> not_recorded{"cycles_true", "bank_command_deg"};

bool holds_as_told(const telemetry::Condition& condition) {
    const auto& [quantity, value, comparison, bound, holds] = condition;
    if (comparison == "<") return holds == (value < bound);
    if (comparison == "<=") return holds == (value <= bound);
    if (comparison == ">=") return holds == (value >= bound);
    if (comparison == ">") return holds == (value > bound);
    return comparison == "==" && holds == (value == bound);
}

const telemetry::Condition* condition_of(const telemetry::Explanation& explanation, std::string_view quantity) {
    const auto found = std::ranges::find(explanation.conditions, quantity, &telemetry::Condition::quantity);
    return found == explanation.conditions.end() ? nullptr : &*found;
}

/// The change is a row of state_machines.csv.
void check_change(const Recorded& recorded, const telemetry::Explanation& explanation, const char* machine) {
    const auto& dictionary = tests::shipped_dictionary();
    const auto table = std::ranges::find(dictionary.state_machines, machine, &dictionary::StateMachineTable::name);
    REQUIRE(table != dictionary.state_machines.end());
    const bool is_mode = explanation.decision == "gnc_mode";
    const auto* from = condition_of(explanation, is_mode ? "previous_mode" : "previous_phase");
    const auto* event = condition_of(explanation, is_mode ? "mode_event" : "phase_event");
    REQUIRE((from != nullptr && event != nullptr));
    const std::string name = dictionary::events_of(*table).at(static_cast<std::size_t>(event->value));
    CHECK(std::ranges::any_of(table->transitions, [&](const dictionary::StateTransition& row) {
        return row.from == recorded.label(explanation.decision, from->value) && row.event == name &&
               row.to == explanation.subject;
    }));
}

/// The requests of tones are recorded with those that are sent.
void check_tone(const Recorded& recorded, const Recorded::Told& told) {
    const auto& tones = tests::shipped_dictionary().tones;
    const telemetry::Explanation& explanation = told.explanation;
    const auto spec = std::ranges::find(tones, explanation.subject, &dictionary::ToneRow::name);
    REQUIRE(spec != tones.end());
    const auto* age = condition_of(explanation, "request_age_s");
    REQUIRE(age != nullptr);
    if (const auto* by = condition_of(explanation, "overtaking_tone")) {
        CHECK(explanation.verdict == "dropped");
        const std::string& other = tones.at(static_cast<std::size_t>(by->value)).name;
        CHECK(tones.at(static_cast<std::size_t>(by->value)).supersedes == explanation.subject);
        CHECK(recorded.asked_for(other, told.sclk));
        CHECK(age->bound == spec->expires_s);
        return;
    }
    if (explanation.verdict == "dropped") {
        CHECK_FALSE(age->holds);
        CHECK(age->bound == spec->expires_s);
        CHECK(age->value <= age->bound + seconds_per_tick);
        return;
    }
    CHECK(explanation.verdict == "chosen");
    const auto sent = recorded.sent(explanation.subject, told.sclk);
    REQUIRE(sent);
    CHECK(age->value == told.sclk - sent->sclk);
    const auto* priority = condition_of(explanation, "tone_priority");
    const auto* next = condition_of(explanation, "next_tone");
    REQUIRE((priority != nullptr && next != nullptr));
    CHECK(priority->value == sent->priority);
    CHECK(priority->bound == tones.at(static_cast<std::size_t>(next->value)).priority);
    if (priority->value > priority->bound) CHECK(age->bound == spec->expires_s);
}

}  // namespace

TEST_CASE("each decision of a landing is explained by the values that its recording has for that cycle, and the bounds "
          "that it is decided by",
          "[explanation][R38][release]") {
    const Recorded recorded{flown().recorded};
    std::set<std::string> explained;
    std::map<std::string, std::pair<double, std::string>> changed;  // by decision: when, and to what
    int checked = 0, bounds_checked = 0, tones_checked = 0;
    for (const Recorded::Told& told : recorded.decisions()) {
        const telemetry::Explanation& explanation = told.explanation;
        INFO(told.sclk << " " << explanation.text);
        explained.insert(explanation.decision);
        CHECK_FALSE(explanation.conditions.empty());
        CHECK(std::ranges::all_of(explanation.conditions, holds_as_told));
        if (explanation.decision == "tone") {
            check_tone(recorded, told);
            ++tones_checked;
            continue;
        }
        const auto holds = [](const telemetry::Condition& condition) { return condition.holds; };
        CHECK(std::ranges::all_of(explanation.conditions, holds) == (explanation.verdict != "held"));
        if (explanation.decision == "gnc_mode" || explanation.decision == "edl_phase") {
            const bool is_mode = explanation.decision == "gnc_mode";
            check_change(recorded, explanation, is_mode ? "GncMode" : "EdlPhase");
            // Of two changes in one cycle the first leads to the second, and only the second is recorded.
            auto& [at, to] = changed[explanation.decision];
            const std::string before = at == told.sclk ? to : recorded.label_before(explanation.decision, told.sclk);
            const auto* from = condition_of(explanation, is_mode ? "previous_mode" : "previous_phase");
            if (!before.empty()) CHECK(recorded.label(explanation.decision, from->value) == before);
            at = told.sclk;
            to = explanation.subject;
        }
        for (const telemetry::Condition& condition : explanation.conditions) {
            const std::string& quantity = condition.quantity;
            INFO(quantity << " " << condition.value << " " << condition.comparison << " " << condition.bound);
            if (quantity.starts_with("previous_") || quantity.ends_with("_event")) continue;  // names, checked above
            const auto is_in = [](double value) {
                return [value](const Range& range) { return value >= range.low && value <= range.high; };
            };
            if (const auto range = recorded.allowed(told, quantity)) {
                INFO("allowed " << range->low << " to " << range->high);
                CHECK(is_in(condition.value)(*range));
                ++checked;
            } else {
                CHECK(not_recorded.contains(quantity));
            }
            CHECK(std::ranges::any_of(recorded.bounds(told, quantity), is_in(condition.bound)));
            ++bounds_checked;
        }
    }
    CHECK(checked > 60);
    CHECK(bounds_checked > checked);
    CHECK(tones_checked > 8);
    // Decisions that a faultless landing does not take have tests of their own.
    const std::set<std::string> of_faults{"sub_constraint", "radar_solution", "stand_by", "take_over", "device_lost"};
    for (const dictionary::OwnerRow& owner : tests::shipped_dictionary().owners) {
        if (owner.kind != dictionary::OwnerRow::Kind::decision || of_faults.contains(owner.name)) continue;
        INFO(owner.name);
        CHECK(explained.contains(owner.name));
    }
}

}  // namespace flight_recorded_landing_test
