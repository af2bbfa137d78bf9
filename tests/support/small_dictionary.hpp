// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/bytes.hpp"
#include "common/space_packet.hpp"
#include "dictionaries/dictionary.hpp"
#include "tests/support/packet_model_of.hpp"

#include <bit>
#include <cstdint>
#include <string_view>
#include <vector>

// A mission of a few words, so that a ground test shows everything that it depends on.
namespace aeolis::tests {

inline dictionary::Type number(std::string_view unit, dictionary::Encoding encoding, unsigned bits) {
    dictionary::Type type;
    type.kind =
        encoding == dictionary::Encoding::ieee754 ? dictionary::ValueKind::real : dictionary::ValueKind::integer;
    type.encoding = encoding;
    type.bits = bits;
    type.unit = unit;
    return type;
}
inline dictionary::Type u(unsigned bits) {
    return number("1", dictionary::Encoding::unsigned_integer, bits);
}
inline dictionary::Type f32(std::string_view unit) {
    return number(unit, dictionary::Encoding::ieee754, 32);
}
inline dictionary::Type f64(std::string_view unit) {
    return number(unit, dictionary::Encoding::ieee754, 64);
}
inline dictionary::Type flag() {
    auto type = u(1);
    type.kind = dictionary::ValueKind::boolean;
    type.unit = "";
    return type;
}
inline dictionary::Type labels(unsigned bits, std::vector<dictionary::EnumValue> values) {
    auto type = u(bits);
    type.kind = dictionary::ValueKind::enumerated;
    type.unit = "";
    type.enumeration = std::move(values);
    return type;
}
inline dictionary::Type within(dictionary::Type type, double least, double largest) {
    type.valid_min = least;
    type.valid_max = largest;
    return type;
}

/// Builds a packet of consecutive fields after the secondary header, padded to a whole octet before its CRC.
class PacketMaker {
  public:
    PacketMaker(dictionary::Dictionary& dictionary, std::string_view name, Apid apid) : dictionary_(dictionary) {
        packet_.name = name;
        packet_.apid = apid;
    }
    PacketMaker& field(std::string_view name, dictionary::Type type) {
        dictionary::Field field;
        field.name = name;
        field.type = std::move(type);
        field.position_bits = at_;
        at_ += field.type.bits;
        packet_.fields.push_back(std::move(field));
        return *this;
    }
    PacketMaker& channel(std::string_view name, dictionary::Type type) {
        const ChannelId id{static_cast<std::uint16_t>(dictionary_.channels.size())};
        dictionary_.channels.push_back({id, std::string{name}, "", "", type});
        field(name, std::move(type));
        packet_.fields.back().channel = id;
        return *this;
    }
    /// Adds a validity bit after the last field.
    PacketMaker& with_validity() {
        packet_.fields.back().validity_bit = at_++;
        return *this;
    }
    PacketMaker& spare(unsigned bits) {
        at_ += bits;
        return *this;
    }
    PacketMaker& event(EvrId id, std::string_view format) {
        packet_.event = id;
        dictionary_.events.push_back(
            {id, packet_.name, dictionary::EventLevel::activity_hi, std::string{format}, dictionary_.packets.size()});
        return field("event_id", u(16));
    }
    void add() {
        packet_.octets = (at_ + 7) / 8 + packet_crc_octets;
        dictionary_.packets.push_back(packet_);
    }

  private:
    dictionary::Dictionary& dictionary_;
    dictionary::Packet packet_;
    unsigned at_ = tm_data_offset_octets * 8;
};

inline constexpr Apid status_apid{0x010}, held_apid{0x014}, event_apid{0x030}, explanation_apid{0x031};
inline constexpr EvrId accepted_event{1}, refused_event{2}, executed_event{3}, parachute_event{4};
inline constexpr Opcode no_op{0x0101}, set_parameters{0x0102}, do_edl{0x0103};

inline void add_packets(dictionary::Dictionary& dictionary) {
    auto speed = f32("m/s");
    speed.alarms.ranges = {{dictionary::Severity::warning, {}, 600.0}, {dictionary::Severity::critical, -1.0, 700.0}};
    speed.alarms.min_violations = 2;
    auto temperature = number("K", dictionary::Encoding::twos_complement, 12);
    temperature.calibrator = {250.0, 0.5, 0.25};
    auto phase = labels(8, {{0, "pre_edl"}, {1, "parachute_descent"}, {2, "landed"}});
    phase.alarms.values = {{dictionary::Severity::severe, 2}};
    PacketMaker{dictionary, "Status", status_apid}
        .channel("speed_mps", speed)
        .channel("altitude_m", f64("m"))
        .with_validity()
        .channel("parameters_received", flag())
        .channel("late_cruise", flag())
        .spare(5)
        .channel("edl_phase", phase)
        .channel("temperature_K", temperature)
        .spare(4)
        .add();
    PacketMaker{dictionary, "ParametersHeld", held_apid}
        .channel("solution_id", u(16))
        .channel("entry_sclk", f64("s"))
        .channel("parachute_speed_mps", f32("m/s"))
        .add();
    PacketMaker{dictionary, "COMMAND_ACCEPTED", event_apid}
        .event(accepted_event, "Command {opcode} (packet {count}) accepted")
        .field("opcode", u(16))
        .field("count", u(16))
        .add();
    PacketMaker{dictionary, "COMMAND_REFUSED", event_apid}
        .event(refused_event, "Command {opcode} (packet {count}) refused: {reason}")
        .field("opcode", u(16))
        .field("count", u(16))
        .field("reason", labels(8, {{0, "wrong_phase"}, {1, "no_parameters"}}))
        .add();
    PacketMaker{dictionary, "COMMAND_EXECUTED", event_apid}
        .event(executed_event, "Command {opcode} (packet {count}) executed")
        .field("opcode", u(16))
        .field("count", u(16))
        .add();
    PacketMaker{dictionary, "PARACHUTE_DEPLOY", event_apid}
        .event(parachute_event, "Mortar at {speed_mps} m/s, {oddity}, {altitude_m} m")
        .field("speed_mps", f32("m/s"))
        .field("altitude_m", f32("m"))
        .with_validity()
        .add();

    PacketMaker explanation{dictionary, "Explanation", explanation_apid};
    explanation
        .field("decision",
               labels(16, {{0, "parachute_deploy"}, {1, "timepoint"}, {2, "tone"}, {3, "command"}, {4, "edl_phase"}}))
        .field("verdict", labels(8, {{0, "fired"}, {1, "held"}, {2, "chosen"}, {3, "refused"}, {4, "changed"}}))
        .field("subject", u(16))
        .field("condition_count", u(8));
    for (const char slot : {'1', '2', '3', '4'}) {
        const std::string ending = std::string{"_"} + slot;
        explanation.field("condition" + ending, labels(16, {{0, "none"}, {1, "speed_mps"}, {2, "tone_priority"}}))
            .field("value" + ending, f64("1"))
            .field("bound" + ending, f64("1"))
            .field("comparison" + ending, labels(8, {{0, "lt"}, {1, "le"}, {2, "eq"}, {3, "ge"}, {4, "gt"}}))
            .field("holds" + ending, flag())
            .spare(7);
    }
    explanation.add();
}

inline void add_argument(dictionary::Command& command, std::string_view name, dictionary::Type type,
                         std::optional<double> default_value = {}) {
    unsigned at = 0;
    for (const auto& argument : command.arguments) at = argument.position_bits + argument.type.bits;
    command.arguments.push_back({std::string{name}, "", std::move(type), at, default_value});
    command.argument_octets = (at + command.arguments.back().type.bits + 7) / 8;
}

inline void add_commands(dictionary::Dictionary& dictionary) {
    const std::vector<dictionary::Verifier> verifiers{{"accepted", accepted_event, refused_event, 10.0},
                                                      {"executed", executed_event, refused_event, 20.0}};
    dictionary::Command plain;
    plain.opcode = no_op;
    plain.name = "NO_OP";
    plain.verifiers = verifiers;

    dictionary::Command set;
    set.opcode = set_parameters;
    set.name = "EDL_SET_PARAMETERS";
    set.verifiers = verifiers;
    add_argument(set, "solution_id", within(u(16), 1, 65535));
    add_argument(set, "entry_sclk", within(f64("s"), 0.0, 4294967295.0));
    add_argument(set, "parachute_speed_mps", within(f32("m/s"), 380.0, 430.0), 405.0);

    dictionary::Command start;
    start.opcode = do_edl;
    start.name = "EDL_DO_EDL";
    start.significance = dictionary::Significance::critical;
    start.reason_for_warning = "it cannot be undone";
    start.verifiers = verifiers;
    start.preconditions = {{dictionary.channel("parameters_received")->id, "==", 1.0, ""},
                           {dictionary.channel("late_cruise")->id, "==", 1.0, ""}};
    dictionary.commands = {plain, set, start};
}

inline dictionary::Dictionary small_dictionary() {
    dictionary::Dictionary dictionary;
    dictionary.mission = "small";
    dictionary.id = 0x1234;
    add_packets(dictionary);
    dictionary.model = packet_model_of(dictionary);
    add_commands(dictionary);
    dictionary.timeline.resize(3);
    dictionary.timeline[2].name = "coolant_vent";
    dictionary.tones.resize(256);
    dictionary.tones[37].name = "parachute_out";
    return dictionary;
}

/// Builds a telemetry packet by the names of its fields; unset fields are zero.
class PacketFiller {
  public:
    PacketFiller(const dictionary::Dictionary& dictionary, std::string_view name)
        : dictionary_(dictionary), packet_(*dictionary.packet(name)), octets_(packet_.octets) {
        if (packet_.event) raw("event_id", packet_.event->value);
    }
    PacketFiller& raw(std::string_view name, std::uint64_t word) {
        for (const auto& field : packet_.fields) {
            if (field.name != name) continue;
            for (unsigned i = 0; i < field.type.bits; ++i)
                put_bit(field.position_bits + i, (word >> (field.type.bits - 1 - i)) & 1U);
            if (field.validity_bit) put_bit(*field.validity_bit, 1);
            return *this;
        }
        throw CheckFailed("no such field", __FILE__, __LINE__);
    }
    PacketFiller& real(std::string_view name, double value) {
        for (const auto& field : packet_.fields)
            if (field.name == name)
                return raw(name, field.type.bits == 32 ? std::bit_cast<std::uint32_t>(static_cast<float>(value))
                                                       : std::bit_cast<std::uint64_t>(value));
        throw CheckFailed("no such field", __FILE__, __LINE__);
    }
    std::vector<std::uint8_t> seal(std::uint16_t count = 0, Sclk time = {397'500'000.0}) {
        seal_tm_packet(octets_, packet_.apid, count, time, dictionary_.id);
        return octets_;
    }

  private:
    void put_bit(std::size_t at, std::uint64_t bit) {
        octets_[at / 8] = static_cast<std::uint8_t>(octets_[at / 8] | (bit & 1U) << (7 - at % 8));
    }
    const dictionary::Dictionary& dictionary_;
    const dictionary::Packet& packet_;
    std::vector<std::uint8_t> octets_;
};

}  // namespace aeolis::tests
