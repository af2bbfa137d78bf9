// SPDX-License-Identifier: Apache-2.0
#include "commands/encoder.hpp"

#include "commands/number.hpp"
#include "common/bytes.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace aeolis::commands {
namespace {

using dictionary::Argument;
using dictionary::Encoding;
using dictionary::Type;
using dictionary::ValueKind;

std::string with_unit(const Type& type, const std::string& number) {
    return type.unit.empty() || type.unit == "1" ? number : number + " " + type.unit;
}

std::string in_quotes(std::string_view name) {
    return "'" + std::string{name} + "'";
}

/// "argument 'parachute_speed_mps' of EDL_SET_PARAMETERS is 500 m/s: "
std::string about(const dictionary::Command& command, const Argument& argument, double value) {
    return "argument " + in_quotes(argument.name) + " of " + command.name + " is " +
           with_unit(argument.type, shortest_text(value)) + ": ";
}

std::string range_text(const Type& type) {
    if (type.valid_min && type.valid_max)
        return "must be from " + shortest_text(*type.valid_min) + " to " +
               with_unit(type, shortest_text(*type.valid_max));
    return type.valid_min ? "must be at least " + with_unit(type, shortest_text(*type.valid_min))
                          : "must be at most " + with_unit(type, shortest_text(*type.valid_max));
}

bool in_range(const Type& type, double value) {
    return (!type.valid_min || value >= *type.valid_min) && (!type.valid_max || value <= *type.valid_max);
}

std::string labels_text(const Type& type) {
    std::string text;
    for (const auto& entry : type.enumeration)
        text += (text.empty() ? "" : ", ") + std::to_string(entry.value) + " " + entry.label;
    return text;
}

bool is_label(const Type& type, double value) {
    return std::any_of(type.enumeration.begin(), type.enumeration.end(),
                       [&](const auto& entry) { return static_cast<double>(entry.value) == value; });
}

struct Bits {
    std::uint64_t word = 0;
    double means = 0.0;  ///< the receiver's value: rounded to the encoding
};

/// The raw number for an engineering value. Only a linear calibration can be inverted.
Result<double> uncalibrated(const std::string& prefix, const Type& type, double value) {
    const auto& c = type.calibrator;
    if (c.empty()) return value;
    if (c.size() != 2 || c[1] == 0.0) return Error{prefix + "its calibrator has no inverse"};
    return (value - c[0]) / c[1];
}
double calibrated(const Type& type, double raw) {
    double sum = 0.0;
    for (std::size_t k = type.calibrator.size(); k-- > 0;) sum = sum * raw + type.calibrator[k];
    return type.calibrator.empty() ? raw : sum;
}

Result<Bits> whole_number(const std::string& prefix, const Type& type, double value) {
    if (value != std::floor(value)) return Error{prefix + "must be a whole number"};
    const bool is_signed = type.encoding == Encoding::twos_complement;
    const double span = std::ldexp(1.0, static_cast<int>(type.bits) - (is_signed ? 1 : 0));
    const double least = is_signed ? -span : 0.0;
    if (value < least || value >= span)
        return Error{prefix + "does not fit " + std::to_string(type.bits) + " bits" +
                     (is_signed ? "" : " without sign")};
    const std::uint64_t word =
        is_signed ? static_cast<std::uint64_t>(static_cast<std::int64_t>(value)) : static_cast<std::uint64_t>(value);
    return Bits{word, value};
}

Result<Bits> floating(const std::string& prefix, const Type& type, double value) {
    if (type.bits == 64) return Bits{std::bit_cast<std::uint64_t>(value), value};
    AEOLIS_CHECK(type.bits == 32);
    const auto narrow = static_cast<float>(value);
    if (!std::isfinite(narrow)) return Error{prefix + "does not fit a 32-bit float"};
    return Bits{std::bit_cast<std::uint32_t>(narrow), static_cast<double>(narrow)};
}

Result<Bits> bits_of(const dictionary::Command& command, const Argument& argument, double value) {
    const Type& type = argument.type;
    const std::string prefix = about(command, argument, value);
    if (!std::isfinite(value)) return Error{prefix + "must be a finite number"};
    if (!in_range(type, value)) return Error{prefix + range_text(type)};
    if (type.kind == ValueKind::boolean && value != 0.0 && value != 1.0) return Error{prefix + "must be 0 or 1"};
    if (type.kind == ValueKind::enumerated && !is_label(type, value))
        return Error{prefix + "must be one of " + labels_text(type)};

    const auto raw = uncalibrated(prefix, type, value);
    if (!raw) return raw.error();
    auto bits = type.encoding == Encoding::ieee754 ? floating(prefix, type, *raw) : whole_number(prefix, type, *raw);
    if (!bits) return bits;
    // Flight checks what it reads: rounding to 32 bits must not move a value from just inside the range to just
    // outside.
    bits->means = calibrated(type, bits->means);
    if (!in_range(type, bits->means))
        return Error{prefix + "becomes " + with_unit(type, shortest_text(bits->means)) + " in 32 bits, " +
                     range_text(type)};
    return bits;
}

/// Writes one field. Arguments may be in any order and leave gaps; `octets` start at zero.
void put_at(std::span<std::uint8_t> octets, std::size_t position_bits, unsigned bits, std::uint64_t word) {
    AEOLIS_CHECK(bits >= 1 && bits <= 64 && position_bits + bits <= octets.size() * 8);
    for (unsigned i = 0; i < bits; ++i) {
        const std::size_t at = position_bits + i;
        const auto bit = static_cast<unsigned>((word >> (bits - 1 - i)) & 1U);
        octets[at / 8] = static_cast<std::uint8_t>(octets[at / 8] | bit << (7 - at % 8));
    }
}

const Argument* argument_named(const dictionary::Command& command, std::string_view name) {
    for (const Argument& argument : command.arguments)
        if (argument.name == name) return &argument;
    return nullptr;
}

const NamedValue* value_named(std::span<const NamedValue> values, std::string_view name) {
    for (const NamedValue& value : values)
        if (value.name == name) return &value;
    return nullptr;
}

}  // namespace

Result<std::vector<std::uint8_t>> encode(const dictionary::Command& command, std::span<const NamedValue> arguments,
                                         std::uint16_t count) {
    AEOLIS_CHECK(count < count_modulus);
    for (const NamedValue& given : arguments) {
        if (argument_named(command, given.name) == nullptr)
            return Error{command.name + " has no argument " + in_quotes(given.name)};
        if (value_named(arguments, given.name) != &given)
            return Error{"argument " + in_quotes(given.name) + " of " + command.name + " is given twice"};
    }

    std::vector<std::uint8_t> packet(tc_overhead_octets + command.argument_octets);
    const auto packet_arguments = std::span{packet}.subspan(tc_arguments_offset_octets, command.argument_octets);
    for (const Argument& argument : command.arguments) {
        const NamedValue* given = value_named(arguments, argument.name);
        if (given == nullptr && !argument.default_value)
            return Error{"argument " + in_quotes(argument.name) + " of " + command.name + " is missing" +
                         (argument.type.valid_min || argument.type.valid_max ? ": " + range_text(argument.type) : "")};
        const auto bits = bits_of(command, argument, given != nullptr ? given->value : *argument.default_value);
        if (!bits) return bits.error();
        put_at(packet_arguments, argument.position_bits, argument.type.bits, bits->word);
    }
    seal_tc_packet(packet, telecommand_apid, count, command.opcode);
    return packet;
}

Result<std::vector<NamedValue>> decode(const dictionary::Command& command, std::span<const std::uint8_t> packet) {
    const auto telecommand = read_tc_packet(packet);
    if (!telecommand) return Error{"no whole telecommand packet with a good CRC"};
    if (telecommand->opcode != command.opcode)
        return Error{"opcode " + std::to_string(telecommand->opcode.value) + " is not that of " + command.name};
    if (telecommand->arguments.size() != command.argument_octets)
        return Error{command.name + " has " + std::to_string(command.argument_octets) + " octets of arguments, not " +
                     std::to_string(telecommand->arguments.size())};

    std::vector<NamedValue> values;
    values.reserve(command.arguments.size());
    for (const Argument& argument : command.arguments) {
        const Type& type = argument.type;
        const std::uint64_t word = read_bits(telecommand->arguments, argument.position_bits, type.bits);
        values.push_back({argument.name, calibrated(type, number_of(type, word))});
    }
    return values;
}

std::vector<NamedValue> fill_from_solution(const dictionary::Command& command, std::span<const NamedValue> given,
                                           std::span<const NamedValue> solution) {
    std::vector<NamedValue> filled{given.begin(), given.end()};
    for (const NamedValue& known : solution)
        if (argument_named(command, known.name) != nullptr && value_named(given, known.name) == nullptr)
            filled.push_back(known);
    return filled;
}

std::string arguments_text(std::span<const NamedValue> arguments) {
    std::string text;
    for (const NamedValue& argument : arguments) {
        if (!text.empty()) text += ' ';
        text += argument.name + "=" + shortest_text(argument.value);
    }
    return text;
}

}  // namespace aeolis::commands
