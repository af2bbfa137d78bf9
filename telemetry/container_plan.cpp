// SPDX-License-Identifier: Apache-2.0
#include "telemetry/container_plan.hpp"

#include "common/bytes.hpp"
#include "common/space_packet.hpp"
#include "dictionaries/words.hpp"
#include "telemetry/container_decoder.hpp"
#include "telemetry/raw_number.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>

namespace aeolis::telemetry {
namespace {

using namespace dictionary::xtce;
namespace xtce = dictionary::xtce;

constexpr unsigned depth_max = 16;                  // as ContainerDecoder has it
constexpr std::size_t packet_bits_max = 8 * 65542;  // the longest space packet
constexpr double repetitions_max = packet_bits_max;
constexpr double exact_max = 9007199254740992.0;  // whole numbers up to here are exact as doubles

std::optional<std::int64_t> fixed_offset(const Amount& amount) {
    const double value = amount.intercept;
    if (!amount.is_fixed() || !(std::abs(value) <= packet_bits_max) || value != std::floor(value)) return std::nullopt;
    return static_cast<std::int64_t>(value);
}

std::optional<std::uint32_t> fixed_bits(const Amount& amount) {
    const double value = amount.intercept;
    if (!amount.is_fixed() || !(value >= 0.0) || value > packet_bits_max || value != std::floor(value))
        return std::nullopt;
    return static_cast<std::uint32_t>(value);
}

bool is_number(const PacketType& type) {
    const bool kind = type.kind == PacketType::Kind::integer || type.kind == PacketType::Kind::real ||
                      type.kind == PacketType::Kind::enumerated || type.kind == PacketType::Kind::boolean;
    const auto form = type.coding.form;
    if (type.kind != PacketType::Kind::real && (form == Coding::Form::ieee754 || form == Coding::Form::mil1750a))
        return false;
    return kind && type.coding.form != Coding::Form::text && type.coding.form != Coding::Form::octets &&
           type.coding.contexts.empty();
}

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

/// The value with which a type's number is compared; none: not as a whole number.
std::optional<std::int64_t> compared_whole(const PacketType& type, const xtce::Condition& when) {
    const bool labelled = type.kind == PacketType::Kind::enumerated || type.kind == PacketType::Kind::boolean;
    if (type.coding.form == Coding::Form::bcd) return std::nullopt;  // its bits may be no number
    const bool plain = type.kind == PacketType::Kind::integer && type.coding.calibration.empty();
    // A label that reads as a number would be compared as text.
    const bool is_label = type.zero == when.value || type.one == when.value ||
                          std::ranges::find(type.labels, when.value, &PacketType::Label::label) != type.labels.end();
    if (!plain && !(labelled && (!when.calibrated || !is_label))) return std::nullopt;
    const auto wanted = dictionary::to_integer(when.value);
    if (!wanted || std::abs(static_cast<double>(*wanted)) > exact_max) return std::nullopt;
    return wanted;
}

/// A whole number from octets, the most significant first.
template <unsigned count>
std::uint64_t big_endian(const std::uint8_t* at) {
    std::uint64_t value = 0;
    for (unsigned i = 0; i < count; ++i) value = value << 8U | at[i];
    return value;
}

std::string exact_text(const RawNumber& number) {
    if (const auto* value = std::get_if<std::uint64_t>(&number)) return std::to_string(*value);
    return std::to_string(std::get<std::int64_t>(number));
}

}  // namespace

/// Compiles containers from the root downwards.
class ContainerPlan::Compiler {
  public:
    Compiler(ContainerPlan& plan, const PacketModel& model, const std::vector<std::size_t>& fields,
             const FieldOf& field_of, const std::function<bool(std::size_t, std::size_t)>& needs_text)
        : plan_(plan), model_(model), fields_(fields), field_of_(field_of), needs_text_(needs_text) {}

    void compile(std::size_t root) {
        plan_.nodes_.resize(model_.containers.size());
        for (std::size_t i = 0; i < model_.containers.size(); ++i)
            if (const auto& base = model_.containers[i].base) plan_.nodes_[*base].derived.push_back(i);
        compile_from(root, {}, 0);
    }

  private:
    /// A number, at a fixed place or behind a repetition.
    struct Place {
        std::size_t parameter = 0;
        std::string name;
        std::uint32_t position_bits = 0, bits = 0;
        const PacketType* type = nullptr;
        bool moves = false;
        const Amount* repeated = nullptr;
        const xtce::Condition* valid = nullptr;  ///< null: always
    };
    /// The numbers of a container and its bases, in the order of the packet. Behind a repetition, positions count from
    /// the end of the number before.
    struct Chain {
        std::vector<Place> places;
        std::uint32_t position_bits = 0, furthest_bits = 0;
        bool moves = false;
    };

    void compile_from(std::size_t index, Chain chain, unsigned depth) {
        Node& node = plan_.nodes_[index];
        const PacketContainer& container = model_.containers[index];
        if (depth == depth_max || container.bits || !add_entries(container, chain)) return;
        // Each container has the steps of its bases, too.
        steps_ += chain.places.size();
        if (steps_ > steps_max) return;
        node.bits = chain.furthest_bits;
        node.fixed = !chain.moves;
        node.abstract = model_.containers[index].abstract;
        node.fields = fields_[index];
        for (const Place& place : chain.places)
            if (!add_step(index, place, chain, node) || !add_validity(index, place, chain, node)) return;
        std::vector<bool> filled(node.fields, false);
        for (const Step& step : node.steps)
            if (step.count == once && !step.skipped) std::fill_n(filled.begin() + step.field, step.times, true);
        node.fills = std::ranges::all_of(filled, std::identity{});
        if (!find_clock(chain, node.clock)) return;
        for (const std::size_t derived : node.derived) {
            auto& tests = plan_.nodes_[derived].tests;
            // Which of several holds is then not known here.
            if (!add_tests(model_.containers[derived].when, chain, tests)) return;
        }
        node.compiled = true;
        find_choice(node);
        for (const std::size_t derived : node.derived) compile_from(derived, chain, depth + 1);
    }

    /// Whether each derived container asks for a number of one and the same field, so that it can be looked up.
    void find_choice(Node& node) const {
        if (node.derived.size() < 2) return;
        const auto asks = [&](std::size_t derived, const Test& of) -> const Test* {
            const auto& tests = plan_.nodes_[derived].tests;
            const auto found = std::ranges::find_if(tests, [&](const Test& test) {
                return test.plain && test.op == xtce::Condition::Operator::equal &&
                       test.position_bits == of.position_bits && test.bits == of.bits && test.wanted >= 0.0;
            });
            return found == tests.end() ? nullptr : &*found;
        };
        for (const Test& of : plan_.nodes_[node.derived.front()].tests) {
            Choice choice{of.position_bits, of.bits, {}, {}};
            for (const std::size_t derived : node.derived)
                if (const Test* test = asks(derived, of))
                    choice.each.push_back(
                        {static_cast<std::uint64_t>(test->wanted), derived, plan_.nodes_[derived].tests.size() == 1});
            if (choice.each.size() != node.derived.size()) continue;
            std::ranges::stable_sort(choice.each, {}, &Choice::Each::wanted);
            constexpr std::uint64_t table_most = 4096;  // chosen: every APID
            if (choice.each.back().wanted < table_most && choice.each.size() < table_most)
                for (std::uint64_t wanted = 0; wanted <= choice.each.back().wanted; ++wanted) {
                    const auto found = std::ranges::lower_bound(choice.each, wanted, {}, &Choice::Each::wanted);
                    choice.first.push_back(static_cast<std::uint16_t>(found - choice.each.begin()));
                }
            node.choice = std::move(choice);
            return;
        }
    }

    /// False: validity is by more than whole numbers that stand before the value.
    bool add_validity(std::size_t container, const Place& place, const Chain& chain, Node& node) const {
        const auto field = place.valid == nullptr ? std::nullopt : field_of_(container, place.parameter, place.name);
        if (!field) return true;
        Validity validity{{}, static_cast<std::uint32_t>(*field)};
        Chain before;
        for (const Place& each : chain.places) {
            if (each.parameter == place.parameter) break;
            before.places.push_back(each);
        }
        if (place.repeated != nullptr || needs_text_(container, *field) ||
            !add_tests(*place.valid, before, validity.tests))
            return false;
        node.valid.push_back(std::move(validity));
        return true;
    }

    bool add_step(std::size_t container, const Place& place, const Chain& chain, Node& node) const {
        Step step{.position_bits = place.position_bits,
                  .bits = static_cast<std::uint8_t>(place.bits),
                  .moves = place.moves,
                  .coding = &place.type->coding,
                  .calibration = calibration_of(*place.type)};
        // By Horner's rule, as longer ones are.
        if (step.calibration != nullptr && step.calibration->polynomial.size() == 2)
            step.line = step.calibration->polynomial.data();
        if (place.repeated != nullptr) {
            const auto count = count_of(container, place, chain);
            if (!count) return false;
            step.count = static_cast<std::uint32_t>(plan_.counts_.size());
            plan_.counts_.push_back(*count);
            step.times = 0;
            for (std::uint32_t i = 0;; ++i) {
                const auto field = field_of_(container, place.parameter, place.name + "[" + std::to_string(i) + "]");
                if (!field) break;
                if (i == 0) step.field = static_cast<std::uint16_t>(*field);
                if (needs_text_(container, *field) || *field != step.field + i) return false;
                ++step.times;
            }
        } else {
            const auto field = field_of_(container, place.parameter, place.name);
            step.skipped = !field;
            step.field = static_cast<std::uint16_t>(field.value_or(0));
            step.text = field && needs_text_(container, *field);
        }
        if (step.skipped && !chain.moves) return true;  // no other step's place depends on it
        step.load = load_of(place, step);
        if (node.steps.empty() || !goes_on(node.steps.back(), step))
            node.steps.push_back(step);
        else
            ++node.steps.back().times;
        return true;
    }

    /// Whether a number is read as those of the step before, stands right behind them, and its field behind theirs.
    static bool goes_on(const Step& before, const Step& step) {
        const auto once_each = [](const Step& one) { return one.count == once && !one.skipped; };
        return once_each(before) && once_each(step) && step.load != Load::any && before.load == step.load &&
               before.bits == step.bits && before.calibration == step.calibration && !before.moves && !step.moves &&
               step.position_bits == before.position_bits + before.times * before.bits &&
               step.field == before.field + before.times;
    }

    static bool is_plain(const Coding& coding) {
        return coding.form == Coding::Form::unsigned_integer && !coding.least_significant_octet_first &&
               !coding.least_significant_bit_first;
    }

    /// The quick ways of reading are for numbers in the usual order.
    static Load load_of(const Place& place, const Step& step) {
        const Coding& coding = *step.coding;
        const bool in_order =
            !coding.least_significant_octet_first && !coding.least_significant_bit_first && !step.text;
        constexpr std::array sizes{8U, 16U, 32U, 64U};
        const auto size = std::ranges::find(sizes, place.bits);
        if (!in_order) return Load::any;
        if (place.moves || place.position_bits % 8 != 0 || size == sizes.end())
            return coding.form == Coding::Form::unsigned_integer ? Load::bits : Load::any;
        constexpr std::array whole{Load::u8, Load::u16, Load::u32, Load::u64};
        constexpr std::array twos_complement{Load::i8, Load::i16, Load::i32, Load::i64};
        constexpr std::array real{Load::any, Load::any, Load::f32, Load::f64};
        const auto which = static_cast<std::size_t>(size - sizes.begin());
        switch (coding.form) {
        case Coding::Form::unsigned_integer: return whole[which];
        case Coding::Form::twos_complement: return twos_complement[which];
        case Coding::Form::ieee754: return real[which];
        default: return Load::any;
        }
    }

    /// A count that is a number read before it, once, and without a choice of raw or calibrated.
    std::optional<Count> count_of(std::size_t container, const Place& repeated, const Chain& chain) const {
        const Amount& amount = *repeated.repeated;
        if (!amount.known || !amount.parameter || !amount.cases.empty()) return std::nullopt;
        const std::string name = model_.parameters[*amount.parameter].name + amount.member;
        const Place* found = nullptr;
        for (const Place& place : chain.places) {
            if (&place == &repeated) break;
            if (place.parameter != *amount.parameter || place.name != name) continue;
            const bool plain = place.type->kind == PacketType::Kind::integer && place.type->coding.calibration.empty();
            if (found != nullptr || !plain || place.repeated != nullptr || place.valid != nullptr) return std::nullopt;
            found = &place;
        }
        const auto field = found != nullptr ? field_of_(container, found->parameter, found->name) : std::nullopt;
        if (!field) return std::nullopt;
        return Count{static_cast<std::uint32_t>(*field), amount.slope, amount.intercept};
    }

    bool add_entries(const PacketContainer& container, Chain& chain) {
        for (const PacketEntry& entry : container.entries) {
            const auto offset = fixed_offset(entry.offset_bits);
            const auto count = fixed_bits(entry.count);
            const bool repeated = entry.count.parameter.has_value();
            if (entry.what != PacketEntry::What::parameter || !offset || (!repeated && count != 1U) ||
                fixed_bits(entry.gap_bits) != 0U || entry.when.form != xtce::Condition::Form::always ||
                !entry.last_indices.empty())
                return false;
            const PacketParameter& parameter = model_.parameters[entry.index];
            const bool from_start = entry.from == PacketEntry::From::container_start;
            if (from_start && (chain.moves || repeated)) return false;
            const std::int64_t position = (from_start ? 0 : std::int64_t{chain.position_bits}) + *offset;
            if (position < 0 || position > std::int64_t{packet_bits_max}) return false;
            chain.position_bits = static_cast<std::uint32_t>(position);
            if (repeated && !add_repeated(entry, parameter, chain)) return false;
            if (repeated) continue;
            const std::size_t before = chain.places.size();
            if (!add_type(entry.index, parameter.name, model_.types[parameter.type], chain, 0)) return false;
            if (parameter.valid.form == xtce::Condition::Form::always) continue;
            for (Place& place : std::span{chain.places}.subspan(before)) place.valid = &parameter.valid;
        }
        return true;
    }

    bool add_repeated(const PacketEntry& entry, const PacketParameter& parameter, Chain& chain) const {
        const PacketType& type = model_.types[parameter.type];
        const auto bits = fixed_bits(type.coding.bits);
        if (!is_number(type) || !bits || *bits == 0 || *bits > 64 ||
            parameter.valid.form != xtce::Condition::Form::always)
            return false;
        chain.places.push_back(
            {entry.index, parameter.name, chain.position_bits, *bits, &type, chain.moves, &entry.count, nullptr});
        chain.position_bits = 0;  // from its end
        chain.moves = true;
        return true;
    }

    bool add_type(std::size_t parameter, const std::string& name, const PacketType& type, Chain& chain,
                  unsigned depth) {
        if (depth == depth_max || ++types_ > steps_max) return false;
        if (type.kind == PacketType::Kind::aggregate)
            return std::ranges::all_of(type.members, [&](const auto& member) {
                return add_type(parameter, name + "." + member.name, model_.types[member.type], chain, depth + 1);
            });
        const auto bits = fixed_bits(type.coding.bits);
        if (!bits || chain.position_bits > packet_bits_max) return false;
        if (type.kind == PacketType::Kind::octets && type.coding.form == Coding::Form::octets && !chain.moves) {
            chain.position_bits += *bits;  // no field
            chain.furthest_bits = std::max(chain.furthest_bits, chain.position_bits);
            return true;
        }
        if (!is_number(type) || *bits == 0 || *bits > 64) return false;
        chain.places.push_back({parameter, name, chain.position_bits, *bits, &type, chain.moves, nullptr, nullptr});
        chain.position_bits = chain.moves ? 0 : chain.position_bits + *bits;
        chain.furthest_bits = std::max(chain.furthest_bits, chain.moves ? 0 : chain.position_bits);
        return true;
    }

    bool add_tests(const xtce::Condition& when, const Chain& chain, std::vector<Test>& tests) const {
        if (when.form == xtce::Condition::Form::always) return true;
        if (when.form == xtce::Condition::Form::all)
            return std::ranges::all_of(when.parts, [&](const auto& part) {
                return part.form == xtce::Condition::Form::compare && add_tests(part, chain, tests);
            });
        if (when.form != xtce::Condition::Form::compare) return false;
        const std::string name = model_.parameters[when.parameter].name + when.member;
        const Place* found = nullptr;
        for (const Place& place : chain.places) {
            if (place.parameter != when.parameter || place.name != name) continue;
            if (found != nullptr || place.moves || place.repeated != nullptr) return false;
            found = &place;
        }
        if (found == nullptr || found->bits > 53 || found->valid != nullptr) return false;
        const auto wanted = compared_whole(*found->type, when);
        if (!wanted) return false;
        tests.push_back({found->position_bits, found->bits, is_plain(found->type->coding), &found->type->coding,
                         when.op, static_cast<double>(*wanted)});
        return true;
    }

    static const Calibration* calibration_of(const PacketType& type) {
        const bool has_one = type.kind == PacketType::Kind::integer || type.kind == PacketType::Kind::real;
        return has_one && !type.coding.calibration.empty() ? &type.coding.calibration : nullptr;
    }

    /// False: the clock is one that only ContainerDecoder reads.
    static bool find_clock(const Chain& chain, std::optional<Clock>& clock) {
        const auto coarse = std::ranges::find_if(chain.places, [](const Place& place) {
            return !place.moves && place.position_bits == primary_header_octets * 8;
        });
        if (coarse == chain.places.end() || std::next(coarse) == chain.places.end()) return true;
        const auto fine = std::next(coarse);
        if (!are_coarse_and_fine({coarse->name, coarse->position_bits, coarse->bits},
                                 {fine->name, fine->position_bits, fine->bits}))
            return true;
        const auto quick = [](const Place& place) {
            return is_plain(place.type->coding) && !place.moves && place.repeated == nullptr;
        };
        if (!quick(*coarse) || !quick(*fine)) return false;
        clock =
            Clock{fine->position_bits, static_cast<std::uint8_t>(coarse->bits), static_cast<std::uint8_t>(fine->bits)};
        return true;
    }

    static constexpr std::size_t steps_max = std::size_t{1} << 18U;  ///< chosen: 20 MB of them
    std::size_t steps_ = 0, types_ = 0;
    ContainerPlan& plan_;
    const PacketModel& model_;
    const std::vector<std::size_t>& fields_;
    const FieldOf& field_of_;
    const std::function<bool(std::size_t, std::size_t)>& needs_text_;
};

ContainerPlan::ContainerPlan(const PacketModel& model, const std::vector<std::size_t>& fields, const FieldOf& field_of,
                             const std::function<bool(std::size_t, std::size_t)>& needs_text)
    : root_(model.root) {
    if (root_) Compiler{*this, model, fields, field_of, needs_text}.compile(*root_);
}

std::size_t ContainerPlan::compiled() const {
    return static_cast<std::size_t>(
        std::ranges::count_if(nodes_, [](const Node& node) { return node.compiled && !node.abstract; }));
}

namespace {

/// As read_bits(), for fields of few octets in fewer steps.
std::uint64_t bits_at(std::span<const std::uint8_t> packet, std::size_t position_bits, unsigned bits) {
    const auto before = static_cast<unsigned>(position_bits % 8);
    const unsigned octets = (before + bits + 7) / 8;
    if (octets > 4) return read_bits(packet, position_bits, bits);
    std::uint64_t value = 0;
    for (const std::uint8_t octet : packet.subspan(position_bits / 8, octets)) value = value << 8U | octet;
    return (value >> (octets * 8 - before - bits)) & ((std::uint64_t{1} << bits) - 1);
}

}  // namespace

bool ContainerPlan::holds(const Test& test, std::span<const std::uint8_t> packet) {
    const std::uint64_t field = bits_at(packet, test.position_bits, test.bits);
    const double number =
        test.plain ? static_cast<double>(field) : as_double(number_in(field, test.bits, *test.coding));
    return meets(number, test.op, test.wanted);
}

bool ContainerPlan::next_of(const Node& node, std::span<const std::uint8_t> packet, const Node*& next) const {
    const Node *restricted = nullptr, *any = nullptr;
    const auto take = [&](const Node& derived) {
        const Node*& found = derived.tests.empty() ? any : restricted;
        const bool first = found == nullptr;
        found = &derived;
        return first;
    };
    const auto is_one = [&](std::size_t index) {
        const Node& derived = nodes_[index];
        return !std::ranges::all_of(derived.tests, [&](const Test& test) { return holds(test, packet); }) ||
               take(derived);
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
void ContainerPlan::read_each(const Step& step, std::size_t times, const Into& into, LoadOne load) {
    const auto each = [&](auto calibrated) {
        for (std::size_t i = 0; i < times; ++i) {
            const Loaded one = load(i);
            into.raw[step.field + i] = one.raw;
            into.value[step.field + i] = std::isfinite(one.number) ? calibrated(one.number) : std::nullopt;
        }
    };
    if (step.calibration == nullptr)
        each([](double number) { return std::optional{number}; });
    else if (step.line != nullptr)
        each([line = step.line](double number) { return finite(line[1] * number + line[0]); });
    else
        each([&](double number) { return calibrated_by(*step.calibration, number); });
}

void ContainerPlan::read_step(const Step& step, std::span<const std::uint8_t> packet, std::size_t position_bits,
                              std::size_t times, const Into& into) {
    const std::uint8_t* const at = packet.data() + position_bits / 8;
    const auto each = [&](auto load) { read_each(step, times, into, load); };
    switch (step.load) {
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
        if (step.text) into.texts->emplace_back(step.field + i, exact_text(number));
        const auto* raw = std::get_if<std::uint64_t>(&number);
        return Loaded{value, raw != nullptr ? *raw : bits};
    });
}

bool ContainerPlan::read_repeated(const Step& step, std::span<const std::uint8_t> packet, std::size_t& position_bits,
                                  const Into& into) const {
    const Count& count = counts_[step.count];
    const auto& of = into.value[count.field];
    if (!of) return false;
    const double times = count.slope * *of + count.intercept;
    if (!(times >= 0.0) || times > repetitions_max || times != std::floor(times)) return false;
    const auto repetitions = static_cast<std::size_t>(times);
    if (repetitions * step.bits > packet.size() * 8 - position_bits) return false;
    read_step(step, packet, position_bits, std::min<std::size_t>(repetitions, step.times), into);
    position_bits += repetitions * step.bits;
    return true;
}

std::optional<std::size_t> ContainerPlan::read(std::size_t container, std::span<const std::uint8_t> packet,
                                               dictionary::Decoded& into) const {
    const Node& node = nodes_[container];
    into.raw.resize(node.fields);
    into.value.resize(node.fields);
    if (!node.fills) {
        std::ranges::fill(into.raw, 0);
        std::ranges::fill(into.value, std::nullopt);
    }
    into.texts.clear();
    into.problem.clear();
    const Into fields{into.raw.data(), into.value.data(), &into.texts};
    const std::size_t packet_bits = packet.size() * 8;
    std::size_t end_bits = node.bits;
    if (node.fixed) {
        for (const Step& step : node.steps) read_step(step, packet, step.position_bits, step.times, fields);
    } else {
        std::size_t at = 0;
        for (const Step& step : node.steps) {
            at = step.moves ? at + step.position_bits : step.position_bits;
            if (at > packet_bits) return std::nullopt;
            if (step.count != once) {
                if (!read_repeated(step, packet, at, fields)) return std::nullopt;
            } else {
                const std::size_t bits = std::size_t{step.times} * step.bits;
                if (bits > packet_bits - at) return std::nullopt;
                if (!step.skipped) read_step(step, packet, at, step.times, fields);
                at += bits;
            }
            end_bits = std::max(end_bits, at);
        }
    }
    for (const Validity& validity : node.valid)
        if (!std::ranges::all_of(validity.tests, [&](const Test& test) { return holds(test, packet); }))
            into.value[validity.field].reset();
    return end_bits;
}

bool ContainerPlan::decode(std::span<const std::uint8_t> packet, dictionary::Decoded& into) const {
    const auto reached = reach(packet);
    if (!reached || reached->abstract || reached->cut) return false;
    const auto end_bits = read(reached->container, packet, into);
    if (!end_bits) return false;
    if (packet.size() * 8 != *end_bits && !is_end_of_packet(packet, *end_bits)) return false;
    const auto& clock = nodes_[reached->container].clock;
    into.packet = reached->container;
    into.timed = clock.has_value();
    into.header.time = {};
    if (clock) {
        const auto& [fine_bit, coarse_bits, fine_bits] = *clock;
        into.header.time.seconds = static_cast<double>(read_bits(packet, primary_header_octets * 8, coarse_bits)) +
                                   static_cast<double>(read_bits(packet, fine_bit, fine_bits)) /
                                       static_cast<double>(std::uint64_t{1} << fine_bits);
    }
    return true;
}

}  // namespace aeolis::telemetry
