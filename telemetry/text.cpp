// SPDX-License-Identifier: Apache-2.0
#include "telemetry/text.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>

namespace aeolis::telemetry {
namespace {

/// Spelling of a unit, and the decimals that people need. Chosen.
struct Notation {
    std::string_view unit;    ///< as in the dictionary
    std::string_view suffix;  ///< as the ending of a name
    int decimals;
};
constexpr std::array notations{
    Notation{"m/s2", "mps2", 2}, Notation{"m/s^2", "", 2},        Notation{"m/s", "mps", 1},
    Notation{"deg/s", "dps", 2}, Notation{"deg", "deg", 2},       Notation{"rad", "rad", 4},
    Notation{"km", "km", 2},     Notation{"m", "m", 1},           Notation{"s", "s", 3},
    Notation{"s", "sclk", 3},    Notation{"g", "g", 2},           Notation{"kg", "kg", 1},
    Notation{"N", "N", 0},       Notation{"Pa", "Pa", 1},         Notation{"%", "percent", 1},
    Notation{"percent", "", 1},  Notation{"octets", "octets", 0}, Notation{"Hz", "hz", 2},
    Notation{"dBHz", "dbhz", 1}, Notation{"", "mach", 2},
};

/// Words of names that are written in capitals.
constexpr std::array<std::string_view, 6> acronyms{"edl", "gnc", "imu", "mfsk", "sufr", "uhf"};
/// Parts of names that are written with a hyphen.
constexpr std::array<std::pair<std::string_view, std::string_view>, 2> with_hyphen{
    {{"x_band", "X-band"}, {"sub_constraint", "sub-constraint"}}};

constexpr double kilometres_from_m = 100'000.0;
constexpr double metres_in_km = 1000.0;
constexpr double slow_below_mps = 10.0;
constexpr double tenths_from_s = 100.0;
constexpr double hours_in_day = 24.0;
constexpr double seconds_in_hour = 3600.0;
constexpr double seconds_in_minute = 60.0;
constexpr int more_decimals_max = 6;  // what differs less is noise of single precision

bool is_whole(double value) {
    return value == std::floor(value) && std::abs(value) < 1e15;
}

std::string digits(double value, std::optional<int> decimals, int more = 0) {
    constexpr int significant = 6;
    char buffer[400];  // a double printed whole has at most 309 digits before the point
    if (decimals && std::abs(value) < 1e12)
        std::snprintf(buffer, sizeof buffer, "%.*f", *decimals + more, value);
    else
        std::snprintf(buffer, sizeof buffer, "%.*g", significant + more, value);
    // "-0.0" would be a sign without a number.
    std::string text = buffer;
    if (text.front() == '-' && text.find_first_not_of("-0.") == std::string::npos) text.erase(0, 1);
    return text;
}

const Notation* notation_of_unit(std::string_view unit) {
    for (const Notation& notation : notations)
        if (!unit.empty() && notation.unit == unit) return &notation;
    return nullptr;
}

const Notation* notation_of_name(std::string_view name) {
    const std::size_t underscore = name.rfind('_');
    const std::string_view ending = underscore == std::string_view::npos ? name : name.substr(underscore + 1);
    for (const Notation& notation : notations)
        if (!notation.suffix.empty() && notation.suffix == ending) return &notation;
    return nullptr;
}

/// Without the zeros at the end of a fraction.
std::string trimmed(std::string number) {
    if (number.find('.') == std::string::npos) return number;
    number.erase(number.find_last_not_of('0') + 1);
    if (number.back() == '.') number.pop_back();
    return number;
}

/// "14.016 s", "4 h 59 min 24 s", from two days on "6 d 2 h"
std::string duration_text(double value_s, int more_decimals) {
    double left_s = std::abs(value_s);
    const int decimals = (left_s >= tenths_from_s ? 1 : 3) + more_decimals;
    if (left_s < seconds_in_hour || left_s > 1e12) return trimmed(digits(value_s, decimals)) + " s";
    const double scale = std::pow(10.0, decimals);
    left_s = std::round(left_s * scale) / scale;
    double hours = std::floor(left_s / seconds_in_hour);
    left_s -= hours * seconds_in_hour;
    const double days = hours >= 2.0 * hours_in_day ? std::floor(hours / hours_in_day) : 0.0;
    hours -= days * hours_in_day;
    const double minutes = std::floor(left_s / seconds_in_minute);
    left_s -= minutes * seconds_in_minute;
    std::string text = value_s < 0.0 ? "-" : "";
    if (days > 0.0) text += digits(days, 0) + " d";
    if (days > 0.0 && hours > 0.0) text += " ";
    if (days == 0.0 || hours > 0.0) text += digits(hours, 0) + " h";
    if (minutes > 0.0) text += " " + digits(minutes, 0) + " min";
    if (left_s > 0.0) text += " " + trimmed(digits(left_s, decimals)) + " s";
    return text;
}

bool is_reference(std::string_view field) {
    return field == "opcode" || field == "timepoint" || field == "anchor" || field == "tone" || field == "constraint" ||
           field == "parameter";
}

std::string moment_words(const dictionary::Dictionary& dictionary, const dictionary::Moment& moment) {
    const auto timepoint = [&] { return in_words(dictionary.timeline[moment.index].name); };
    switch (moment.kind) {
    case dictionary::Moment::Kind::anchor: return "the anchor " + in_words(dictionary.anchors[moment.index].name);
    case dictionary::Moment::Kind::triggered: return "the triggering of " + timepoint();
    case dictionary::Moment::Kind::fired: return "the firing of " + timepoint();
    case dictionary::Moment::Kind::do_edl: break;
    }
    return "the acceptance of \"do EDL\"";
}

const std::string* label_of(const dictionary::Type& type, double value) {
    for (const dictionary::EnumValue& entry : type.enumeration)
        if (entry.holds(value)) return &entry.label;
    return nullptr;
}

}  // namespace

std::string number_text(const dictionary::Type& type, std::optional<double> value) {
    if (!value) return "undefined";
    switch (type.kind) {
    case dictionary::ValueKind::boolean: return *value != 0.0 ? "true" : "false";
    case dictionary::ValueKind::enumerated: {
        const std::string* label = label_of(type, *value);
        return label != nullptr ? *label : digits(*value, 0) + " (no label)";
    }
    case dictionary::ValueKind::integer:
        if (is_whole(*value)) return digits(*value, 0);
        break;  // calibrated to a fraction
    case dictionary::ValueKind::real:
    case dictionary::ValueKind::text: break;
    }
    const Notation* notation = notation_of_unit(type.unit);
    return digits(*value, notation != nullptr ? std::optional{notation->decimals} : std::nullopt);
}

std::string value_text(const dictionary::Type& type, std::optional<double> value) {
    const std::string number = number_text(type, value);
    const bool bare = !value || type.unit.empty() || type.unit == "1" || type.kind == dictionary::ValueKind::boolean ||
                      type.kind == dictionary::ValueKind::enumerated;
    return bare ? number : number + " " + type.unit;
}

std::string_view without_unit(std::string_view name) {
    if (notation_of_name(name) == nullptr) return name;
    const std::size_t underscore = name.rfind('_');
    return underscore == std::string_view::npos ? name : name.substr(0, underscore);
}

std::string named_value_text(std::string_view name, double value, int more_decimals) {
    const Notation* notation = notation_of_name(name);
    const bool whole = is_whole(value) && more_decimals == 0;
    if (notation == nullptr) return digits(value, whole ? std::optional{0} : std::nullopt, more_decimals);
    if (notation->unit == "s") return duration_text(value, more_decimals);
    if (notation->unit == "m/s" && std::abs(value) < slow_below_mps) return digits(value, 2, more_decimals) + " m/s";
    if (notation->unit == "m" && std::abs(value) >= kilometres_from_m)
        return digits(value / metres_in_km, notation->decimals, more_decimals) + " km";
    return digits(value, notation->decimals, more_decimals) + (notation->unit.empty() ? "" : " ") +
           std::string{notation->unit};
}

std::string span_text(double span_s) {
    constexpr double tenths = 10.0;
    return duration_text(std::round(span_s * tenths) / tenths, 0);
}

std::pair<std::string, std::string> told_apart(std::string_view name, double value, double other) {
    std::pair<std::string, std::string> texts;
    for (int more = 0; more <= more_decimals_max; ++more) {
        texts = {named_value_text(name, value, more), named_value_text(name, other, more)};
        if (value == other || texts.first != texts.second) break;
    }
    return texts;
}

std::string in_words(std::string_view name) {
    std::string words;
    while (!name.empty()) {
        const auto* const hyphenated = std::ranges::find_if(with_hyphen, [&](const auto& each) {
            return name.starts_with(each.first) && (name.size() == each.first.size() || name[each.first.size()] == '_');
        });
        const bool hyphen = hyphenated != with_hyphen.end();
        const std::string_view word = hyphen ? hyphenated->first : name.substr(0, name.find('_'));
        name.remove_prefix(std::min(name.size(), word.size() + 1));
        if (!words.empty()) words += ' ';
        if (hyphen) {
            words += hyphenated->second;
            continue;
        }
        const bool acronym = std::ranges::find(acronyms, word) != acronyms.end();
        for (const char c : word) words += acronym ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
    }
    return words;
}

std::string reference_text(const dictionary::Dictionary& dictionary, std::string_view field, double number) {
    const std::string plain = digits(number, 0);
    if (number < 0.0 || number > 65535.0 || !is_whole(number)) return plain;
    const auto index = static_cast<std::size_t>(number);
    if (field == "opcode") {
        const auto* command = dictionary.command(Opcode{static_cast<std::uint16_t>(index)});
        return command != nullptr ? command->name : plain;
    }
    if (field == "constraint") {
        if (index >= dictionary.constraints.size()) return plain;
        const dictionary::ConstraintRow& row = dictionary.constraints[index];
        return plain + " (from " + moment_words(dictionary, row.from) + " to " + moment_words(dictionary, row.to) +
               ", constraints.csv:" + std::to_string(row.line) + ")";
    }
    const auto numbered = [&](const auto& rows) {
        return index < rows.size() && !rows[index].name.empty() ? plain + " " + rows[index].name : plain;
    };
    if (field == "timepoint") return numbered(dictionary.timeline);
    if (field == "anchor") return numbered(dictionary.anchors);
    if (field == "tone") return numbered(dictionary.tones);
    if (field == "parameter") return numbered(dictionary.parameters);
    return plain;
}

const char* name_of(dictionary::EventLevel level) {
    switch (level) {
    case dictionary::EventLevel::fatal: return "FATAL";
    case dictionary::EventLevel::warning_hi: return "WARNING_HI";
    case dictionary::EventLevel::warning_lo: return "WARNING_LO";
    case dictionary::EventLevel::command: return "COMMAND";
    case dictionary::EventLevel::activity_hi: return "ACTIVITY_HI";
    case dictionary::EventLevel::activity_lo: return "ACTIVITY_LO";
    case dictionary::EventLevel::diagnostic: return "DIAGNOSTIC";
    }
    return "";
}

const dictionary::Event* event_of(const dictionary::Dictionary& dictionary, const Decoded& decoded) {
    const auto& id = dictionary.packets[decoded.packet].event;
    return id ? dictionary.event(*id) : nullptr;
}

namespace {

std::string argument_text(const dictionary::Dictionary& dictionary, const dictionary::Field& field,
                          std::optional<double> value) {
    const bool names_a_thing = field.type.kind == dictionary::ValueKind::integer && value;
    return names_a_thing && is_reference(field.name) ? reference_text(dictionary, field.name, *value)
                                                     : number_text(field.type, value);
}

}  // namespace

std::string event_text(const dictionary::Dictionary& dictionary, const dictionary::Event& event,
                       const Decoded& decoded) {
    const dictionary::Packet& packet = dictionary.packets[decoded.packet];
    std::string text;
    std::string_view rest = event.format;
    while (!rest.empty()) {
        const std::size_t open = rest.find('{');
        const std::size_t close = open == std::string_view::npos ? open : rest.find('}', open);
        if (close == std::string_view::npos) break;
        text += rest.substr(0, open);
        const auto field = field_index(packet, rest.substr(open + 1, close - open - 1));
        text += field && *field < decoded.value.size()
                    ? argument_text(dictionary, packet.fields[*field], decoded.value[*field])
                    : std::string{rest.substr(open, close - open + 1)};
        rest.remove_prefix(close + 1);
    }
    return text.append(rest);
}

}  // namespace aeolis::telemetry
