// SPDX-License-Identifier: Apache-2.0
#include "telemetry/time_source.hpp"

#include "common/bytes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <variant>

namespace aeolis::telemetry {
namespace {

using dictionary::xtce::PacketModel;
using Form = TimeSource::Form;

// [ccsds-301.0-b-4]
constexpr double day_s = 86400.0, milli = 1e-3, micro = 1e-6, pico = 1e-12;
constexpr unsigned cuc_tai = 0b001, cuc_agency = 0b010, cds_code = 0b100;
constexpr std::size_t cuc_counts = 4, cds_ms_octets = 4, cds_octets = 6;
constexpr std::size_t number_octets_max = 8;

const std::map<std::string_view, Form> forms{{"seconds", Form::seconds},           {"milliseconds", Form::milliseconds},
                                             {"microseconds", Form::microseconds}, {"cuc", Form::cuc},
                                             {"cuc-preamble", Form::cuc_preamble}, {"cds", Form::cds},
                                             {"cds-preamble", Form::cds_preamble}};

std::optional<double> seconds_in(const Datum& datum) {
    if (const auto* value = std::get_if<double>(&datum)) return *value;
    if (const auto* value = std::get_if<std::uint64_t>(&datum)) return static_cast<double>(*value);
    if (const auto* value = std::get_if<std::int64_t>(&datum)) return static_cast<double>(*value);
    return std::nullopt;
}

double number_in(std::span<const std::uint8_t> octets) {
    std::uint64_t value = 0;
    for (const std::uint8_t octet : octets.first(std::min(octets.size(), number_octets_max)))
        value = value << 8 | octet;
    return static_cast<double>(value);
}

double fraction_in(std::span<const std::uint8_t> octets) {
    return std::ldexp(number_in(octets), -8 * static_cast<int>(std::min(octets.size(), number_octets_max)));
}

std::optional<PacketTime> cuc_of(std::span<const std::uint8_t> octets, std::size_t counts, const std::string& epoch) {
    constexpr std::size_t counts_max = 4, fraction_max = 3;  // without the preamble's extension
    if (counts > counts_max || octets.size() < counts || octets.size() > counts + fraction_max) return std::nullopt;
    return PacketTime{number_in(octets.first(counts)) + fraction_in(octets.subspan(counts)), epoch};
}

std::optional<PacketTime> cuc_by_preamble(std::span<const std::uint8_t> octets) {
    if (octets.empty() || (octets[0] & 0x80) != 0) return std::nullopt;
    const unsigned code = octets[0] >> 4;
    const std::size_t counts = (octets[0] >> 2 & 0b11) + 1, fraction = octets[0] & 0b11;
    if ((code != cuc_tai && code != cuc_agency) || octets.size() != 1 + counts + fraction) return std::nullopt;
    return cuc_of(octets.subspan(1), counts, code == cuc_tai ? "TAI" : "");
}

/// Days of UTC with milliseconds of the day; none where no day has as many.
/// @param part_s  of a millisecond
std::optional<PacketTime> time_of_day(double days, double milliseconds, double part_s, const std::string& epoch) {
    constexpr double day_ms = 86'400'000.0, leap_second_ms = 1000.0;
    if (!(milliseconds < day_ms + leap_second_ms) || !(part_s < milli)) return std::nullopt;
    return PacketTime{days * day_s + milliseconds * milli + part_s, epoch, true, milliseconds >= day_ms};
}

/// @param below  octets of the part of a millisecond
std::optional<PacketTime> cds_of(std::span<const std::uint8_t> octets, std::size_t days, std::size_t below,
                                 const std::string& epoch) {
    if ((below != 0 && below != 2 && below != 4) || octets.size() != days + cds_ms_octets + below) return std::nullopt;
    const double part_s = below == 4 ? pico : micro;
    return time_of_day(number_in(octets.first(days)), number_in(octets.subspan(days, cds_ms_octets)),
                       number_in(octets.subspan(days + cds_ms_octets)) * part_s, epoch);
}

std::optional<PacketTime> cds_by_preamble(std::span<const std::uint8_t> octets) {
    if (octets.empty() || octets[0] >> 4 != cds_code) return std::nullopt;
    const std::size_t days = (octets[0] & 0b100) != 0 ? 3 : 2;
    constexpr std::array<std::size_t, 4> below{0, 2, 4, 99};  // the last is reserved
    return cds_of(octets.subspan(1), days, below[octets[0] & 0b11], (octets[0] & 0b1000) == 0 ? "TAI" : "");
}

std::optional<PacketTime> time_of(Form form, std::span<const std::uint8_t> octets) {
    switch (form) {
    case Form::cuc: return cuc_of(octets, cuc_counts, {});
    case Form::cuc_preamble: return cuc_by_preamble(octets);
    case Form::cds:
        return octets.size() < cds_octets ? std::nullopt : cds_of(octets, 2, octets.size() - cds_octets, {});
    case Form::cds_preamble: return cds_by_preamble(octets);
    default: return std::nullopt;
    }
}

}  // namespace

Result<TimeSource> TimeSource::parse(const PacketModel& model, const std::string& text) {
    TimeSource source;
    std::string name = text;
    if (const auto colon = name.rfind(':'); colon != std::string::npos) {
        const auto form = forms.find(std::string_view{name}.substr(colon + 1));
        if (form != forms.end()) {
            source.form = form->second;
            name.erase(colon);
        }
    }
    for (std::size_t end = name.size(); end > 0 && end != std::string::npos; end = name.find_last_of("./[", end - 1)) {
        const std::string whole = name.substr(0, end);
        std::vector<std::size_t> found;
        for (std::size_t i = 0; i < model.parameters.size(); ++i)
            if (model.parameters[i].path == whole || model.parameters[i].name == whole ||
                model.parameters[i].path.ends_with("/" + whole))
                found.push_back(i);
        if (found.size() > 1)
            return Error{"several parameters are called '" + whole + "': say which by its path, such as " +
                         model.parameters[found.front()].path};
        if (found.size() == 1) {
            const auto& parameter = model.parameters[found.front()];
            source.parameter = found.front();
            source.name = parameter.name;
            source.member = name.substr(end);
            std::ranges::replace(source.member, '/', '.');
            const auto& type = model.types[parameter.type];
            source.epoch = type.epoch;
            if (type.kind == dictionary::xtce::PacketType::Kind::octets && source.form == Form::as_fits)
                return Error{"'" + name + "' is octets: say :cuc, :cuc-preamble, :cds or :cds-preamble behind it"};
            return source;
        }
        if (end == 0) break;
    }
    return Error{"there is no parameter '" + name +
                 "' in the XTCE file; after ':' stand seconds, milliseconds, "
                 "microseconds, cuc, cuc-preamble, cds or cds-preamble"};
}

std::vector<const DecodedValue*> TimeSource::parts_in(std::span<const DecodedValue> values) const {
    const std::string wanted = name + member;
    std::vector<const DecodedValue*> parts;
    for (const DecodedValue& value : values) {
        if (value.parameter != parameter || !value.name.starts_with(wanted)) continue;
        const bool inside = value.name.size() > wanted.size();
        if (inside && value.name[wanted.size()] != '.' && value.name[wanted.size()] != '[') continue;
        parts.push_back(&value);
    }
    return parts;
}

bool TimeSource::is_defined_in(std::span<const DecodedValue> values) const {
    const auto parts = parts_in(values);
    return !parts.empty() && std::ranges::none_of(parts, [](const DecodedValue* part) {
        return std::holds_alternative<std::monostate>(part->calibrated);
    });
}

std::optional<PacketTime> TimeSource::time_in(std::span<const DecodedValue> values) const {
    const auto parts = parts_in(values);
    if (parts.empty()) return std::nullopt;
    const auto with_epoch = [&](std::optional<PacketTime> time) {
        if (time && time->epoch.empty()) time->epoch = epoch;
        return time;
    };
    if (const auto* octets = std::get_if<std::vector<std::uint8_t>>(&parts[0]->raw); octets != nullptr) {
        return parts.size() == 1 ? with_epoch(time_of(form, *octets)) : std::nullopt;
    }
    const auto number = [&](std::size_t i) {
        return seconds_in(form == Form::cuc || form == Form::cds ? parts[i]->raw : parts[i]->calibrated);
    };
    const auto first = number(0);
    if (!first) return std::nullopt;
    const bool two = parts.size() == 2 && std::holds_alternative<std::uint64_t>(parts[1]->raw);
    if (form == Form::cds) {
        if (parts.size() < 2 || parts.size() > 3 || !number(1) || (parts.size() == 3 && !number(2)))
            return std::nullopt;
        const double below_s = parts.size() == 3 ? *number(2) * (parts[2]->bits > 16 ? pico : micro) : 0.0;
        return time_of_day(*first, *number(1), below_s, epoch);
    }
    if (two && (form == Form::cuc || form == Form::as_fits)) {
        const auto fraction = std::get<std::uint64_t>(parts[1]->raw);
        return PacketTime{*first + std::ldexp(static_cast<double>(fraction), -static_cast<int>(parts[1]->bits)), epoch};
    }
    if (parts.size() != 1 || form == Form::cuc) return std::nullopt;
    const double a_second = form == Form::milliseconds ? 1e3 : form == Form::microseconds ? 1e6 : 1.0;
    return PacketTime{*first / a_second, epoch};
}

}  // namespace aeolis::telemetry
