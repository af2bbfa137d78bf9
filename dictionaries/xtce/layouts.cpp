// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/xtce/layouts.hpp"

#include "common/space_packet.hpp"
#include "dictionaries/words.hpp"

namespace aeolis::dictionary::xtce {
namespace {

constexpr unsigned bits_max = static_cast<unsigned>(packet_octets_max - packet_crc_octets) * 8;

}  // namespace

Layouts::Layouts(const Symbols& symbols, const Parameters& parameters, Reporter& report)
    : symbols_(symbols), parameters_(parameters), report_(report) {
    for (const Symbol& symbol : symbols.all())
        if (symbol.kind == Kind::container) lay_out(symbol, 0);
}

const Layout& Layouts::lay_out(const Symbol& container, unsigned depth) {
    if (const auto known = layouts_.find(container.path); known != layouts_.end()) return known->second;
    Layout layout;
    if (std::string_view{container.element.name()} != "SequenceContainer") {
        report_.fault(container.element, std::string{container.element.name()} + " is not supported");
        layout.sound = false;
        return layouts_[container.path] = layout;
    }
    report_.expect(container.element,
                   {"LongDescription", "AncillaryDataSet", "DefaultRateInStream", "EntryList", "BaseContainer"},
                   {"name", "shortDescription", "abstract"});
    layout.abstract = container.element.attribute("abstract").as_bool();
    read_base(container, layout, depth);
    if (layout.sound)
        for (const pugi::xml_node entry : container.element.child("EntryList").children())
            if (entry.type() == pugi::node_element) read_entry(container, entry, layout);
    return layouts_[container.path] = layout;
}

void Layouts::read_base(const Symbol& container, Layout& layout, unsigned depth) {
    const pugi::xml_node base = container.element.child("BaseContainer");
    if (!base) return;
    report_.expect(base, {"RestrictionCriteria"}, {"containerRef"});
    const std::string reference = base.attribute("containerRef").value();
    const Symbol* symbol = symbols_.find(Kind::container, container.scope, reference);
    if (symbol == nullptr) {
        report_.fault(base, "there is no container " + in_quotes(reference));
        layout.sound = false;
        return;
    }
    if (depth == base_depth_max) {
        report_.fault(base, "container " + in_quotes(name_of(container.element)) + " is based on itself, or too deep");
        layout.sound = false;
        return;
    }
    const Layout& from = lay_out(*symbol, depth + 1);
    layout.sound = from.sound;
    layout.entries = from.entries;
    layout.end_bits = from.end_bits;
    layout.conditions = from.conditions;
    read_conditions(container, base.child("RestrictionCriteria"), layout);
}

void Layouts::read_conditions(const Symbol& container, pugi::xml_node criteria, Layout& layout) {
    report_.expect(criteria, {"Comparison", "ComparisonList"}, {});
    report_.expect(criteria.child("ComparisonList"), {"Comparison"}, {});
    for (const pugi::xml_node comparison : criteria.children("Comparison"))
        read_condition(container, comparison, layout);
    for (const pugi::xml_node comparison : criteria.child("ComparisonList").children("Comparison"))
        read_condition(container, comparison, layout);
}

void Layouts::read_condition(const Symbol& container, pugi::xml_node comparison, Layout& layout) {
    report_.expect(comparison, {}, {"parameterRef", "value", "comparisonOperator", "useCalibratedValue"});
    const std::string reference = comparison.attribute("parameterRef").value();
    const std::string word = comparison.attribute("value").value();
    const Symbol* parameter = symbols_.find(Kind::parameter, container.scope, reference);
    const auto value = to_integer(word);
    if (parameter == nullptr)
        report_.fault(comparison, "there is no parameter " + in_quotes(reference));
    else if (std::string_view{comparison.attribute("comparisonOperator").as_string("==")} != "==")
        report_.fault(comparison, "only equality restricts a container");
    else if (!value)
        report_.fault(comparison, "value " + in_quotes(word) + " is not a whole number");
    else {
        layout.conditions[name_of(parameter->element)] = *value;
        return;
    }
    layout.sound = false;
}

std::optional<unsigned> Layouts::position_of(pugi::xml_node entry, const Layout& layout) {
    const pugi::xml_node location = entry.child("LocationInContainerInBits");
    if (!location) return layout.end_bits;
    report_.expect(location, {"FixedValue"}, {"referenceLocation"});
    const std::string reference = location.attribute("referenceLocation").as_string("previousEntry");
    const std::string word = location.child("FixedValue").text().as_string();
    const auto value = to_integer(word);
    if (!value || *value < -std::int64_t{bits_max} || *value > std::int64_t{bits_max}) {
        report_.fault(location, "FixedValue " + in_quotes(word) + " is no possible number of bits");
        return std::nullopt;
    }
    if (reference != "previousEntry" && reference != "containerStart") {
        report_.fault(location, "referenceLocation " + in_quotes(reference) + " is not supported");
        return std::nullopt;
    }
    const std::int64_t position = *value + (reference == "previousEntry" ? std::int64_t{layout.end_bits} : 0);
    if (position >= 0) return static_cast<unsigned>(position);
    report_.fault(location, "the entry begins before the packet");
    return std::nullopt;
}

void Layouts::check_overlap(pugi::xml_node entry, const Placed& placed, Layout& layout) {
    const unsigned begin = placed.position_bits;
    const unsigned end = begin + placed.parameter->type->bits;
    for (const Placed& other : layout.entries) {
        const unsigned other_end = other.position_bits + other.parameter->type->bits;
        if (begin >= other_end || other.position_bits >= end) continue;
        report_.fault(entry,
                      in_quotes(placed.parameter->name) + " overlaps the bits of " + in_quotes(other.parameter->name));
        layout.sound = false;
        return;
    }
}

void Layouts::read_entry(const Symbol& container, pugi::xml_node entry, Layout& layout) {
    if (std::string_view{entry.name()} != "ParameterRefEntry") {
        report_.fault(entry, std::string{entry.name()} + " is not supported");
        layout.sound = false;
        return;
    }
    report_.expect(entry, {"LocationInContainerInBits"}, {"parameterRef"});
    const std::string reference = entry.attribute("parameterRef").value();
    const Symbol* symbol = symbols_.find(Kind::parameter, container.scope, reference);
    if (symbol == nullptr) {
        report_.fault(entry, "there is no parameter " + in_quotes(reference));
        layout.sound = false;
        return;
    }
    const Parameter& parameter = parameters_.by_path.at(symbol->path);
    if (!parameter.type || !layout.sound) {
        layout.sound = false;
        return;
    }
    const auto position = position_of(entry, layout);
    if (!position) {
        layout.sound = false;
        return;
    }
    const Placed placed{&parameter, *position, entry};
    for (const Placed& other : layout.entries)
        if (other.parameter->name == parameter.name) {
            report_.fault(entry, in_quotes(parameter.name) + " is there twice in one packet");
            layout.sound = false;
            return;
        }
    check_overlap(entry, placed, layout);
    layout.entries.push_back(placed);
    layout.end_bits = *position + parameter.type->bits;
    if (layout.sound && layout.end_bits > bits_max) {
        report_.fault(entry, "the packet is longer than " + std::to_string(packet_octets_max) + " octets");
        layout.sound = false;
    }
}

}  // namespace aeolis::dictionary::xtce
