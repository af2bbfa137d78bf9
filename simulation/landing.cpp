#include "simulation/landing.hpp"

#include "common/bytes.hpp"
#include "simulation/devices/computers.hpp"
#include "simulation/devices/load.hpp"
#include "simulation/devices/recorder.hpp"
#include "simulation/links/in_flight.hpp"
#include "simulation/links/relay_link.hpp"
#include "simulation/links/uhf_link.hpp"
#include "simulation/links/x_band_link.hpp"
#include "simulation/mars/earth.hpp"
#include "simulation/moments.hpp"
#include "simulation/random.hpp"
#include "simulation/venues/gnc_alone.hpp"
#include "simulation/venues/gnc_stand_in.hpp"
#include "simulation/world.hpp"

#include <algorithm>
#include <string_view>

namespace aeolis::simulation {
namespace {

constexpr double x_band_hz = 8.4e9;           // [facts]
constexpr double light_mps = 299792458.0;     // [bipm-si]
constexpr std::size_t remembered_ticks = 256; // 4 s: an event report is recorded within a few cycles
constexpr double symbol_s = 10.0;

std::int64_t microseconds(double seconds) {
    return static_cast<std::int64_t>(std::llround(seconds * 1.0e6));
}

} // namespace

/// A link's last told state: a change is sent to Earth like everything else.
struct LinkTeller {
    LinkId link{};
    bool x_band = false;
    bool told = false, up = false;
    std::string_view reason{};

    std::optional<LinkState> change(bool up_now, const char* reason_now, Ert ert) {
        if (told && up_now == up && reason == reason_now) return {};
        told = true;
        up = up_now;
        reason = reason_now;
        return LinkState{link, x_band, ert, up, reason_now};
    }
};

const char* name_of(Outcome outcome) {
    switch (outcome) {
    case Outcome::running:
        return "running";
    case Outcome::touchdown:
        return "touchdown";
    case Outcome::impact:
        return "impact";
    case Outcome::lost:
        return "lost";
    case Outcome::not_commanded:
        return "not_commanded";
    case Outcome::timeout:
        return "timeout";
    }
    return "running";
}

struct Landing::State {
    Scenario scenario;
    std::vector<EventReportName> reports;
    World world;
    Computers computers;
    std::optional<GncAlone> gnc_alone; // in that venue the computers stay off
    std::optional<GncStandIn> gnc_stand_in;
    flight::OctetBuffer<16384> radiated; // by either computer in this cycle
    Recorder recorder;
    UhfLink uhf;
    XBandLink x_band;
    RelayLink relay;

    std::int64_t light_time_us;
    InFlight<std::vector<std::uint8_t>> uplinks;
    InFlight<ReceivedPacket> packets;
    InFlight<ReceivedTone> tones;
    InFlight<XBandField> fields;
    InFlight<LinkState> links;
    LinkTeller uhf_told{.link = LinkId::uhf_live}, x_band_told{.x_band = true}, relay_told{.link = LinkId::relay};
    InFlight<ReceivedOctets> octets;

    std::array<TruthState, remembered_ticks> remembered{};
    std::int64_t ticks_without_computer = 0;
    bool computer_on = true;
    std::uint64_t seed, case_number;
    bool dispersed;
    std::optional<ParachuteReport> parachute;
    CycleReport report;

    State(const Scenario& s, const flight::Load& load, std::uint64_t seed_in, std::uint64_t case_number_in,
          std::vector<EventReportName> names)
        : scenario(s), reports(std::move(names)), world(s, seed_in, case_number_in),
          computers(load, world.sclk()), uhf(s.radio, Random{seed_in, links_case(s, case_number_in), Stream::uhf}),
          x_band(s.radio, Random{seed_in, links_case(s, case_number_in), Stream::x_band}),
          relay(s.radio.relay_rate_bps),
          light_time_us(microseconds(s.radio.light_time_s)), seed(seed_in), case_number(case_number_in),
          dispersed(!disperses_later(s)) {
        computer_on = world.outcome() == Outcome::running;
        if (s.test_venue == TestVenue::gnc_alone) gnc_alone.emplace(load, world.solution(), world.sclk());
        if (s.test_venue == TestVenue::all_but_gnc) gnc_stand_in.emplace(load);
    }

    static std::uint64_t links_case(const Scenario& s, std::uint64_t case_number) {
        return disperses_later(s) ? 0 : case_number;
    }

    void disperse();
    void inject_resets() {
        for (const ComputerReset& reset : scenario.computer_resets)
            if (scenario.entry_sclk - world.sclk() == reset.before_entry_s) computers.reset_prime(world.sclk());
    }

    Sclk sclk() const { return world.sclk() + static_cast<double>(ticks_without_computer) * seconds_per_tick; }
    ClockCorrelation correlation() const { return {scenario.entry_sclk, scenario.entry_scet}; }
    std::int64_t now_us() const { return correlation().scet_of(sclk()).microseconds; }

    void fly();
    void fly_tick(bool skipped);
    /// The commands of this cycle that go out on the buses; none: nobody runs them.
    const flight::DeviceOutputs* run_computers(bool skipped);
    const flight::DeviceOutputs* run_gnc_alone();
    void radiate(std::span<const std::uint8_t> pltus, std::int64_t cycle_start_us);
    void receive_tone(std::optional<ToneId> sent, std::int64_t cycle_start_us);
    void relay_recording(std::int64_t cycle_start_us);
    void note_parachute();
    void read_event_reports();
    void tell(LinkTeller& teller, bool up, const char* reason, std::int64_t at_us);
    bool relaying() const;
    bool recording_down() const { return !relaying() || relay.sent_octets() == recorder.octets().size(); }
};

void Landing::State::tell(LinkTeller& teller, bool up, const char* reason, std::int64_t at_us) {
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
    const std::size_t recorded_before = recorder.octets().size();
    radiated.clear();
    fly_tick(false);
    report.ticks_skipped = computers.take_ticks_skipped();
    for (int tick = 0; tick < report.ticks_skipped && computer_on; ++tick)
        fly_tick(true);
    report.recorded = recorder.octets().subspan(recorded_before);
    report.radiated = radiated.span();
    read_event_reports();
}

void Landing::State::fly_tick(bool skipped) {
    disperse();
    const std::int64_t cycle_start_us = now_us();
    uplinks.arrive(cycle_start_us,
                   [&](std::int64_t, const std::vector<std::uint8_t>& packet) { world.receive(packet); });
    world.set_nvm(static_cast<std::uint32_t>(recorder.octets().size()), Recorder::capacity_octets);
    remembered[static_cast<std::size_t>(world.sclk().ticks()) % remembered_ticks] = world.truth();

    const std::size_t radiated_before = radiated.size();
    const flight::DeviceOutputs* commands = gnc_alone ? run_gnc_alone() : run_computers(skipped);
    radiate(radiated.span().subspan(radiated_before), cycle_start_us);
    receive_tone(commands != nullptr ? commands->tone : std::nullopt, cycle_start_us);
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
    for (const flight::gnc::Trigger trigger : gnc_alone->told().triggers)
        if (const char* name = decided_by_gnc(trigger)) report.events.push_back(moment(name, world.truth()));
    return &commands;
}

void Landing::State::radiate(std::span<const std::uint8_t> pltus, std::int64_t cycle_start_us) {
    const TruthState truth = world.truth();
    uhf.offer(pltus);
    const auto arrived = uhf.cycle({truth.e_s, truth.altitude_m, truth.speed_mps, computer_on && world.uhf_on()});
    const Ert ert{cycle_start_us + microseconds(seconds_per_tick) + light_time_us};
    if (!arrived.empty()) octets.send(ert.microseconds, {LinkId::uhf_live, ert, {arrived.begin(), arrived.end()}});
    tell(uhf_told, uhf.up(), uhf.reason(), cycle_start_us);
}

void Landing::State::receive_tone(std::optional<ToneId> sent, std::int64_t cycle_start_us) {
    const TruthState truth = world.truth();
    const double range_rate_mps = earth_range_rate_mps(vector3(truth.p_MoB_M_m), vector3(truth.v_MB_M_mps), truth.e_s);
    const double doppler_hz = -range_rate_mps / light_mps * x_band_hz;
    auto tone = x_band.cycle(sent, {truth.sclk, truth.e_s, doppler_hz});
    if (scenario.radio.tones_from_samples) {
        XBandField field{{cycle_start_us + light_time_us}, truth.sclk - scenario.entry_sclk, doppler_hz, x_band.up(), {}, 0.0};
        if (const auto symbol = x_band.sending()) {
            field.tone = symbol->tone;
            field.tone_age_s = truth.sclk - symbol->started;
        }
        fields.send(field.ert.microseconds, field);
    }
    if (tone) {
        tone->start = {correlation().scet_of(tone->sent_at).microseconds + light_time_us};
        tone->end = {std::min(tone->start.microseconds + microseconds(symbol_s), cycle_start_us + light_time_us)};
        tones.send(tone->end.microseconds, *tone);
    }
    tell(x_band_told, x_band.up(), x_band.reason(), cycle_start_us);
}

bool Landing::State::relaying() const {
    return world.outcome() == Outcome::touchdown;
}

void Landing::State::relay_recording(std::int64_t cycle_start_us) {
    if (!relaying()) return;
    const bool started = sclk() - *world.contact() >= scenario.radio.relay_start_after_touchdown_s;
    if (!started) return;
    relay.cycle(recorder.octets(), [&](std::int64_t left_us, std::span<const std::uint8_t> packet) {
        const Ert ert{cycle_start_us + left_us + light_time_us};
        packets.send(ert.microseconds, {LinkId::relay, ert, {packet.begin(), packet.end()}});
    });
    const bool complete = !computer_on && recording_down();
    tell(relay_told, !complete, complete ? "recording complete" : "nominal", cycle_start_us);
}

void Landing::State::note_parachute() {
    const bool deployed = std::ranges::any_of(
        world.events(), [](const TruthEvent& event) { return event.name == "parachute_deploy"; });
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
        reports.erase(found); // the first of a name is the moment
    }
}

Landing::Landing(const Scenario& scenario, std::uint64_t seed, std::uint64_t case_number,
                 std::vector<EventReportName> reports)
    : state_(std::make_unique<State>(scenario, load_for(scenario), seed, case_number, std::move(reports))) {}
Landing::Landing(const Landing& other) : state_(std::make_unique<State>(*other.state_)) {
    // What was reported of the last cycle points into the original.
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
    s.report.octets.clear();
    s.report.packets.clear();
    s.report.tones.clear();
    s.report.x_band.clear();
    s.report.symbols.clear();
    s.report.links.clear();
    s.report.events.clear();

    const std::int64_t cycle_start_us = s.now_us();
    if (s.computer_on)
        s.fly();
    else
        ++s.ticks_without_computer;
    s.relay_recording(cycle_start_us);

    const std::int64_t now_us = s.now_us();
    s.octets.arrive(now_us, [&](std::int64_t, ReceivedOctets&& o) { s.report.octets.push_back(std::move(o)); });
    s.packets.arrive(now_us, [&](std::int64_t, ReceivedPacket&& p) { s.report.packets.push_back(std::move(p)); });
    auto& tones = s.scenario.radio.tones_from_samples ? s.report.symbols : s.report.tones;
    s.tones.arrive(now_us, [&](std::int64_t, const ReceivedTone& t) { tones.push_back(t); });
    s.fields.arrive(now_us, [&](std::int64_t, const XBandField& f) { s.report.x_band.push_back(f); });
    s.links.arrive(now_us, [&](std::int64_t, LinkState&& l) { s.report.links.push_back(std::move(l)); });
    return s.report;
}

bool Landing::dispersed() const {
    return state_->dispersed;
}
void Landing::take_case(std::uint64_t case_number) {
    AEOLIS_CHECK(!state_->dispersed);
    state_->case_number = case_number;
}

void Landing::uplink(std::span<const std::uint8_t> packet) {
    State& s = *state_;
    s.uplinks.send(s.now_us() + s.light_time_us, {packet.begin(), packet.end()});
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

bool Landing::finished() const {
    const State& s = *state_;
    return !s.computer_on && s.recording_down() && s.octets.empty() && s.packets.empty() && s.tones.empty() && s.fields.empty() && s.links.empty();
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
SeparationReport Landing::separation() const {
    return state_->world.separation();
}
flight::Computer::Counters Landing::counters() const {
    return state_->computers.counters();
}
std::span<const std::uint8_t> Landing::recording() const {
    return state_->recorder.octets();
}

double Landing::relay_progress() const {
    const State& s = *state_;
    const std::size_t recorded = s.recorder.octets().size();
    if (recorded == 0 || !s.relaying()) return 0.0;
    const double part = static_cast<double>(s.relay.sent_octets()) / static_cast<double>(recorded);
    // While the computer still records, what has come down cannot be all.
    return s.computer_on ? std::min(part, 0.999) : part;
}

} // namespace aeolis::simulation
