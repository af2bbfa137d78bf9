// SPDX-License-Identifier: Apache-2.0
#include "server/shadow/shadow.hpp"

#include "server/rehearsal/kept_requests.hpp"
#include "server/shadow/prospect.hpp"
#include "simulation/vectors.hpp"
#include "telemetry/packet_stream.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <numbers>
#include <spdlog/spdlog.h>
#include <utility>

namespace aeolis::server::shadow {
namespace {

constexpr double light_mps = 299792458.0;  // [bipm-si]
constexpr double own_kept_s = 30.0;        // chosen: telemetry is at most so old when it comes at once
constexpr double residual_lasts_s = 1.5;   // chosen: three of the slowest states
constexpr std::int64_t second_ticks = 64;
// Chosen: how long the vehicle must be outside before it departs, by as many values.
constexpr double persists_s = 3.0, carrier_persists_s = 10.0;
constexpr std::uint32_t persists_values = 3;
constexpr double carrier_sigmas = 4.0;
constexpr double degrees_per_radian = 180.0 / std::numbers::pi;

/// Commands that change nothing of a flight that goes as expected.
bool moves_the_landing(std::string_view command) {
    static constexpr std::array<std::string_view, 5> none{"NO_OP", "EDL_STAGE_PARAMETER", "EDL_DISCARD_PARAMETERS",
                                                          "EDL_DUMP_PARAMETERS", "SECOND_CHANCE_ENABLE"};
    return std::ranges::find(none, command) == none.end();
}

double angle_deg(const std::array<double, 4>& a, const std::array<double, 4>& b) {
    const simulation::Quaternion one{a[0], a[1], a[2], a[3]}, other{b[0], b[1], b[2], b[3]};
    return one.normalized().angularDistance(other.normalized()) * degrees_per_radian;
}

double distance(const std::array<double, 3>& a, const std::array<double, 3>& b) {
    return (simulation::vector3(a) - simulation::vector3(b)).norm();
}

double length(const std::array<double, 3>& a) {
    return simulation::vector3(a).norm();
}

}  // namespace

Shadow::Shadow(const simulation::Scenario& scenario, const simulation::NavigationSolution& solution,
               const ClockCorrelation& clock, const dictionary::Dictionary& dictionary, const ForecastOrder& order)
    : scenario_(scenario), dictionary_(dictionary), order_(order),
      flight_(begin_ground_flight(scenario, solution, clock, dictionary)),
      lag_(static_cast<std::uint64_t>(std::ceil(scenario.radio.light_time_s / seconds_per_tick))), heard_(dictionary),
      own_told_(dictionary), decoder_(dictionary), second_of_(dictionary.channels.size(), -1),
      value_said_(dictionary.channels.size()), ever_said_(dictionary.channels.size()),
      expectations_(dictionary, scenario.entry_sclk), said_(dictionary.timeline.size()),
      said_told_(dictionary.timeline.size()), packets_(dictionary) {}

void Shadow::take(std::uint64_t cycle, const v1::KeptRequest& request) {
    if (request.has_ensemble()) {
        if (astray_ || request.ensemble().order() != plan_number_) return;  // its plan is not flown any more
        expectations_.take(request.ensemble());
        plan_wanted_ = false;
        pending_flown_ = expectations_changed_ = true;
        return;
    }
    if (!request.has_command() && !request.has_verdict()) return;  // an instructor's
    sent_.push_back({cycle, request});
    if (request.has_command() && !moves_the_landing(request.command().command())) return;
    pending_changed_ = pending_changed_ || expectations_.known();
    expectations_changed_ = expectations_changed_ || expectations_.known();
    expectations_.withdraw();
    plan_wanted_ = true;
    ++plan_number_;
}

void Shadow::step() {
    while (!sent_.empty() && sent_.front().cycle <= flight_->cycles()) {
        if (!repeat(*flight_, sent_.front().request)) go_astray();
        sent_.pop_front();
    }
    const NavigatedState truth = state_of(flight_->landing());
    flight_->step();
    flight_->take_stages();
    telemetry::PacketStream packets{flight_->landing().report().recorded};
    while (const auto packet = packets.next()) {
        telemetry::DecodedPacket decoded;
        decoder_.decode(*packet, decoded);
        own_told_.hear(decoded);
        if (decoded.refusal.empty()) note_values(decoded.content);
    }
    const auto& told = own_told_.newest();
    if (told && told->sclk == truth.sclk) own_.push_back({truth, *told});
    while (!own_.empty() && truth.sclk - own_.front().truth.sclk > own_kept_s) own_.pop_front();
}

/// The first value of each channel in each second, if it differs from the one said last.
void Shadow::note_values(const telemetry::Decoded& decoded) {
    const auto& fields = dictionary_.packets[decoded.packet].fields;
    const std::int64_t second = decoded.header.time.ticks() / second_ticks;
    for (std::size_t i = 0; i < fields.size(); ++i) {
        if (!fields[i].channel) continue;
        const auto channel = fields[i].channel->value;
        if (std::exchange(second_of_[channel], second) == second) continue;
        const auto& value = decoded.value[i];
        if (ever_said_[channel] && value_said_[channel] == value) continue;
        ever_said_[channel] = true;
        value_said_[channel] = value;
        changed_.push_back({ChannelId{channel}, decoded.header.time, value});
    }
}

void Shadow::say_values(std::vector<ShadowPackets::Octets>& out) {
    const auto second_of = [](const telemetry::ExpectedValue& each) { return each.at.ticks() / second_ticks; };
    std::ranges::stable_sort(changed_, {}, second_of);  // a packet may be recorded a cycle after its time
    for (auto first = changed_.begin(); first != changed_.end();) {
        const auto second = second_of(*first);
        const auto last =
            std::find_if(first, changed_.end(), [&](const auto& each) { return second_of(each) != second; });
        for (auto& packet : packets_.values({first, last}, Sclk::from_ticks(second * second_ticks)))
            out.push_back(std::move(packet));
        first = last;
    }
    changed_.clear();
}

void Shadow::hold_against(const NavigatedState& state, std::vector<ShadowPackets::Octets>& out) {
    const auto own = std::ranges::find(own_, state.sclk, [](const Own& each) { return each.truth.sclk; });
    look_at(Quantity::altitude_m, altitude_m(state.p_MoB_M_m), 0.0, state.sclk, out);
    look_at(Quantity::speed_mps, length(state.v_MB_M_mps), 0.0, state.sclk, out);
    if (own == own_.end() || (moved_ && state.sclk < *moved_)) return;
    residual_ = {distance(state.p_MoB_M_m, own->told.p_MoB_M_m),
                 altitude_m(state.p_MoB_M_m) - altitude_m(own->told.p_MoB_M_m),
                 length(state.v_MB_M_mps) - length(own->told.v_MB_M_mps), angle_deg(state.q_MB, own->told.q_MB)};
    residual_at_ = state.sclk;
    if (held_ && state.sclk - *held_ < HeardFlight::states_apart_s) return;
    const double ago_s = flight_->landing().sclk() - state.sclk;
    const auto to_now = [&](flight::NavigationShift by) {
        for (std::size_t i = 0; i < 3; ++i) by.p_MoB_M_m[i] += by.v_MB_M_mps[i] * ago_s;
        return by;
    };
    const auto vehicle = to_now(shift_to(own->truth, state));
    flight_->shift(vehicle, to_now(shift_to(own->told, state)));
    held_ = state.sclk;
    moved_ = flight_->landing().sclk();
    out.push_back(packets_.moved(
        {length(vehicle.p_MoB_M_m), length(vehicle.v_MB_M_mps), angle_deg(own->truth.q_MB, state.q_MB)}, state.sclk));
}

void Shadow::look_at_firings(std::vector<ShadowPackets::Octets>& out) {
    const auto& fired = heard_.fired();
    for (; firings_seen_ < fired.size(); ++firings_seen_) {
        const auto [row, at] = fired[firings_seen_];
        if (row >= dictionary_.timeline.size() || expectations_.told(row)) continue;
        const auto expected = expectations_.expected(row);
        const double seen_s = at - scenario_.entry_sclk;
        if (expected && seen_s < expected->tolerated.from)
            departs({static_cast<std::uint16_t>(row), TimepointDeparture::Kind::too_early, seen_s, *expected}, out);
        if (expected && seen_s > expected->tolerated.to)
            departs({static_cast<std::uint16_t>(row), TimepointDeparture::Kind::too_late, seen_s, *expected}, out);
        expectations_.fired(row, at);
        expectations_changed_ = true;
    }
}

void Shadow::look_at_stands(std::vector<ShadowPackets::Octets>& out) {
    const auto& stands = heard_.stands();
    for (; stands_seen_ < stands.size(); ++stands_seen_) {
        const auto [sclk, row] = stands[stands_seen_];
        if (row >= dictionary_.timeline.size() || expectations_.told(row)) continue;
        const auto expected = expectations_.expected(row);
        const double seen_s = sclk - scenario_.entry_sclk;
        if (!expected || seen_s <= expected->tolerated.to) continue;
        if (late_row_ == row)  // twice: a status may have been made just before it fired
            departs({row, TimepointDeparture::Kind::not_yet_fired, seen_s, *expected}, out);
        late_row_ = row;
    }
}

void Shadow::depart() {
    ++departures_;
    go_astray();
}

/// From here on the plan is not the vehicle's: nothing is expected by it.
void Shadow::go_astray() {
    astray_ = true;
    expectations_.withdraw();
    expectations_changed_ = true;
}

void Shadow::departs(const TimepointDeparture& departure, std::vector<ShadowPackets::Octets>& out) {
    if (departure.expected.cases < values_for_99 || !departed_rows_.insert(departure.row).second) return;
    depart();
    out.push_back(packets_.departed(departure, scenario_.entry_sclk + departure.seen_s));
}

/// @param doubt  of the value itself, which may lie so far beyond what is tolerated
void Shadow::look_at(Quantity quantity, double value, double doubt, Sclk at, std::vector<ShadowPackets::Octets>& out) {
    Excess& excess = excess_[static_cast<std::size_t>(quantity)];
    const auto range = expectations_.tell_departures() ? expectations_.range(quantity, at) : std::nullopt;
    if (!range || (value >= range->tolerated_from() - doubt && value <= range->tolerated_to() + doubt)) {
        excess = {};
        return;
    }
    if (!excess.since) excess.since = at;
    ++excess.seen;
    const double persists = quantity == Quantity::range_rate_mps ? carrier_persists_s : persists_s;
    if (excess.told || excess.seen < persists_values || at - *excess.since < persists) return;
    excess.told = true;
    depart();
    out.push_back(packets_.departed(CourseDeparture{quantity, at - scenario_.entry_sclk, value, *range}, at));
}

void Shadow::look_at_carrier(const telemetry::Received& received, Ert now, std::vector<ShadowPackets::Octets>& out) {
    const double mps_per_hz = light_mps / dictionary_.mfsk.carrier_hz;
    for (const auto& carrier : received.carrier) {
        if (!carrier.estimate || carrier.lock != CarrierLock::locked) continue;
        const double ago_s =
            static_cast<double>(now.microseconds - carrier.middle.microseconds) * 1.0e-6 + scenario_.radio.light_time_s;
        const double rate_mps = -(carrier.predict_hz + carrier.estimate->residual_hz) * mps_per_hz;
        const double doubt_mps = carrier_sigmas * carrier.estimate->sigma_hz * mps_per_hz;
        const double run_ahead_s = static_cast<double>(cycles_ - flight_->cycles()) * seconds_per_tick;
        const Sclk sent = flight_->landing().sclk() + run_ahead_s - ago_s;
        look_at(Quantity::range_rate_mps, rate_mps, doubt_mps, sent, out);
    }
}

void Shadow::expect_again(std::vector<ShadowPackets::Octets>& out) {
    if (!std::exchange(expectations_changed_, false)) return;
    const Sclk now = flight_->landing().sclk();
    for (std::size_t row = 0; row < said_.size(); ++row) {
        if (said_told_[row]) continue;
        const auto number = static_cast<std::uint16_t>(row);
        if (expectations_.told(row)) {
            if (said_[row]) out.push_back(packets_.expects(number, *said_[row], true, now));
            said_told_[row] = true;
            continue;
        }
        auto expected = expectations_.expected(row);
        if (said_[row] == expected) continue;
        out.push_back(packets_.expects(number, expected.value_or(ExpectedTime{}), false, now));
        said_[row] = expected;
    }
}

/// Orders the plan's flights when the timeline runs, and asks for what is ready.
void Shadow::plan(Made& made, std::vector<ShadowPackets::Octets>& out) {
    const Sclk now = flight_->landing().sclk();
    if (std::exchange(pending_changed_, false)) out.push_back(packets_.plan_changed(now));
    if (std::exchange(pending_flown_, false) && expectations_.tell_departures())
        out.push_back(packets_.plan_flown(expectations_.cases(), now));
    if (!live_ || order_.cases == 0 || astray_) return;
    if (ensemble_ && ensemble_->ready()) {
        auto flown = ensemble_->take();
        const bool current = ensemble_->number() == plan_number_;
        ensemble_.reset();
        if (flown && current)
            *made.request.emplace().mutable_ensemble() = std::move(*flown);
        else if (!flown)
            spdlog::warn("ground's plan could not be flown: {}", flown.error().message);
    }
    const auto& stands = own_told_.stands();
    const bool runs = !stands.empty() && stands.back().timepoint < dictionary_.timeline.size();
    if (!plan_wanted_ || !runs || ensemble_ || made.request || !sent_.empty()) return;
    plan_wanted_ = false;
    ensemble_ = std::make_unique<EnsembleFlight>(flight_->flight(), knowledge_by(heard_, held_, scenario_), scenario_,
                                                 dictionary_, order_, plan_number_);
}

double Shadow::altitude_m(const std::array<double, 3>& p_MoB_M_m) const {
    return length(p_MoB_M_m) - scenario_.target.radius_m;
}

ShadowState Shadow::state() const {
    ShadowState state;
    const auto& landing = flight_->landing();
    const Sclk now = landing.sclk();
    const NavigatedState own = state_of(landing);
    state.flight = {altitude_m(own.p_MoB_M_m), length(own.v_MB_M_mps)};
    if (const auto& stands = own_told_.stands(); !stands.empty()) state.timepoint = stands.back().timepoint;
    if (const auto& newest = heard_.newest()) state.heard_age_s = now - newest->sclk;
    if (residual_at_ && now - *residual_at_ <= residual_lasts_s) state.residual = residual_;
    const auto altitude = expectations_.range(Quantity::altitude_m, now),
               speed = expectations_.range(Quantity::speed_mps, now);
    if (altitude && speed) state.plan = {*altitude, *speed};
    state.departures = departures_;
    state.plan_cases = static_cast<std::uint16_t>(expectations_.cases());
    const bool unexpected = std::ranges::any_of(heard_.warnings(), [&](const auto& told) {
        return std::ranges::none_of(own_told_.warnings(), [&](const auto& each) { return each.name == told.name; });
    });
    if (landing.flown())
        state.stand = Stand::over;
    else if (astray_ || unexpected)
        state.stand = Stand::departed;
    else if (held_)
        state.stand = Stand::with_the_vehicle;
    return state;
}

Companion::Made Shadow::hear(const telemetry::Received& received, Ert now) {
    ++cycles_;
    if (lost_) return {};
    try {
        return make(received, now);
    } catch (const std::exception& bug) {
        // A bug of ground's flight is none of the run.
        spdlog::error("the flight that ground keeps ends: {}", bug.what());
        lost_ = true;
        Made made;
        for (std::size_t row = 0; row < said_.size(); ++row)
            if (said_[row] && !said_told_[row])
                made.packets.push_back(
                    {telemetry::station_link, now,
                     packets_.expects(static_cast<std::uint16_t>(row), {}, false, flight_->landing().sclk())});
        ShadowState over;
        over.stand = Stand::over;
        made.packets.push_back({telemetry::station_link, now, packets_.state(over, flight_->landing().sclk())});
        return made;
    }
}

Companion::Made Shadow::make(const telemetry::Received& received, Ert now) {
    Made made;
    std::vector<ShadowPackets::Octets> out;
    const bool flies = cycles_ > lag_ && !flight_->landing().flown() && !flight_->finished();
    if (flies) step();
    const auto heard_before = heard_.newest();
    heard_.hear(received);
    look_at_firings(out);
    look_at_stands(out);
    if (const auto& newest = heard_.newest(); newest && (!heard_before || heard_before->sclk != newest->sclk) && flies)
        hold_against(*newest, out);
    look_at_carrier(received, now, out);
    plan(made, out);
    expect_again(out);
    const Sclk own_now = flight_->landing().sclk();
    const bool over = !flies && cycles_ > lag_;
    if (flies && own_now.ticks() % second_ticks == 0) say_values(out);
    if ((flies && own_now.ticks() % second_ticks == 0) || (over && !std::exchange(over_told_, true)))
        out.push_back(packets_.state(state(), own_now));
    for (auto& octets : out) made.packets.push_back({telemetry::station_link, now, std::move(octets)});
    return made;
}

MakeCompanion make_shadows(const dictionary::Dictionary& dictionary, const ForecastOrder& order) {
    return [&dictionary, order](const Rehearsal& run) -> std::unique_ptr<Companion> {
        const auto& scenario = run.scenario();
        const bool told = dictionary.packet("ShadowState") != nullptr;
        if (!told || !scenario.ground_flight.value_or(false) || scenario.test_venue == simulation::TestVenue::gnc_alone)
            return nullptr;
        return std::make_unique<Shadow>(scenario, run.landing().solution(), run.landing().correlation(), dictionary,
                                        order);
    };
}

}  // namespace aeolis::server::shadow
