// SPDX-License-Identifier: Apache-2.0
// What a whole landing records and radiates, read back by the ground's own functions.
#include "flight/computer.hpp"
#include "generated/dictionary_flight.hpp"
#include "simulation/entry_reference.hpp"
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
    std::vector<std::pair<Sclk, RadarBeam>> beams;
    std::map<Sclk, ThrusterCommand> pulses;   ///< of the cycles that have any
    std::map<Sclk, EngineCommand> throttles;  ///< while ignited
    bool landed = false;
    Computer::Counters counters;
};

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
        world.set_nvm(0, 1U << 30);
        world.receive(test::set_parameters(world.solution()));
        int after = 0;
        for (int cycle = 0; after < 64 * 30 && cycle < 64 * 1500; ++cycle) {
            if (cycle == 64) world.receive(test::do_edl());
            const DeviceInputs& in = world.sense();
            flown.imu.insert(flown.imu.end(), in.imu.begin(), in.imu.end());
            for (const RadarBeam& beam : in.radar) flown.beams.emplace_back(in.now, beam);
            const Sclk now = in.now;
            computer.step(in, *out);
            if (out->thrusters != ThrusterCommand{}) flown.pulses[now] = out->thrusters;
            if (out->engines.ignited) flown.throttles[now] = out->engines;
            take(out->nvm.span(), flown.recorded);
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
    Sclk last, landed;
    for (const Octets& packet : flown().recorded) {
        const std::string& name = ground.name(packet);
        if (name == "ImuTable") last = ground.decoded.header.time;
        if (name == "FLYAWAY_START") landed = ground.decoded.header.time;
    }
    REQUIRE(landed > Sclk{});
    CHECK(last > landed);
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

TEST_CASE("the recording tells what has become of each pyro, switch and valve, and as what GNC flew the vehicle",
          "[pyro][edl][R52]") {
    Ground ground;
    std::map<std::string, double> last;
    for (const Octets& packet : flown().recorded) {
        const std::string& name = ground.name(packet);
        if (name != "PyroStatus" && name != "PowerStatus" && name != "TelecomStatus" && name != "GncConfiguration" &&
            name != "ThrusterPulses")
            continue;
        const auto& fields = ground.dictionary.packets[ground.decoded.packet].fields;
        for (std::size_t i = 0; i < fields.size(); ++i) last[fields[i].name] = *ground.decoded.value[i];
    }
    int pyros = 0;
    for (const auto& [name, value] : last)
        if (name.starts_with("pyro_") && name != "pyro_manager_armed") {
            INFO(name);
            ++pyros;
            CHECK(static_cast<PyroState>(value) == PyroState::fired);
        }
    CHECK(pyros == static_cast<int>(pyro_count));
    CHECK(static_cast<SwitchState>(last.at("switch_descent_imu")) == SwitchState::on);
    CHECK(static_cast<SwitchState>(last.at("switch_parachute_antenna")) == SwitchState::on);
    CHECK(static_cast<SwitchState>(last.at("switch_uhf")) == SwitchState::off);
    CHECK(last.contains("thrusters_enabled"));
    for (const char* name : {"cruise_stage_gone", "parachute_out", "heatshield_gone", "backshell_gone",
                             "rover_separated", "touchdown_declared", "bridle_gone", "engines_off"})
        CHECK(last.at(name) == 1.0);
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

    struct Range {
        double low = 0.0, high = 0.0;
    };
    /// The values that the recording allows for a quantity of a decision; none where it records nothing like it.
    std::optional<Range> allowed(const Told& told, const std::string& quantity) const {
        const double at = told.sclk;
        const auto exactly = [](double value) { return Range{value - 1.0e-9, value + 1.0e-9}; };
        if (quantity == "time_in_mode_s") return exactly(at - latest(moments_.at("GNC_MODE_CHANGED"), at));
        if (quantity == "time_since_backshell_s") return exactly(at - triggered_.at("backshell_separation"));
        if (quantity == "time_since_parachute_s") return exactly(at - triggered_.at("parachute_deploy"));
        if (quantity == "time_since_reversal_s") return exactly(at - latest(moments_.at("BANK_REVERSAL"), at));
        if (quantity == "reply_wait_s") return exactly(at - triggered_.at(told.explanation.subject));
        if (quantity == "time_since_previous_timepoint_s") return exactly(at - latest(fired_, at));
        // A command's owner decides a cycle or two before the dispatcher explains; entry is kept in ticks.
        const auto nearly = [](double value) { return Range{value - 0.04, value + 0.04}; };
        if (quantity == "time_to_entry_s") return nearly(held_.at("entry_sclk") - at);
        if (quantity == "solution_age_s") return nearly(std::abs(held_.at("epoch_sclk") - at));
        if (quantity == "time_to_backshell_s") {
            const double height_m = near("altitude_m", at).low - held_.at("backshell_altitude_m");
            const double left_s = height_m / near("descent_rate_mps", at).low;
            return Range{left_s - 1.0e-3, left_s + 1.0e-3};
        }
        // Touchdown is judged before this cycle's thrust is commanded: by that of the one before.
        if (quantity == "thrust_N") return near("thrust_command_N", at - seconds_per_tick);
        if (values_.contains(quantity)) return near(quantity, at);
        return std::nullopt;
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
        } else if (name == "BANK_REVERSAL" || name == "GNC_MODE_CHANGED") {
            moments_[name].insert(sclk);
        }
        const auto& fields = ground_.dictionary.packets[ground_.decoded.packet].fields;
        for (std::size_t i = 0; i < fields.size(); ++i) {
            const std::optional<double> value = ground_.decoded.value[i];
            if (!value) continue;
            if (name == "GncNavigation" || name == "GncEntry" || name == "GncDescent" || name == "GncRadar")
                values_[fields[i].name][sclk] = *value;
            if (name == "ParametersHeld") held_[fields[i].name] = *value;
            if (name == "GNC_MODE_CHANGED" && fields[i].name == "gnc_mode")
                labels_["gnc_mode"][sclk] = telemetry::number_text(fields[i].type, value);
            if (name == "EDL_PHASE_CHANGED" && fields[i].name == "phase")
                labels_["edl_phase"][sclk] = telemetry::number_text(fields[i].type, value);
        }
    }

    static double latest(const std::set<double>& moments, double before) {
        const auto after = moments.lower_bound(before);
        REQUIRE(after != moments.begin());
        return *std::prev(after);
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

    Ground ground_;
    std::vector<Told> decisions_;
    std::map<std::string, std::map<double, double>> values_;
    std::map<std::string, double> held_, triggered_;
    std::map<std::string, std::set<double>> moments_;
    std::map<std::string, std::map<double, std::string>> labels_;
    std::set<double> fired_;
};

/// Quantities that this test does not hold against the recording: facts and counts of the moment, and what a cycle derives.
const std::set<std::string> not_recorded{"cycles_true",
                                         "time_to_parachute_s",
                                         "bank_command_deg",
                                         "time_overdue_s",
                                         "entry_apart_from_navigation_s",
                                         "gnc_enabled",
                                         "time_to_first_timepoint_s",
                                         "fault_inhibit",
                                         "edl_enabled",
                                         "parameters_received",
                                         "restart_pending",
                                         "radar_locked",
                                         "mode_event",
                                         "phase_event"};

}  // namespace

TEST_CASE("each decision of a landing is explained by the values that its recording has for that cycle",
          "[explanation][R38][release]") {
    const Recorded recorded{flown().recorded};
    std::set<std::string> explained;
    std::map<std::string, std::pair<double, std::string>> changed;  // by decision: when, and to what
    int checked = 0;
    for (const Recorded::Told& told : recorded.decisions()) {
        const telemetry::Explanation& explanation = told.explanation;
        INFO(told.sclk << " " << explanation.text);
        explained.insert(explanation.decision);
        if (explanation.decision == "tone") continue;  // chosen among requests, which are not recorded
        const auto holds = [](const telemetry::Condition& condition) { return condition.holds; };
        CHECK_FALSE(explanation.conditions.empty());
        CHECK(std::ranges::all_of(explanation.conditions, holds) == (explanation.verdict != "held"));
        for (const telemetry::Condition& condition : explanation.conditions) {
            INFO(condition.quantity << " " << condition.value);
            if (condition.quantity == "previous_mode" || condition.quantity == "previous_phase") {
                // Of two changes in one cycle the first leads to the second, and only the second is recorded.
                auto& [at, to] = changed[explanation.decision];
                std::string before = at == told.sclk ? to : recorded.label_before(explanation.decision, told.sclk);
                std::ranges::replace(before, '_', ' ');
                CHECK_THAT(explanation.text,
                           Catch::Contains(": previous " +
                                               std::string{condition.quantity == "previous_mode" ? "mode " : "phase "} +
                                               before,
                                           Catch::CaseSensitive::No));
                const auto colon = explanation.text.find(':'), begins = explanation.text.find(" to ") + 4;
                REQUIRE(begins < colon);
                at = told.sclk;
                to = explanation.text.substr(begins, colon - begins);
            } else if (const auto range = recorded.allowed(told, condition.quantity)) {
                CHECK(condition.value >= range->low);
                CHECK(condition.value <= range->high);
                ++checked;
            } else {
                CHECK(not_recorded.contains(condition.quantity));
            }
        }
    }
    CHECK(checked > 40);
    // Decisions that a faultless landing does not take have tests of their own.
    const std::set<std::string> of_faults{"sub_constraint", "radar_solution", "stand_by", "take_over"};
    for (const dictionary::OwnerRow& owner : tests::shipped_dictionary().owners) {
        if (owner.kind != dictionary::OwnerRow::Kind::decision || of_faults.contains(owner.name)) continue;
        INFO(owner.name);
        CHECK(explained.contains(owner.name));
    }
}

}  // namespace flight_recorded_landing_test
