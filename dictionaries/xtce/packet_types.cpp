// SPDX-License-Identifier: Apache-2.0
#include "common/time.hpp"
#include "dictionaries/words.hpp"
#include "dictionaries/xtce/packet_model_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <string_view>
#include <utility>

namespace aeolis::dictionary::xtce {
namespace {

constexpr unsigned type_depth_max = 16;          // chosen: types within types, and types of types
constexpr std::int64_t exponent_max = 32;        // chosen: of a polynomial
constexpr std::int64_t spline_order_max = 1000;  // chosen: any order may be asked for, and is then named
constexpr std::size_t label_values_max = 1U << 20U;

/// Kind of a ParameterType or an ArgumentType.
PacketType::Kind model_kind_of(std::string_view element) {
    using enum PacketType::Kind;
    constexpr std::array<std::pair<std::string_view, PacketType::Kind>, 10> kinds{{{"Integer", integer},
                                                                                   {"Float", real},
                                                                                   {"Enumerated", enumerated},
                                                                                   {"Boolean", boolean},
                                                                                   {"String", text},
                                                                                   {"Binary", octets},
                                                                                   {"AbsoluteTime", time},
                                                                                   {"RelativeTime", time},
                                                                                   {"Aggregate", aggregate},
                                                                                   {"Array", array}}};
    for (const std::string_view suffix : {"ParameterType", "ArgumentType"})
        if (element.ends_with(suffix)) {
            element.remove_suffix(suffix.size());
            const auto found = std::ranges::find(kinds, element, &std::pair<std::string_view, PacketType::Kind>::first);
            return found == kinds.end() ? unknown : found->second;
        }
    return unknown;
}

std::optional<Coding::Form> integer_form(std::string_view word) {
    using enum Coding::Form;
    if (word == "unsigned") return unsigned_integer;
    if (word == "twosComplement" || word == "twosCompliment") return twos_complement;
    if (word == "onesComplement" || word == "onesCompliment") return ones_complement;
    if (word == "signMagnitude") return sign_and_magnitude;
    if (word == "BCD") return bcd_octets;
    if (word == "packedBCD") return bcd;
    return std::nullopt;
}

/// Whether a time can be counted from it: by name, or a date, also with a time of the day and its offset from UTC.
bool is_epoch(const std::string& epoch) {
    constexpr std::array<std::string_view, 5> names{"TAI", "GPS", "J2000", "UNIX", "POSIX"};
    if (std::ranges::find(names, epoch) != names.end()) return true;
    constexpr std::size_t date_size = 10, offset_size = 6;  // 2000-01-01, +01:00
    if (epoch.size() == date_size) return scet_from_text(epoch + "T00:00:00").has_value();
    if (scet_from_text(epoch)) return true;
    if (epoch.size() < date_size + offset_size) return false;
    const std::string offset = epoch.substr(epoch.size() - offset_size);
    return (offset[0] == '+' || offset[0] == '-') && offset[3] == ':' &&
           scet_from_text(epoch.substr(0, epoch.size() - offset_size)).has_value();
}

std::optional<Coding::Characters> characters_of(std::string_view word) {
    using enum Coding::Characters;
    if (word == "UTF-8" || word == "US-ASCII") return utf8;
    if (word == "ISO-8859-1") return latin1;
    if (word == "UTF-16" || word == "UTF-16BE") return utf16_big_endian;  // UTF-16: unless a mark says otherwise
    if (word == "UTF-16LE") return utf16_little_endian;
    return std::nullopt;
}

std::optional<Coding::Form> real_form(std::string_view word, std::int64_t bits) {
    if (word == "IEEE754_1985" || word == "IEEE754")
        return bits == 16 || bits == 32 || bits == 64 ? std::optional{Coding::Form::ieee754} : std::nullopt;
    if (word == "MILSTD_1750A" || word == "MIL-1750A")
        return bits == 32 ? std::optional{Coding::Form::mil1750a} : std::nullopt;
    return std::nullopt;
}

/// Whether a calibrator has nothing beside what is read of it, which might be a word that is spelled wrongly.
bool has_only(pugi::xml_node element, std::initializer_list<std::string_view> children,
              std::initializer_list<std::string_view> attributes) {
    const auto is_one_of = [](std::string_view name, const auto& names) {
        return std::ranges::find(names, name) != names.end();
    };
    return std::ranges::all_of(element.children(),
                               [&](const pugi::xml_node child) {
                                   return child.type() != pugi::node_element || is_one_of(child.name(), children) ||
                                          std::string_view{child.name()} == "AncillaryDataSet";
                               }) &&
           std::ranges::all_of(element.attributes(), [&](const pugi::xml_attribute attribute) {
               return is_one_of(attribute.name(), attributes) ||
                      std::string_view{attribute.name()}.find(':') != std::string_view::npos;
           });
}

}  // namespace

std::size_t ModelTypes::of(const std::string& scope, pugi::xml_node at, const char* reference, Kind kind) {
    const std::string word = at.attribute(reference).value();
    if (const Symbol* symbol = parts_.symbols.find(kind, scope, word)) return of(*symbol);
    parts_.report.fault(at, "there is no type " + in_quotes(word));
    types.push_back({.name = word, .line = parts_.report.line(at)});
    return types.size() - 1;
}

std::size_t ModelTypes::of(const Symbol& symbol) {
    const std::pair key{symbol.kind, symbol.path};
    if (const auto found = by_path_.find(key); found != by_path_.end()) return found->second;
    const std::size_t index = types.size();
    types.push_back({.name = name_of(symbol.element), .line = parts_.report.line(symbol.element)});
    by_path_.emplace(key, index);
    if (depth_ == type_depth_max) {
        parts_.report.fault(symbol.element, "types are nested deeper than " + std::to_string(type_depth_max));
        return index;
    }
    ++depth_;
    PacketType type = read(symbol);
    --depth_;
    types[index] = std::move(type);
    return index;
}

PacketType ModelTypes::read(const Symbol& symbol) {
    const pugi::xml_node element = symbol.element;
    PacketType type;
    if (element.attribute("baseType")) type = types[of(symbol.scope, element, "baseType", symbol.kind)];
    type.name = name_of(element);
    type.line = parts_.report.line(element);
    type.kind = model_kind_of(element.name());
    if (const pugi::xml_node unit = element.child("UnitSet").child("Unit")) type.unit = unit.text().as_string();
    switch (type.kind) {
    case PacketType::Kind::unknown:
        parts_.report.fault(element, std::string{element.name()} + " is unknown or not supported");
        return type;
    case PacketType::Kind::aggregate: read_members(symbol, type); return type;
    case PacketType::Kind::array:
        type.element = of(symbol.scope, element, "arrayTypeRef", symbol.kind);
        type.last_indices = read_last_indices(parts_, symbol.scope, element.child("DimensionList"));
        return type;
    case PacketType::Kind::time: read_time(symbol, type); return type;
    case PacketType::Kind::enumerated: read_labels(element, type); break;
    case PacketType::Kind::boolean:
        type.zero = element.attribute("zeroStringValue").as_string(type.zero.c_str());
        type.one = element.attribute("oneStringValue").as_string(type.one.c_str());
        break;
    default: break;
    }
    read_coding(symbol, element, type);
    check_sign(element, type);
    read_valid_range(element, type);
    read_alarms(symbol, type);
    return type;
}

/// A type says whether its values have a sign, an encoding whether its bits have one. The encoding is read.
void ModelTypes::check_sign(pugi::xml_node element, const PacketType& type) {
    const pugi::xml_node coding = element.child("IntegerDataEncoding");
    const auto has_sign = parts_.report.flag_or(element, "signed", true);
    if (!element.attribute("signed") || !has_sign || !coding) return;
    using enum Coding::Form;
    const auto form = type.coding.form;
    if (*has_sign && !coding.attribute("encoding"))
        parts_.report.fault(coding, "signed, but no encoding says how: it is read as unsigned");
    if (!*has_sign && (form == twos_complement || form == ones_complement || form == sign_and_magnitude) &&
        type.coding.calibration.empty() && type.coding.contexts.empty())
        parts_.report.fault(coding, "unsigned by its type, signed by its encoding: the encoding is read");
}

void ModelTypes::read_valid_range(pugi::xml_node element, PacketType& type) {
    pugi::xml_node range = element.child("ValidRange");
    if (!range) range = element.child("ValidRangeSet").child("ValidRange");
    if (!range) return;
    if (range.next_sibling("ValidRange")) parts_.report.fault(range, "of several valid ranges only the first is read");
    if (range.attribute("minInclusive")) type.valid_min = parts_.report.number_or(range, "minInclusive", std::nullopt);
    if (range.attribute("maxInclusive")) type.valid_max = parts_.report.number_or(range, "maxInclusive", std::nullopt);
}

void ModelTypes::read_coding(const Symbol& symbol, pugi::xml_node holder, PacketType& type) {
    const bool is_base_uncoded = std::exchange(type.uncoded, false);
    for (const char* name : {"IntegerDataEncoding", "FloatDataEncoding"})
        if (const pugi::xml_node coding = holder.child(name)) return read_number(symbol, coding, type);
    if (const pugi::xml_node coding = holder.child("StringDataEncoding")) return read_text(symbol, coding, type);
    if (const pugi::xml_node coding = holder.child("BinaryDataEncoding")) {
        type.coding.form = Coding::Form::octets;
        type.unread = type.kind != PacketType::Kind::octets;
        if (type.unread && type.kind != PacketType::Kind::time)  // of a time it is told with the time
            parts_.report.fault(coding,
                                std::string{symbol.element.name()} + " in octets is not supported: they are given");
        type.coding.bits = parts_.amount(symbol.scope, coding.child("SizeInBits"));
        if (!parts_.has_usual_order(coding, "the octets are given as they are")) type.unread = true;
        for (const char* algorithm : {"FromBinaryTransformAlgorithm", "ToBinaryTransformAlgorithm"})
            if (const pugi::xml_node found = coding.child(algorithm)) {
                parts_.report.fault(found,
                                    std::string{algorithm} + " is not supported: the octets are given as they are");
                type.unread = true;
            }
        return;
    }
    if (symbol.element.attribute("baseType")) {  // the base type has the encoding
        type.uncoded = is_base_uncoded;
        return;
    }
    type.uncoded = true;  // a finding only where it is in a packet
    type.kind = PacketType::Kind::unknown;
}

void ModelTypes::read_number(const Symbol& symbol, pugi::xml_node coding, PacketType& type) {
    const bool real = std::string_view{coding.name()} == "FloatDataEncoding";
    const auto bits = parts_.report.integer_or(coding, "sizeInBits", real ? 32 : 8, 1, 64);
    const std::string_view word = coding.attribute("encoding").as_string(real ? "IEEE754_1985" : "unsigned");
    const auto form = real ? real_form(word, bits.value_or(0)) : integer_form(word);
    if (!form)
        parts_.report.fault(coding, "encoding " + in_quotes(word) + " of " + std::to_string(bits.value_or(0)) +
                                        " bits is not supported");
    // The size is known nevertheless: fields after it can be read.
    type.unread = !form || type.kind == PacketType::Kind::text;
    if (type.kind == PacketType::Kind::text)
        parts_.report.fault(coding, "text in a number is not supported: the number is given");
    type.coding.form = form.value_or(Coding::Form::octets);
    if (!form) type.kind = PacketType::Kind::octets;
    if (!bits) type.kind = PacketType::Kind::unknown;
    type.coding.bits = Amount::fixed(static_cast<double>(bits.value_or(0)));
    const bool ordered = read_order(coding, bits.value_or(0), type.coding);
    read_calibrations(symbol, coding, type.coding);
    const bool parts = type.coding.least_significant_octet_first && !type.coding.least_significant_bit_first &&
                       bits.value_or(0) % 8 != 0;
    if (parts)
        parts_.report.fault(coding, "least significant octet first is not supported for " +
                                        std::to_string(bits.value_or(0)) + " bits: octets are given");
    if (ordered && !parts) return;
    type.unread = true;
    type.coding.form = Coding::Form::octets;
    if (type.kind != PacketType::Kind::unknown) type.kind = PacketType::Kind::octets;
}

/// False: the order is not supported, and no number can be read.
bool ModelTypes::read_order(pugi::xml_node coding, std::int64_t bits, Coding& into) {
    const std::string_view bit_order = coding.attribute("bitOrder").as_string("mostSignificantBitFirst");
    into.least_significant_bit_first = bit_order == "leastSignificantBitFirst";
    if (!into.least_significant_bit_first && bit_order != "mostSignificantBitFirst") {
        parts_.report.fault(coding, "bit order " + in_quotes(bit_order) + " is not supported: octets are given");
        return false;
    }
    const std::string_view order = coding.attribute("byteOrder").as_string("mostSignificantByteFirst");
    into.least_significant_octet_first = order == "leastSignificantByteFirst";
    if (order != "leastSignificantByteFirst" && order != "mostSignificantByteFirst") {
        parts_.report.fault(coding, "byte order " + in_quotes(order) + " is not supported: octets are given");
        return false;
    }
    // XTCE 1.0 and 1.1 list the octets, each with its significance.
    const pugi::xml_node list = coding.child("ByteOrderList");
    if (!list || bits == 0) return true;
    const std::int64_t octets = (bits + 7) / 8;
    std::vector<std::int64_t> octet_order;
    for (const pugi::xml_node each : list.children("Byte")) {
        const auto significance = parts_.report.integer_or(each, "byteSignificance", std::nullopt, 0, octets - 1);
        if (!significance) return false;
        octet_order.push_back(*significance);
    }
    auto sorted = octet_order;
    std::ranges::sort(sorted);
    if (std::ssize(sorted) != octets || std::ranges::adjacent_find(sorted) != sorted.end()) {
        parts_.report.fault(list, "ByteOrderList does not name each of " + std::to_string(octets) +
                                      " octets once: octets are given");
        return false;
    }
    if (octets < 2 || std::ranges::is_sorted(octet_order, std::ranges::greater{})) return true;
    into.least_significant_octet_first = std::ranges::is_sorted(octet_order);
    if (!into.least_significant_octet_first)
        parts_.report.fault(coding, "octets in mixed order are not supported: octets are given");
    return into.least_significant_octet_first;
}

bool ModelParts::has_usual_order(pugi::xml_node encoding, const std::string& otherwise) const {
    bool usual = true;
    for (const auto& [attribute, order] :
         {std::pair{"bitOrder", "mostSignificantBitFirst"}, std::pair{"byteOrder", "mostSignificantByteFirst"}}) {
        const std::string_view word = encoding.attribute(attribute).as_string(order);
        if (word == order) continue;
        usual = false;
        report.fault(encoding, std::string{attribute} + " " + in_quotes(word) + " of " + encoding.name() +
                                   " is not supported: " + otherwise);
    }
    return usual;
}

void ModelTypes::read_text(const Symbol& symbol, pugi::xml_node coding, PacketType& type) {
    type.coding.form = Coding::Form::text;
    type.unread = false;
    if (type.kind != PacketType::Kind::text && type.kind != PacketType::Kind::octets) {
        parts_.report.fault(coding,
                            std::string{symbol.element.name()} + " in characters is not supported: they are given");
        type.unread = true;
    }
    const std::string_view characters = coding.attribute("encoding").as_string("UTF-8");
    if (const auto known = characters_of(characters)) {
        type.coding.characters = *known;
    } else {
        parts_.report.fault(coding, "characters in " + in_quotes(characters) + " are not supported: octets are given");
        type.unread = true;
        type.coding.characters = Coding::Characters::utf8;
        type.kind = PacketType::Kind::octets;
    }
    if (!parts_.has_usual_order(coding, "octets are given")) {
        type.unread = true;
        type.kind = PacketType::Kind::octets;
    }
    pugi::xml_node size = coding.child("SizeInBits");
    const pugi::xml_node variable = coding.child("Variable");
    if (!size) size = variable;
    const auto most_bits = parts_.report.number_or(variable, "maxSizeInBits", 8.0 * 65536);
    type.coding.bits = Amount::fixed(most_bits.value_or(0.0));
    if (!most_bits) type.kind = PacketType::Kind::unknown;
    // XTCE 1.2 demands a size where the text itself says where it ends; in files for Yamcs this name fills the place.
    const bool delimited = size.child("LeadingSize") || size.child("TerminationChar");
    const std::string_view sized_by =
        size.child("DynamicValue").child("ParameterInstanceRef").attribute("parameterRef").value();
    type.coding.boxed = size.child("Fixed") || size.child("FixedValue") || size.child("DiscreteLookupList") ||
                        (size.child("DynamicValue") && !(delimited && sized_by == "_yamcs_ignore"));
    if (type.coding.boxed) type.coding.bits = parts_.amount(symbol.scope, size);
    if (type.coding.boxed && variable.attribute("maxSizeInBits")) type.coding.most_bits = most_bits.value_or(0.0);
    if (const pugi::xml_node leading = size.child("LeadingSize")) {
        const auto tag_bits = parts_.report.integer_or(leading, "sizeInBitsOfSizeTag", 16, 1, 64);
        type.coding.leading_size_bits = static_cast<unsigned>(tag_bits.value_or(0));
        if (!tag_bits) type.kind = PacketType::Kind::unknown;
        type.coding.leading_size_unit_bits = parts_.agreement.leading_size_unit_bits;
    }
    if (const pugi::xml_node end = size.child("TerminationChar")) {
        const auto wide = type.coding.characters;
        const bool two_octets =
            wide == Coding::Characters::utf16_big_endian || wide == Coding::Characters::utf16_little_endian;
        const std::string word = end.text().as_string(two_octets ? "0000" : "00");
        const auto value = to_integer("0x" + word);
        if (value && word.size() == (two_octets ? 4 : 2)) {
            if (two_octets) type.coding.terminator.push_back(static_cast<std::uint8_t>(*value >> 8));
            type.coding.terminator.push_back(static_cast<std::uint8_t>(*value & 0xFF));
        } else {
            parts_.report.fault(end, "a termination of " + in_quotes(word) +
                                         " is not one character of the encoding: "
                                         "packets are read up to it");
            type.kind = PacketType::Kind::unknown;
        }
    }
    if (!size) {
        parts_.report.fault(coding, "type " + in_quotes(type.name) + " does not say how long its text is");
        type.kind = PacketType::Kind::unknown;
    }
}

void ModelTypes::read_calibrations(const Symbol& symbol, pugi::xml_node coding, Coding& into) {
    if (const pugi::xml_node calibrator = coding.child("DefaultCalibrator")) into.calibration = calibration(calibrator);
    for (const pugi::xml_node each : coding.child("ContextCalibratorList").children("ContextCalibrator"))
        into.contexts.push_back(
            {parts_.condition(symbol.scope, each.child("ContextMatch")), calibration(each.child("Calibrator"))});
}

Calibration ModelTypes::calibration(pugi::xml_node calibrator) {
    Calibration result;
    if (const pugi::xml_node polynomial = calibrator.child("PolynomialCalibrator")) {
        for (const pugi::xml_node term : polynomial.children("Term")) {
            const auto exponent = parts_.report.integer_or(term, "exponent", std::nullopt, 0, exponent_max);
            const auto coefficient = parts_.report.number_or(term, "coefficient", std::nullopt);
            result.known = result.known && exponent && coefficient;
            if (!exponent || !coefficient) continue;
            const auto power = static_cast<std::size_t>(*exponent);
            if (result.polynomial.size() <= power) result.polynomial.resize(power + 1, 0.0);
            result.polynomial[power] += *coefficient;
        }
        result.known = result.known && has_only(polynomial, {"Term"}, {"name", "shortDescription"});
        if (!polynomial.child("Term")) {
            parts_.report.fault(polynomial, "a polynomial without terms: its values are undefined");
            result.known = false;
        }
        // The value itself: as a whole number it keeps its last digit.
        if (result.known && result.polynomial == std::vector{0.0, 1.0}) result.polynomial.clear();
        return result;
    }
    if (const pugi::xml_node spline = calibrator.child("SplineCalibrator")) {
        const auto order = parts_.report.integer_or(spline, "order", 1, 0, spline_order_max);
        for (const pugi::xml_node point : spline.children("SplinePoint")) {
            const auto raw = parts_.report.number_or(point, "raw", std::nullopt);
            const auto calibrated = parts_.report.number_or(point, "calibrated", std::nullopt);
            const auto point_order = parts_.report.integer_or(point, "order", order.value_or(1), 0, spline_order_max);
            if (point_order && order && point_order != order)
                parts_.report.fault(point, "a point of another order than its spline is not supported: its values are "
                                           "undefined");
            result.known = result.known && raw && calibrated && point_order == order;
            if (raw && calibrated) result.spline.emplace_back(*raw, *calibrated);
        }
        std::ranges::sort(result.spline);
        const auto extrapolate = parts_.report.flag_or(spline, "extrapolate", false);
        result.flat = order == 0;
        result.extrapolate = extrapolate.value_or(false);
        result.known = result.known && order && extrapolate && *order <= 1 &&
                       has_only(spline, {"SplinePoint"}, {"order", "extrapolate", "name", "shortDescription"});
        if (order && *order > 1)
            parts_.report.fault(spline, "a spline of order " + std::to_string(*order) +
                                            " is not supported: its values are undefined");
        if (!spline.child("SplinePoint")) {
            parts_.report.fault(spline, "a spline without points: its values are undefined");
            result.known = false;
        }
        return result;
    }
    parts_.report.fault(
        calibrator, "a calibrator that is neither polynomial nor spline is not supported: its values are undefined");
    result.known = false;
    return result;
}

void ModelTypes::read_labels(pugi::xml_node element, PacketType& type) {
    std::map<std::int64_t, std::pair<std::int64_t, std::string>> of_values;  // first value: last, label
    for (const pugi::xml_node entry : element.child("EnumerationList").children("Enumeration")) {
        const auto first = to_integer(number_digits(entry.attribute("value").value()));
        const auto last =
            entry.attribute("maxValue") ? to_integer(number_digits(entry.attribute("maxValue").value())) : first;
        const std::string label = entry.attribute("label").value();
        if (!first || !last || *last < *first || label.empty()) {
            parts_.report.fault(entry, !first || !last ? "its value is not a whole number"
                                       : label.empty()
                                           ? "a value without a label"
                                           : "label " + in_quotes(label) + ": maxValue " + std::to_string(*last) +
                                                 " is below value " + std::to_string(*first) + ": it labels nothing");
            continue;
        }
        const auto above = of_values.upper_bound(*last);  // the labels before it may have the same values
        if (const auto same = above == of_values.begin() ? above : std::prev(above);
            same != above && same->second.first >= *first && same->second.second != label)
            parts_.report.fault(entry, "labels " + in_quotes(same->second.second) + " and " + in_quotes(label) +
                                           " are of one value: it has the first of the file");
        of_values.try_emplace(*first, *last, label);
        if (type.labels.size() < label_values_max)
            type.labels.push_back({*first, *last, label, parts_.report.line(entry)});
    }
}

void ModelTypes::read_time(const Symbol& symbol, PacketType& type) {
    const pugi::xml_node encoding = symbol.element.child("Encoding");
    const std::string_view units = encoding.attribute("units").as_string("seconds");
    constexpr std::array<std::pair<std::string_view, double>, 3> seconds_in{
        {{"seconds", 1.0}, {"picoSeconds", 1e-12}, {"days", 86400.0}}};
    const auto unit = std::ranges::find(seconds_in, units, &std::pair<std::string_view, double>::first);
    const double unit_s = unit == seconds_in.end() ? 1.0 : unit->second;
    constexpr double undefined = std::numeric_limits<double>::quiet_NaN();
    type.time_offset_s = unit_s * parts_.report.number_or(encoding, "offset", 0.0).value_or(undefined);
    auto scale = parts_.report.number_or(encoding, "scale", 1.0);
    if (scale == 0.0) {
        parts_.report.fault(encoding, "a time of scale 0 is undefined");
        scale.reset();
    }
    type.time_scale_s = unit_s * scale.value_or(undefined);
    read_reference_time(symbol, type);
    read_coding(symbol, encoding ? encoding : symbol.element, type);
    if (unit == seconds_in.end()) {
        parts_.report.fault(encoding,
                            "time in " + in_quotes(std::string{units}) + " is not supported: it is undefined");
        type.unread = true;
        type.coding.calibration = {.known = false};
    }
    if (!std::isfinite(type.time_scale_s + type.time_offset_s)) type.unread = true;
    if (type.kind == PacketType::Kind::time && type.coding.form == Coding::Form::octets)
        parts_.report.fault(encoding, "a time that is no number is given as its octets");
}

void ModelTypes::read_reference_time(const Symbol& symbol, PacketType& type) {
    type.relative = std::string_view{symbol.element.name()} == "RelativeTimeParameterType";
    const pugi::xml_node reference = symbol.element.child("ReferenceTime");
    if (const pugi::xml_node epoch = reference.child("Epoch")) {
        const auto letters = [](char c) { return static_cast<char>(c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c); };
        type.epoch = epoch.text().as_string();
        std::ranges::transform(type.epoch, type.epoch.begin(), letters);
        if (!is_epoch(type.epoch))
            parts_.report.fault(epoch, "epoch " + in_quotes(type.epoch) +
                                           " is neither TAI, GPS, J2000, UNIX, POSIX nor a date: times are given as "
                                           "seconds after it");
    }
    if (const pugi::xml_node since = reference.child("OffsetFrom")) {
        const auto found = parts_.parameter(symbol.scope, since, "parameterRef");
        if (found && found->member.empty())
            type.time_since = found->parameter;
        else
            type.relative = true;
        if (found && !found->member.empty())
            parts_.report.fault(since,
                                "a time since a member is not supported: it is given without what it counts from");
    }
}

void ModelTypes::read_members(const Symbol& symbol, PacketType& type) {
    for (const pugi::xml_node member : symbol.element.child("MemberList").children("Member"))
        type.members.push_back(
            {name_of(member),
             of(symbol.scope, member, member.attribute("typeRef") ? "typeRef" : "parameterTypeRef", symbol.kind)});
}

std::optional<std::size_t> fixed_amount(const Amount& amount) {
    const double value = amount.intercept;
    if (!amount.is_fixed() || !(value >= 0.0) || value > 1.0e6) return std::nullopt;
    return static_cast<std::size_t>(value);
}

Type field_type(const PacketType& type) {
    Type words;
    words.name = type.name;
    words.unit = type.kind == PacketType::Kind::time ? "s" : type.unit;
    words.bits = static_cast<unsigned>(fixed_amount(type.coding.bits).value_or(0));
    switch (type.kind) {
    case PacketType::Kind::integer: words.kind = ValueKind::integer; break;
    case PacketType::Kind::enumerated: words.kind = ValueKind::enumerated; break;
    case PacketType::Kind::boolean: words.kind = ValueKind::boolean; break;
    case PacketType::Kind::text: words.kind = ValueKind::text; break;
    case PacketType::Kind::octets: words.binary = true; break;
    default: words.kind = ValueKind::real; break;
    }
    for (const auto& label : type.labels)
        words.enumeration.push_back(
            {label.first, label.label, label.last == label.first ? std::nullopt : std::optional{label.last}});
    words.calibrator = type.coding.calibration.polynomial;
    words.valid_min = type.valid_min;
    words.valid_max = type.valid_max;
    words.alarms = type.alarms;
    const auto form = type.coding.form;
    if (form == Coding::Form::ieee754 || form == Coding::Form::mil1750a)
        words.encoding = Encoding::ieee754;
    else if (form == Coding::Form::twos_complement || form == Coding::Form::ones_complement ||
             form == Coding::Form::sign_and_magnitude)
        words.encoding = Encoding::twos_complement;
    return words;
}

}  // namespace aeolis::dictionary::xtce
