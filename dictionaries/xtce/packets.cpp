// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/xtce/packets.hpp"

#include "common/space_packet.hpp"
#include "dictionaries/words.hpp"

#include <algorithm>
#include <array>

namespace aeolis::dictionary::xtce {
namespace {

constexpr std::int64_t apid_max = 0x7FE;  // 7FF is idle [ccsds-133.0-b-2]
constexpr std::int64_t event_id_max = 0xFFFF;
constexpr unsigned header_bits = static_cast<unsigned>(tm_data_offset_octets) * 8;

constexpr std::array event_levels{std::pair{"FATAL", EventLevel::fatal},
                                  std::pair{"WARNING_HI", EventLevel::warning_hi},
                                  std::pair{"WARNING_LO", EventLevel::warning_lo},
                                  std::pair{"COMMAND", EventLevel::command},
                                  std::pair{"ACTIVITY_HI", EventLevel::activity_hi},
                                  std::pair{"ACTIVITY_LO", EventLevel::activity_lo},
                                  std::pair{"DIAGNOSTIC", EventLevel::diagnostic}};

std::string ancillary(pugi::xml_node container, std::string_view name) {
    for (const pugi::xml_node data : container.child("AncillaryDataSet").children("AncillaryData"))
        if (name == data.attribute("name").value()) return data.text().as_string();
    return {};
}

class PacketReader {
  public:
    PacketReader(const Parameters& parameters, Reporter& report) : parameters_(parameters), report_(report) {}

    void read(const Symbol& symbol, const Layout& layout) {
        const pugi::xml_node element = symbol.element;
        const std::string name = name_of(element);
        const bool is_event = layout.conditions.contains("event_id");
        if (is_event) result.declared_events.push_back({name, has_arguments(element)});
        if (!layout.sound) return;
        const auto apid = layout.conditions.find("apid");
        if (apid == layout.conditions.end()) {
            report_.fault(element, "packet " + in_quotes(name) + " has no APID: no restriction on apid");
            return;
        }
        if (apid->second < 0 || apid->second > apid_max) {
            report_.fault(element, "packet " + in_quotes(name) + ": APID " + std::to_string(apid->second) +
                                       " is outside 0 ... " + std::to_string(apid_max));
            return;
        }
        if (layout.end_bits < header_bits) {
            report_.fault(element, "packet " + in_quotes(name) + " is shorter than the headers of telemetry");
            return;
        }
        if (const auto why = unusable_as_identifier(name))
            report_.fault(element, "packet " + in_quotes(name) + " " + *why);
        Packet packet;
        packet.name = name;
        packet.text = element.attribute("shortDescription").value();
        packet.apid = Apid{static_cast<std::uint16_t>(apid->second)};
        packet.octets = (layout.end_bits + 7) / 8 + static_cast<unsigned>(packet_crc_octets);
        packet.expected_rate_hz = rate(element);
        packet.fields = fields(layout);
        packet.content = content(layout);
        if (is_event) {
            if (!read_event(symbol, layout.conditions.at("event_id"), packet)) return;
        }
        claim_apid(element, packet);
        claim_name(element, packet);
        result.packets.push_back(std::move(packet));
    }

    Packets result;

  private:
    static bool has_arguments(pugi::xml_node container) {
        return static_cast<bool>(container.child("EntryList").first_child());
    }

    std::optional<double> rate(pugi::xml_node container) {
        const pugi::xml_node element = container.child("DefaultRateInStream");
        if (!element) return std::nullopt;
        report_.expect(element, {}, {"basis", "minimumValue", "maximumValue"});
        return report_.number(element, "minimumValue");
    }

    /// Fields after the headers. A validity flag is part of the field it applies to.
    std::vector<Field> fields(const Layout& layout) {
        std::vector<Field> all;
        std::set<std::string> flags;
        for (const Placed& placed : layout.entries) flags.insert(placed.parameter->valid_by);
        for (const Placed& placed : layout.entries) {
            const Parameter& parameter = *placed.parameter;
            if (placed.position_bits < header_bits || flags.contains(parameter.path) || parameter.type->binary)
                continue;
            if (is_taken_in_packets(parameter.name))
                report_.fault(placed.element, in_quotes(parameter.name) + " is a name of the encoder's own");
            Field field{parameter.name, *parameter.type, parameter.channel, placed.position_bits, std::nullopt};
            if (!parameter.valid_by.empty()) field.validity_bit = flag_position(layout, placed);
            all.push_back(std::move(field));
        }
        return all;
    }

    std::optional<Content> content(const Layout& layout) {
        std::optional<Content> found;
        for (const Placed& placed : layout.entries) {
            const Parameter& parameter = *placed.parameter;
            if (!parameter.type->binary) continue;
            if (found)
                report_.fault(placed.element, in_quotes(parameter.name) + ": a packet has binary data once at most");
            else if (placed.position_bits % 8 != 0 || !parameter.valid_by.empty())
                report_.fault(placed.element, in_quotes(parameter.name) +
                                                  ": binary data begin at a whole octet and are always defined");
            found = Content{parameter.name, placed.position_bits / 8, parameter.type->bits / 8};
        }
        return found;
    }

    std::optional<unsigned> flag_position(const Layout& layout, const Placed& placed) {
        const Parameter& flag = parameters_.by_path.at(placed.parameter->valid_by);
        const auto entry = std::ranges::find(layout.entries, &flag, &Placed::parameter);
        if (entry == layout.entries.end())
            report_.fault(placed.element, in_quotes(placed.parameter->name) + " is valid by " + in_quotes(flag.name) +
                                              ", which is not in this packet");
        else if (&*entry > &placed)  // decoders go from front to back
            report_.fault(placed.element, in_quotes(placed.parameter->name) + " is valid by " + in_quotes(flag.name) +
                                              ", which stands behind it");
        else if (flag.type->bits != 1)
            report_.fault(placed.element, in_quotes(placed.parameter->name) + " is valid by " + in_quotes(flag.name) +
                                              ", which is not one bit");
        else
            return entry->position_bits;
        return std::nullopt;
    }

    bool read_event(const Symbol& symbol, std::int64_t id, Packet& packet) {
        const pugi::xml_node element = symbol.element;
        report_.expect(element.child("AncillaryDataSet"), {"AncillaryData"}, {});
        if (id < 0 || id > event_id_max) {
            report_.fault(element, "event " + in_quotes(packet.name) + ": id " + std::to_string(id) +
                                       " is outside 0 ... " + std::to_string(event_id_max));
            return false;
        }
        const EvrId event_id{static_cast<std::uint16_t>(id)};
        result.event_by_path.emplace(symbol.path, event_id);
        const auto [first, added] = event_lines_.emplace(event_id, report_.line(element));
        if (!added)
            report_.fault(element, "event " + in_quotes(packet.name) + ": id " + std::to_string(id) +
                                       " is taken, first in line " + std::to_string(first->second));
        Event event{event_id, packet.name, EventLevel::diagnostic, ancillary(element, "format"), result.packets.size()};
        const std::string word = ancillary(element, "level");
        const auto level = std::ranges::find(event_levels, word, [](const auto& l) { return std::string{l.first}; });
        if (level == event_levels.end())
            report_.fault(element, "event " + in_quotes(packet.name) + ": level " + in_quotes(word) + " is unknown");
        else
            event.level = level->second;
        check_format(element, event, packet);
        packet.event = event_id;
        result.events.push_back(std::move(event));
        return true;
    }

    void check_format(pugi::xml_node element, const Event& event, const Packet& packet) {
        if (event.format.empty()) report_.fault(element, "event " + in_quotes(event.name) + " has no format");
        for (std::size_t open = event.format.find('{'); open != std::string::npos;
             open = event.format.find('{', open + 1)) {
            const std::size_t close = event.format.find('}', open);
            const std::string field =
                event.format.substr(open + 1, close == std::string::npos ? close : close - open - 1);
            if (std::ranges::find(packet.fields, field, &Field::name) != packet.fields.end()) continue;
            report_.fault(element, "event " + in_quotes(event.name) + ": its format names " + in_quotes(field) +
                                       ", which is no argument of it");
            return;
        }
    }

    /// Only events may share an APID, and only with each other.
    void claim_apid(pugi::xml_node element, const Packet& packet) {
        const auto [first, added] = apids_.emplace(packet.apid, Claim{report_.line(element), packet.event.has_value()});
        if (added || (packet.event && first->second.event)) return;
        report_.fault(element, "packet " + in_quotes(packet.name) + ": APID " + std::to_string(packet.apid.value) +
                                   " is taken, first in line " + std::to_string(first->second.line));
    }

    void claim_name(pugi::xml_node element, const Packet& packet) {
        const auto [first, added] = names_.emplace(packet.name, report_.line(element));
        if (!added)
            report_.fault(element, "packet " + in_quotes(packet.name) + " is there twice, first in line " +
                                       std::to_string(first->second));
    }

    struct Claim {
        unsigned line = 0;
        bool event = false;
    };

    const Parameters& parameters_;
    Reporter& report_;
    std::map<Apid, Claim> apids_;
    std::map<EvrId, unsigned> event_lines_;
    std::map<std::string, unsigned> names_;
};

}  // namespace

Packets read_packets(const Symbols& symbols, const Parameters& parameters, const Layouts& layouts, Reporter& report) {
    PacketReader reader{parameters, report};
    for (const Symbol& symbol : symbols.all()) {
        if (symbol.kind != Kind::container) continue;
        const Layout& layout = layouts.of(symbol);
        if (!layout.abstract) reader.read(symbol, layout);
    }
    return std::move(reader.result);
}

}  // namespace aeolis::dictionary::xtce
