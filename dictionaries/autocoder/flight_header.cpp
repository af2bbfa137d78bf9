// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/autocoder/flight_header.hpp"

#include "common/space_packet.hpp"
#include "dictionaries/autocoder/cpp_text.hpp"
#include "dictionaries/enumerations.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace aeolis::dictionary::autocoder {
namespace {

constexpr unsigned header_bits = static_cast<unsigned>(tm_data_offset_octets) * 8;

/// One value at its position, as an expression that yields an unsigned or a floating-point number.
struct Write {
    unsigned position_bits = 0;
    unsigned bits = 0;
    std::string statement;
};

std::string put(const Type& type, const std::string& value) {
    const std::string bits = std::to_string(type.bits);
    if (type.encoding == Encoding::ieee754) return (type.bits == 32 ? "put_float(" : "put_double(") + value + ")";
    if (type.kind == ValueKind::boolean) return "put(" + value + " ? 1 : 0, " + bits + ")";
    if (type.encoding == Encoding::twos_complement)
        return "put_signed(static_cast<std::int64_t>(" + value + "), " + bits + ")";
    return "put(static_cast<std::uint64_t>(" + value + "), " + bits + ")";
}

std::string zero(const Type& type) {
    return type.kind == ValueKind::boolean || type.encoding == Encoding::ieee754 || type.kind == ValueKind::integer
               ? value_type(type) + "{}"
               : "static_cast<" + value_type(type) + ">(0)";
}

class HeaderWriter {
  public:
    explicit HeaderWriter(const Dictionary& dictionary) : dictionary_(dictionary) {}

    std::string write() {
        out_ << made_by_autocoder(dictionary_, "the dictionary")
             << "#pragma once\n\n"
                "#include \"common/bytes.hpp\"\n#include \"common/ids.hpp\"\n\n"
                "#include <array>\n#include <cmath>\n#include <cstddef>\n#include <cstdint>\n#include "
                "<optional>\n#include <span>\n\n"
                "namespace aeolis::flight {\n\n"
                "enum class EventLevel : std::uint8_t {\n"
                "    fatal, warning_hi, warning_lo, command, activity_hi, activity_lo, diagnostic\n};\n\n"
             << "inline constexpr std::uint16_t dictionary_id = " << hexadecimal(dictionary_.id, 4) << ";\n"
             << "inline constexpr std::uint32_t timeline_version = " << hexadecimal(dictionary_.timeline_version, 8)
             << ";\n\n";
        write_enumerations();
        out_ << "// `octets` is the whole packet with headers and CRC; encode() writes the data between them.\n"
                "namespace packet {\n\n";
        for (const Packet& packet : dictionary_.packets)
            if (!packet.event && !is_made_on_ground(packet.apid)) write_packet(packet, nullptr);
        out_ << "}  // namespace packet\n\nnamespace evr {\n\n";
        for (const Event& event : dictionary_.events)
            if (const Packet& packet = dictionary_.packets[event.packet]; !is_made_on_ground(packet.apid))
                write_packet(packet, &event);
        out_ << "}  // namespace evr\n\nnamespace command {\n\n";
        for (const Command& command : dictionary_.commands) write_command(command);
        out_ << "}  // namespace command\n\n";
        write_ids();
        out_ << "}  // namespace aeolis::flight\n";
        return out_.str();
    }

  private:
    void write_enumerations() {
        auto packets = dictionary_.packets;
        std::erase_if(packets, [](const Packet& packet) { return is_made_on_ground(packet.apid); });
        for (const Type* type : enumerations_of(packets, dictionary_.commands)) {
            const bool is_signed = type->encoding == Encoding::twos_complement;
            Type integer = *type;
            integer.kind = ValueKind::integer;
            out_ << "enum class " << camel_case(type->name) << " : " << value_type(integer) << " {\n";
            for (const EnumValue& entry : type->enumeration)
                out_ << "    " << entry.label << " = " << entry.value << (is_signed ? "" : "U") << ",\n";
            out_ << "};\n\n";
        }
    }

    /// A packet's data in bit order, including spare bits. The `event_id` of an event is a constant, not a member.
    static std::vector<Write> writes(const Packet& packet, const Event* event) {
        std::vector<Write> all;
        for (const Field& field : packet.fields) {
            const bool is_id = event != nullptr && field.name == "event_id";
            std::string value = is_id ? "id.value" : field.name;
            if (field.validity_bit) {
                all.push_back({*field.validity_bit, 1, "put(" + field.name + ".has_value() ? 1 : 0, 1)"});
                value += ".value_or(" + zero(field.type) + ")";
            }
            all.push_back({field.position_bits, field.type.bits, put(field.type, value)});
        }
        if (const auto& content = packet.content)
            all.push_back({content->offset_octets * 8, content->octets * 8, "put_octets(" + content->name + ")"});
        std::ranges::sort(all, {}, &Write::position_bits);
        return all;
    }

    void write_packet(const Packet& packet, const Event* event) {
        if (!packet.text.empty()) out_ << "/// " << packet.text << ".\n";
        out_ << "struct " << packet.name << " {\n"
             << "    static constexpr Apid apid{" << hexadecimal(packet.apid.value, 3) << "};\n";
        if (event != nullptr)
            out_ << "    static constexpr EvrId id{" << event->id.value << "};\n"
                 << "    static constexpr EventLevel level = EventLevel::" << level_name(event->level) << ";\n";
        out_ << "    static constexpr std::size_t octets = " << packet.octets << ";\n";
        bool first = true;
        for (const Field& field : packet.fields) {
            if (event != nullptr && field.name == "event_id") continue;
            if (first) out_ << "\n";
            first = false;
            if (field.validity_bit)
                out_ << "    std::optional<" << value_type(field.type) << "> " << field.name << "{};\n";
            else
                out_ << "    " << value_type(field.type) << " " << field.name << "{};\n";
        }
        if (packet.content)
            out_ << "    std::array<std::uint8_t, " << packet.content->octets << "> " << packet.content->name
                 << "{};\n";
        out_ << "\n    void encode(BitWriter& out) const {\n";
        write_body(packet, event);
        out_ << "    }\n    bool operator==(const " << packet.name << "&) const = default;\n};\n\n";
    }

    void write_body(const Packet& packet, const Event* event) {
        unsigned position = header_bits;
        for (const Write& write : writes(packet, event)) {
            write_gap(write.position_bits - position);
            out_ << "        out." << write.statement << ";\n";
            position = write.position_bits + write.bits;
        }
        const unsigned end = (packet.octets - static_cast<unsigned>(packet_crc_octets)) * 8;
        write_gap(end - position);
        if (position == header_bits && end == position) out_ << "        static_cast<void>(out);\n";
    }

    void write_gap(unsigned bits) {
        for (; bits > 0; bits -= std::min(bits, 64U))
            out_ << "        out.put(0, " << std::min(bits, 64U) << ");  // spare\n";
    }

    static const char* level_name(EventLevel level) {
        switch (level) {
        case EventLevel::fatal: return "fatal";
        case EventLevel::warning_hi: return "warning_hi";
        case EventLevel::warning_lo: return "warning_lo";
        case EventLevel::command: return "command";
        case EventLevel::activity_hi: return "activity_hi";
        case EventLevel::activity_lo: return "activity_lo";
        case EventLevel::diagnostic: break;
        }
        return "diagnostic";
    }

    void write_command(const Command& command) {
        if (!command.text.empty()) out_ << "/// " << command.text << ".\n";
        out_ << "struct " << command.name << " {\n"
             << "    static constexpr Opcode opcode{" << hexadecimal(command.opcode.value, 4) << "};\n"
             << "    static constexpr std::size_t argument_octets = " << command.argument_octets << ";\n";
        if (!command.arguments.empty()) out_ << "\n";
        for (const Argument& argument : command.arguments)
            out_ << "    " << value_type(argument.type) << " " << argument.name << "{};"
                 << (argument.text.empty() ? "" : "  ///< " + argument.text) << "\n";
        out_ << "\n    /// None when the length is wrong, or an argument is outside its valid range or not finite.\n"
             << "    static std::optional<" << command.name << "> decode(std::span<const std::uint8_t> octets) {\n"
             << "        if (octets.size() != argument_octets) return std::nullopt;\n"
             << "        " << command.name << " c;\n";
        if (!command.arguments.empty()) out_ << "        BitReader in{octets};\n";
        for (const Argument& argument : command.arguments) write_argument(argument);
        out_ << "        return c;\n    }\n";
        write_carry(command);
        out_ << "    bool operator==(const " << command.name << "&) const = default;\n};\n\n";
    }

    /// Writes the function that transfers a command held on board to another computer (flight/cross_string).
    void write_carry(const Command& command) {
        if (command.arguments.empty()) return;
        out_ << "\n    template <typename Exchange>\n    void carry(Exchange& exchange) {\n        exchange(";
        for (const Argument& argument : command.arguments)
            out_ << (&argument == &command.arguments.front() ? "" : ", ") << argument.name;
        out_ << ");\n    }\n";
    }

    void write_argument(const Argument& argument) {
        const Type& type = argument.type;
        const std::string name = "c." + argument.name;
        const std::string bits = std::to_string(type.bits);
        const auto refuse_when = [&](const std::string& condition) {
            out_ << "        if (" << condition << ") return std::nullopt;\n";
        };
        if (type.encoding == Encoding::ieee754) {
            out_ << "        " << name << " = in." << (type.bits == 32 ? "get_float()" : "get_double()") << ";\n";
            refuse_when("!std::isfinite(" + name + ")");
        } else {
            const bool is_signed = type.encoding == Encoding::twos_complement;
            const std::string raw = std::string{"in."} + (is_signed ? "get_signed(" : "get(") + bits + ")";
            const std::string value =
                type.kind == ValueKind::boolean ? raw + " != 0" : "static_cast<" + value_type(type) + ">(" + raw + ")";
            out_ << "        " << name << " = " << value << ";\n";
        }
        if (type.kind == ValueKind::enumerated) return write_membership(type, name);
        if (type.kind == ValueKind::boolean || !type.calibrator.empty()) return;
        const auto [least, most] = range(type);
        if (least) refuse_when("static_cast<double>(" + name + ") < " + double_literal(*least));
        if (most) refuse_when("static_cast<double>(" + name + ") > " + double_literal(*most));
    }

    /// Range of valid values to test; a bound that the encoding enforces needs no test.
    static std::pair<std::optional<double>, std::optional<double>> range(const Type& type) {
        auto least = type.valid_min;
        auto most = type.valid_max;
        if (type.encoding == Encoding::unsigned_integer && least && *least <= 0.0) least.reset();
        if (type.encoding == Encoding::unsigned_integer && most &&
            *most >= std::ldexp(1.0, static_cast<int>(type.bits)) - 1.0)
            most.reset();
        return {least, most};
    }

    void write_membership(const Type& type, const std::string& name) {
        out_ << "        switch (" << name << ") {\n";
        for (const EnumValue& entry : type.enumeration)
            out_ << "        case " << camel_case(type.name) << "::" << entry.label << ":\n";
        out_ << "            break;\n        default: return std::nullopt;\n        }\n";
    }

    template <typename Rows>
    void write_constants(const char* space, const char* type, const Rows& rows) {
        out_ << "namespace " << space << " {\n";
        for (const auto& row : rows)
            if (!row.name.empty())
                out_ << "inline constexpr " << type << " " << row.name << "{" << unsigned{row.id.value} << "};\n";
        out_ << "}  // namespace " << space << "\n\n";
    }

    void write_ids() {
        out_ << "inline constexpr std::size_t timepoint_count = " << dictionary_.timeline.size() << ";\n"
             << "inline constexpr std::size_t anchor_count = " << dictionary_.anchors.size() << ";\n"
             << "inline constexpr std::size_t constraint_count = " << dictionary_.constraints.size() << ";\n\n";
        write_constants("timepoint", "TimepointId", dictionary_.timeline);
        write_constants("anchor", "AnchorId", dictionary_.anchors);
        write_constants("tone", "ToneId", dictionary_.tones);
    }

    const Dictionary& dictionary_;
    std::ostringstream out_;
};

}  // namespace

std::string flight_header(const Dictionary& dictionary) {
    return HeaderWriter{dictionary}.write();
}

}  // namespace aeolis::dictionary::autocoder
