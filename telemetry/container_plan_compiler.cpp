// SPDX-License-Identifier: Apache-2.0
// Compiles containers to steps. Only ContainerDecoder reads:
// - conditions and sizes by text, by BCD, by whole numbers of more than 53 bits, or by numbers that are repeated, occur
//   twice, stand nowhere before, or have a validity or a context of their own; conditions that are not understood
// - derived containers that are restricted by what stands behind a place that varies
// - arrays of several dimensions that vary, lists within such lists, repeated containers, gaps between repetitions
// - containers of a told size, and places from the begin of a container that stands behind what varies
// - times since another, clocks that are not plain numbers, and what is of an unknown kind
#include "common/space_packet.hpp"
#include "dictionaries/words.hpp"
#include "telemetry/container_decoder.hpp"
#include "telemetry/container_plan.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

namespace aeolis::telemetry {
namespace {

using namespace dictionary::xtce;
namespace xtce = dictionary::xtce;

constexpr unsigned nested_max = ContainerDecoder::depth_max;
constexpr std::int64_t packet_bits_max = std::int64_t{8} * 65542;  // the longest space packet
constexpr double exact_max = 9007199254740992.0;                   // whole numbers up to here are exact as doubles
constexpr unsigned exact_bits = 53;
constexpr std::size_t clock_bits = primary_header_octets * 8;

std::optional<std::int64_t> fixed_offset(const Amount& amount) {
    const double value = amount.intercept;
    if (!amount.is_fixed() || !(std::abs(value) <= static_cast<double>(packet_bits_max)) || value != std::floor(value))
        return std::nullopt;
    return static_cast<std::int64_t>(value);
}

std::optional<std::uint32_t> fixed_bits(const Amount& amount) {
    const auto value = fixed_offset(amount);
    return value && *value >= 0 ? std::optional{static_cast<std::uint32_t>(*value)} : std::nullopt;
}

bool is_real(const Coding& coding) {
    return coding.form == Coding::Form::ieee754 || coding.form == Coding::Form::mil1750a;
}

bool is_labelled(const PacketType& type) {
    return type.kind == PacketType::Kind::enumerated || type.kind == PacketType::Kind::boolean;
}

bool is_number(const PacketType& type) {
    const bool real = type.kind == PacketType::Kind::real || type.kind == PacketType::Kind::time;
    const bool kind = real || type.kind == PacketType::Kind::integer || is_labelled(type);
    if (!real && is_real(type.coding)) return false;
    return kind && type.coding.form != Coding::Form::text && type.coding.form != Coding::Form::octets;
}

/// The bits of a number that is read; none: it is none, or not of 1 to 64 bits.
std::optional<std::uint32_t> number_bits(const PacketType& type) {
    const auto bits = fixed_bits(type.coding.bits);
    return is_number(type) && bits && *bits > 0 && *bits <= 64 ? bits : std::nullopt;
}

bool in_usual_order(const Coding& coding) {
    return !coding.least_significant_octet_first && !coding.least_significant_bit_first;
}

bool is_plain(const Coding& coding) {
    return coding.form == Coding::Form::unsigned_integer && in_usual_order(coding);
}

/// The numbers that have this label and no other; none: not told so simply.
std::optional<std::vector<std::pair<double, double>>> numbers_called(const PacketType& type, const std::string& label) {
    std::vector<std::pair<double, double>> numbers;
    for (const auto& each : type.labels) {
        const auto overlaps = [&](const auto& other) {
            return &other != &each && other.first <= each.last && other.last >= each.first;
        };
        if (each.label != label) continue;
        if (numbers.size() == 16) return std::nullopt;  // chosen
        const auto first = static_cast<double>(each.first), last = static_cast<double>(each.last);
        if (std::ranges::any_of(type.labels, overlaps) || std::abs(first) > exact_max || std::abs(last) > exact_max)
            return std::nullopt;
        numbers.emplace_back(first, last);
    }
    return numbers;
}

std::optional<double> wanted_number(const std::string& word) {
    if (const auto whole = dictionary::to_integer(word)) {
        const auto number = static_cast<double>(*whole);
        return std::abs(number) <= exact_max ? std::optional{number} : std::nullopt;
    }
    return dictionary::to_number(word);
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
    static constexpr std::size_t no_loop = std::string::npos, no_parameter = std::string::npos;

    /// A step before it is known which fields it has.
    struct Place {
        Op op = Op::numbers;
        std::size_t parameter = 0;
        std::string name{};
        std::int64_t position_bits = 0;
        std::uint32_t bits = 0;
        const PacketType* type = nullptr;
        bool moves = false;
        bool in_block = false;  ///< perhaps not there, or several times
        bool repeated = false;
        std::size_t loop = 0;  ///< the number of the loop that it is in; 0: none
        std::uint32_t index = none, valid = none, contexts = none, kept = none;
        std::size_t inside = 0;          ///< of a block: the number of places in it
        std::size_t brackets = no_loop;  ///< in the name: where its index in the loop is, "[0]"
    };
    /// The places of a container and its bases, in the order of the packet. Behind what moves, positions count from
    /// the end of the place before.
    struct Chain {
        std::vector<Place> places{};
        std::int64_t position_bits = 0, furthest_bits = 0;
        bool moves = false;
        bool octets_for_clock = false;  ///< octets stand where a clock could
        unsigned blocks = 0;            ///< that the next place is in
        std::size_t loops = 0, loop = 0, brackets = no_loop;
        std::uint32_t kept = 0;
        std::size_t counted = 0;                ///< entries and types, as ContainerDecoder counts them
        std::size_t entry = 0;                  ///< the first place of the entry
        std::size_t parameter = no_parameter;   ///< of the entry
        std::vector<std::string> aggregates{};  ///< that the next place is in, outermost first
    };

    void compile_from(std::size_t index, Chain chain, unsigned depth) {
        Node& node = plan_.nodes_[index];
        const PacketContainer& container = model_.containers[index];
        if (depth == nested_max || !add_container(container, chain, 0)) return;
        // Each container has the steps of its bases, too.
        steps_ += chain.places.size();
        if (steps_ > steps_max || chain.counted > values_max || (chain.moves && chain.position_bits != 0)) return;
        node.bits = static_cast<std::uint32_t>(chain.furthest_bits);
        node.abstract = container.abstract;
        node.fields = fields_[index];
        node.keeps = chain.kept > 0;
        node.fixed = std::ranges::all_of(chain.places, [](const Place& place) {
            return place.op == Op::numbers && !place.moves && !place.in_block;
        });
        filled_.assign(node.fields, false);
        texts_.assign(node.fields, false);
        if (!add_steps(index, chain.places, node) || !find_clock(chain, node.clock)) return;
        node.fills = std::ranges::all_of(filled_, std::identity{});
        for (const std::size_t derived : node.derived) {
            // Which of several holds is then not known here.
            if (!add_restriction(model_.containers[derived].when, chain, plan_.nodes_[derived].tests)) return;
        }
        node.compiled = true;
        find_choice(node);
        for (const std::size_t derived : node.derived) compile_from(derived, chain, depth + 1);
    }

    /// Whether each derived container asks for a number of one and the same field, so that it can be looked up.
    void find_choice(Node& node) const {
        if (node.derived.size() < 2) return;
        const auto is_lookup = [](const Test& test) {
            return test.form == xtce::Condition::Form::compare && test.of.plain &&
                   test.op == xtce::Condition::Operator::equal && test.wanted >= 0.0 && test.wanted <= exact_max &&
                   test.wanted == std::floor(test.wanted);
        };
        const auto asks = [&](std::size_t derived, const Test& first) -> const Test* {
            const auto& tests = plan_.nodes_[derived].tests;
            const auto found = std::ranges::find_if(tests, [&](const Test& test) {
                return is_lookup(test) && test.of.position_bits == first.of.position_bits &&
                       test.of.bits == first.of.bits;
            });
            return found == tests.end() ? nullptr : &*found;
        };
        for (const Test& first : plan_.nodes_[node.derived.front()].tests) {
            if (!is_lookup(first)) continue;
            Choice choice{first.of.position_bits, first.of.bits, {}, {}};
            for (const std::size_t derived : node.derived)
                if (const Test* test = asks(derived, first))
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

    // ---- places ------------------------------------------------------------------------------------------------

    bool add_container(const PacketContainer& container, Chain& chain, unsigned depth) {
        if (container.bits || depth == nested_max) return false;
        // Only the packet's own begin is known behind what moves.
        std::optional<std::int64_t> start = 0;
        if (depth > 0) start = chain.moves ? std::nullopt : std::optional{chain.position_bits};
        return std::ranges::all_of(container.entries, [&](const PacketEntry& entry) {
            if (++types_ > steps_max || ++chain.counted > values_max) return false;
            if (entry.when.form == xtce::Condition::Form::always) return add_entry(entry, start, chain, depth);
            begin_entry(entry, chain);
            const auto when = test_of(entry.when, chain, false);
            if (!when) return false;
            const std::size_t block = open(Op::when, keep(plan_.tests_, *when), chain);
            return add_entry(entry, start, chain, depth) && close(block, chain);
        });
    }

    static void begin_entry(const PacketEntry& entry, Chain& chain) {
        chain.entry = chain.places.size();
        chain.parameter = entry.what == PacketEntry::What::parameter ? entry.index : no_parameter;
    }

    /// Whether the entry is of a kind that is compiled, and its place is.
    bool add_entry(const PacketEntry& entry, std::optional<std::int64_t> start, Chain& chain, unsigned depth) {
        if (entry.what == PacketEntry::What::unknown || entry.what == PacketEntry::What::around ||
            fixed_bits(entry.gap_bits) != 0U)
            return false;
        begin_entry(entry, chain);
        if (!add_location(entry, start, chain)) return false;
        const auto count = fixed_bits(entry.count);
        if (entry.what == PacketEntry::What::container)
            return count == 1U && add_container(model_.containers[entry.index], chain, depth + 1);
        const PacketParameter& parameter = model_.parameters[entry.index];
        begin_entry(entry, chain);
        const std::size_t first = chain.entry;
        if (!add_parameter(entry, parameter, count, chain)) return false;
        if (parameter.valid.form == xtce::Condition::Form::always) return true;
        const auto valid = test_of(parameter.valid, chain, false);
        if (!valid) return false;
        const auto index = keep(plan_.tests_, *valid);
        for (Place& place : std::span{chain.places}.subspan(first)) place.valid = index;
        return true;
    }

    bool add_location(const PacketEntry& entry, std::optional<std::int64_t> start, Chain& chain) {
        const bool from_start = entry.from == PacketEntry::From::container_start;
        if (from_start && !start) return false;
        const auto offset = fixed_offset(entry.offset_bits);
        if (offset && !(from_start && chain.blocks > 0)) {
            if (from_start) chain.moves = false;
            const std::int64_t position = (from_start ? *start : chain.position_bits) + *offset;
            if (std::abs(position) > packet_bits_max || (position < 0 && !chain.moves)) return false;
            chain.position_bits = position;
            if (!chain.moves) pass(0, chain);
            return true;
        }
        const auto size = size_of(entry.offset_bits, chain);
        if (!size) return false;
        if (from_start) {
            chain.moves = false;
            chain.position_bits = *start;
        }
        add_place({.op = Op::move, .index = *size}, chain);
        chain.moves = true;
        return true;
    }

    bool add_parameter(const PacketEntry& entry, const PacketParameter& parameter, std::optional<std::uint32_t> count,
                       Chain& chain) {
        const PacketType& type = model_.types[parameter.type];
        if (!entry.last_indices.empty() && type.kind == PacketType::Kind::array)
            return count == 1U && add_array(parameter.name, type, entry.last_indices, chain, 0);
        if (count == 1U) return add_type(parameter.name, type, chain, 0);
        const std::size_t first = chain.places.size();
        bool added = true;
        if (count && *count <= unrolled_max) {
            for (std::uint32_t i = 0; added && i < *count; ++i)
                added = add_type(parameter.name + "[" + std::to_string(i) + "]", type, chain, 0);
        } else {
            const auto size = size_of(entry.count, chain);
            added = size && add_list(parameter.name, type, *size, chain, 0);
        }
        for (Place& place : std::span{chain.places}.subspan(first)) place.repeated = true;
        return added;
    }

    bool add_type(const std::string& name, const PacketType& type, Chain& chain, unsigned depth) {
        if (depth == nested_max || ++types_ > steps_max || ++chain.counted > values_max ||
            chain.position_bits > packet_bits_max)
            return false;
        switch (type.kind) {
        case PacketType::Kind::unknown: return false;
        case PacketType::Kind::aggregate: {
            chain.aggregates.push_back(name);
            const bool added = std::ranges::all_of(type.members, [&](const auto& member) {
                return add_type(name + "." + member.name, model_.types[member.type], chain, depth + 1);
            });
            chain.aggregates.pop_back();
            return added;
        }
        case PacketType::Kind::array: return add_array(name, type, type.last_indices, chain, depth + 1);
        default: break;
        }
        if (type.coding.form == Coding::Form::text) return add_text(name, type, chain);
        if (type.coding.form == Coding::Form::octets) return add_octets(type, chain);
        return add_number(name, type, chain);
    }

    bool add_array(const std::string& name, const PacketType& type, const std::vector<Amount>& last_indices,
                   Chain& chain, unsigned depth) {
        if (last_indices.empty() || depth >= nested_max) return false;
        const PacketType& element = model_.types[type.element];
        std::vector<std::size_t> sizes;
        std::size_t elements = 1;
        for (const Amount& last : last_indices) {
            const auto index = fixed_offset(last);
            if (!index || *index < -1 || *index >= unrolled_max) break;
            sizes.push_back(static_cast<std::size_t>(*index + 1));
            elements *= sizes.back();
            if (elements > unrolled_max) break;
        }
        if (sizes.size() < last_indices.size() || elements > unrolled_max) {
            const auto size = last_indices.size() == 1 ? size_of(last_indices.front(), chain, 1) : std::nullopt;
            return size && add_list(name, element, *size, chain, depth);
        }
        for (std::size_t i = 0; i < elements; ++i) {
            std::string indices;
            std::size_t left = i;
            for (auto size = sizes.rbegin(); size != sizes.rend(); left /= *size++)
                indices.insert(0, "[" + std::to_string(left % *size) + "]");
            if (!add_type(name + indices, element, chain, depth + 1)) return false;
        }
        return true;
    }

    /// As many of one type as a number in the packet says.
    bool add_list(const std::string& name, const PacketType& type, std::uint32_t size, Chain& chain, unsigned depth) {
        if (chain.loop != 0) return false;
        if (const auto bits = number_bits(type); bits && type.kind != PacketType::Kind::time) {
            const auto contexts = contexts_of(type, chain);
            if (!contexts) return false;
            add_place(
                {.op = Op::list, .name = name, .bits = *bits, .type = &type, .index = size, .contexts = *contexts},
                chain);
            chain.moves = true;
            return true;
        }
        const std::size_t block = open(Op::loop, size, chain);
        chain.loop = ++chain.loops;
        chain.brackets = name.size();
        const bool added = add_type(name + "[0]", type, chain, depth + 1);
        chain.loop = 0;
        chain.brackets = no_loop;
        return added && close(block, chain);
    }

    bool add_number(const std::string& name, const PacketType& type, Chain& chain) {
        const auto bits = number_bits(type);
        const auto contexts = bits ? contexts_of(type, chain) : std::nullopt;
        if (!contexts || type.time_since) return false;
        add_place({.name = name, .bits = *bits, .type = &type, .contexts = *contexts}, chain);
        if (!chain.moves) pass(*bits, chain);
        return true;
    }

    bool add_octets(const PacketType& type, Chain& chain) {
        if (const auto bits = fixed_bits(type.coding.bits); bits && *bits > 0 && !chain.moves) {
            const auto is_clock = [](const Place& place) { return !place.moves && place.position_bits == clock_bits; };
            chain.octets_for_clock = chain.octets_for_clock || (is_clock({.position_bits = chain.position_bits}) &&
                                                                std::ranges::none_of(chain.places, is_clock));
            pass(*bits, chain);  // no field
            return true;
        }
        const auto size = size_of(type.coding.bits, chain);
        if (!size) return false;
        add_place({.op = Op::octets, .index = *size}, chain);
        chain.moves = true;
        return true;
    }

    bool add_text(const std::string& name, const PacketType& type, Chain& chain) {
        const auto size = size_of(type.coding.bits, chain);
        if (!size || type.coding.leading_size_bits > 64) return false;
        add_place({.op = Op::text, .name = name, .type = &type, .index = *size}, chain);
        const auto bits = fixed_bits(type.coding.bits);
        if (type.coding.boxed && bits && !chain.moves)
            pass(*bits, chain);
        else
            chain.moves = true;
        return true;
    }

    /// What is behind a place of a size that is known.
    static void pass(std::uint32_t bits, Chain& chain) {
        chain.position_bits += bits;
        chain.furthest_bits = std::max(chain.furthest_bits, chain.position_bits);
    }

    /// Behind it, positions count from its end; pass() undoes this.
    static void add_place(Place place, Chain& chain) {
        place.parameter = chain.parameter;
        place.position_bits = chain.position_bits;
        place.moves = chain.moves;
        place.in_block = chain.blocks > 0;
        place.loop = chain.loop;
        place.brackets = chain.brackets;
        const bool has_end = place.op == Op::numbers ||
                             (place.op == Op::text && place.type->coding.boxed && fixed_bits(place.type->coding.bits));
        if (chain.moves || !has_end) chain.position_bits = 0;
        chain.places.push_back(std::move(place));
    }

    static std::size_t open(Op op, std::uint32_t index, Chain& chain) {
        add_place({.op = op, .index = index}, chain);
        chain.moves = true;
        ++chain.blocks;
        return chain.places.size() - 1;
    }
    static bool close(std::size_t block, Chain& chain) {
        // A place from the container's begin may have ended what moves: behind the block, either is possible.
        if (!chain.moves) return false;
        --chain.blocks;
        chain.places[block].inside = chain.places.size() - block - 1;
        return chain.position_bits == 0;
    }

    template <typename Kept>
    static std::uint32_t keep(std::vector<Kept>& all, Kept one) {
        all.push_back(std::move(one));
        return static_cast<std::uint32_t>(all.size() - 1);
    }

    // ---- what numbers decide -------------------------------------------------------------------------------------

    /// The operand of a number that is read once before the entry. Of a labelled type, its number.
    std::optional<Operand> operand_of(std::size_t place_index, bool calibrated, Chain& chain) {
        Place& place = chain.places[place_index];
        const PacketType& type = *place.type;
        const bool exact = is_real(type.coding) || place.bits <= exact_bits;
        const bool digits = type.coding.form == Coding::Form::bcd || type.coding.form == Coding::Form::bcd_octets;
        if (place.op != Op::numbers || !exact || digits || place.valid != none ||
            (place.loop != 0 && place.loop != chain.loop))
            return std::nullopt;
        Operand operand{.position_bits = static_cast<std::uint32_t>(place.position_bits),
                        .bits = place.bits,
                        .coding = &type.coding};
        if (calibrated && type.kind == PacketType::Kind::time) return std::nullopt;
        if (calibrated && !is_labelled(type)) {
            if (place.contexts != none) return std::nullopt;
            operand.calibration = calibration_of(type);
        }
        operand.plain = is_plain(type.coding) && operand.calibration == nullptr;
        if (!place.moves && !place.in_block) return operand;
        if (place.kept == none) {
            if (chain.kept == kept_max) return std::nullopt;
            place.kept = chain.kept++;
        }
        operand.kept = place.kept;
        operand.plain = false;
        return operand;
    }

    /// The place of a parameter's value, or of a member of it; none: not exactly one, before the entry.
    std::optional<std::size_t> find_place(std::size_t parameter, const std::string& name, const Chain& chain) {
        looked_at_ += chain.entry + 1;
        if (parameter == chain.parameter || looked_at_ > looked_at_max) return std::nullopt;
        std::optional<std::size_t> found;
        for (std::size_t i = 0; i < chain.entry; ++i) {
            const Place& place = chain.places[i];
            if (place.type == nullptr || place.parameter != parameter) continue;
            if (place.repeated || place.op == Op::list || place.loop != 0) return std::nullopt;
            if (place.name != name) continue;
            if (found) return std::nullopt;
            found = i;
        }
        return found;
    }

    /// The place of a member of the innermost aggregate that has it; none: not exactly one.
    std::optional<std::size_t> find_sibling(const std::string& member, const Chain& chain) {
        looked_at_ += (chain.places.size() + 1) * chain.aggregates.size();
        if (looked_at_ > looked_at_max) return std::nullopt;
        std::optional<std::size_t> found;
        for (auto aggregate = chain.aggregates.rbegin(); !found && aggregate != chain.aggregates.rend(); ++aggregate)
            for (std::size_t i = 0; i < chain.places.size(); ++i) {
                if (chain.places[i].type == nullptr || chain.places[i].name != *aggregate + "." + member) continue;
                if (found) return std::nullopt;
                found = i;
            }
        return found;
    }

    /// The index of a compiled amount.
    std::optional<std::uint32_t> size_of(const Amount& amount, Chain& chain, int more = 0) {
        if (!amount.known) return std::nullopt;
        Size size{.slope = amount.slope, .intercept = amount.intercept, .more = more};
        for (const auto& [when, value] : amount.cases) {
            auto test = test_of(when, chain, false);
            if (!test) return std::nullopt;
            size.cases.emplace_back(std::move(*test), value);
        }
        if (amount.cases.empty() && (amount.parameter || !amount.sibling.empty())) {
            const auto place =
                amount.parameter
                    ? find_place(*amount.parameter, model_.parameters[*amount.parameter].name + amount.member, chain)
                    : find_sibling(amount.sibling, chain);
            size.of = place ? operand_of(*place, amount.calibrated, chain) : std::nullopt;
            if (!size.of) return std::nullopt;
        }
        return keep(plan_.sizes_, std::move(size));
    }

    /// None: only ContainerDecoder can judge it. `at_once`: of numbers at fixed places alone.
    std::optional<Test> test_of(const xtce::Condition& when, Chain& chain, bool at_once) {
        using Form = xtce::Condition::Form;
        if (++tests_ > steps_max) return std::nullopt;
        if (when.form == Form::always) return Test{};
        if (when.form == Form::compare) return comparison_of(when, chain, at_once);
        if (when.form == Form::unknown) return std::nullopt;
        Test test{.form = when.form};
        for (const auto& part : when.parts) {
            auto one = test_of(part, chain, at_once);
            if (!one) return std::nullopt;
            test.parts.push_back(std::move(*one));
        }
        return test;
    }

    std::optional<Test> comparison_of(const xtce::Condition& when, Chain& chain, bool at_once) {
        const auto found = find_place(when.parameter, model_.parameters[when.parameter].name + when.member, chain);
        if (!found) return std::nullopt;
        const Place& place = chain.places[*found];
        if (at_once && (place.moves || place.in_block)) return std::nullopt;
        const auto operand = operand_of(*found, when.calibrated, chain);
        if (!operand) return std::nullopt;
        const PacketType& type = *place.type;
        const bool is_label =
            type.zero == when.value || type.one == when.value ||
            std::ranges::find(type.labels, when.value, &PacketType::Label::label) != type.labels.end();
        if (is_labelled(type) && when.calibrated && is_label) return label_test(type, when, *operand);
        const auto wanted = wanted_number(when.value);
        if (!wanted || when.by_label) return std::nullopt;
        return compared(*operand, when.op, *wanted);
    }

    static Test compared(const Operand& operand, xtce::Condition::Operator op, double wanted) {
        return {.form = xtce::Condition::Form::compare, .of = operand, .op = op, .wanted = wanted};
    }

    /// A label is equal or not; a number without one is not equal.
    static std::optional<Test> label_test(const PacketType& type, const xtce::Condition& when, const Operand& operand) {
        using enum xtce::Condition::Operator;
        if (!when.by_label || (when.op != equal && when.op != not_equal)) return std::nullopt;
        const bool is_equal = when.op == equal;
        if (type.kind == PacketType::Kind::boolean) {
            if (type.zero == type.one) return std::nullopt;
            const bool is_zero = type.zero == when.value;
            return compared(operand, is_equal == is_zero ? equal : not_equal, 0.0);
        }
        const auto numbers = numbers_called(type, when.value);
        if (!numbers || numbers->empty()) return std::nullopt;
        Test test{.form = is_equal ? xtce::Condition::Form::any : xtce::Condition::Form::all};
        for (const auto& [first, last] : *numbers) {
            if (first == last) {
                test.parts.push_back(compared(operand, is_equal ? equal : not_equal, first));
                continue;
            }
            Test range{.form = is_equal ? xtce::Condition::Form::all : xtce::Condition::Form::any};
            range.parts.push_back(compared(operand, is_equal ? greater_or_equal : less, first));
            range.parts.push_back(compared(operand, is_equal ? less_or_equal : greater, last));
            test.parts.push_back(std::move(range));
        }
        return test.parts.size() == 1 ? test.parts.front() : test;
    }

    /// What a derived container asks for, in the packet of its base.
    bool add_restriction(const xtce::Condition& when, Chain& chain, std::vector<Test>& tests) {
        if (when.form == xtce::Condition::Form::always) return true;
        chain.entry = chain.places.size();
        chain.parameter = no_parameter;
        auto test = test_of(when, chain, true);
        if (!test) return false;
        if (test->form == xtce::Condition::Form::all && !test->parts.empty())
            tests = std::move(test->parts);
        else
            tests.push_back(std::move(*test));
        return true;
    }

    /// The index of a type's contexts; `none` where it has none. No value: only ContainerDecoder can judge them.
    std::optional<std::uint32_t> contexts_of(const PacketType& type, Chain& chain) {
        if (type.coding.contexts.empty() || is_labelled(type)) return none;
        Contexts contexts;
        for (const auto& [when, calibration] : type.coding.contexts) {
            auto test = test_of(when, chain, false);
            if (!test) return std::nullopt;
            contexts.emplace_back(std::move(*test), calibrator(calibration.empty() ? nullptr : &calibration));
        }
        return keep(plan_.contexts_, std::move(contexts));
    }

    static const Calibration* calibration_of(const PacketType& type) {
        return !is_labelled(type) && !type.coding.calibration.empty() ? &type.coding.calibration : nullptr;
    }
    static Calibrator calibrator(const Calibration* calibration) {
        // By Horner's rule, as longer ones are.
        const bool line = calibration != nullptr && calibration->known && calibration->polynomial.size() == 2;
        return {calibration, line ? calibration->polynomial.data() : nullptr};
    }

    // ---- steps -------------------------------------------------------------------------------------------------

    bool add_steps(std::size_t container, std::span<const Place> places, Node& node) {
        std::size_t begin = node.steps.size();
        for (std::size_t i = 0; i < places.size(); ++i) {
            const Place& place = places[i];
            const auto inside = places.subspan(i + 1, place.inside);
            i += place.inside;
            auto step = step_of(container, place, inside);
            if (!step) return false;
            if (step->skipped && node.fixed) continue;  // no other step's place depends on it
            if (place.loop == 0 && node.steps.size() > begin && goes_on(node.steps.back(), *step)) {
                ++node.steps.back().times;
                continue;
            }
            const std::size_t at = node.steps.size();
            node.steps.push_back(*step);
            if (place.op != Op::when && place.op != Op::loop) continue;
            if (!add_steps(container, inside, node)) return false;
            node.steps[at].times = static_cast<std::uint32_t>(node.steps.size() - at - 1);
            if (place.op == Op::loop && node.steps[at].times == 0) return false;  // of nothing, for ever
            begin = node.steps.size();
        }
        return true;
    }

    std::optional<Step> step_of(std::size_t container, const Place& place, std::span<const Place> inside) {
        Step step{.position_bits = static_cast<std::int32_t>(place.position_bits),
                  .index = place.index,
                  .valid = place.valid,
                  .contexts = place.contexts,
                  .bits = static_cast<std::uint8_t>(place.bits),
                  .kept = static_cast<std::uint8_t>(std::min<std::uint32_t>(place.kept, 0xFF)),
                  .op = place.op,
                  .moves = place.moves};
        if (place.op == Op::loop)
            return add_fields_of_loop(container, inside, step) ? std::optional{step} : std::nullopt;
        if (place.type == nullptr) return step;
        step.coding = &place.type->coding;
        step.calibrator = calibrator(calibration_of(*place.type));
        if (place.op == Op::list) {
            if (!add_fields_of_list(container, place, step)) return std::nullopt;
        } else {
            const auto field = field_of(container, place, 0);
            step.skipped = !field;
            step.field = static_cast<std::uint16_t>(field.value_or(0));
            step.text = field && needs_text_(container, *field);
            // What an earlier one of the name had would have to stay.
            if (field && place.op == Op::text && (!step.text || texts_.at(*field))) return std::nullopt;
            if (field && place.op == Op::text) texts_[*field] = true;
            if (field && !place.in_block) filled_[*field] = true;
            if (place.type->kind == PacketType::Kind::time && place.op == Op::numbers && !add_time(place, step))
                return std::nullopt;
        }
        step.load = load_of(place, step, true);
        step.unaligned = load_of(place, step, false);
        if (!place.moves && place.position_bits % 8 != 0) step.load = step.unaligned;
        return step;
    }

    /// False: a time that might be the packet's is no field.
    bool add_time(const Place& place, Step& step) {
        const PacketType& type = *place.type;
        // That of an array's element or of a member is not.
        const bool is_of_packet = !type.relative && &type == &model_.types[model_.parameters[place.parameter].type];
        step.time = keep(plan_.times_, TimeScale{type.time_offset_s, type.time_scale_s, is_of_packet});
        return !is_of_packet || (!step.skipped && place.loop == 0);
    }

    std::optional<std::size_t> field_of(std::size_t container, const Place& place, std::size_t repetition) const {
        std::string name = place.name;
        if (place.brackets != no_loop) name.replace(place.brackets, 3, "[" + std::to_string(repetition) + "]");
        return field_of_(container, place.parameter, name);
    }

    bool add_fields_of_list(std::size_t container, const Place& place, Step& step) const {
        step.times = 0;
        for (std::uint32_t i = 0;; ++i) {
            const auto field = field_of_(container, place.parameter, place.name + "[" + std::to_string(i) + "]");
            if (!field) break;
            if (i == 0) step.field = static_cast<std::uint16_t>(*field);
            if (i == 0) step.text = needs_text_(container, *field);
            if (*field != step.field + i) return false;
            ++step.times;
        }
        step.skipped = step.times == 0;
        return true;
    }

    /// False: the fields of its repetitions do not follow each other alike.
    bool add_fields_of_loop(std::size_t container, std::span<const Place> inside, Step& step) const {
        std::vector<std::pair<const Place*, std::size_t>> first;
        for (const Place& place : inside)
            if (const auto field = place.type == nullptr ? std::nullopt : field_of(container, place, 0))
                first.emplace_back(&place, *field);
        step.field = static_cast<std::uint16_t>(first.size());
        for (; !first.empty(); ++step.known) {
            std::size_t found = 0;
            for (const auto& [place, field] : first)
                if (const auto one = field_of(container, *place, step.known)) {
                    if (*one != field + step.known * first.size()) return false;
                    ++found;
                }
            if (found == 0) break;
            if (found != first.size()) return false;
        }
        return true;
    }

    /// Whether a number is read as those of the step before, stands right behind them, and its field behind theirs.
    static bool goes_on(const Step& before, const Step& step) {
        const auto joins = [](const Step& one) { return one.op == Op::numbers && one.kept >= kept_max; };
        const bool adjacent = step.moves ? step.position_bits == 0
                                         : !before.moves && static_cast<std::size_t>(step.position_bits) ==
                                                                static_cast<std::size_t>(before.position_bits) +
                                                                    std::size_t{before.times} * before.bits;
        if (!joins(before) || !joins(step) || !adjacent || before.bits != step.bits || before.time != none ||
            step.time != none)
            return false;
        if (before.skipped || step.skipped) return before.skipped && step.skipped;
        return step.load != Load::any && before.load == step.load && before.valid == step.valid &&
               before.contexts == step.contexts && before.calibrator.calibration == step.calibrator.calibration &&
               step.field == before.field + before.times;
    }

    /// The quick ways of reading are for numbers in the usual order.
    static Load load_of(const Place& place, const Step& step, bool aligned) {
        const Coding& coding = *step.coding;
        constexpr std::array sizes{8U, 16U, 32U, 64U};
        const auto size = std::ranges::find(sizes, place.bits);
        if (!in_usual_order(coding) || step.text) return Load::any;
        if (!aligned || size == sizes.end())
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

    // ---- the clock ---------------------------------------------------------------------------------------------

    /// False: the clock is one that only ContainerDecoder reads.
    static bool find_clock(const Chain& chain, std::optional<Clock>& clock) {
        if (chain.octets_for_clock) return true;
        const auto stands = [](const Place& place) { return !place.moves && !place.in_block; };
        const auto first = std::ranges::find_if(
            chain.places, [&](const Place& place) { return !stands(place) || place.position_bits == clock_bits; });
        if (first == chain.places.end()) return true;
        if (!stands(*first)) return !may_have_clock(chain);
        const auto fine = std::next(first);
        if (fine == chain.places.end()) return true;
        const auto is_quick = [&](const Place& place) {
            return place.op == Op::numbers && is_plain(place.type->coding) && stands(place);
        };
        if (first->op == Op::numbers && fine->op == Op::numbers && stands(*fine) &&
            !are_coarse_and_fine({first->name, clock_bits, first->bits},
                                 {fine->name, static_cast<std::size_t>(fine->position_bits), fine->bits}))
            return true;
        if (!is_quick(*first) || !is_quick(*fine)) return !may_have_clock(chain);
        clock = Clock{static_cast<std::uint32_t>(fine->position_bits), static_cast<std::uint8_t>(first->bits),
                      static_cast<std::uint8_t>(fine->bits)};
        return true;
    }

    /// Whether there are numbers that are called coarse and fine, wherever they stand.
    static bool may_have_clock(const Chain& chain) {
        return std::ranges::any_of(chain.places, [&](const Place& coarse) {
            if (coarse.type == nullptr || !are_coarse_and_fine({coarse.name, 0, coarse.bits}, {"fine", coarse.bits, 1}))
                return false;
            return std::ranges::any_of(chain.places, [&](const Place& fine) {
                return fine.type != nullptr && are_coarse_and_fine({"coarse", 0, 1}, {fine.name, 1, fine.bits});
            });
        });
    }

    static constexpr std::size_t steps_max = std::size_t{1} << 18U;      ///< chosen: 20 MB of them
    static constexpr std::int64_t unrolled_max = 4096;                   ///< chosen: longer lists are read in a loop
    static constexpr std::size_t looked_at_max = std::size_t{1} << 26U;  ///< chosen: a second's work
    std::size_t steps_ = 0, types_ = 0, tests_ = 0;
    std::size_t looked_at_ = 0;  ///< places, for what conditions and sizes name
    std::vector<bool> filled_;   ///< fields of the container that have a step, always done
    std::vector<bool> texts_;    ///< and those that have a step of text
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

}  // namespace aeolis::telemetry
