// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/bytes.hpp"
#include "common/space_packet.hpp"
#include "dictionaries/dictionary.hpp"
#include "telemetry/station/received.hpp"
#include "tests/support/packet_model_of.hpp"
#include "tests/support/temporary_folder.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <unistd.h>
#include <vector>

// A small mission for tests of archive and pipeline: one fast packet, one slow one, an event, a firing.
namespace aeolis::test {

inline constexpr Apid navigation_apid{0x20};
inline constexpr Apid status_apid{0x10};
inline constexpr Apid fired_apid{0x12};
inline constexpr Apid event_apid{0x30};
inline constexpr ChannelId altitude{0}, speed{1}, phase{2};
inline constexpr EvrId mortar_event{7};
inline constexpr std::uint16_t dictionary_id = 4711;

inline dictionary::Type real32(const char* unit) {
    dictionary::Type type;
    type.kind = dictionary::ValueKind::real;
    type.encoding = dictionary::Encoding::ieee754;
    type.bits = 32;
    type.unit = unit;
    return type;
}
inline dictionary::Type real64(const char* unit) {
    auto type = real32(unit);
    type.bits = 64;
    return type;
}
inline dictionary::Type whole(unsigned bits) {
    dictionary::Type type;
    type.bits = bits;
    type.unit = "1";
    return type;
}

/// Navigation: altitude_m f32, its validity bit, speed_mps f32.
inline dictionary::Dictionary small_dictionary() {
    using namespace dictionary;
    Dictionary d;
    d.mission = "TEST";
    d.id = dictionary_id;
    d.timeline_version = 3;
    d.channels = {{altitude, "altitude_m", "GNC-0001", "above the landing radius", real32("m")},
                  {speed, "speed_mps", "GNC-0002", "relative to Mars", real32("m/s")},
                  {phase, "edl_phase", "EDL-0001", "vehicle state", whole(8)}};
    Alarms too_fast;
    too_fast.ranges = {{Severity::warning, {}, 6000.0}};
    d.channels[speed.value].type.alarms = too_fast;
    const unsigned data = tm_data_offset_octets * 8;
    Packet navigation{"Navigation", "", navigation_apid, {}, tm_overhead_octets + 9, {}, 64.0, {}};
    navigation.fields = {{"altitude_m", d.channels[0].type, altitude, data, data + 64},
                         {"speed_mps", d.channels[1].type, speed, data + 32, {}}};
    Packet status{"Status", "", status_apid, {}, tm_overhead_octets + 1, {}, 1.0, {}};
    status.fields = {{"edl_phase", d.channels[2].type, phase, data, {}}};
    Packet fired{"TimepointFired", "", fired_apid, {}, tm_overhead_octets + 19, {}, {}, {}};
    auto verdict = whole(8);
    verdict.kind = ValueKind::enumerated;
    verdict.enumeration = {{0, "completed"}, {1, "timed_out"}};
    fired.fields = {{"timepoint", whole(16), {}, data, {}},
                    {"triggered_sclk", real64("s"), {}, data + 16, {}},
                    {"fired_sclk", real64("s"), {}, data + 80, {}},
                    {"verdict", verdict, {}, data + 144, {}}};
    Packet mortar{"PARACHUTE_DEPLOY", "", event_apid, mortar_event, tm_overhead_octets + 6, {}, {}, {}};
    mortar.fields = {{"event_id", whole(16), {}, data, {}}, {"speed_mps", real32("m/s"), {}, data + 16, {}}};
    d.packets = {navigation, status, fired, mortar};
    d.model = tests::packet_model_of(d);
    d.events = {{mortar_event, "PARACHUTE_DEPLOY", EventLevel::activity_hi, "mortar fired at {speed_mps} m/s", 3}};
    d.anchors = {{AnchorId{0}, "root", {}, {}, ""}, {AnchorId{1}, "entry", AnchorId{0}, {}, ""}};
    TimelineRow vent;
    vent.id = TimepointId{0};
    vent.name = "coolant_vent";
    vent.anchor = AnchorId{1};
    vent.desired_offset_s = -826.0;
    vent.minimum_offset_s = 0.0;
    TimelineRow cut = vent;
    cut.id = TimepointId{1};
    cut.name = "cut_cables";
    cut.anchor = {};
    cut.desired_offset_s = 10.0;
    TimelineRow deploy;
    deploy.id = TimepointId{2};
    deploy.name = "parachute_deploy";
    d.timeline = {vent, cut, deploy};
    d.tones.resize(256);
    for (std::size_t i = 0; i < d.tones.size(); ++i) d.tones[i].id = ToneId{static_cast<std::uint8_t>(i)};
    d.tones[9].name = "PARACHUTE";
    d.tones[9].meaning = "parachute deployed";
    return d;
}

using Octets = std::vector<std::uint8_t>;

inline Octets navigation_packet(std::uint16_t count, double sclk_s, std::optional<float> altitude_m, float speed_mps) {
    Octets packet(tm_overhead_octets + 9);
    BitWriter bits{std::span<std::uint8_t>(packet).subspan(tm_data_offset_octets)};
    bits.put_float(altitude_m.value_or(0.0F));
    bits.put_float(speed_mps);
    bits.put(altitude_m ? 1 : 0, 1);
    seal_tm_packet(packet, navigation_apid, count, Sclk{sclk_s}, dictionary_id);
    return packet;
}
inline Octets status_packet(std::uint16_t count, double sclk_s, std::uint8_t phase_number) {
    Octets packet(tm_overhead_octets + 1);
    packet[tm_data_offset_octets] = phase_number;
    seal_tm_packet(packet, status_apid, count, Sclk{sclk_s}, dictionary_id);
    return packet;
}
inline Octets fired_packet(std::uint16_t count, double sclk_s, std::uint16_t timepoint) {
    Octets packet(tm_overhead_octets + 19);
    BitWriter bits{std::span<std::uint8_t>(packet).subspan(tm_data_offset_octets)};
    bits.put(timepoint, 16);
    bits.put_double(sclk_s - 0.25);
    bits.put_double(sclk_s);
    bits.put(0, 8);
    seal_tm_packet(packet, fired_apid, count, Sclk{sclk_s}, dictionary_id);
    return packet;
}
inline Octets mortar_packet(std::uint16_t count, double sclk_s, float speed_mps) {
    Octets packet(tm_overhead_octets + 6);
    BitWriter bits{std::span<std::uint8_t>(packet).subspan(tm_data_offset_octets)};
    bits.put(mortar_event.value, 16);
    bits.put_float(speed_mps);
    seal_tm_packet(packet, event_apid, count, Sclk{sclk_s}, dictionary_id);
    return packet;
}

inline telemetry::ReceivedPacket live(Octets octets, std::int64_t ert_us = 1'000'000) {
    return {telemetry::uhf_live_link, Ert{ert_us}, std::move(octets)};
}
inline telemetry::ReceivedPacket recorded(Octets octets, std::int64_t ert_us = 900'000'000) {
    return {telemetry::relay_link, Ert{ert_us}, std::move(octets)};
}

}  // namespace aeolis::test
