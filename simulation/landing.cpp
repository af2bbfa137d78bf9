// SPDX-License-Identifier: Apache-2.0
#include "simulation/landing.hpp"

#include "common/bytes.hpp"
#include "simulation/devices/computers.hpp"
#include "simulation/devices/load.hpp"
#include "simulation/devices/recorder.hpp"
#include "simulation/devices/relay_radio.hpp"
#include "simulation/links/error_bursts.hpp"
#include "simulation/links/in_flight.hpp"
#include "simulation/links/orbiter_pass.hpp"
#include "simulation/links/transmitter.hpp"
#include "simulation/links/uhf_link.hpp"
#include "simulation/links/x_band_link.hpp"
#include "simulation/mars/earth.hpp"
#include "simulation/moments.hpp"
#include "simulation/random.hpp"
#include "simulation/venues/gnc_alone.hpp"
#include "simulation/venues/gnc_stand_in.hpp"
#include "simulation/world.hpp"

#include <algorithm>
#include <deque>
#include <string>
#include <type_traits>
#include <variant>

namespace aeolis::simulation {
namespace {

constexpr double x_band_hz = 8.4e9;            // [facts]
constexpr double light_mps = 299792458.0;      // [bipm-si]
constexpr std::size_t remembered_ticks = 256;  // 4 s: an event report is recorded within a few cycles
constexpr double symbol_s = 10.0;
constexpr double uplink_burst_octets = 32.0;  // our assumption: mean length of an error burst

constexpr const char* station_out_reason = "station out";

std::int64_t microseconds(double seconds) {
    return static_cast<std::int64_t>(std::llround(seconds * 1.0e6));
}

}  // namespace

/// The last reported state of a link. Its changes travel to Earth like everything else.
struct LinkTeller {
    telemetry::Link link;
    bool told = false, up = false;
    std::string reason{};

    std::optional<LinkTruth> change(bool up_now, const std::string& reason_now, Ert ert) {
        if (told && up_now == up && reason == reason_now) return {};
        told = true;
        up = up_now;
        reason = reason_now;
        return LinkTruth{link, ert, up, reason_now};
    }
};

/// The links of a recording orbiter, reported when it delivers.
struct StoredLinks {
    LinkTeller realtime, files;
    explicit StoredLinks(const std::string& orbiter)
        : realtime{.link = {"uhf_" + orbiter, false}}, files{.link = {"relay_" + orbiter, true}} {}
};

const char* name_of(Outcome outcome) {
    switch (outcome) {
    case Outcome::running: return "running";
    case Outcome::touchdown: return "touchdown";
    case Outcome::impact: return "impact";
    case Outcome::lost: return "lost";
    case Outcome::not_commanded: return "not_commanded";
    case Outcome::timeout: return "timeout";
    }
    return "running";
}

struct Landing::State {
    Scenario scenario;
    ClockCorrelation clock;
    std::vector<EventReportName> reports;
    World world;
    Computers computers;
    std::optional<GncAlone> gnc_alone;  // in that venue the computers stay off
    std::optional<GncStandIn> gnc_stand_in;
    flight::OctetBuffer<16384> radiated;  // by either computer in this cycle
    Recorder recorder;
    UhfLink uhf;
    Transmitter x_band_telemetry;
    XBandLink x_band;
    std::vector<OrbiterPass> passes;
    RelayRadio relay_radio;
    std::deque<std::vector<std::uint8_t>> forwarded;  ///< PLTUs for the rover, at an orbiter
    std::size_t delivery_restarts = 0;                ///< of the scenario's, so far

    std::int64_t light_time_us;
    ErrorBursts uplink_errors;
    InFlight<std::vector<std::uint8_t>> uplinks;
    InFlight<SentSymbol> symbols;
    InFlight<XBandField> fields;
    InFlight<LinkTruth> links;
    InFlight<std::vector<std::uint8_t>> forwards;
    LinkTeller uhf_told{.link = telemetry::uhf_live_link}, x_band_told{.link = telemetry::x_band_link},
        x_band_telemetry_told{.link = telemetry::x_band_telemetry_link}, relay_told{.link = telemetry::relay_link};
    std::vector<StoredLinks> stored_told;  ///< one a pass
    InFlight<telemetry::ReceivedOctets> octets;
    std::vector<LinkTruth> at_station;   ///< each link's latest state that has reached Earth
    std::vector<LinkTruth> told_ground;  ///< and as last reported to ground
    std::optional<XBandFrontEnd> antenna;
    std::optional<XBandReceiverModel> receiver;

    std::array<TruthState, remembered_ticks> remembered{};
    std::int64_t ticks_without_computer = 0;
    bool computer_on = true;
    bool unheard = false;
    std::uint64_t seed, case_number;
    bool dispersed;
    std::optional<ParachuteReport> parachute;
    CycleReport report;

    State(const Scenario& s, const flight::Load& load, std::uint64_t seed_in, std::uint64_t case_number_in,
          std::vector<EventReportName> names, const std::optional<ClockCorrelation>& known_clock)
        : scenario(s), clock(known_clock.value_or(clock_of_scenario(s))), reports(std::move(names)),
          world(s, seed_in, case_number_in), computers(load, world.sclk()), uhf(s.radio),
          x_band_telemetry(s.radio.uhf_rate_bps), x_band(s.radio),
          passes(passes_of(s, seed_in, links_case(s, case_number_in))), relay_radio(s.radio.light_time_s),
          light_time_us(microseconds(s.radio.light_time_s)),
          uplink_errors(s.radio.uplink_loss_fraction, uplink_burst_octets,
                        Random{seed_in, links_case(s, case_number_in), Stream::uplink}),
          seed(seed_in), case_number(case_number_in), dispersed(!disperses_later(s)) {
        computer_on = world.outcome() == Outcome::running;
        stored_told.reserve(passes.size());
        for (const OrbiterPass& pass : passes) stored_told.emplace_back(pass.row().orbiter);
        if (s.test_venue == TestVenue::gnc_alone) gnc_alone.emplace(load, world.solution(), world.sclk());
        if (s.test_venue == TestVenue::all_but_gnc) gnc_stand_in.emplace(load);
    }

    static ClockCorrelation clock_of_scenario(const Scenario& s) {
        ClockCorrelation own;
        own.sclk = s.entry_sclk;
        own.scet = s.entry_scet;
        return own;
    }
    static std::vector<OrbiterPass> passes_of(const Scenario& s, std::uint64_t seed, std::uint64_t case_number);
    static std::uint64_t links_case(const Scenario& s, std::uint64_t case_number) {
        return disperses_later(s) ? 0 : case_number;
    }

    void disperse();
    void inject_resets() {
        for (const ComputerReset& reset : scenario.computer_resets)
            if (scenario.entry_sclk - world.sclk() == reset.before_entry_s) computers.reset_prime(world.sclk());
    }

    Sclk sclk() const { return world.sclk() + static_cast<double>(ticks_without_computer) * seconds_per_tick; }
    const ClockCorrelation& correlation() const { return clock; }
    std::int64_t now_us() const { return correlation().scet_of(sclk()).microseconds; }

    void fly();
    void fly_tick(bool skipped);
    /// The commands of this cycle that go out on the buses; null: nobody runs them.
    const flight::DeviceOutputs* run_computers(bool skipped);
    const flight::DeviceOutputs* run_gnc_alone();
    /// Sends telemetry by X-band while that is its mode and its antenna for it is attached, then by UHF; never by both.
    /// The other carries idle frames, which bring no octets. X-band ends its present frame before it changes to tones.
    void radiate(std::span<const std::uint8_t> pltus, std::int64_t cycle_start_us);
    void radiate_by_x_band(std::int64_t cycle_start_us);
    void receive_tone(std::optional<ToneId> sent, std::int64_t cycle_start_us);
    void relay_recording(std::int64_t cycle_start_us);
    /// Sends octets that leave Mars with this cycle.
    void send_octets(const telemetry::Link& link, std::span<const std::uint8_t> what, std::int64_t cycle_start_us);
    void deliver_stored(std::int64_t cycle_start_us);
    OrbiterPass* first_in_view(bool also_stored);
    void hand_down(OrbiterPass& pass);
    flight::RecordingDelivery::Recording recording() const { return {recorder.octets(), !computer_on}; }
    void note_parachute();
    void read_event_reports();
    void tell(LinkTeller& teller, bool up, const std::string& reason, std::int64_t at_us);
    bool station_out() const;
    bool orbiters_out() const;
    double least_uhf_loss() const;  ///< 0: as the pass has it
    /// Reports a link's change to ground, as far as ground can see it: data arrive again, or no more.
    void tell(const LinkTruth& state, Ert ert);
    /// Reports the links as ground sees them during an outage of the station or its line, and after that.
    void tell_station(bool out, std::int64_t now_us);
    bool relaying() const;
    bool passes_over() const;
    bool recording_down() const { return !relaying() || relay_radio.done(recording()) || passes_over(); }
    bool stored_down() const {
        return std::ranges::all_of(passes, [](const OrbiterPass& pass) { return !pass.waits(); });
    }
    /// Seconds from the scenario's entry, as for passes.
    double e_s() const { return sclk() - scenario.entry_sclk; }
};

std::vector<OrbiterPass> Landing::State::passes_of(const Scenario& s, std::uint64_t seed, std::uint64_t case_number) {
    Random random{seed, case_number, Stream::uhf};
    if (s.radio.relay_passes.empty()) return {OrbiterPass{OrbiterPass::always(), s.radio, random}};
    std::vector<OrbiterPass> passes;
    passes.reserve(s.radio.relay_passes.size());
    for (const RelayPass& row : s.radio.relay_passes)
        passes.emplace_back(row, s.radio, Random{random.bits(), case_number, Stream::relay});
    return passes;
}

void Landing::State::tell(LinkTeller& teller, bool up, const std::string& reason, std::int64_t at_us) {
    const Ert ert{at_us + light_time_us};
    if (auto change = teller.change(up, reason, ert)) links.send(ert.microseconds, std::move(*change));
}

void Landing::State::disperse() {
    if (dispersed || world.sclk() < scenario.entry_sclk - *scenario.disperse_before_entry_s) return;
    dispersed = true;
    const flight::NavigationShift shift = world.disperse(seed, case_number);
    computers.shift_navigation(shift);
    if (gnc_alone) gnc_alone->shift_navigation(shift);
}

void Landing::State::fly() {
    if (unheard) {
        recorder.forget();
        if (!world.cruise_stage_on()) computers.leave_idle_backup();
    }
    const std::size_t recorded_before = recorder.octets().size();
    radiated.clear();
    fly_tick(false);
    report.ticks_skipped = computers.take_ticks_skipped();
    for (int tick = 0; tick < report.ticks_skipped && computer_on; ++tick) fly_tick(true);
    report.recorded = recorder.octets().subspan(recorded_before);
    report.radiated = radiated.span();
    read_event_reports();
}

void Landing::State::fly_tick(bool skipped) {
    disperse();
    const std::int64_t cycle_start_us = now_us();
    uplinks.arrive(cycle_start_us,
                   [&](std::int64_t, const std::vector<std::uint8_t>& packet) { world.receive(packet); });
    world.set_nvm(static_cast<std::uint32_t>(recorder.used_octets()), Recorder::capacity_octets);
    remembered[static_cast<std::size_t>(world.sclk().ticks()) % remembered_ticks] = world.truth();

    const std::size_t radiated_before = radiated.size();
    const flight::DeviceOutputs* commands = gnc_alone ? run_gnc_alone() : run_computers(skipped);
    if (!unheard) {
        radiate(radiated.span().subspan(radiated_before), cycle_start_us);
        receive_tone(commands != nullptr ? commands->tone : std::nullopt, cycle_start_us);
    }
    if (commands != nullptr)
        world.advance(*commands);
    else
        world.advance_uncommanded();
    report.events.insert(report.events.end(), world.events().begin(), world.events().end());
    note_parachute();

    const bool landed = world.outcome() == Outcome::touchdown;
    const bool over = world.outcome() != Outcome::running;
    computer_on = !over || (landed && world.sclk() - *world.contact() < scenario.end_after_touchdown_s);
}

const flight::DeviceOutputs* Landing::State::run_computers(bool skipped) {
    inject_resets();
    if (gnc_stand_in) computers.replace_gnc(gnc_stand_in->cycle(world, computers.gnc_configuration()));
    if (skipped)
        computers.step_without_prime(world.sense());
    else
        computers.step(world.sense());
    for (const std::size_t place : {0, 1}) {
        (void)recorder.append(computers.outputs(place).nvm.span());
        radiated.append(computers.outputs(place).uhf.span());
    }
    return computers.commands();
}

const flight::DeviceOutputs* Landing::State::run_gnc_alone() {
    const flight::DeviceOutputs& commands = gnc_alone->cycle(world.sense());
    for (const auto& one : gnc_alone->told().triggers)
        if (const char* name = decided_by_gnc(one.trigger)) report.events.push_back(moment(name, world.truth()));
    return &commands;
}

void Landing::State::radiate(std::span<const std::uint8_t> pltus, std::int64_t cycle_start_us) {
    const TruthState truth = world.truth();
    if (world.cruise_stage_on() && !world.x_band_sends_tones())
        (void)x_band_telemetry.offer(pltus);
    else
        uhf.offer(pltus);
    radiate_by_x_band(cycle_start_us);
    const auto left = uhf.cycle(
        {truth.e_s, truth.altitude_m, truth.speed_mps, computer_on && world.uhf_on(), world.parachute_antenna_on()});
    OrbiterPass* live = first_in_view(false);
    for (OrbiterPass& pass : passes) {
        pass.lose_at_least(least_uhf_loss());
        if (!pass.in_view(e_s()) || orbiters_out() || (!pass.row().stored && &pass != live)) continue;
        send_octets(telemetry::uhf_live_link, pass.hear(Traffic::realtime, left, e_s()), cycle_start_us);
    }
    const bool up = uhf.up() && live != nullptr;
    tell(uhf_told, up,
         up && !live->row().orbiter.empty() ? "by " + live->row().orbiter
         : uhf.up() && !up                  ? "no orbiter in view"
                                            : uhf.reason(),
         cycle_start_us);
}

/// At UHF's rate, without losses, and Earth hears it whenever it is above the horizon: our assumptions, as the cruise
/// stage's antenna points at Earth.
void Landing::State::radiate_by_x_band(std::int64_t cycle_start_us) {
    const bool sends =
        computer_on && world.cruise_stage_on() && (!world.x_band_sends_tones() || !x_band_telemetry.idle());
    const bool up = sends && world.earth_view().up;
    const auto left = x_band_telemetry.cycle();
    if (up) send_octets(telemetry::x_band_telemetry_link, left, cycle_start_us);
    tell(x_band_telemetry_told, up, up ? "nominal" : sends ? "Earth set" : "not switched on", cycle_start_us);
}

void Landing::State::send_octets(const telemetry::Link& link, std::span<const std::uint8_t> what,
                                 std::int64_t cycle_start_us) {
    const Ert ert{cycle_start_us + microseconds(seconds_per_tick) + light_time_us};
    if (!what.empty()) octets.send(ert.microseconds, {link, ert, {what.begin(), what.end()}});
}

OrbiterPass* Landing::State::first_in_view(bool also_stored) {
    if (orbiters_out()) return nullptr;
    const auto found = std::ranges::find_if(
        passes, [&](const OrbiterPass& pass) { return pass.in_view(e_s()) && (also_stored || !pass.row().stored); });
    return found == passes.end() ? nullptr : &*found;
}

void Landing::State::deliver_stored(std::int64_t cycle_start_us) {
    for (std::size_t i = 0; i < passes.size(); ++i) {
        if (!passes[i].row().stored) continue;
        // An orbiter has one link to Earth: an earlier pass's recording goes first.
        const bool busy = std::any_of(
            passes.begin(), passes.begin() + static_cast<std::ptrdiff_t>(i), [&](const OrbiterPass& earlier) {
                return earlier.row().stored && earlier.row().orbiter == passes[i].row().orbiter &&
                       earlier.delivers(e_s());
            });
        if (busy) continue;
        for (const Traffic traffic : {Traffic::realtime, Traffic::files}) {
            LinkTeller& told = traffic == Traffic::realtime ? stored_told[i].realtime : stored_told[i].files;
            const auto delivered = passes[i].deliver(traffic, e_s());
            send_octets(told.link, delivered, cycle_start_us);
            if (!delivered.empty()) tell(told, true, "delivers what it recorded", cycle_start_us);
            if (delivered.empty() && told.up) tell(told, false, "delivered", cycle_start_us);
        }
    }
}

void Landing::State::receive_tone(std::optional<ToneId> sent, std::int64_t cycle_start_us) {
    const TruthState truth = world.truth();
    const double range_rate_mps = earth_range_rate_mps(vector3(truth.p_MoB_M_m), vector3(truth.v_MB_M_mps), truth.e_s);
    const double doppler_hz = -range_rate_mps / light_mps * x_band_hz;
    World::EarthView earth = world.earth_view();
    for (const FalseTone& other : scenario.false_tones)
        if (sent && goes_on(other, scenario.entry_sclk - sclk())) sent = other.tone;
    if (!world.x_band_sends_tones() || !x_band_telemetry.idle()) {
        sent.reset();
        earth.gain.reset();  // left out: the carrier of telemetry, which the tones' receiver is not set to
    }
    const auto ended = x_band.cycle(sent, {truth.sclk, truth.e_s, earth.up, earth.gain});
    if (scenario.radio.tones_from_samples.value_or(false) || receiver) {
        XBandField field;
        field.ert = {cycle_start_us + light_time_us};
        field.e_s = truth.sclk - scenario.entry_sclk;
        field.doppler_hz = doppler_hz;
        field.up = x_band.earth_up();
        if (field.up) field.gain_db = 10.0 * std::log10(*earth.gain);
        if (const auto symbol = x_band.sending()) {
            field.tone = symbol->tone;
            field.tone_age_s = truth.sclk - symbol->started;
        }
        fields.send(field.ert.microseconds, field);
    }
    if (ended) {
        SentSymbol symbol{ended->tone, ended->started, {}, {}};
        symbol.start = {correlation().scet_of(symbol.at).microseconds + light_time_us};
        symbol.end = {std::min(symbol.start.microseconds + microseconds(symbol_s), cycle_start_us + light_time_us)};
        symbols.send(symbol.end.microseconds, symbol);
    }
    tell(x_band_told, x_band.earth_up(), x_band.reason(), cycle_start_us);
}

bool Landing::State::station_out() const {
    return std::ranges::any_of(scenario.station_outages, [before_entry_s = -e_s()](const StationOutage& outage) {
        return goes_on(outage, before_entry_s);
    });
}

bool Landing::State::orbiters_out() const {
    return std::ranges::any_of(scenario.orbiter_outages, [before_entry_s = -e_s()](const OrbiterOutage& outage) {
        return goes_on(outage, before_entry_s);
    });
}

double Landing::State::least_uhf_loss() const {
    double least = 0.0;
    for (const UhfLoss& loss : scenario.uhf_losses)
        if (goes_on(loss, -e_s())) least = std::max(least, loss.fraction);
    return least;
}

void Landing::State::tell(const LinkTruth& state, Ert ert) {
    report.links.push_back({state.link, ert, state.up, state.reason});
    if (state.link == telemetry::x_band_link) return;  // the receiver finds the carrier or does not
    const auto same = std::ranges::find(told_ground, state.link, &LinkTruth::link);
    if (same != told_ground.end() && same->up == state.up && (!state.up || same->reason == state.reason)) return;
    (same != told_ground.end() ? *same : told_ground.emplace_back(state)) = state;
    report.earth.links.push_back({state.link, ert, state.up, state.up ? state.reason : ""});
}

void Landing::State::tell_station(bool out, std::int64_t now_us) {
    const bool begins = out && !report.earth.station_out, ends = !out && report.earth.station_out;
    report.earth.station_out = out;
    if (begins)
        for (const LinkTruth& state : at_station)
            if (state.up) tell({state.link, {}, false, station_out_reason}, Ert{now_us});
    links.arrive(now_us, [&](std::int64_t, LinkTruth&& state) {
        const auto known = std::ranges::find(at_station, state.link, &LinkTruth::link);
        (known != at_station.end() ? *known : at_station.emplace_back(state)) = state;
        if (!out && !ends) tell(state, state.ert);
    });
    if (ends) {
        told_ground.clear();  // a station that is back reports all its links
        for (const LinkTruth& state : at_station) tell(state, Ert{now_us});
    }
}

bool Landing::State::relaying() const {
    return world.outcome() == Outcome::touchdown;
}

bool Landing::State::passes_over() const {
    return std::ranges::all_of(passes, [&](const OrbiterPass& pass) { return pass.is_over(e_s()); });
}

void Landing::State::hand_down(OrbiterPass& pass) {
    for (; !forwarded.empty(); forwarded.pop_front()) {
        pass.spoil_forward(forwarded.front(), e_s());
        relay_radio.receive(forwarded.front());
    }
}

void Landing::State::relay_recording(std::int64_t cycle_start_us) {
    deliver_stored(cycle_start_us);
    if (!relaying()) return;
    const double landed_s = sclk() - *world.contact();
    if (landed_s < scenario.radio.relay_start_after_touchdown_s) return;
    const auto& restarts = scenario.radio.delivery_restarts_after_touchdown_s;
    if (delivery_restarts < restarts.size() && landed_s >= restarts[delivery_restarts]) {
        relay_radio.restart();
        ++delivery_restarts;
    }
    forwards.arrive(cycle_start_us,
                    [&](std::int64_t, std::vector<std::uint8_t>&& pltu) { forwarded.push_back(std::move(pltu)); });
    OrbiterPass* serving = first_in_view(true);
    if (serving != nullptr) hand_down(*serving);
    const auto sent = relay_radio.cycle(recording(), serving != nullptr ? serving->file_rate_bps(e_s()) : 0.0);
    if (serving != nullptr)
        send_octets(telemetry::relay_link, serving->hear(Traffic::files, sent, e_s()), cycle_start_us);
    const bool complete = relay_radio.done(recording());
    const bool up = !complete && serving != nullptr && !serving->row().stored;
    const std::string by =
        serving != nullptr && !serving->row().orbiter.empty() ? "by " + serving->row().orbiter : "nominal";
    tell(relay_told, up,
         complete                ? "recording complete"
         : serving == nullptr    ? "no orbiter in view"
         : serving->row().stored ? by + ", which delivers later"
                                 : by,
         cycle_start_us);
}

void Landing::State::note_parachute() {
    const bool deployed =
        std::ranges::any_of(world.events(), [](const TruthEvent& event) { return event.name == "parachute_deploy"; });
    if (!deployed || parachute) return;
    const World::Inspection seen = world.inspect();
    parachute = {seen.mach, seen.dynamic_pressure_Pa};
}

void Landing::State::read_event_reports() {
    if (reports.empty()) return;
    std::span<const std::uint8_t> recorded = report.recorded;
    for (auto packet = take_packet(recorded); !packet.empty(); packet = take_packet(recorded)) {
        const Apid apid = read_primary_header(packet)->apid;
        const bool is_report =
            std::any_of(reports.begin(), reports.end(), [&](const auto& r) { return r.apid == apid; });
        if (!is_report || packet.size() < tm_overhead_octets + 2) continue;
        const auto header = read_tm_packet(packet);
        if (!header) continue;
        const EvrId id{static_cast<std::uint16_t>(read_bits(packet, tm_data_offset_octets * 8, 16))};
        const auto found =
            std::find_if(reports.begin(), reports.end(), [&](const auto& r) { return r.apid == apid && r.id == id; });
        if (found == reports.end()) continue;
        const TruthState& truth = remembered[static_cast<std::size_t>(header->time.ticks()) % remembered_ticks];
        if (truth.sclk == header->time) report.events.push_back(moment(found->name.c_str(), truth));
        reports.erase(found);  // the first report of a name dates the event
    }
}

Landing::Landing(const Scenario& scenario, std::uint64_t seed, std::uint64_t case_number,
                 std::vector<EventReportName> reports, std::optional<ClockCorrelation> clock)
    : state_(std::make_unique<State>(scenario, load_for(scenario), seed, case_number, std::move(reports), clock)) {}
Landing::Landing(const Landing& other) : state_(std::make_unique<State>(*other.state_)) {
    // The last cycle's report points into the original.
    state_->report = {};
}
Landing& Landing::operator=(const Landing& other) {
    if (this != &other) *this = Landing{other};
    return *this;
}
Landing::Landing(Landing&&) noexcept = default;
Landing& Landing::operator=(Landing&&) noexcept = default;
Landing::~Landing() = default;

const CycleReport& Landing::step() {
    State& s = *state_;
    s.report.ticks_skipped = 0;
    s.report.recorded = {};
    s.report.radiated = {};
    s.report.earth.clear();
    s.report.x_band.clear();
    s.report.symbols.clear();
    s.report.links.clear();
    s.report.events.clear();

    const std::int64_t cycle_start_us = s.now_us();
    if (s.computer_on) {
        s.fly();
    } else {
        ++s.ticks_without_computer;
        for (LinkTeller* told :
             {&s.uhf_told, &s.x_band_told, &s.x_band_telemetry_told})  // the transmitters have no driver any more
            if (told->up) s.tell(*told, false, "computer off", cycle_start_us);
    }
    if (s.unheard) return s.report;
    s.relay_recording(cycle_start_us);

    const std::int64_t now_us = s.now_us();
    const bool out = s.station_out();
    telemetry::Downlink& earth = s.report.earth;
    earth.now = Ert{now_us};
    s.tell_station(out, now_us);
    s.octets.arrive(now_us, [&](std::int64_t, telemetry::ReceivedOctets&& o) {
        if (!out) earth.octets.push_back(std::move(o));
    });
    s.symbols.arrive(now_us, [&](std::int64_t, const SentSymbol& symbol) { s.report.symbols.push_back(symbol); });
    s.fields.arrive(now_us, [&](std::int64_t, XBandField f) {
        f.up = f.up && !out;
        s.report.x_band.push_back(f);
        if (s.antenna) earth.x_band.push_back(s.antenna->sample(f));
        if (s.receiver) s.receiver->hear(f, earth);
    });
    return s.report;
}

const CycleReport& Landing::report() const {
    return state_->report;
}

void Landing::listen_by(XBandFrontEnd antenna) {
    state_->antenna.emplace(std::move(antenna));
}

void Landing::listen_by(XBandReceiverModel receiver) {
    state_->receiver.emplace(std::move(receiver));
}

bool Landing::dispersed() const {
    return state_->dispersed;
}
void Landing::take_case(std::uint64_t case_number) {
    AEOLIS_CHECK(!state_->dispersed);
    state_->case_number = case_number;
}

void Landing::redraw(std::uint64_t seed, std::uint64_t case_number, const std::optional<StateKnowledge>& knowledge) {
    state_->world.redraw(seed, case_number, knowledge);
}

PlacedState Landing::placed_state() const {
    PlacedState state = state_->world.placed_state();
    const auto frame = state_->computers.state_frame();
    state.computer.assign(frame.begin(), frame.end());
    return state;
}

Result<void> Landing::place(const PlacedState& state) {
    State& s = *state_;
    const auto fired = [&](flight::PyroId pyro) { return state.fired[static_cast<std::size_t>(pyro)]; };
    if (s.gnc_alone || s.gnc_stand_in) return Error{"a landing without its own computer and GNC cannot be placed"};
    if (s.world.outcome() != Outcome::running) return Error{"the landing is over"};
    if (Sclk::from_ticks(state.sclk.ticks()) != state.sclk) return Error{"the time is not a whole tick of 1/64 s"};
    if (state.sclk < s.scenario.entry_sclk - s.scenario.start_before_entry_s)
        return Error{"the time is before the landing's start"};
    if (!fired(flight::PyroId::cruise_stage_separation)) return Error{"the cruise stage is still attached"};
    if (fired(flight::PyroId::bridle_cutter)) return Error{"the bridle is cut: the rover stands"};
    if (!s.computers.place(state.computer)) return Error{"the computer's state is not a state frame of this build"};
    s.world.place(state);
    s.dispersed = true;  // a placed landing has the errors that it has
    return {};
}

void Landing::shift(const flight::NavigationShift& vehicle, const flight::NavigationShift& navigation) {
    state_->world.shift(vehicle);
    state_->computers.shift_navigation(navigation);
}

void Landing::fly_unheard() {
    state_->unheard = true;
    state_->recorder.forget();
}

void Landing::uplink(std::span<const std::uint8_t> octets) {
    State& s = *state_;
    std::vector<std::uint8_t> arriving{octets.begin(), octets.end()};
    s.uplink_errors.spoil(arriving);
    s.uplinks.send(s.now_us() + s.light_time_us, std::move(arriving));
}

void Landing::forward(std::span<const std::uint8_t> pltu) {
    State& s = *state_;
    s.forwards.send(s.now_us() + s.light_time_us, {pltu.begin(), pltu.end()});
}

void Landing::inject(Fault fault) {
    State& s = *state_;
    const double before_entry_s = s.scenario.entry_sclk - s.world.sclk();
    const auto begin_now = [&](auto spell) {
        // By Earth's clock, which continues when the computer is off.
        spell.begin_before_entry_s = s.scenario.entry_sclk - s.sclk();
        return spell;
    };
    std::visit(
        [&]<typename Kind>(Kind& kind) {
            if constexpr (std::is_same_v<Kind, ComputerReset>) {
                s.scenario.computer_resets.push_back({before_entry_s});
            } else if constexpr (std::is_same_v<Kind, StationOutage>) {
                s.scenario.station_outages.push_back(begin_now(kind));
            } else if constexpr (std::is_same_v<Kind, OrbiterOutage>) {
                s.scenario.orbiter_outages.push_back(begin_now(kind));
            } else if constexpr (std::is_same_v<Kind, UhfLoss>) {
                s.scenario.uhf_losses.push_back(begin_now(kind));
            } else if constexpr (std::is_same_v<Kind, FalseTone>) {
                s.scenario.false_tones.push_back(begin_now(kind));
            } else {
                kind.begin_before_entry_s = before_entry_s;
                s.world.inject(kind);
            }
        },
        fault);
}

void Landing::run_prime_by(std::shared_ptr<flight::CycleRunner> runner) {
    state_->computers.run_prime_by(std::move(runner));
}

void Landing::reset_prime() {
    if (state_->computer_on) state_->computers.reset_prime(state_->sclk());
}

Sclk Landing::sclk() const {
    return state_->sclk();
}
Scet Landing::scet() const {
    return correlation().scet_of(sclk());
}
Ert Landing::ert_now() const {
    return {scet().microseconds};
}
double Landing::light_time_s() const {
    return state_->scenario.radio.light_time_s;
}
ClockCorrelation Landing::correlation() const {
    return state_->correlation();
}
const NavigationSolution& Landing::solution() const {
    return state_->world.solution();
}
TruthState Landing::truth() const {
    return state_->world.truth();
}
Outcome Landing::outcome() const {
    return state_->world.outcome();
}
std::string Landing::outcome_reason() const {
    return state_->world.outcome_reason();
}

bool Landing::flown() const {
    return !state_->computer_on;
}

bool Landing::finished() const {
    const State& s = *state_;
    return !s.computer_on && s.recording_down() && s.stored_down() && s.octets.empty() && s.symbols.empty() &&
           s.fields.empty() && s.links.empty();
}

std::optional<TouchdownReport> Landing::touchdown() const {
    return state_->world.touchdown();
}
double Landing::peak_deceleration_mps2() const {
    return state_->world.peak_deceleration_mps2();
}
std::optional<ParachuteReport> Landing::parachute() const {
    return state_->parachute;
}
Inspection Landing::inspect() const {
    return state_->world.inspect();
}
std::vector<Draw> Landing::draws() const {
    return state_->world.draws();
}
SeparationReport Landing::separation() const {
    return state_->world.separation();
}
flight::Computer::Counters Landing::counters() const {
    return state_->computers.counters();
}
std::span<const std::uint8_t> Landing::recording() const {
    return state_->recorder.octets();
}

bool Landing::relaying() const {
    return state_->relaying();
}

}  // namespace aeolis::simulation
