// SPDX-License-Identifier: Apache-2.0
#include "commands/read_back.hpp"

#include "commands/number.hpp"
#include "common/bytes.hpp"
#include "common/space_packet.hpp"

#include <algorithm>
#include <cstdio>

namespace aeolis::commands {
namespace {

const dictionary::Field* field_of(const dictionary::Packet& packet, const dictionary::Argument& argument) {
    for (const dictionary::Field& field : packet.fields)
        if (field.name == argument.name && field.type.bits == argument.type.bits &&
            field.type.encoding == argument.type.encoding)
            return &field;
    return nullptr;
}

std::string value_text(const dictionary::Type& type, std::uint64_t word) {
    return shortest_text(number_of(type, word));
}

std::string hexadecimal(std::uint64_t word) {
    char buffer[24];
    std::snprintf(buffer, sizeof buffer, " (0x%llX)", static_cast<unsigned long long>(word));
    return buffer;
}

}  // namespace

const dictionary::Packet* read_back_packet(const dictionary::Dictionary& dictionary,
                                           const dictionary::Command& command) {
    if (command.arguments.empty()) return nullptr;
    for (const dictionary::Packet& packet : dictionary.packets) {
        const auto held = [&](const auto& argument) { return field_of(packet, argument) != nullptr; };
        if (!packet.event && std::all_of(command.arguments.begin(), command.arguments.end(), held)) return &packet;
    }
    return nullptr;
}

std::string ReadBack::text() const {
    const std::string at = " at SCLK " + text_of(held_at);
    if (equal())
        return std::to_string(compared) + " of " + std::to_string(compared) + " arguments equal bit for bit" + at;
    std::string text =
        std::to_string(differences.size()) + " of " + std::to_string(compared) + " arguments differ" + at;
    for (std::size_t i = 0; i < differences.size(); ++i)
        text += (i == 0 ? ": " : "; ") + differences[i].argument + " sent " + differences[i].sent + ", held " +
                differences[i].held;
    return text;
}

ReadBack compare(const dictionary::Command& command, std::span<const std::uint8_t> sent,
                 const dictionary::Packet& report, std::span<const std::uint8_t> held) {
    const auto telecommand = read_tc_packet(sent);
    const auto header = read_tm_packet(held);
    AEOLIS_CHECK(telecommand && telecommand->opcode == command.opcode &&
                 telecommand->arguments.size() == command.argument_octets);
    AEOLIS_CHECK(header && held.size() == report.octets);

    ReadBack result;
    result.held_at = header->time;
    for (const dictionary::Argument& argument : command.arguments) {
        const dictionary::Field* field = field_of(report, argument);
        AEOLIS_CHECK(field != nullptr);  // read_back_packet() chose this report
        ++result.compared;
        const std::uint64_t ours = read_bits(telecommand->arguments, argument.position_bits, argument.type.bits);
        const std::uint64_t theirs = read_bits(held, field->position_bits, field->type.bits);
        if (field->validity_bit && read_bits(held, *field->validity_bit, 1) == 0) {
            result.differences.push_back({argument.name, value_text(argument.type, ours), "undefined"});
        } else if (ours != theirs) {
            ReadBack::Difference difference{argument.name, value_text(argument.type, ours),
                                            value_text(argument.type, theirs)};
            if (difference.sent == difference.held) {
                difference.sent += hexadecimal(ours);
                difference.held += hexadecimal(theirs);
            }
            result.differences.push_back(std::move(difference));
        }
    }
    return result;
}

}  // namespace aeolis::commands
