// SPDX-License-Identifier: Apache-2.0
#include "telemetry/container_decoder.hpp"

#include "common/bytes.hpp"
#include "common/crc.hpp"
#include "common/space_packet.hpp"
#include "dictionaries/words.hpp"
#include "dictionaries/xtce/characters.hpp"
#include "telemetry/raw_number.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <ranges>
#include <unordered_map>
#include <unordered_set>
#include <utility>

namespace aeolis::telemetry {
namespace {

using namespace dictionary::xtce;
namespace xtce = dictionary::xtce;  // telemetry has a Condition of its own

constexpr std::size_t steps_max = 4 * ContainerDecoder::values_max;  // entries read, for a packet

/// A number for comparison and arithmetic; none for text and octets.
std::optional<long double> number_of(const Datum& datum) {
    if (const auto* value = std::get_if<std::uint64_t>(&datum)) return *value;
    if (const auto* value = std::get_if<std::int64_t>(&datum)) return *value;
    if (const auto* value = std::get_if<double>(&datum)) return *value;
    return std::nullopt;
}

template <typename Left, typename Right>
bool compared(const Left& left, xtce::Condition::Operator op, const Right& right) {
    switch (op) {
    case xtce::Condition::Operator::equal: return left == right;
    case xtce::Condition::Operator::not_equal: return left != right;
    case xtce::Condition::Operator::less: return left < right;
    case xtce::Condition::Operator::less_or_equal: return left <= right;
    case xtce::Condition::Operator::greater: return left > right;
    case xtce::Condition::Operator::greater_or_equal: return left >= right;
    }
    return false;
}

std::optional<long double> compared_number(const std::string& word) {
    if (const auto whole = dictionary::to_integer(word)) return *whole;
    if (const auto number = dictionary::to_number(word)) return *number;
    return std::nullopt;
}

Datum defined(double value) {
    return std::isfinite(value) ? Datum{value} : Datum{};
}

/// The decoding of one packet.
class Reading {
  public:
    Reading(const PacketModel& model, std::span<const std::uint8_t> packet) : model_(model), packet_(packet) {}

    /// Reads a container. Returns false when the packet cannot be read further.
    bool read_container(const PacketContainer& container, std::size_t start_bits, unsigned depth) {
        if (depth == ContainerDecoder::depth_max) return stop("containers are nested too deep", container.line);
        for (const PacketEntry& entry : container.entries)
            if (!read_entry(container, entry, start_bits, depth)) return false;
        return !container.bits || end_container(container, start_bits);
    }

    /// None: whether it holds is not known.
    std::optional<bool> judge(const xtce::Condition& condition) const {
        switch (condition.form) {
        case xtce::Condition::Form::always: return true;
        case xtce::Condition::Form::compare: return compare(condition);
        case xtce::Condition::Form::unknown: return std::nullopt;
        case xtce::Condition::Form::all:
        case xtce::Condition::Form::any: break;
        }
        const bool decisive = condition.form == xtce::Condition::Form::any;  // of one part
        std::optional<bool> result = !decisive;
        for (const xtce::Condition& part : condition.parts) {
            const auto one = judge(part);
            if (one == decisive) return decisive;
            if (!one) result.reset();
        }
        return result;
    }
    bool holds(const xtce::Condition& condition) const { return judge(condition).value_or(false); }

    /// The derived container that describes the packet further. None where none does, or where several do.
    std::optional<std::size_t> next_of(const std::vector<std::size_t>& derived) {
        std::optional<std::size_t> restricted, any, not_known;
        for (const std::size_t each : derived) {
            const PacketContainer& container = model_.containers[each];
            const auto describes = judge(container.when);
            if (!describes) not_known = each;
            if (!describes.value_or(false)) continue;
            auto& found = container.when.form == xtce::Condition::Form::always ? any : restricted;
            if (found) {
                stop(model_.containers[*found].name + " and " + container.name + " both describe it", container.line);
                return std::nullopt;
            }
            found = each;
        }
        if (!restricted && not_known) {
            const PacketContainer& container = model_.containers[*not_known];
            stop("whether " + container.name +
                     " describes it is not known: its condition is not understood, or its value is not known",
                 container.line);
            return std::nullopt;
        }
        return restricted ? restricted : any;
    }

    /// The end of what lies furthest back in the packet.
    std::size_t furthest_bits() const { return std::max(furthest_, position_); }

    DecodedContents contents;

  private:
    /// The values of a parameter's latest occurrence: several for an aggregate or array.
    struct Latest {
        std::size_t first = 0;
        std::size_t count = 0;
        std::string name;
    };

    bool stop(const std::string& why, unsigned line) {
        contents.problem = why + " (line " + std::to_string(line) + ")";
        return false;
    }

    const DecodedValue* value_of(std::size_t parameter, const std::string& member) const {
        const auto found_latest = latest_.find(parameter);
        if (found_latest == latest_.end()) return nullptr;
        const Latest& latest = found_latest->second;
        const auto values = std::span{contents.values}.subspan(latest.first, latest.count);
        if (member.empty()) return values.size() == 1 ? values.data() : nullptr;
        const auto found = std::ranges::find(values, latest.name + member, &DecodedValue::name);
        return found == values.end() ? nullptr : &*found;
    }

    /// None: one side is not there, is undefined, or cannot be compared with the other.
    std::optional<bool> compare(const xtce::Condition& condition) const {
        const DecodedValue* value = value_of(condition.parameter, condition.member);
        if (value == nullptr) return std::nullopt;
        const bool is_raw_text = std::holds_alternative<std::vector<std::uint8_t>>(value->raw) &&
                                 std::holds_alternative<std::string>(value->calibrated);
        if (!condition.calibrated && !is_raw_text && is_no_number(*value)) return std::nullopt;
        const Datum& datum = condition.calibrated || is_raw_text ? value->calibrated : value->raw;
        const auto wanted = compared_number(condition.value);
        if (const auto* text = std::get_if<std::string>(&datum)) {
            const auto raw = number_of(value->raw);
            // Some files compare a label by its number.
            if (!condition.by_label && *text != condition.value && wanted && raw)
                return compared(*raw, condition.op, *wanted);
            return compared(*text, condition.op, condition.value);
        }
        const auto number = number_of(datum);
        if (!number) return std::nullopt;
        if (condition.by_label) return condition.op == xtce::Condition::Operator::not_equal;  // a number without one
        if (!wanted) return std::nullopt;
        return compared(*number, condition.op, *wanted);
    }
    /// Whether the bits of a number are none, such as a decimal digit above 9.
    bool is_no_number(const DecodedValue& value) const {
        return no_numbers_.contains(static_cast<std::size_t>(&value - contents.values.data()));
    }

    /// The member of that name of the innermost aggregate that is being read and has it.
    const DecodedValue* sibling(const std::string& member) const {
        for (const std::string& aggregate : std::views::reverse(aggregates_)) {
            const std::string name = aggregate + "." + member;
            const auto found = std::ranges::find(std::views::reverse(contents.values), name, &DecodedValue::name);
            if (found != contents.values.rend()) return &*found;
        }
        return nullptr;
    }

    /// A whole number from `least`, of 2^40 at most in size; none when it is unknown, less, or not a number. A
    /// calibrated count is whole within the digits of its coefficients.
    std::optional<std::int64_t> evaluate_from(std::int64_t least, const Amount& amount) const {
        double value = amount.intercept;
        if (!amount.cases.empty()) {
            const auto found = std::ranges::find_if(amount.cases, [&](const auto& each) {
                return judge(each.when).value_or(true);  // behind one that is not known none is
            });
            if (found == amount.cases.end() || !holds(found->when)) return std::nullopt;
            value = found->value;
        } else if (amount.parameter || !amount.sibling.empty()) {
            const DecodedValue* known =
                amount.parameter ? value_of(*amount.parameter, amount.member) : sibling(amount.sibling);
            if (known == nullptr) return std::nullopt;
            const bool labelled = std::holds_alternative<std::string>(known->calibrated);
            const auto number = number_of(amount.calibrated && !labelled ? known->calibrated : known->raw);
            if (!number || is_no_number(*known)) return std::nullopt;
            value = amount.slope * static_cast<double>(*number) + amount.intercept;
        }
        constexpr double most = 1099511627776.0, digits = 1e-9;
        const double whole = std::round(value);
        if (!amount.known || !(std::abs(value - whole) <= digits * std::max(1.0, std::abs(whole))) ||
            whole < static_cast<double>(least) || std::abs(whole) > most)
            return std::nullopt;
        return static_cast<std::int64_t>(whole);
    }
    std::optional<std::size_t> evaluate(const Amount& amount) const {
        const auto value = evaluate_from(0, amount);
        return value ? std::optional{static_cast<std::size_t>(*value)} : std::nullopt;
    }

    /// Goes to the end of a container whose size is told.
    bool end_container(const PacketContainer& container, std::size_t start_bits) {
        const auto bits = evaluate(*container.bits);
        if (!bits) return stop("the size of " + container.name + " cannot be known", container.line);
        if (position_ > start_bits + *bits)
            return stop("the entries of " + container.name + " are longer than its size, " + std::to_string(*bits) +
                            " bits",
                        container.line);
        if (start_bits + *bits > packet_.size() * 8) return cut("the end of " + container.name, *bits, container.line);
        position_ = start_bits + *bits;
        return true;
    }

    bool read_entry(const PacketContainer& container, const PacketEntry& entry, std::size_t start_bits,
                    unsigned depth) {
        if (++steps_ > steps_max) return stop("it has more entries than a packet may", entry.line);
        furthest_ = std::max(furthest_, position_);  // the entry may stand before it
        const std::string where = "an entry of " + container.name;
        const auto included = judge(entry.when);
        if (!included)
            return stop(where + " has a condition that is not understood, or whose value is not known", entry.line);
        if (!*included) return true;
        if (entry.what == PacketEntry::What::around) return stop(where + " holds itself", entry.line);
        if (entry.what == PacketEntry::What::unknown) return stop(where + " is not supported", entry.line);
        const auto offset = evaluate_from(std::numeric_limits<std::int64_t>::min(), entry.offset_bits);
        const auto count = evaluate(entry.count);
        const auto gap = evaluate(entry.gap_bits);
        if (!offset || !count || !gap)
            return stop(where + " has a location or a count that cannot be known", entry.line);
        const bool from_start = entry.from == PacketEntry::From::container_start;
        const std::int64_t position = static_cast<std::int64_t>(from_start ? start_bits : position_) + *offset;
        if (position < 0) return stop(where + " begins before the packet", entry.line);
        position_ = static_cast<std::size_t>(position);
        const bool repeated = entry.count.parameter || !entry.count.cases.empty() || entry.count.intercept != 1.0;
        for (std::size_t i = 0; i < *count; ++i) {
            if (i > 0) position_ += *gap;
            // Entries without size could be repeated for ever.
            if (++steps_ > steps_max) return stop("it repeats more than a packet may", entry.line);
            const std::string suffix = repeated ? "[" + std::to_string(i) + "]" : "";
            if (!read_once(entry, suffix, depth)) return false;
        }
        return true;
    }

    bool read_once(const PacketEntry& entry, const std::string& suffix, unsigned depth) {
        if (entry.what == PacketEntry::What::container)
            return read_container(model_.containers[entry.index], position_, depth + 1);
        const PacketParameter& parameter = model_.parameters[entry.index];
        reading_ = entry.index;
        const std::size_t before = contents.values.size();
        const PacketType& type = model_.types[parameter.type];
        const std::string name = parameter.name + suffix;
        const bool read = type.kind == PacketType::Kind::array && !entry.last_indices.empty()
                              ? read_array(type, entry.last_indices, name, depth + 1)
                              : read_type(type, name, depth + 1);
        const std::size_t count = contents.values.size() - before;
        latest_[entry.index] = {before, count, name};
        const auto valid = judge(parameter.valid);
        if (!valid) note_unread(parameter.line);
        if (!valid.value_or(false))
            for (auto& value : std::span{contents.values}.subspan(before, count)) value.calibrated = {};
        else if (type.kind == PacketType::Kind::time && count == 1)
            note_time(entry.index, type, contents.values.back());
        return read;
    }

    void note_unread(unsigned line) { contents.unread.push_back({reading_, line}); }

    void note_time(std::size_t parameter, const PacketType& type, DecodedValue& value) {
        auto* seconds = std::get_if<double>(&value.calibrated);
        if (seconds == nullptr || type.relative) return;
        if (type.time_since) {
            const DecodedValue* from = value_of(*type.time_since, {});
            const auto from_s = from == nullptr ? std::nullopt : number_of(from->calibrated);
            value.calibrated = from_s ? defined(*seconds + static_cast<double>(*from_s)) : Datum{};
            if (!from_s || !time_from_ || *time_from_ != *type.time_since) return;
            contents.time->seconds = std::get<double>(value.calibrated);
        } else if (!contents.time) {
            contents.time = PacketTime{*seconds, type.epoch};
            time_from_ = parameter;
        }
    }

    bool read_type(const PacketType& type, const std::string& name, unsigned depth) {
        if (depth >= 2 * ContainerDecoder::depth_max) return stop("types are nested too deep", type.line);
        // Types without size could be nested without end.
        if (contents.values.size() >= ContainerDecoder::values_max || ++steps_ > steps_max)
            return stop("there are more values than a packet may have", type.line);
        switch (type.kind) {
        case PacketType::Kind::unknown: return stop("the type of " + name + " is not supported", type.line);
        case PacketType::Kind::aggregate: {
            aggregates_.push_back(name);
            const bool read = std::ranges::all_of(type.members, [&](const auto& member) {
                return read_type(model_.types[member.type], name + "." + member.name, depth + 1);
            });
            aggregates_.pop_back();
            return read;
        }
        case PacketType::Kind::array: return read_array(type, type.last_indices, name, depth + 1);
        default: break;
        }
        if (type.unread) note_unread(type.line);
        if (type.coding.form == Coding::Form::text) return read_text(type, name);
        const auto bits = evaluate(type.coding.bits);
        if (!bits) return stop("the size of " + name + " cannot be known", type.line);
        if (!has(*bits)) return cut(name, *bits, type.line);
        if (type.coding.form == Coding::Form::octets) return read_octets(name, *bits);
        return read_number(type, name, static_cast<unsigned>(*bits));
    }

    bool read_array(const PacketType& type, const std::vector<Amount>& last_indices, const std::string& name,
                    unsigned depth) {
        if (last_indices.empty()) return stop("the dimensions of " + name + " are not known", type.line);
        std::vector<std::size_t> sizes;
        std::size_t elements = 1;
        for (const Amount& last : last_indices) {
            const auto index = evaluate_from(-1, last);  // -1: it is empty
            if (!index) return stop("the dimensions of " + name + " cannot be known", type.line);
            sizes.push_back(static_cast<std::size_t>(*index + 1));
            if (sizes.back() > ContainerDecoder::values_max / std::max<std::size_t>(1, elements))
                return stop("there are more values than a packet may have", type.line);
            elements *= sizes.back();
        }
        for (std::size_t i = 0; i < elements; ++i) {
            std::string indices;
            std::size_t left = i;
            for (auto size = sizes.rbegin(); size != sizes.rend(); left /= *size++)
                indices.insert(0, "[" + std::to_string(left % *size) + "]");
            if (!read_type(model_.types[type.element], name + indices, depth + 1)) return false;
        }
        return true;
    }

    bool has(std::size_t bits) const {
        return position_ <= packet_.size() * 8 && bits <= packet_.size() * 8 - position_;
    }
    bool cut(const std::string& name, std::size_t bits, unsigned line) {
        return stop("the packet ends before " + name + ": " + std::to_string(bits) + " bits at bit " +
                        std::to_string(position_) + " of " + std::to_string(packet_.size() * 8),
                    line);
    }

    std::vector<std::uint8_t> take_octets(std::size_t bits) {
        std::vector<std::uint8_t> octets;
        octets.reserve((bits + 7) / 8);
        for (; bits > 0; position_ += std::min<std::size_t>(bits, 8), bits -= std::min<std::size_t>(bits, 8))
            octets.push_back(static_cast<std::uint8_t>(
                read_bits(packet_, position_, static_cast<unsigned>(std::min<std::size_t>(bits, 8)))));
        return octets;
    }

    bool read_octets(const std::string& name, std::size_t bits) {
        const std::size_t position = position_;
        const Datum octets = take_octets(bits);
        contents.values.push_back({name, octets, octets, position, bits, reading_});
        return true;
    }

    bool read_number(const PacketType& type, const std::string& name, unsigned bits) {
        if (bits == 0 || bits > 64) return stop(name + " is a number of " + std::to_string(bits) + " bits", type.line);
        const std::uint64_t field = read_bits(packet_, position_, bits);
        const std::size_t position = std::exchange(position_, position_ + bits);
        Datum raw = std::visit([](auto value) -> Datum { return value; }, number_in(field, bits, type.coding));
        if (const auto* real = std::get_if<double>(&raw); real != nullptr && !std::isfinite(*real)) {
            no_numbers_.insert(contents.values.size());
            if (type.coding.form == Coding::Form::bcd || type.coding.form == Coding::Form::bcd_octets)
                note_unread(type.line);
            contents.values.push_back({name, field, {}, position, bits, reading_});
            return true;
        }
        Datum calibrated = calibrated_value(type, raw);
        contents.values.push_back({name, std::move(raw), std::move(calibrated), position, bits, reading_});
        return true;
    }

    Datum calibrated_value(const PacketType& type, const Datum& raw) {
        const long double number = number_of(raw).value_or(0);
        if (type.kind == PacketType::Kind::boolean) return number == 0 ? type.zero : type.one;
        if (type.kind == PacketType::Kind::enumerated) {
            const auto found = std::ranges::find_if(
                type.labels, [&](const auto& label) { return number >= label.first && number <= label.last; });
            return found == type.labels.end() ? raw : Datum{found->label};
        }
        const auto context = std::ranges::find_if(type.coding.contexts,
                                                  [&](const auto& each) { return judge(each.when).value_or(true); });
        const bool one_is_known = context == type.coding.contexts.end() || holds(context->when);
        const Calibration& calibration =
            context == type.coding.contexts.end() ? type.coding.calibration : context->calibration;
        if (!one_is_known || !calibration.known) {
            if (!type.unread) note_unread(type.line);
            return {};
        }
        Datum value = raw;
        if (!calibration.empty()) {
            const auto calibrated = calibrated_by(calibration, static_cast<double>(number));
            value = calibrated ? Datum{*calibrated} : Datum{};
        }
        if (type.kind != PacketType::Kind::time) return value;
        const auto time = number_of(value);
        return time ? defined(type.time_offset_s + type.time_scale_s * static_cast<double>(*time)) : Datum{};
    }

    bool read_text(const PacketType& type, const std::string& name) {
        const Coding& coding = type.coding;
        auto bits = evaluate(coding.bits);
        if (!bits) return stop("the size of " + name + " cannot be known", type.line);
        if (coding.most_bits > 0.0 && static_cast<double>(*bits) > coding.most_bits)
            return stop(name + " is longer than its maxSizeInBits", type.line);
        if (coding.boxed && !has(*bits)) return cut(name, *bits, type.line);
        const std::size_t begin = position_;
        const std::size_t end = position_ + *bits;
        std::size_t terminator_bits = 0;
        if (coding.leading_size_bits > 0) {
            if (!has(coding.leading_size_bits)) return cut(name, coding.leading_size_bits, type.line);
            const std::uint64_t units = read_bits(packet_, position_, coding.leading_size_bits);
            position_ += coding.leading_size_bits;
            const std::uint64_t size = units > *bits ? units : units * coding.leading_size_unit_bits;
            // In a box stands the leading size, too.
            const std::size_t room =
                *bits - (coding.boxed ? std::min<std::size_t>(*bits, coding.leading_size_bits) : 0);
            if (size > room || !has(size)) return cut(name, size, type.line);
            bits = size;
        } else if (!coding.terminator.empty()) {
            const auto step = static_cast<unsigned>(8 * coding.terminator.size());
            std::uint64_t terminator = 0;
            for (const std::uint8_t octet : coding.terminator) terminator = terminator << 8 | octet;
            std::size_t length = 0;
            while (length + step <= *bits && has(length + step) &&
                   read_bits(packet_, position_ + length, step) != terminator)
                length += step;
            const bool ends = length + step <= *bits && has(length + step);
            if (!ends && !coding.boxed && length + step <= *bits)
                return stop("the packet ends before the end of " + name, type.line);
            bits = length;
            terminator_bits = ends ? step : 0;
        }
        if (!has(*bits)) return cut(name, *bits, type.line);
        auto octets = take_octets(*bits);
        position_ = coding.boxed ? end : position_ + terminator_bits;
        auto text = type.kind == PacketType::Kind::octets ? std::nullopt : text_of(octets, coding.characters);
        if (!text && type.kind != PacketType::Kind::octets) note_unread(type.line);
        Datum shown = text ? Datum{std::move(*text)} : type.kind == PacketType::Kind::octets ? Datum{octets} : Datum{};
        contents.values.push_back({name, std::move(octets), std::move(shown), begin, position_ - begin, reading_});
        return true;
    }

    const PacketModel& model_;
    std::span<const std::uint8_t> packet_;
    std::unordered_map<std::size_t, Latest>
        latest_;                                  ///< by parameter; only those in the packet, as a model has thousands
    std::unordered_set<std::size_t> no_numbers_;  ///< values whose bits are no number, in contents.values
    std::size_t position_ = 0, furthest_ = 0;
    std::size_t steps_ = 0;
    std::vector<std::string> aggregates_;   ///< being read, outermost first
    std::size_t reading_ = 0;               ///< the parameter
    std::optional<std::size_t> time_from_;  ///< the parameter that gave contents.time
};

bool is_named(std::string_view name, std::string_view part) {
    const auto same = [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; };
    return !std::ranges::search(name, part, same).empty();
}

/// Recognises a clock by names alone, as in files of instruments that leave time to the reader.
std::optional<PacketTime> coarse_and_fine(const std::vector<DecodedValue>& values) {
    const auto coarse = std::ranges::find(values, primary_header_octets * 8, &DecodedValue::position_bits);
    if (coarse == values.end() || std::next(coarse) == values.end()) return std::nullopt;
    const auto fine = std::next(coarse);
    const auto* counts = std::get_if<std::uint64_t>(&coarse->raw);
    const auto* fraction = std::get_if<std::uint64_t>(&fine->raw);
    if (counts == nullptr || fraction == nullptr ||
        !are_coarse_and_fine({coarse->name, coarse->position_bits, coarse->bits},
                             {fine->name, fine->position_bits, fine->bits}))
        return std::nullopt;
    return PacketTime{
        static_cast<double>(*counts) + std::ldexp(static_cast<double>(*fraction), -static_cast<int>(fine->bits)), {}};
}

}  // namespace

bool are_coarse_and_fine(const NamedPlace& coarse, const NamedPlace& fine) {
    constexpr std::size_t coarse_bits_max = 32, fine_bits_max = 24;  // [ccsds-301.0-b-4], without its extension
    return coarse.bits <= coarse_bits_max && fine.bits <= fine_bits_max &&
           fine.position_bits == coarse.position_bits + coarse.bits && is_named(coarse.name, "coarse") &&
           is_named(fine.name, "fine");
}

bool is_end_of_packet(std::span<const std::uint8_t> packet, std::size_t entries_end_bits) {
    const std::size_t behind_bits = packet.size() * 8 - std::min(packet.size() * 8, entries_end_bits);
    const auto padding_bits = static_cast<unsigned>(behind_bits % 8);
    if (padding_bits != 0 && read_bits(packet, entries_end_bits, padding_bits) != 0) return false;
    return behind_bits < 8 || (behind_bits / 8 == packet_crc_octets && crc16(packet) == 0);
}

std::string datum_text(const Datum& datum) {
    if (const auto* value = std::get_if<std::uint64_t>(&datum)) return std::to_string(*value);
    if (const auto* value = std::get_if<std::int64_t>(&datum)) return std::to_string(*value);
    if (const auto* value = std::get_if<std::string>(&datum)) return *value;
    if (const auto* value = std::get_if<double>(&datum)) {
        std::array<char, 32> text{};
        const auto end = std::to_chars(text.data(), text.data() + text.size(), *value);
        return {text.data(), end.ptr};
    }
    if (const auto* value = std::get_if<std::vector<std::uint8_t>>(&datum)) {
        constexpr const char* digits = "0123456789abcdef";
        std::string text;
        text.reserve(value->size() * 2);
        for (const std::uint8_t octet : *value) {
            text += digits[octet >> 4];
            text += digits[octet & 15];
        }
        return text;
    }
    return "undefined";
}

std::vector<std::size_t> ContainerDecoder::roots_of(const PacketModel& model) {
    std::vector<bool> part_of_other(model.containers.size(), false);
    for (const PacketContainer& container : model.containers)
        for (const PacketEntry& entry : container.entries)
            if (entry.what == PacketEntry::What::container || entry.what == PacketEntry::What::around)
                part_of_other[entry.index] = true;
    std::vector<std::size_t> roots;
    for (std::size_t i = 0; i < model.containers.size(); ++i) {
        const PacketContainer& container = model.containers[i];
        const bool has_base = container.base || container.when.form != xtce::Condition::Form::always;
        if (!has_base && !part_of_other[i]) roots.push_back(i);
    }
    return roots;
}

Result<std::size_t> ContainerDecoder::root_of(const PacketModel& model, const std::string& name) {
    const auto roots = roots_of(model);
    if (roots.empty()) return Error{"the XTCE file has no container to begin with"};
    if (name.empty() && roots.size() == 1) return roots.front();
    std::string names;
    std::vector<std::size_t> named;
    for (const std::size_t root : roots) {
        const PacketContainer& container = model.containers[root];
        if (!name.empty() && container.path == name) return root;
        if (container.name == name) named.push_back(root);
        names += (names.empty() ? "" : ", ") + container.path;
    }
    if (named.size() == 1) return named.front();
    if (!named.empty()) return Error{"several containers are called '" + name + "': say which of " + names};
    if (!name.empty()) return Error{"no packet begins with a container '" + name + "'; those that can are " + names};
    return Error{"several containers of the XTCE file have no base: say with which one packets begin: " + names};
}

ContainerDecoder::ContainerDecoder(const PacketModel& model)
    : model_(model), root_(model.root), derived_(model.containers.size()) {
    if (const auto only = root_of(model, {}); !root_ && only) root_ = *only;
    for (std::size_t i = 0; i < model.containers.size(); ++i)
        if (model.containers[i].base) derived_[*model.containers[i].base].push_back(i);
}

DecodedContents ContainerDecoder::decode(std::span<const std::uint8_t> packet) const {
    if (!root_) {
        DecodedContents none;
        none.problem = root_of(model_, {}).error().message;
        return none;
    }
    Reading reading{model_, packet};
    std::size_t at = *root_;
    bool readable = reading.read_container(model_.containers[at], 0, 0);
    while (readable) {
        const auto next = reading.next_of(derived_[at]);
        if (!next) break;
        at = *next;
        readable = reading.read_container(model_.containers[at], 0, 0);
    }
    const PacketContainer& last = model_.containers[at];
    auto contents = std::move(reading.contents);
    contents.container = last.name;
    contents.container_index = at;
    if (!contents.time) contents.time = coarse_and_fine(contents.values);
    if (readable && contents.problem.empty() && last.abstract)
        contents.problem = "no container describes it: " + last.name + " is abstract";
    const std::size_t behind_bits = packet.size() * 8 - std::min(packet.size() * 8, reading.furthest_bits());
    if (contents.problem.empty() && behind_bits > 0 && !is_end_of_packet(packet, reading.furthest_bits()))
        contents.problem = std::to_string(behind_bits) + " bits are behind the last entry of " + last.name + " (line " +
                           std::to_string(last.line) + ")";
    return contents;
}

}  // namespace aeolis::telemetry
