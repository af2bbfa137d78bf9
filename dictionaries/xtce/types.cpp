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

/// One element of a ParameterTypeSet or ArgumentTypeSet.
class TypeReader {
  public:
    TypeReader(pugi::xml_node element, Reporter& report) : element_(element), report_(report) {}

    /// Reads the type as far as possible; faults become findings.
    std::optional<Type> read() {
        if (std::string_view{element_.name()} == "BinaryParameterType") return read_binary();
        const auto kind = kind_of(element_.name());
        if (!kind) {
            report_.fault(element_, std::string{element_.name()} + " is unknown or not supported");
            return std::nullopt;
        }
        report_.expect(element_,
                       {"LongDescription", "UnitSet", "IntegerDataEncoding", "FloatDataEncoding", "EnumerationList",
                        "ValidRange", "ValidRangeSet", "DefaultAlarm", "ContextAlarmList"},
                       {"name", "shortDescription", "sizeInBits", "signed", "zeroStringValue", "oneStringValue"});
        type_.name = name_of(element_);
        type_.kind = *kind;
        if (!read_encoding()) return std::nullopt;
        read_unit();
        read_enumeration();
        read_valid_range();
        type_.alarms = read_alarms(element_.child("DefaultAlarm"), type_, report_);
        return type_;
    }

  private:
    void fault(pugi::xml_node at, const std::string& message) {
        report_.fault(at, "type " + in_quotes(type_.name) + ": " + message);
    }

    std::optional<Type> read_binary() {
        report_.expect(element_, {"LongDescription", "UnitSet", "BinaryDataEncoding"}, {"name", "shortDescription"});
        type_.name = name_of(element_);
        type_.binary = true;
        const pugi::xml_node encoding = element_.child("BinaryDataEncoding");
        report_.expect(encoding, {"SizeInBits"}, {});
        report_.expect(encoding.child("SizeInBits"), {"FixedValue"}, {});
        const std::string word = encoding.child("SizeInBits").child("FixedValue").text().as_string();
        const auto bits = to_integer(word);
        if (!bits || *bits < 8 || *bits > std::int64_t{packet_octets_max} * 8 || *bits % 8 != 0) {
            fault(encoding ? encoding : element_,
                  "binary data of " + in_quotes(word) + " bits: only a fixed number of whole octets is supported");
            return std::nullopt;
        }
        type_.bits = static_cast<unsigned>(*bits);
        return type_;
    }

    bool read_encoding() {
        if (const pugi::xml_node real = element_.child("FloatDataEncoding")) return read_float(real);
        if (const pugi::xml_node integer = element_.child("IntegerDataEncoding")) return read_integer(integer);
        fault(element_, "has no data encoding");
        return false;
    }

    bool read_float(pugi::xml_node encoding) {
        report_.expect(encoding, {"DefaultCalibrator"}, {"sizeInBits", "encoding"});
        const std::string form = encoding.attribute("encoding").as_string("IEEE754_1985");
        const auto bits = encoding.attribute("sizeInBits") ? report_.integer(encoding, "sizeInBits", 32, 64) : 32;
        if (!bits) return false;
        type_.encoding = Encoding::ieee754;
        type_.bits = static_cast<unsigned>(*bits);
        if ((*bits != 32 && *bits != 64) || (form != "IEEE754_1985" && form != "IEEE754")) {
            fault(encoding, "only IEEE 754 of 32 or 64 bits is supported");
            return false;
        }
        if (type_.kind != ValueKind::real) {
            fault(encoding, "only a number with a fraction is encoded as IEEE 754");
            return false;
        }
        read_calibrator(encoding);
        return true;
    }

    bool read_integer(pugi::xml_node encoding) {
        report_.expect(encoding, {"DefaultCalibrator"}, {"sizeInBits", "encoding"});
        const std::string form = encoding.attribute("encoding").as_string("unsigned");
        const auto bits = encoding.attribute("sizeInBits") ? report_.integer(encoding, "sizeInBits", 1, 64) : 8;
        if (!bits) return false;
        type_.bits = static_cast<unsigned>(*bits);
        if (form == "twosComplement") {
            type_.encoding = Encoding::twos_complement;
        } else if (form != "unsigned") {
            fault(encoding, "encoding " + in_quotes(form) + " is not supported");
            return false;
        }
        read_calibrator(encoding);
        return true;
    }

    void read_calibrator(pugi::xml_node encoding) {
        const pugi::xml_node calibrator = encoding.child("DefaultCalibrator");
        if (!calibrator) return;
        report_.expect(calibrator, {"PolynomialCalibrator"}, {});
        const pugi::xml_node polynomial = calibrator.child("PolynomialCalibrator");
        report_.expect(polynomial, {"Term"}, {});
        for (const pugi::xml_node term : polynomial.children("Term")) {
            report_.expect(term, {}, {"coefficient", "exponent"});
            const auto exponent = report_.integer(term, "exponent", 0, 16);
            const auto coefficient = report_.number(term, "coefficient");
            if (!exponent || !coefficient) continue;
            if (type_.calibrator.size() <= static_cast<std::size_t>(*exponent))
                type_.calibrator.resize(static_cast<std::size_t>(*exponent) + 1, 0.0);
            type_.calibrator[static_cast<std::size_t>(*exponent)] = *coefficient;
        }
    }

    void read_unit() {
        const pugi::xml_node set = element_.child("UnitSet");
        report_.expect(set, {"Unit"}, {});
        type_.unit = set.child("Unit").text().as_string();
        const bool is_number = type_.kind == ValueKind::integer || type_.kind == ValueKind::real;
        if (is_number && type_.unit.empty()) fault(element_, "has no unit (1 for a pure number)");
    }

    void read_enumeration() {
        const pugi::xml_node list = element_.child("EnumerationList");
        report_.expect(list, {"Enumeration"}, {});
        std::set<std::int64_t> values;
        std::set<std::string> labels;
        for (const pugi::xml_node entry : list.children("Enumeration")) {
            report_.expect(entry, {}, {"value", "label", "shortDescription"});
            const auto value = report_.integer(entry, "value", std::numeric_limits<std::int64_t>::min(),
                                               std::numeric_limits<std::int64_t>::max());
            const std::string label = entry.attribute("label").value();
            if (const auto why = unusable_as_identifier(label)) fault(entry, "label " + in_quotes(label) + " " + *why);
            if (!labels.insert(label).second) fault(entry, "label " + in_quotes(label) + " is there twice");
            if (!value) continue;
            const auto [least, most] = encodable(type_);
            if (!values.insert(*value).second)
                fault(entry, "value " + std::to_string(*value) + " is there twice");
            else if (static_cast<double>(*value) < least || static_cast<double>(*value) > most)
                fault(entry,
                      "value " + std::to_string(*value) + " does not fit " + std::to_string(type_.bits) + " bits");
            type_.enumeration.push_back({*value, label});
        }
        if (type_.kind == ValueKind::enumerated && type_.enumeration.empty() && !list.child("Enumeration"))
            fault(element_, "is an enumeration without values");
    }

    void read_valid_range() {
        pugi::xml_node range = element_.child("ValidRange");
        if (const pugi::xml_node set = element_.child("ValidRangeSet")) {
            report_.expect(set, {"ValidRange"}, {});
            range = set.child("ValidRange");
            if (range.next_sibling("ValidRange")) fault(set, "several valid ranges are not supported");
        }
        if (!range) return;
        report_.expect(range, {}, {"minInclusive", "maxInclusive"});
        type_.valid_min = report_.number(range, "minInclusive");
        type_.valid_max = report_.number(range, "maxInclusive");
        const auto [least, most] = encodable(type_);
        if (type_.valid_min && type_.valid_max && *type_.valid_min > *type_.valid_max) {
            fault(range, "minInclusive is above maxInclusive");
            type_.valid_min = type_.valid_max = std::nullopt;  // so that no default is reported as outside the range
        } else if (type_.calibrator.empty() &&
                   (type_.valid_min.value_or(least) < least || type_.valid_max.value_or(most) > most))
            fault(range, "the valid range does not fit " + std::to_string(type_.bits) + " bits");
    }

    pugi::xml_node element_;
    Reporter& report_;
    Type type_;
};

}  // namespace

Types::Types(const Symbols& symbols, Reporter& report) : symbols_(symbols) {
    std::map<std::string, unsigned> enumerations;
    for (const Symbol& symbol : symbols.all()) {
        if (symbol.kind != Kind::parameter_type && symbol.kind != Kind::argument_type) continue;
        auto type = TypeReader{symbol.element, report}.read();
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
