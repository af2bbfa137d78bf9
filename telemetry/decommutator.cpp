// SPDX-License-Identifier: Apache-2.0
#include "telemetry/decommutator.hpp"

#include "common/bytes.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace aeolis::telemetry {
namespace {

constexpr unsigned event_id_position_bits = tm_data_offset_octets * 8;
constexpr unsigned event_id_bits = 16;
constexpr std::size_t apid_count = 2048;

// Written out so that the compiler makes one load and one swap of each.
std::uint64_t word32(const std::uint8_t* octet) {
    return static_cast<std::uint32_t>(octet[0]) << 24 | static_cast<std::uint32_t>(octet[1]) << 16 |
           static_cast<std::uint32_t>(octet[2]) << 8 | static_cast<std::uint32_t>(octet[3]);
}

/// Reads a field. Most fields begin and end at octets: those are read as words.
std::uint64_t read_field(std::span<const std::uint8_t> packet, std::uint32_t position_bits, unsigned bits) {
    if (position_bits % 8 != 0) return read_bits(packet, position_bits, bits);
    const std::uint8_t* octet = packet.data() + position_bits / 8;
    switch (bits) {
    case 8: return octet[0];
    case 16: return static_cast<std::uint64_t>(octet[0]) << 8 | octet[1];
    case 32: return word32(octet);
    case 64: return word32(octet) << 32 | word32(octet + 4);
    default: return read_bits(packet, position_bits, bits);
    }
}

}  // namespace

const char* name_of(Refusal refusal) {
    switch (refusal) {
    case Refusal::not_a_packet: return "not_a_packet";
    case Refusal::bad_crc: return "bad_crc";
    case Refusal::other_dictionary: return "other_dictionary";
    case Refusal::unknown_apid: return "unknown_apid";
    case Refusal::unknown_event: return "unknown_event";
    case Refusal::wrong_length: return "wrong_length";
    }
    return "";
}

Decommutator::Decommutator(const dictionary::Dictionary& dictionary)
    : dictionary_id_(dictionary.id), by_apid_(apid_count, no_packet), holds_events_(apid_count, false) {
    AEOLIS_CHECK(dictionary.packets.size() < no_packet);
    for (std::size_t index = 0; index < dictionary.packets.size(); ++index) {
        const dictionary::Packet& packet = dictionary.packets[index];
        AEOLIS_CHECK(packet.apid.value < apid_count);
        AEOLIS_CHECK(packet.octets >= tm_overhead_octets);
        if (packet.event) {
            AEOLIS_CHECK(packet.octets * 8 >= event_id_position_bits + event_id_bits);
            holds_events_[packet.apid.value] = true;
            events_.push_back({packet.apid.value, packet.event->value, static_cast<std::uint32_t>(index)});
        } else {
            by_apid_[packet.apid.value] = static_cast<std::uint16_t>(index);
        }
        plans_.push_back({static_cast<std::uint32_t>(steps_.size()), static_cast<std::uint32_t>(packet.fields.size()),
                          packet.octets});
        for (const dictionary::Field& field : packet.fields) steps_.push_back(compile(field, packet));
    }
    std::sort(events_.begin(), events_.end());
}

Decommutator::Step Decommutator::compile(const dictionary::Field& field, const dictionary::Packet& packet) {
    const dictionary::Type& type = field.type;
    // The only check of bounds: decode() then just compares the packet's length with the plan's.
    AEOLIS_CHECK(type.bits >= 1 && type.bits <= 64);
    AEOLIS_CHECK(field.position_bits + type.bits <= packet.octets * 8);
    AEOLIS_CHECK(!field.validity_bit || *field.validity_bit < packet.octets * 8);
    Step step;
    step.position_bits = field.position_bits;
    step.validity_bit = field.validity_bit ? *field.validity_bit : no_validity_bit;
    step.bits = static_cast<std::uint8_t>(type.bits);
    switch (type.encoding) {
    case dictionary::Encoding::unsigned_integer: step.form = Form::unsigned_integer; break;
    case dictionary::Encoding::twos_complement: step.form = Form::signed_integer; break;
    case dictionary::Encoding::ieee754:
        AEOLIS_CHECK(type.bits == 32 || type.bits == 64);
        step.form = type.bits == 32 ? Form::float32 : Form::float64;
        break;
    }
    step.first_coefficient = static_cast<std::uint32_t>(coefficients_.size());
    step.coefficients = static_cast<std::uint16_t>(type.calibrator.size());
    coefficients_.insert(coefficients_.end(), type.calibrator.begin(), type.calibrator.end());
    return step;
}

std::optional<std::size_t> Decommutator::event_packet(Apid apid, std::span<const std::uint8_t> packet) const {
    const auto id = static_cast<std::uint16_t>(read_bits(packet, event_id_position_bits, event_id_bits));
    const auto found = std::lower_bound(events_.begin(), events_.end(), EventPlan{apid.value, id, 0});
    if (found == events_.end() || found->apid != apid.value || found->event != id) return std::nullopt;
    return found->packet;
}

std::optional<Refusal> Decommutator::decode(std::span<const std::uint8_t> packet, Decoded& into) const {
    const auto header = read_tm_packet(packet);
    if (!header) {
        const auto primary = read_primary_header(packet);
        const bool whole = primary && !primary->telecommand && primary->secondary_header &&
                           packet.size() >= tm_overhead_octets && packet.size() == primary->packet_octets();
        return whole ? Refusal::bad_crc : Refusal::not_a_packet;
    }
    if (header->dictionary_id != dictionary_id_) return Refusal::other_dictionary;

    const Apid apid = header->primary.apid;
    std::size_t index = by_apid_[apid.value];
    if (holds_events_[apid.value]) {
        if (packet.size() * 8 < event_id_position_bits + event_id_bits + packet_crc_octets * 8)
            return Refusal::wrong_length;
        const auto event = event_packet(apid, packet);
        if (!event) return Refusal::unknown_event;
        index = *event;
    } else if (index == no_packet) {
        return Refusal::unknown_apid;
    }
    const Plan& plan = plans_[index];
    if (packet.size() != plan.octets) return Refusal::wrong_length;

    into.packet = index;
    into.header = *header;
    into.raw.resize(plan.steps);
    into.value.resize(plan.steps);
    for (std::size_t i = 0; i < plan.steps; ++i) {
        const Step& step = steps_[plan.first_step + i];
        const std::uint64_t raw = read_field(packet, step.position_bits, step.bits);
        into.raw[i] = raw;
        into.value[i] = step.validity_bit != no_validity_bit && read_bits(packet, step.validity_bit, 1) == 0
                            ? std::nullopt
                            : calibrated(step, raw);
    }
    return std::nullopt;
}

std::optional<double> Decommutator::calibrated(const Step& step, std::uint64_t raw) const {
    double value = 0.0;
    switch (step.form) {
    case Form::unsigned_integer: value = static_cast<double>(raw); break;
    case Form::signed_integer: value = static_cast<double>(sign_extend(raw, step.bits)); break;
    case Form::float32: value = static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(raw))); break;
    case Form::float64: value = std::bit_cast<double>(raw); break;
    }
    if (step.coefficients > 0) {
        const double* coefficient = coefficients_.data() + step.first_coefficient;
        double sum = 0.0;
        for (int k = step.coefficients - 1; k >= 0; --k) sum = sum * value + coefficient[k];
        value = sum;
    }
    if (!std::isfinite(value)) return std::nullopt;
    return value;
}

}  // namespace aeolis::telemetry
