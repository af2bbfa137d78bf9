// SPDX-License-Identifier: Apache-2.0
#include "server/shadow/shadow_packets.hpp"

#include "common/bytes.hpp"
#include "common/check.hpp"
#include "common/space_packet.hpp"

#include <algorithm>
#include <array>

namespace aeolis::server::shadow {
namespace {

constexpr Apid state_apid{0x7E3}, moved_apid{0x7E4}, expects_apid{0x7E5}, event_apid{0x7E6}, values_apid{0x7E7};
constexpr std::size_t state_octets = 60, moved_octets = 12, expects_octets = 29, event_id_octets = 2;
constexpr std::size_t timepoint_departure_octets = 35, course_departure_octets = 33;
constexpr std::uint64_t flag = 1;

void put(BitWriter& out, double value) {
    out.put_float(static_cast<float>(value));
}

}  // namespace

ShadowPackets::ShadowPackets(const dictionary::Dictionary& dictionary) : dictionary_(dictionary) {}

ShadowPackets::Octets ShadowPackets::sealed(Apid apid, std::span<const std::uint8_t> data, Sclk at) {
    Octets packet(tm_overhead_octets + data.size());
    std::ranges::copy(data, packet.begin() + tm_data_offset_octets);
    seal_tm_packet(packet, apid, counts_[apid.value]++, at, dictionary_.id);
    return packet;
}

ShadowPackets::Octets ShadowPackets::event(std::string_view name, std::span<const std::uint8_t> arguments, Sclk at) {
    const auto found = std::ranges::find(dictionary_.events, name, &dictionary::Event::name);
    AEOLIS_CHECK(found != dictionary_.events.end());
    Octets data(event_id_octets + arguments.size());
    BitWriter out{data};
    out.put(found->id.value, 16);
    out.put_octets(arguments);
    return sealed(event_apid, data, at);
}

ShadowPackets::Octets ShadowPackets::state(const ShadowState& state, Sclk at) {
    std::array<std::uint8_t, state_octets> data{};
    BitWriter out{data};
    out.put(state.flight ? flag : 0, 1);
    out.put(state.heard_age_s ? flag : 0, 1);
    out.put(state.residual ? flag : 0, 1);
    out.put(state.plan ? flag : 0, 1);
    out.put(state.timepoint ? flag : 0, 1);
    out.put(0, 3);
    out.put(static_cast<std::uint64_t>(state.stand), 8);
    out.put(state.timepoint.value_or(0), 16);
    const auto flight = state.flight.value_or(ShadowState::Course{});
    put(out, flight.altitude_m);
    put(out, flight.speed_mps);
    put(out, state.heard_age_s.value_or(0.0));
    const auto residual = state.residual.value_or(ShadowState::Residual{});
    for (const double each : {residual.position_m, residual.altitude_m, residual.speed_mps, residual.attitude_deg})
        put(out, each);
    const auto plan = state.plan.value_or(ShadowState::Plan{});
    for (const auto& range : {plan.altitude_m, plan.speed_mps})
        for (const double each : {range.least, range.median, range.most}) put(out, each);
    out.put(state.departures, 16);
    out.put(state.plan_cases, 16);
    return sealed(state_apid, data, at);
}

ShadowPackets::Octets ShadowPackets::moved(const ShadowMoved& moved, Sclk at) {
    std::array<std::uint8_t, moved_octets> data{};
    BitWriter out{data};
    for (const double each : {moved.position_m, moved.speed_mps, moved.attitude_deg}) put(out, each);
    return sealed(moved_apid, data, at);
}

ShadowPackets::Octets ShadowPackets::expects(std::uint16_t row, const ExpectedTime& time, bool told, Sclk at) {
    std::array<std::uint8_t, expects_octets> data{};
    BitWriter out{data};
    const auto interval = time.interval_99.value_or(ExpectedTime::Interval{});
    out.put(row, 16);
    out.put(told ? flag : 0, 1);
    out.put(time.interval_99 ? flag : 0, 1);
    out.put(0, 6);
    for (const double each : {time.e_s, interval.from, interval.to}) out.put_double(each);
    out.put(time.cases, 16);
    return sealed(expects_apid, data, at);
}

ShadowPackets::Octets ShadowPackets::departed(const TimepointDeparture& departure, Sclk at) {
    std::array<std::uint8_t, timepoint_departure_octets> data{};
    BitWriter out{data};
    out.put(departure.row, 16);
    out.put(static_cast<std::uint64_t>(departure.kind), 8);
    const auto& expected = departure.expected;
    for (const double each : {departure.seen_s, expected.e_s, expected.tolerated.from, expected.tolerated.to})
        out.put_double(each);
    return event("TIMEPOINT_DEPARTED", data, at);
}

ShadowPackets::Octets ShadowPackets::departed(const CourseDeparture& departure, Sclk at) {
    std::array<std::uint8_t, course_departure_octets> data{};
    BitWriter out{data};
    out.put(static_cast<std::uint64_t>(departure.quantity), 8);
    for (const double each :
         {departure.seen_s, departure.observed, departure.range.tolerated_from(), departure.range.tolerated_to()})
        out.put_double(each);
    return event("COURSE_DEPARTED", data, at);
}

std::vector<ShadowPackets::Octets> ShadowPackets::values(std::span<const telemetry::ExpectedValue> values,
                                                         Sclk second) {
    std::vector<Octets> packets;
    for (std::size_t i = 0; i < values.size(); i += telemetry::expected_values_max) {
        const auto some = values.subspan(i, std::min(telemetry::expected_values_max, values.size() - i));
        packets.push_back(sealed(values_apid, telemetry::pack_expected_values(some, second), second));
    }
    return packets;
}

ShadowPackets::Octets ShadowPackets::plan_flown(std::uint32_t cases, Sclk at) {
    std::array<std::uint8_t, 2> data{};
    BitWriter out{data};
    out.put(cases, 16);
    return event("PLAN_FLOWN", data, at);
}

ShadowPackets::Octets ShadowPackets::plan_changed(Sclk at) {
    return event("PLAN_CHANGED", {}, at);
}

}  // namespace aeolis::server::shadow
