// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/xtce/types.hpp"

#include "common/space_packet.hpp"
#include "dictionaries/words.hpp"
#include "dictionaries/xtce/alarms.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace aeolis::dictionary::xtce {
namespace {

std::optional<ValueKind> kind_of(std::string_view element) {
    if (element == "IntegerParameterType" || element == "IntegerArgumentType") return ValueKind::integer;
    if (element == "FloatParameterType" || element == "FloatArgumentType") return ValueKind::real;
    if (element == "EnumeratedParameterType" || element == "EnumeratedArgumentType") return ValueKind::enumerated;
    if (element == "BooleanParameterType" || element == "BooleanArgumentType") return ValueKind::boolean;
    return std::nullopt;
}

/// Smallest and largest number that the encoding can hold.
std::pair<double, double> encodable(const Type& type) {
    switch (type.encoding) {
    case Encoding::unsigned_integer: return {0.0, std::ldexp(1.0, static_cast<int>(type.bits)) - 1.0};
    case Encoding::twos_complement:
        return {-std::ldexp(1.0, static_cast<int>(type.bits) - 1),
                std::ldexp(1.0, static_cast<int>(type.bits) - 1) - 1.0};
    case Encoding::ieee754: break;
    }
    const double largest =
        type.bits == 32 ? double{std::numeric_limits<float>::max()} : std::numeric_limits<double>::max();
    return {-largest, largest};
}

/// The rules for one element of a ParameterTypeSet or ArgumentTypeSet.
class TypeRules {
  public:
    TypeRules(pugi::xml_node element, const PacketType& model, Reporter& report)
        : element_(element), model_(model), report_(report), type_(field_type(model)) {}

    /// The type in the words of the dictionary; none: part of it is not understood, or not supported.
    std::optional<Type> check() {
        if (std::string_view{element_.name()} == "BinaryParameterType") return check_binary();
        const auto kind = kind_of(element_.name());
        if (!kind) {
            if (model_.kind != PacketType::Kind::unknown)  // that the model does not know it has been told
                report_.fault(element_, std::string{element_.name()} + " is not supported");
            return std::nullopt;
        }
        report_.expect(element_,
                       {"LongDescription", "UnitSet", "IntegerDataEncoding", "FloatDataEncoding", "EnumerationList",
                        "ValidRange", "ValidRangeSet", "DefaultAlarm", "ContextAlarmList"},
                       {"name", "shortDescription", "sizeInBits", "signed", "zeroStringValue", "oneStringValue"});
        if (model_.kind == PacketType::Kind::unknown || type_.binary || !check_encoding()) return std::nullopt;
        check_unit();
        check_enumeration();
        check_valid_range();
        check_default_alarm(element_.child("DefaultAlarm"), type_.alarms, report_);
        return type_;
    }

  private:
    void fault(pugi::xml_node at, const std::string& message) {
        report_.fault(at, "type " + in_quotes(type_.name) + ": " + message);
    }

    std::optional<Type> check_binary() {
        report_.expect(element_, {"LongDescription", "UnitSet", "BinaryDataEncoding"}, {"name", "shortDescription"});
        const pugi::xml_node encoding = element_.child("BinaryDataEncoding");
        report_.expect(encoding, {"SizeInBits"}, {});
        report_.expect(encoding.child("SizeInBits"), {"FixedValue"}, {});
        if (type_.bits >= 8 && type_.bits <= packet_octets_max * 8 && type_.bits % 8 == 0) return type_;
        const std::string word = encoding.child("SizeInBits").child("FixedValue").text().as_string();
        fault(encoding ? encoding : element_,
              "binary data of " + in_quotes(word) + " bits: only a fixed number of whole octets is supported");
        return std::nullopt;
    }

    /// Flight encodes whole numbers, unsigned and in two's complement, and IEEE 754.
    bool check_encoding() {
        using enum Coding::Form;
        const pugi::xml_node real = element_.child("FloatDataEncoding");
        const pugi::xml_node encoding = real ? real : element_.child("IntegerDataEncoding");
        report_.expect(encoding, {"DefaultCalibrator"}, {"sizeInBits", "encoding"});
        const pugi::xml_node calibrator = encoding.child("DefaultCalibrator");
        report_.expect(calibrator, {"PolynomialCalibrator"}, {});
        report_.expect(calibrator.child("PolynomialCalibrator"), {"Term"}, {});
        for (const pugi::xml_node term : calibrator.child("PolynomialCalibrator").children("Term"))
            report_.expect(term, {}, {"coefficient", "exponent"});
        const auto form = model_.coding.form;
        if (form == ieee754 && type_.bits != 32 && type_.bits != 64)
            fault(encoding, "only IEEE 754 of 32 or 64 bits is supported");
        else if (form == ieee754 && type_.kind != ValueKind::real)
            fault(encoding, "only a number with a fraction is encoded as IEEE 754");
        else if (form != ieee754 && form != unsigned_integer && form != twos_complement)
            fault(encoding, "encoding " + in_quotes(encoding.attribute("encoding").value()) + " is not supported");
        else
            return true;
        return false;
    }

    void check_unit() {
        report_.expect(element_.child("UnitSet"), {"Unit"}, {});
        const bool is_number = type_.kind == ValueKind::integer || type_.kind == ValueKind::real;
        if (is_number && type_.unit.empty()) fault(element_, "has no unit (1 for a pure number)");
    }

    void check_enumeration() {
        const pugi::xml_node list = element_.child("EnumerationList");
        report_.expect(list, {"Enumeration"}, {});
        for (const pugi::xml_node entry : list.children("Enumeration"))
            report_.expect(entry, {}, {"value", "label", "shortDescription"});
        std::set<std::int64_t> values;
        std::set<std::string> labels;
        const auto [least, most] = encodable(type_);
        for (const auto& [value, last, label, line] : model_.labels) {
            const auto told = [&, line = line](const std::string& message) {
                report_.fault(line, "type " + in_quotes(type_.name) + ": " + message);
            };
            if (const auto why = unusable_as_identifier(label)) told("label " + in_quotes(label) + " " + *why);
            if (!labels.insert(label).second) told("label " + in_quotes(label) + " is there twice");
            if (!values.insert(value).second)
                told("value " + std::to_string(value) + " is there twice");
            else if (static_cast<double>(value) < least || static_cast<double>(value) > most)
                told("value " + std::to_string(value) + " does not fit " + std::to_string(type_.bits) + " bits");
        }
        if (type_.kind == ValueKind::enumerated && !list.child("Enumeration"))
            fault(element_, "is an enumeration without values");
    }

    void check_valid_range() {
        pugi::xml_node range = element_.child("ValidRange");
        if (const pugi::xml_node set = element_.child("ValidRangeSet")) {
            report_.expect(set, {"ValidRange"}, {});
            range = set.child("ValidRange");
            if (range.next_sibling("ValidRange")) fault(set, "several valid ranges are not supported");
        }
        if (!range) return;
        report_.expect(range, {}, {"minInclusive", "maxInclusive"});
        const auto [least, most] = encodable(type_);
        if (type_.valid_min && type_.valid_max && *type_.valid_min > *type_.valid_max) {
            fault(range, "minInclusive is above maxInclusive");
            type_.valid_min = type_.valid_max = std::nullopt;  // so that no default is reported as outside the range
        } else if (type_.calibrator.empty() &&
                   (type_.valid_min.value_or(least) < least || type_.valid_max.value_or(most) > most))
            fault(range, "the valid range does not fit " + std::to_string(type_.bits) + " bits");
    }

    pugi::xml_node element_;
    const PacketType& model_;
    Reporter& report_;
    Type type_;
};

}  // namespace

Types::Types(const Symbols& symbols, ModelTypes& model, Reporter& report) : symbols_(symbols) {
    std::map<std::string, unsigned> enumerations;
    for (const Symbol& symbol : symbols.all()) {
        if (symbol.kind != Kind::parameter_type && symbol.kind != Kind::argument_type) continue;
        auto type = TypeRules{symbol.element, model.types[model.of(symbol)], report}.check();
        if (type && type->kind == ValueKind::enumerated) {
            // Each enumeration becomes an enum class of flight, all in one namespace.
            const auto [first, added] = enumerations.emplace(type->name, report.line(symbol.element));
            if (!added)
                report.fault(symbol.element, "enumeration " + in_quotes(type->name) +
                                                 " is there twice, first in line " + std::to_string(first->second));
            if (const auto why = unusable_as_identifier(type->name))
                report.fault(symbol.element, "enumeration " + in_quotes(type->name) + " " + *why);
        }
        types_.emplace(std::pair{symbol.kind, symbol.path}, std::move(type));
    }
}

std::optional<Type> Types::of(Kind kind, const std::string& scope, pugi::xml_node element, const char* attribute,
                              Reporter& report) const {
    const std::string reference = element.attribute(attribute).value();
    const Symbol* symbol = symbols_.find(kind, scope, reference);
    if (symbol == nullptr) {
        report.fault(element, std::string{element.name()} + " " + in_quotes(name_of(element)) + ": there is no type " +
                                  in_quotes(reference));
        return std::nullopt;
    }
    return types_.at(std::pair{kind, symbol->path});
}

}  // namespace aeolis::dictionary::xtce
