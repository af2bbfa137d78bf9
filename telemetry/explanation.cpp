#include "telemetry/explanation.hpp"

#include "telemetry/text.hpp"

#include <algorithm>

namespace aeolis::telemetry {
namespace {

constexpr std::size_t fields_of_a_condition = 5;

/// One field of the packet, as text or number.
struct Reader {
    const dictionary::Packet& packet;
    const Decoded& decoded;

    std::string label(std::size_t field) const { return number_text(packet.fields[field].type, decoded.value[field]); }
    std::string label(std::string_view name) const {
        const auto field = field_index(packet, name);
        return field ? label(*field) : std::string{};
    }
    double number(std::size_t field) const { return decoded.value[field].value_or(0.0); }
    double number(std::string_view name) const {
        const auto field = field_index(packet, name);
        return field ? number(*field) : 0.0;
    }
};

std::string symbol_of(const std::string& comparison) {
    if (comparison == "lt") return "<";
    if (comparison == "le") return "<=";
    if (comparison == "eq") return "==";
    if (comparison == "ge") return ">=";
    if (comparison == "gt") return ">";
    return comparison;
}

bool mentions(const std::string& decision, std::string_view word) {
    return decision.find(word) != std::string::npos;
}

std::string subject_of(const dictionary::Dictionary& dictionary, const std::string& decision, double number) {
    if (mentions(decision, "timepoint")) {
        const auto id = static_cast<std::size_t>(number);
        return id < dictionary.timeline.size() ? dictionary.timeline[id].name : "number " + std::to_string(id);
    }
    if (mentions(decision, "tone")) {
        const auto id = static_cast<std::size_t>(number);
        const bool named = id < dictionary.tones.size() && !dictionary.tones[id].name.empty();
        return std::to_string(id) + (named ? " " + dictionary.tones[id].name : std::string{});
    }
    const auto* command = dictionary.command(Opcode{static_cast<std::uint16_t>(number)});
    return command != nullptr ? command->name : std::string{};
}

std::string sentence_of(const Condition& condition) {
    return std::string{condition.holds ? "" : "not "} + std::string{without_unit(condition.quantity)} + " " +
           named_value_text(condition.quantity, condition.value) + " " + condition.comparison + " " +
           named_value_text(condition.quantity, condition.bound);
}

std::vector<Condition> conditions_of(const Reader& reader) {
    std::vector<Condition> conditions;
    const auto count_field = field_index(reader.packet, "condition_count");
    if (!count_field) return conditions;
    const std::size_t first = *count_field + 1;
    const std::size_t slots = (reader.packet.fields.size() - first) / fields_of_a_condition;
    const auto count = std::min(slots, static_cast<std::size_t>(std::max(0.0, reader.number(*count_field))));
    for (std::size_t slot = 0; slot < count; ++slot) {
        const std::size_t at = first + slot * fields_of_a_condition;
        conditions.push_back({reader.label(at), reader.number(at + 1), symbol_of(reader.label(at + 3)),
                              reader.number(at + 2), reader.number(at + 4) != 0.0});
    }
    return conditions;
}

} // namespace

std::optional<Explanation> explain(const dictionary::Dictionary& dictionary, const Decoded& decoded) {
    const dictionary::Packet& packet = dictionary.packets[decoded.packet];
    if (packet.name != "Explanation" || decoded.value.size() != packet.fields.size()) return std::nullopt;
    const Reader reader{packet, decoded};

    Explanation explanation;
    explanation.decision = reader.label("decision");
    explanation.verdict = reader.label("verdict");
    explanation.subject = subject_of(dictionary, explanation.decision, reader.number("subject"));
    explanation.conditions = conditions_of(reader);

    explanation.text = explanation.decision;
    if (!explanation.subject.empty()) explanation.text += " " + explanation.subject;
    explanation.text += " " + explanation.verdict;
    for (std::size_t i = 0; i < explanation.conditions.size(); ++i)
        explanation.text += (i == 0 ? ": " : "; ") + sentence_of(explanation.conditions[i]);
    return explanation;
}

} // namespace aeolis::telemetry
