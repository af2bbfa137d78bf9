// SPDX-License-Identifier: Apache-2.0
#include "telemetry/other_mission.hpp"

#include "common/bytes.hpp"
#include "dictionaries/words.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace aeolis::telemetry {
namespace {

using namespace dictionary::xtce;
namespace xtce = dictionary::xtce;  // telemetry has a Condition of its own

constexpr unsigned apid_position_bits = 5, apid_bits = 11;  // [ccsds-133.0-b-2]
constexpr unsigned number_bits_max = 64;
constexpr double time_max_s =
    1e12;  // chosen, 30 000 years: a time beyond is none, and an axis to it would show nothing

/// The number of a list's elements that become fields: all of a short list of known length.
std::size_t elements_of(const std::vector<Amount>& last_indices) {
    std::size_t elements = 1;
    for (const Amount& last : last_indices)
        elements *=
            std::min(fixed_amount(last).value_or(OtherMission::elements_max - 1) + 1, OtherMission::elements_max);
    return std::min(elements, OtherMission::elements_max);
}

bool is_channel(const PacketType& type) {
    switch (type.kind) {
    case PacketType::Kind::text: return type.coding.form == Coding::Form::text;
    case PacketType::Kind::integer:
    case PacketType::Kind::real:
    case PacketType::Kind::enumerated:
    case PacketType::Kind::boolean:
    case PacketType::Kind::time:
        return type.coding.form != Coding::Form::text && type.coding.form != Coding::Form::octets;
    default: return false;
    }
}

dictionary::Type type_of(const PacketType& type) {
    dictionary::Type words = field_type(type);
    const bool calibrated = !type.coding.calibration.empty() || !type.coding.contexts.empty();
    if (words.kind == dictionary::ValueKind::integer && calibrated) words.kind = dictionary::ValueKind::real;
    if (words.bits == 0 && words.kind == dictionary::ValueKind::integer) words.bits = number_bits_max;
    return words;
}

PacketModel with_root(PacketModel model) {
    if (const auto only = ContainerDecoder::root_of(model, {}); !model.root && only) model.root = *only;
    return model;
}

std::optional<double> channel_value(const DecodedValue& value) {
    const auto number = [](const Datum& datum) -> std::optional<double> {
        if (const auto* real = std::get_if<double>(&datum)) return *real;
        if (const auto* whole = std::get_if<std::uint64_t>(&datum)) return static_cast<double>(*whole);
        if (const auto* whole = std::get_if<std::int64_t>(&datum)) return static_cast<double>(*whole);
        return std::nullopt;
    };
    // A label stands for its number.
    if (std::holds_alternative<std::string>(value.calibrated)) return number(value.raw);
    return number(value.calibrated);
}

}  // namespace

const char* name_of(xtce::Condition::Operator op) {
    switch (op) {
    case xtce::Condition::Operator::equal: return "==";
    case xtce::Condition::Operator::not_equal: return "!=";
    case xtce::Condition::Operator::less: return "<";
    case xtce::Condition::Operator::less_or_equal: return "<=";
    case xtce::Condition::Operator::greater: return ">";
    case xtce::Condition::Operator::greater_or_equal: return ">=";
    }
    return "==";
}

/// Builds packets and channels from containers and parameters, once.
class OtherMission::Builder {
  public:
    Builder(OtherMission& mission, const PacketModel& model) : mission_(mission), model_(model) {}

    void build() {
        for (std::size_t i = 0; i < model_.containers.size(); ++i) {
            const PacketContainer& container = model_.containers[i];
            dictionary::Packet& packet = mission_.dictionary_.packets.emplace_back();
            packet.name = names_.insert("packet " + container.name).second ? container.name : container.path.substr(1);
            packet.expected_rate_hz = container.expected_rate_hz;
            packet.apid = apid_of(i).value_or(unrestricted_apid);
            mission_.fields_.emplace_back();
            if (!container.abstract) add_container(i, 0);
        }
        for (std::size_t i = 0; i < types_.size(); ++i)
            add_context_alarms(mission_.dictionary_.channels[i], *types_[i]);
    }

  private:
    /// Alarms of a context whose channels no packet holds can never be in force, and are left out.
    void add_context_alarms(dictionary::Channel& channel, const PacketType& type) {
        for (const auto& [when, alarms] : type.context_alarms) {
            dictionary::ContextAlarms added{{}, alarms};
            const auto can = add_conditions(when, added.context);
            if (can && *can) channel.type.alarms.contexts.push_back(std::move(added));
            if (!can)
                mission_.unsupported_alarms_.push_back(
                    "line " + std::to_string(type.line) + ": alarms of " + channel.name +
                    " in a context that is not a comparison of channels are not judged");
        }
    }

    /// None: the condition cannot be judged by channels. False: it can never hold.
    std::optional<bool> add_conditions(const xtce::Condition& when, std::vector<dictionary::Precondition>& into) const {
        if (when.form == xtce::Condition::Form::all) {
            bool can_hold = true;
            for (const auto& part : when.parts) {
                const auto can = add_conditions(part, into);
                if (!can) return std::nullopt;
                can_hold = can_hold && *can;
            }
            return can_hold;
        }
        if (when.form != xtce::Condition::Form::compare) return std::nullopt;
        const auto found = channels_.find({when.parameter, model_.parameters[when.parameter].name + when.member});
        if (found == channels_.end()) return false;
        const dictionary::Type& type = mission_.dictionary_.channels[found->second.value].type;
        const bool calibrated = type.kind == dictionary::ValueKind::real;
        auto number = dictionary::to_number(when.value);
        if (const auto label = std::ranges::find(type.enumeration, when.value, &dictionary::EnumValue::label);
            label != type.enumeration.end()) {
            if (label->last) return std::nullopt;
            number = static_cast<double>(label->value);
        }
        if (!number || type.kind == dictionary::ValueKind::text || (calibrated && !when.calibrated))
            return std::nullopt;
        into.push_back({found->second, name_of(when.op), *number, {}});
        return true;
    }

    /// Nested references multiply even when depth is bounded: what is not reached counts as left out.
    bool too_many_steps() {
        if (++steps_ <= steps_max) return false;
        mission_.omitted_fields_ = std::max<std::size_t>(mission_.omitted_fields_, 1);
        return true;
    }

    /// Adds base containers first, in the order of decoding and no deeper.
    void add_container(std::size_t index, unsigned depth) {
        if (depth == ContainerDecoder::depth_max || too_many_steps()) return;
        const PacketContainer& container = model_.containers[index];
        if (container.base) add_container(*container.base, depth + 1);
        for (const PacketEntry& entry : container.entries) {
            if (entry.what == PacketEntry::What::unknown || entry.what == PacketEntry::What::around)
                return;  // decoding ends here
            if (entry.what == PacketEntry::What::container) {
                add_container(entry.index, depth + 1);
                continue;
            }
            const PacketParameter& parameter = model_.parameters[entry.index];
            const auto count = fixed_amount(entry.count);
            parameter_ = entry.index;
            if (count == 1U) {
                add_type(parameter.name, model_.types[parameter.type], entry.last_indices, 0);
                continue;
            }
            for (std::size_t i = 0; i < std::min(count.value_or(elements_max), elements_max); ++i)
                add_type(parameter.name + "[" + std::to_string(i) + "]", model_.types[parameter.type],
                         entry.last_indices, 0);
        }
    }

    void add_type(const std::string& name, const PacketType& type, const std::vector<Amount>& last_indices,
                  unsigned depth) {
        if (depth == ContainerDecoder::depth_max || mission_.omitted_fields_ > 0 || too_many_steps()) return;
        if (type.kind == PacketType::Kind::aggregate) {
            for (const auto& member : type.members)
                add_type(name + "." + member.name, model_.types[member.type], {}, depth + 1);
        } else if (type.kind == PacketType::Kind::array) {
            const auto& dimensions = last_indices.empty() ? type.last_indices : last_indices;
            if (dimensions.size() != 1) return;  // tables are only in contents()
            for (std::size_t i = 0; i < elements_of(dimensions); ++i)
                add_type(name + "[" + std::to_string(i) + "]", model_.types[type.element], {}, depth + 1);
        } else if (is_channel(type)) {
            add_field(name, type);
        }
    }

    void add_field(const std::string& name, const PacketType& type) {
        auto& fields = mission_.fields_.back();
        auto& channels = mission_.dictionary_.channels;
        dictionary::Packet& packet = mission_.dictionary_.packets.back();
        const FieldKey key{parameter_, name};
        if (fields.contains(key)) return;
        auto known = channels_.find(key);
        if (++fields_ > fields_max || (known == channels_.end() && channels.size() == channels_max)) {
            ++mission_.omitted_fields_;
            return;
        }
        if (known == channels_.end()) {
            const PacketParameter& parameter = model_.parameters[parameter_];
            const std::string with_path = parameter.path.substr(1) + name.substr(parameter.name.size());
            const std::string& unique = names_.insert(name).second ? name : with_path;
            const ChannelId channel{static_cast<std::uint16_t>(channels.size())};
            channels.push_back({channel, unique, unique, type.name, type_of(type)});
            types_.push_back(&type);
            known = channels_.emplace(key, channel).first;
        }
        const dictionary::Channel& channel = channels[known->second.value];
        fields.emplace(key, packet.fields.size());
        packet.fields.push_back({channel.name, channel.type, channel.id, 0, std::nullopt});
    }

    /// The parameter at the primary header's APID, in the container that all others derive from.
    std::optional<std::size_t> apid_parameter(std::size_t root) const {
        std::size_t position = 0;
        for (const PacketEntry& entry : model_.containers[root].entries) {
            if (entry.what != PacketEntry::What::parameter || entry.from != PacketEntry::From::previous ||
                entry.when.form != xtce::Condition::Form::always || fixed_amount(entry.offset_bits) != 0U ||
                fixed_amount(entry.count) != 1U)
                return std::nullopt;
            const PacketType& type = model_.types[model_.parameters[entry.index].type];
            const auto bits = fixed_amount(type.coding.bits);
            if (!is_channel(type) || !bits) return std::nullopt;
            if (position == apid_position_bits && *bits == apid_bits) return entry.index;
            position += *bits;
        }
        return std::nullopt;
    }

    std::optional<Apid> apid_of(std::size_t index) const {
        std::size_t root = index;
        for (unsigned depth = 0; model_.containers[root].base; root = *model_.containers[root].base)
            if (++depth > ContainerDecoder::depth_max) return std::nullopt;
        const auto parameter = apid_parameter(root);
        if (!parameter) return std::nullopt;
        for (std::size_t at = index;; at = *model_.containers[at].base) {
            if (const auto apid = asked_for(model_.containers[at].when, *parameter)) return apid;
            if (!model_.containers[at].base) return std::nullopt;
        }
    }

    static std::optional<Apid> asked_for(const xtce::Condition& condition, std::size_t parameter) {
        if (condition.form == xtce::Condition::Form::compare && condition.parameter == parameter &&
            condition.member.empty() && condition.op == xtce::Condition::Operator::equal) {
            const auto value = dictionary::to_integer(condition.value);
            if (value && *value >= 0 && *value < 2048) return Apid{static_cast<std::uint16_t>(*value)};
        }
        if (condition.form != xtce::Condition::Form::all) return std::nullopt;
        for (const xtce::Condition& part : condition.parts)
            if (const auto apid = asked_for(part, parameter)) return apid;
        return std::nullopt;
    }

    static constexpr std::size_t steps_max = std::size_t{1}
                                             << 21U;  ///< chosen: a second's work, and twice what fields_max takes
    std::size_t steps_ = 0;
    OtherMission& mission_;
    const PacketModel& model_;
    std::map<FieldKey, ChannelId> channels_;
    std::vector<const PacketType*> types_;  ///< by channel
    std::set<std::string> names_;           ///< taken
    std::size_t parameter_ = 0;             ///< the parameter whose fields are being added
    std::size_t fields_ = 0;
};

OtherMission::OtherMission(PacketModel model, std::uint16_t id, std::optional<TimeSource> time)
    : model_(with_root(std::move(model))), decoder_(model_), time_(std::move(time)) {
    dictionary_.mission = model_.name;
    dictionary_.id = id;
    Builder{*this, model_}.build();
    if (time_) return;
    std::vector<std::size_t> fields;
    fields.reserve(dictionary_.packets.size());
    for (const auto& packet : dictionary_.packets) fields.push_back(packet.fields.size());
    const auto field_of = [this](std::size_t container, std::size_t parameter, const std::string& name) {
        const auto found = fields_[container].find({parameter, name});
        return found == fields_[container].end() ? std::nullopt : std::optional{found->second};
    };
    const auto needs_text_at = [this](std::size_t container, std::size_t field) {
        return needs_text(dictionary_.packets[container].fields[field].type);
    };
    plan_.emplace(model_, fields, field_of, needs_text_at);
}

DecodedContents OtherMission::contents(std::span<const std::uint8_t> packet) const {
    auto contents = decoder_.decode(packet);
    if (time_) contents.time = time_->time_in(contents.values);
    return contents;
}

std::optional<std::string> OtherMission::decode(std::span<const std::uint8_t> packet, Decoded& into) const {
    // Checks only what all missions' primary headers share: parts of segmented packets are packets too.
    if (space_packet_octets(packet) != packet.size()) return name_of(Refusal::not_a_packet);
    into.header = {};
    into.header.primary.apid = Apid{static_cast<std::uint16_t>(read_bits(packet, apid_position_bits, apid_bits))};
    if (plan_ && plan_->decode(packet, into)) return std::nullopt;
    const DecodedContents contents = this->contents(packet);
    if (model_.containers.empty() || contents.values.empty() || model_.containers[contents.container_index].abstract)
        return contents.problem.empty() ? std::string{"no container describes it"} : contents.problem;
    into.packet = contents.container_index;
    into.problem = contents.problem;
    into.timed = contents.time && std::abs(contents.time->seconds) <= time_max_s;
    into.header.time = Sclk{into.timed ? contents.time->seconds : 0.0};
    into.texts.clear();
    const auto& known = dictionary_.packets[into.packet].fields;
    const std::size_t fields = known.size();
    into.raw.assign(fields, 0);
    into.value.assign(fields, std::nullopt);
    const auto& names = fields_[into.packet];
    for (const DecodedValue& value : contents.values) {
        const auto field = names.find({value.parameter, value.name});
        if (field == names.end()) continue;
        into.value[field->second] = channel_value(value);
        if (needs_text(known[field->second].type) && !std::holds_alternative<std::monostate>(value.calibrated))
            into.texts.emplace_back(field->second, datum_text(value.calibrated));
        if (const auto* raw = std::get_if<std::uint64_t>(&value.raw))
            into.raw[field->second] = *raw;
        else if (value.bits > 0 && value.bits <= number_bits_max)  // an empty text has none
            into.raw[field->second] = read_bits(packet, value.position_bits, static_cast<unsigned>(value.bits));
    }
    return std::nullopt;
}

}  // namespace aeolis::telemetry
