// SPDX-License-Identifier: Apache-2.0
#include "telemetry/container_plan.hpp"

#include "common/bytes.hpp"
#include "common/space_packet.hpp"
#include "dictionaries/xtce/characters.hpp"
#include "telemetry/container_decoder.hpp"
#include "telemetry/raw_number.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace aeolis::telemetry {
namespace {

using namespace dictionary::xtce;
namespace xtce = dictionary::xtce;

constexpr double latest_s = 1e12;           // OtherMission takes none beyond
constexpr std::size_t loop_steps_max = 18;  // that ContainerDecoder counts for a value, at most

double as_double(const RawNumber& number) {
    return std::visit([](auto value) { return static_cast<double>(value); }, number);
}

bool meets(double left, xtce::Condition::Operator op, double right) {
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

std::optional<double> finite(double value) {
    return std::isfinite(value) ? std::optional{value} : std::nullopt;
}

/// A whole number from octets, the most significant first.
template <unsigned count>
std::uint64_t big_endian(const std::uint8_t* at) {
    if constexpr (count == 8) {
        return big_endian<4>(at) << 32U | big_endian<4>(at + 4);
    } else if constexpr (count == 4) {
        return std::uint64_t{at[0]} << 24U | std::uint64_t{at[1]} << 16U | std::uint64_t{at[2]} << 8U | at[3];
    } else {
        static_assert(count == 2);
        return std::uint64_t{at[0]} << 8U | at[1];
    }
}

std::string exact_text(const RawNumber& number) {
    if (const auto* value = std::get_if<std::uint64_t>(&number)) return std::to_string(*value);
    return std::to_string(std::get<std::int64_t>(number));
}

}  // namespace

std::size_t ContainerPlan::compiled() const {
    return static_cast<std::size_t>(
        std::ranges::count_if(nodes_, [](const Node& node) { return node.compiled && !node.abstract; }));
}

namespace {

/// As read_bits(), in fewer steps where eight octets are there to be read at once.
std::uint64_t bits_at(std::span<const std::uint8_t> packet, std::size_t position_bits, unsigned bits) {
    const auto before = static_cast<unsigned>(position_bits % 8);
    const std::size_t octet = position_bits / 8;
    if (octet + 8 > packet.size() || before + bits > 64) return read_bits(packet, position_bits, bits);
    return big_endian<8>(packet.data() + octet) << before >> (64 - bits);
}

}  // namespace

double ContainerPlan::value_of(const Operand& operand, std::span<const std::uint8_t> packet, const double* kept) {
    constexpr double undefined = std::numeric_limits<double>::quiet_NaN();
    double number = undefined;
    if (operand.kept != none) {
        number = kept[operand.kept];
    } else {
        const std::uint64_t field = bits_at(packet, operand.position_bits, operand.bits);
        if (operand.plain) return static_cast<double>(field);
        number = as_double(number_in(field, operand.bits, *operand.coding));
    }
    if (operand.calibration == nullptr || !std::isfinite(number)) return number;
    return calibrated_by(*operand.calibration, number).value_or(undefined);
}

std::optional<bool> ContainerPlan::judge(const Test& test, std::span<const std::uint8_t> packet, const double* kept) {
    if (test.form == xtce::Condition::Form::compare) {
        const double number = value_of(test.of, packet, kept);
        return std::isfinite(number) ? std::optional{meets(number, test.op, test.wanted)} : std::nullopt;
    }
    const bool decisive = test.form == xtce::Condition::Form::any;  // of one part
    std::optional<bool> result = !decisive;
    for (const Test& part : test.parts) {
        const auto one = judge(part, packet, kept);
        if (one == decisive) return decisive;
        if (!one) result.reset();
    }
    return result;
}

bool ContainerPlan::holds(std::uint32_t test, const Run& run) const {
    return judge(tests_[test], run.packet, run.kept.data()).value_or(false);
}

std::optional<std::int64_t> ContainerPlan::evaluate(std::uint32_t size, const Run& run, bool signed_one) const {
    const Size& known = sizes_[size];
    double value = known.intercept;
    if (!known.cases.empty()) {
        const auto found = std::ranges::find_if(known.cases, [&](const auto& each) {
            return judge(each.first, run.packet, run.kept.data()).value_or(true);  // behind an unknown one none is
        });
        if (found == known.cases.end() || !judge(found->first, run.packet, run.kept.data())) return std::nullopt;
        value = found->second;
    } else if (known.of) {
        value = known.slope * value_of(*known.of, run.packet, run.kept.data()) + known.intercept;
    }
    constexpr double most = 1099511627776.0, digits = 1e-9;  // as ContainerDecoder has them
    if (!(std::abs(value) <= most)) return std::nullopt;
    auto whole = static_cast<std::int64_t>(value);
    if (static_cast<double>(whole) != value) {
        const double rounded = std::round(value);
        if (!(std::abs(value - rounded) <= digits * std::max(1.0, std::abs(rounded)))) return std::nullopt;
        whole = static_cast<std::int64_t>(rounded);
    }
    whole += known.more;
    return whole >= 0 || signed_one ? std::optional{whole} : std::nullopt;
}

bool ContainerPlan::next_of(const Node& node, std::span<const std::uint8_t> packet, const Node*& next) const {
    const Node *restricted = nullptr, *any = nullptr;
    const auto take = [&](const Node& derived) {
        const Node*& found = derived.tests.empty() ? any : restricted;
        const bool first = found == nullptr;
        found = &derived;
        return first;
    };
    // False: several are, or whether it is one is not known.
    const auto is_one = [&](std::size_t index) {
        const Node& derived = nodes_[index];
        bool known = true;
        for (const Test& test : derived.tests) {
            const auto holds = judge(test, packet, nullptr);
            if (holds == false) return true;
            known = known && holds;
        }
        return known && take(derived);
    };
    bool one = true;
    if (const auto& choice = node.choice) {
        const std::uint64_t field = bits_at(packet, choice->position_bits, choice->bits);
        auto each = choice->each.begin();
        if (choice->first.empty())
            each = std::ranges::lower_bound(choice->each, field, {}, &Choice::Each::wanted);
        else
            each += field < choice->first.size() ? choice->first[field] : std::ssize(choice->each);
        for (; one && each != choice->each.end() && each->wanted == field; ++each)
            one = each->alone ? take(nodes_[each->container]) : is_one(each->container);
    } else {
        one = std::ranges::all_of(node.derived, is_one);
    }
    next = restricted != nullptr ? restricted : any;
    return one;
}

std::optional<ContainerPlan::Reached> ContainerPlan::reach(std::span<const std::uint8_t> packet) const {
    const Node* node = root_ ? &nodes_[*root_] : nullptr;
    while (node != nullptr && node->compiled) {
        const auto reached = [&](bool cut) {
            return Reached{static_cast<std::size_t>(node - nodes_.data()), node->abstract, cut};
        };
        if (node->bits > packet.size() * 8) return reached(true);
        const Node* next = nullptr;
        if (!next_of(*node, packet, next)) return std::nullopt;
        if (next == nullptr) return reached(false);
        node = next;
    }
    return std::nullopt;
}

namespace {

/// A number, and what Decoded::raw says of it.
struct Loaded {
    double number = 0.0;
    std::uint64_t raw = 0;
};
Loaded whole(std::uint64_t number) {
    return {static_cast<double>(number), number};
}
template <typename Signed>
Loaded signed_whole(std::uint64_t bits) {
    return {static_cast<double>(static_cast<Signed>(bits)), bits};
}

}  // namespace

/// Reads numbers of one kind, one after another, into fields that follow one another.
template <typename LoadOne>
void ContainerPlan::read_each(const Step& step, const Calibrator& calibrator, std::size_t times, const Into& into,
                              LoadOne load) {
    const std::size_t first = step.field + into.shift;
    const auto each = [&](auto calibrated) {
        for (std::size_t i = 0; i < times; ++i) {
            const Loaded one = load(i);
            into.raw[first + i] = one.raw;
            into.value[first + i] = std::isfinite(one.number) ? calibrated(one.number) : std::nullopt;
        }
    };
    if (calibrator.calibration == nullptr)
        each([](double number) { return std::optional{number}; });
    else if (calibrator.line != nullptr)
        each([line = calibrator.line](double number) { return finite(line[1] * number + line[0]); });
    else
        each([&](double number) { return calibrated_by(*calibrator.calibration, number); });
}

void ContainerPlan::read_step(const Step& step, const Calibrator& calibrator, std::span<const std::uint8_t> packet,
                              std::size_t position_bits, std::size_t times, const Into& into) {
    const std::uint8_t* const at = packet.data() + position_bits / 8;
    const auto each = [&](auto load) { read_each(step, calibrator, times, into, load); };
    switch (position_bits % 8 == 0 ? step.load : step.unaligned) {
    case Load::u8: return each([at](std::size_t i) { return whole(at[i]); });
    case Load::u16: return each([at](std::size_t i) { return whole(big_endian<2>(at + 2 * i)); });
    case Load::u32: return each([at](std::size_t i) { return whole(big_endian<4>(at + 4 * i)); });
    case Load::u64: return each([at](std::size_t i) { return whole(big_endian<8>(at + 8 * i)); });
    case Load::i8: return each([at](std::size_t i) { return signed_whole<std::int8_t>(at[i]); });
    case Load::i16: return each([at](std::size_t i) { return signed_whole<std::int16_t>(big_endian<2>(at + 2 * i)); });
    case Load::i32: return each([at](std::size_t i) { return signed_whole<std::int32_t>(big_endian<4>(at + 4 * i)); });
    case Load::i64: return each([at](std::size_t i) { return signed_whole<std::int64_t>(big_endian<8>(at + 8 * i)); });
    case Load::f32:
        return each([at](std::size_t i) {
            const auto bits = static_cast<std::uint32_t>(big_endian<4>(at + 4 * i));
            return Loaded{static_cast<double>(std::bit_cast<float>(bits)), bits};
        });
    case Load::f64:
        return each([at](std::size_t i) {
            const auto bits = big_endian<8>(at + 8 * i);
            return Loaded{std::bit_cast<double>(bits), bits};
        });
    case Load::bits:
        return each([&](std::size_t i) { return whole(bits_at(packet, position_bits + i * step.bits, step.bits)); });
    case Load::any: break;
    }
    each([&](std::size_t i) {
        const std::uint64_t bits = read_bits(packet, position_bits + i * step.bits, step.bits);
        const RawNumber number = number_in(bits, step.bits, *step.coding);
        const double value = as_double(number);
        if (!std::isfinite(value)) return Loaded{value, bits};
        if (step.text && into.texts != nullptr)
            into.texts->emplace_back(step.field + into.shift + i, exact_text(number));
        const auto* raw = std::get_if<std::uint64_t>(&number);
        return Loaded{value, raw != nullptr ? *raw : bits};
    });
}

const ContainerPlan::Calibrator* ContainerPlan::calibrator_of(const Step& step, const Run& run) const {
    if (step.contexts == none) return &step.calibrator;
    for (const auto& [test, calibrator] : contexts_[step.contexts]) {
        const auto holds = judge(test, run.packet, run.kept.data());
        if (!holds) return nullptr;  // behind one that is not known none is
        if (*holds) return &calibrator;
    }
    return &step.calibrator;
}

inline void ContainerPlan::give(const Step& step, std::size_t position_bits, std::size_t times, Run& run) const {
    if (step.valid == none && step.contexts == none && step.time == none)
        read_step(step, step.calibrator, run.packet, position_bits, times, run.into);
    else
        give_decided(step, position_bits, times, run);
}

void ContainerPlan::give_decided(const Step& step, std::size_t position_bits, std::size_t times, Run& run) const {
    const Calibrator* calibrator = calibrator_of(step, run);
    const bool defined = calibrator != nullptr && (step.valid == none || holds(step.valid, run));
    Into into = run.into;
    if (!defined) into.texts = nullptr;
    read_step(step, defined ? *calibrator : Calibrator{}, run.packet, position_bits, times, into);
    if (!defined)
        std::fill_n(into.value + step.field + into.shift, times, std::nullopt);
    else if (step.time != none)
        give_times(step, times, run);
}

/// Makes counts seconds.
void ContainerPlan::give_times(const Step& step, std::size_t times, Run& run) const {
    const TimeScale& scale = times_[step.time];
    for (auto& value : std::span{run.into.value + step.field + run.into.shift, times}) {
        if (value) value = finite(scale.offset_s + scale.scale_s * *value);
        if (value && scale.absolute && !run.time_s) run.time_s = value;
    }
}

bool ContainerPlan::read_numbers(const Step& step, std::size_t count, std::size_t fields, Run& run) const {
    const std::size_t bits = count * step.bits;
    if (bits > run.bits() - run.at) return false;
    if (!step.skipped && run.into.fields) give(step, run.at, fields, run);
    if (step.kept < kept_max) {
        const Operand here{
            .position_bits = static_cast<std::uint32_t>(run.at), .bits = step.bits, .coding = step.coding};
        run.kept[step.kept] = value_of(here, run.packet, nullptr);
    }
    run.at += bits;
    return true;
}

bool ContainerPlan::read_list(const Step& step, Run& run) const {
    const auto count = evaluate(step.index, run);
    if (!count || static_cast<std::size_t>(*count) > run.values_left) return false;
    const auto all = static_cast<std::size_t>(*count);
    run.values_left -= all;
    return read_numbers(step, all, std::min<std::size_t>(all, step.times), run);
}

bool ContainerPlan::pass_octets(const Step& step, Run& run) const {
    const auto bits = evaluate(step.index, run);
    if (!bits || static_cast<std::size_t>(*bits) > run.bits() - run.at) return false;
    run.at += static_cast<std::size_t>(*bits);
    return true;
}

bool ContainerPlan::move(const Step& step, Run& run) const {
    const auto bits = evaluate(step.index, run, true);
    const std::int64_t position = bits ? static_cast<std::int64_t>(run.at) + *bits : -1;
    if (position < 0) return false;
    run.at = static_cast<std::size_t>(position);
    return run.at <= run.bits();
}

bool ContainerPlan::repeat(const Step& step, std::span<const Step> steps, Run& run) const {
    const auto count = evaluate(step.index, run);
    const std::size_t values_most = run.values_left / loop_steps_max;
    if (!count || static_cast<std::size_t>(*count) > values_most / steps.size()) return false;
    run.values_left -= static_cast<std::size_t>(*count) * steps.size() * loop_steps_max;
    const Into before = run.into;
    bool read = true;
    for (std::size_t i = 0; read && i < static_cast<std::size_t>(*count); ++i) {
        run.into.fields = before.fields && i < step.known;
        read = run_steps(steps, run);
        run.into.shift += step.field;
    }
    run.into = before;
    return read;
}

namespace {

struct TextPlace {
    std::size_t text_bits = 0, behind_bits = 0;  ///< behind: the terminator
};

/// The size of a text that ends at a character: none where the packet ends before. `most_bits` from `at_bits` at most.
std::optional<TextPlace> ended_text(const Coding& coding, std::span<const std::uint8_t> packet, std::size_t at_bits,
                                    std::size_t most_bits) {
    const auto step = static_cast<unsigned>(8 * coding.terminator.size());
    const std::size_t steps = std::min(most_bits, packet.size() * 8 - at_bits) / step;
    std::size_t found = 0;
    if (step == 8 && at_bits % 8 == 0) {
        const auto octets = packet.subspan(at_bits / 8, steps);
        found = static_cast<std::size_t>(std::ranges::find(octets, coding.terminator[0]) - octets.begin());
    } else {
        std::uint64_t terminator = 0;
        for (const std::uint8_t octet : coding.terminator) terminator = terminator << 8U | octet;
        while (found < steps && read_bits(packet, at_bits + found * step, step) != terminator) ++found;
    }
    const bool ends = found < steps;
    if (!ends && !coding.boxed && found * step + step <= most_bits) return std::nullopt;
    return TextPlace{found * step, ends ? step : 0};
}

/// As the leading size says; none where the text or its size is not all in the packet, or in its box.
std::optional<std::size_t> led_text_bits(const Coding& coding, std::span<const std::uint8_t> packet,
                                         std::size_t at_bits, std::size_t most_bits) {
    const std::size_t left_bits = packet.size() * 8 - at_bits;
    if (coding.leading_size_bits > left_bits) return std::nullopt;
    const std::uint64_t units = read_bits(packet, at_bits, coding.leading_size_bits);
    const std::uint64_t size = units > most_bits ? units : units * coding.leading_size_unit_bits;
    // In a box stands the leading size, too.
    const std::size_t room =
        most_bits - (coding.boxed ? std::min<std::size_t>(most_bits, coding.leading_size_bits) : 0);
    if (size > room || size > left_bits - coding.leading_size_bits) return std::nullopt;
    return size;
}

std::optional<std::string> text_at(const Coding& coding, std::span<const std::uint8_t> packet, std::size_t at_bits,
                                   std::size_t bits) {
    if (at_bits % 8 == 0 && bits % 8 == 0) return text_of(packet.subspan(at_bits / 8, bits / 8), coding.characters);
    std::vector<std::uint8_t> octets;
    for (std::size_t done = 0; done < bits; done += 8) {
        const auto some = static_cast<unsigned>(std::min<std::size_t>(8, bits - done));
        octets.push_back(static_cast<std::uint8_t>(read_bits(packet, at_bits + done, some)));
    }
    return text_of(octets, coding.characters);
}

}  // namespace

bool ContainerPlan::read_text(const Step& step, Run& run) const {
    const Coding& coding = *step.coding;
    const auto most = evaluate(step.index, run);
    const std::size_t begin = run.at;
    if (!most || (coding.most_bits > 0.0 && static_cast<double>(*most) > coding.most_bits) ||
        (coding.boxed && static_cast<std::size_t>(*most) > run.bits() - begin))
        return false;
    const auto most_bits = static_cast<std::size_t>(*most);
    TextPlace place{most_bits, 0};
    if (coding.leading_size_bits > 0) {
        const auto bits = led_text_bits(coding, run.packet, begin, most_bits);
        if (!bits) return false;
        place.text_bits = *bits;
    } else if (!coding.terminator.empty()) {
        const auto found = ended_text(coding, run.packet, begin, most_bits);
        if (!found) return false;
        place = *found;
    }
    const std::size_t text = begin + coding.leading_size_bits;
    if (place.text_bits > run.bits() - text) return false;
    run.at = coding.boxed ? begin + most_bits : text + place.text_bits + place.behind_bits;
    if (!step.skipped && run.into.fields) give_text(step, begin, text, place.text_bits, run);
    return true;
}

void ContainerPlan::give_text(const Step& step, std::size_t begin_bits, std::size_t text_bits, std::size_t size_bits,
                              const Run& run) const {
    const std::size_t field = step.field + run.into.shift;
    const std::size_t all_bits = run.at - begin_bits;
    const bool as_number = all_bits > 0 && all_bits <= 64;
    run.into.raw[field] = as_number ? read_bits(run.packet, begin_bits, static_cast<unsigned>(all_bits)) : 0;
    run.into.value[field] = std::nullopt;
    if (step.valid != none && !holds(step.valid, run)) return;
    if (auto text = text_at(*step.coding, run.packet, text_bits, size_bits))
        run.into.texts->emplace_back(field, std::move(*text));
}

bool ContainerPlan::run_steps(std::span<const Step> steps, Run& run) const {
    for (std::size_t i = 0; i < steps.size(); ++i) {
        const Step& step = steps[i];
        const std::int64_t position = step.position_bits + (step.moves ? static_cast<std::int64_t>(run.at) : 0);
        if (position < 0 || position > static_cast<std::int64_t>(run.bits())) return false;
        run.at = static_cast<std::size_t>(position);
        bool read = true;
        switch (step.op) {
        case Op::numbers: read = read_numbers(step, step.times, step.times, run); break;
        case Op::list: read = read_list(step, run); break;
        case Op::text: read = read_text(step, run); break;
        case Op::octets: read = pass_octets(step, run); break;
        case Op::move: read = move(step, run); break;
        case Op::when: {
            const auto included = judge(tests_[step.index], run.packet, run.kept.data());
            read = included.has_value();
            if (included == false) i += step.times;
            break;
        }
        case Op::loop:
            read = repeat(step, steps.subspan(i + 1, step.times), run);
            i += step.times;
            break;
        }
        if (!read) return false;
        run.end_bits = std::max(run.end_bits, run.at);
    }
    return true;
}

bool ContainerPlan::run_node(const Node& node, std::span<const std::uint8_t> packet, dictionary::Decoded& into,
                             Run& run) const {
    into.raw.resize(node.fields);
    into.value.resize(node.fields);
    if (!node.fills) {
        std::ranges::fill(into.raw, 0);
        std::ranges::fill(into.value, std::nullopt);
    }
    into.texts.clear();
    into.problem.clear();
    run.packet = packet;
    run.into = {into.raw.data(), into.value.data(), &into.texts};
    run.end_bits = node.bits;
    if (node.keeps) run.kept.fill(std::numeric_limits<double>::quiet_NaN());
    if (!node.fixed) return run_steps(node.steps, run);
    for (const Step& step : node.steps) give(step, static_cast<std::size_t>(step.position_bits), step.times, run);
    return true;
}

std::optional<std::size_t> ContainerPlan::read(std::size_t container, std::span<const std::uint8_t> packet,
                                               dictionary::Decoded& into) const {
    Run run;
    return run_node(nodes_[container], packet, into, run) ? std::optional{run.end_bits} : std::nullopt;
}

bool ContainerPlan::decode(std::span<const std::uint8_t> packet, dictionary::Decoded& into) const {
    const auto reached = reach(packet);
    if (!reached || reached->abstract || reached->cut) return false;
    const Node& node = nodes_[reached->container];
    Run run;
    if (!run_node(node, packet, into, run)) return false;
    if (run.bits() != run.end_bits && !is_end_of_packet(packet, run.end_bits)) return false;
    if (!run.time_s && node.clock) {
        const auto& [fine_bit, coarse_bits, fine_bits] = *node.clock;
        run.time_s = static_cast<double>(bits_at(packet, primary_header_octets * 8, coarse_bits)) +
                     static_cast<double>(bits_at(packet, fine_bit, fine_bits)) /
                         static_cast<double>(std::uint64_t{1} << fine_bits);
    }
    if (run.time_s && std::abs(*run.time_s) > latest_s) return false;
    into.packet = reached->container;
    into.timed = run.time_s.has_value();
    into.header.time = Sclk{run.time_s.value_or(0.0)};
    return true;
}

}  // namespace aeolis::telemetry
