// SPDX-License-Identifier: Apache-2.0
#include "telemetry/container_plan.hpp"

#include "common/bytes.hpp"
#include "common/crc.hpp"
#include "common/space_packet.hpp"
#include "dictionaries/words.hpp"
#include "telemetry/container_decoder.hpp"
#include "telemetry/raw_number.hpp"

#include <algorithm>
#include <cmath>

namespace aeolis::telemetry {
namespace {

using namespace dictionary::xtce;
namespace xtce = dictionary::xtce;

constexpr unsigned depth_max = 16;                  // as ContainerDecoder has it
constexpr std::size_t packet_bits_max = 8 * 65542;  // the longest space packet
constexpr double exact_max = 9007199254740992.0;    // whole numbers up to here are exact as doubles

std::optional<std::uint32_t> fixed_bits(const Amount& amount) {
    const double value = amount.intercept;
    if (!amount.known || amount.parameter || !amount.cases.empty() || !(value >= 0.0) || value > packet_bits_max ||
        value != std::floor(value))
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

bool compared(double left, xtce::Condition::Operator op, double right) {
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
    /// A number at a fixed place.
    struct Place {
        std::size_t parameter = 0;
        std::string name;
        std::uint32_t position_bits = 0, bits = 0;
        const PacketType* type = nullptr;
    };
    /// The numbers of a container and its bases, in the order of the packet.
    struct Chain {
        std::vector<Place> places;
        std::uint32_t position_bits = 0, furthest_bits = 0;
    };

    void compile_from(std::size_t index, Chain chain, unsigned depth) {
        Node& node = plan_.nodes_[index];
        if (depth == depth_max || !add_entries(model_.containers[index], chain)) return;
        node.bits = chain.furthest_bits;
        node.abstract = model_.containers[index].abstract;
        node.fields = fields_[index];
        for (const Place& place : chain.places)
            if (const auto field = field_of_(index, place.parameter, place.name))
                node.steps.push_back({place.position_bits, static_cast<std::uint16_t>(*field),
                                      static_cast<std::uint8_t>(place.bits), needs_text_(index, *field),
                                      &place.type->coding, calibration_of(*place.type)});
        node.clock = clock_of(chain);
        for (const std::size_t derived : node.derived) {
            auto& tests = plan_.nodes_[derived].tests;
            // Which of several holds is then not known here.
            if (!add_tests(model_.containers[derived].when, chain, tests)) return;
        }
        node.compiled = true;
        for (const std::size_t derived : node.derived) compile_from(derived, chain, depth + 1);
    }

    bool add_entries(const PacketContainer& container, Chain& chain) const {
        for (const PacketEntry& entry : container.entries) {
            const auto offset = fixed_bits(entry.offset_bits), count = fixed_bits(entry.count);
            if (entry.what != PacketEntry::What::parameter || !offset || count != 1U ||
                entry.when.form != xtce::Condition::Form::always || !entry.last_indices.empty())
                return false;
            const PacketParameter& parameter = model_.parameters[entry.index];
            if (parameter.valid.form != xtce::Condition::Form::always) return false;
            const std::uint32_t from = entry.from == PacketEntry::From::container_start ? 0 : chain.position_bits;
            chain.position_bits = from + *offset;
            if (!add_type(entry.index, parameter.name, model_.types[parameter.type], chain, 0)) return false;
        }
        return true;
    }

    bool add_type(std::size_t parameter, const std::string& name, const PacketType& type, Chain& chain,
                  unsigned depth) const {
        if (depth == depth_max) return false;
        if (type.kind == PacketType::Kind::aggregate)
            return std::ranges::all_of(type.members, [&](const auto& member) {
                return add_type(parameter, name + "." + member.name, model_.types[member.type], chain, depth + 1);
            });
        const auto bits = fixed_bits(type.coding.bits);
        if (!is_number(type) || !bits || *bits == 0 || *bits > 64 || chain.position_bits > packet_bits_max)
            return false;
        chain.places.push_back({parameter, name, chain.position_bits, *bits, &type});
        chain.position_bits += *bits;
        chain.furthest_bits = std::max(chain.furthest_bits, chain.position_bits);
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
            if (found != nullptr) return false;  // twice in the packet
            found = &place;
        }
        const auto wanted = dictionary::to_integer(when.value);
        if (found == nullptr || found->type->kind != PacketType::Kind::integer ||
            !found->type->coding.calibration.empty() || found->bits > 53 || !wanted ||
            std::abs(static_cast<double>(*wanted)) > exact_max)
            return false;
        tests.push_back(
            {found->position_bits, found->bits, &found->type->coding, when.op, static_cast<double>(*wanted)});
        return true;
    }

    static const Calibration* calibration_of(const PacketType& type) {
        const bool has_one = type.kind == PacketType::Kind::integer || type.kind == PacketType::Kind::real;
        return has_one && !type.coding.calibration.empty() ? &type.coding.calibration : nullptr;
    }

    static std::optional<Clock> clock_of(const Chain& chain) {
        const auto coarse = std::ranges::find(chain.places, primary_header_octets * 8, &Place::position_bits);
        if (coarse == chain.places.end() || std::next(coarse) == chain.places.end()) return std::nullopt;
        const auto fine = std::next(coarse);
        const auto counts = [](const Place& place) {
            const auto form = place.type->coding.form;
            return form == Coding::Form::unsigned_integer;
        };
        if (!counts(*coarse) || !counts(*fine) ||
            !are_coarse_and_fine({coarse->name, coarse->position_bits, coarse->bits},
                                 {fine->name, fine->position_bits, fine->bits}))
            return std::nullopt;
        return Clock{fine->position_bits, static_cast<std::uint8_t>(coarse->bits),
                     static_cast<std::uint8_t>(fine->bits)};
    }

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

/// The container that describes the whole packet; null: none that is compiled, or more than one.
const ContainerPlan::Node* ContainerPlan::node_of(std::span<const std::uint8_t> packet) const {
    const std::size_t packet_bits = packet.size() * 8;
    const auto holds = [&](const Test& test) {
        const std::uint64_t field = read_bits(packet, test.position_bits, test.bits);
        return compared(as_double(number_in(field, test.bits, *test.coding)), test.op, test.wanted);
    };
    const Node* node = root_ ? &nodes_[*root_] : nullptr;
    while (node != nullptr && node->compiled && node->bits <= packet_bits) {
        const Node *restricted = nullptr, *any = nullptr;
        for (const std::size_t index : node->derived) {
            const Node& derived = nodes_[index];
            if (!std::ranges::all_of(derived.tests, holds)) continue;
            const Node*& found = derived.tests.empty() ? any : restricted;
            if (found != nullptr) return nullptr;
            found = &derived;
        }
        const Node* next = restricted != nullptr ? restricted : any;
        if (next == nullptr) return node->abstract ? nullptr : node;
        node = next;
    }
    return nullptr;
}

bool ContainerPlan::decode(std::span<const std::uint8_t> packet, dictionary::Decoded& into) const {
    const Node* node = node_of(packet);
    if (node == nullptr) return false;
    const std::size_t behind_bits = packet.size() * 8 - node->bits;
    if (behind_bits != 0 && (behind_bits != 8 * packet_crc_octets || crc16(packet) != 0)) return false;
    into.packet = static_cast<std::size_t>(node - nodes_.data());
    into.raw.assign(node->fields, 0);
    into.value.assign(node->fields, std::nullopt);
    into.texts.clear();
    for (const Step& step : node->steps) {
        const std::uint64_t field = read_bits(packet, step.position_bits, step.bits);
        const RawNumber number = number_in(field, step.bits, *step.coding);
        const double value = as_double(number);
        if (const auto* whole = std::get_if<std::uint64_t>(&number)) into.raw[step.field] = *whole;
        if (!std::isfinite(value)) {
            into.raw[step.field] = field;
            continue;
        }
        into.value[step.field] = step.calibration == nullptr ? value : calibrated_by(*step.calibration, value);
        if (step.text) into.texts.emplace_back(step.field, exact_text(number));
    }
    into.timed = node->clock.has_value();
    into.header.time = {};
    if (node->clock) {
        const auto& [fine_bit, coarse_bits, fine_bits] = *node->clock;
        into.header.time.seconds =
            static_cast<double>(read_bits(packet, primary_header_octets * 8, coarse_bits)) +
            std::ldexp(static_cast<double>(read_bits(packet, fine_bit, fine_bits)), -static_cast<int>(fine_bits));
    }
    return true;
}

}  // namespace aeolis::telemetry
