// SPDX-License-Identifier: Apache-2.0
#include "telemetry/explanation.hpp"

#include "telemetry/text.hpp"

#include <algorithm>

namespace aeolis::telemetry {
namespace {

constexpr std::size_t slots = 4;

/// Fields of the packet by name; a field that the dictionary lacks is empty or zero.
struct Reader {
    const dictionary::Packet& packet;
    const Decoded& decoded;

    std::string label(std::string_view name) const {
        const auto field = field_index(packet, name);
        return field ? number_text(packet.fields[*field].type, decoded.value[*field]) : std::string{};
    }
    double number(std::string_view name) const {
        const auto field = field_index(packet, name);
        return field ? decoded.value[*field].value_or(0.0) : 0.0;
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

std::string subject_of(const dictionary::Dictionary& dictionary, const std::string& decision, double number) {
    if (decision == "timepoint" || decision == "tone") return reference_text(dictionary, decision, number);
    if (decision == "sub_constraint") return reference_text(dictionary, "constraint", number);
    if (decision == "command" || decision == "do_edl" || decision == "set_parameters")
        return reference_text(dictionary, "opcode", number);
    if (decision == "bank_reversal") return std::to_string(static_cast<unsigned>(number));
    // "edl_phase", "gnc_mode": the subject is the new value of the channel of that name.
    const dictionary::Channel* channel = dictionary.channel(decision);
    return channel != nullptr ? number_text(channel->type, number) : std::string{};
}

/// The opposite of a condition that does not hold: of "<= 405.0", "> 405.0".
std::string opposite_of(const std::string& symbol) {
    if (symbol == "<") return ">=";
    if (symbol == "<=") return ">";
    if (symbol == "==") return "!=";
    if (symbol == ">=") return "<";
    if (symbol == ">") return "<=";
    return "not " + symbol;
}

/// Whether the quantity is a tone's number, whose name is added: "overtaking_tone 50 radar_lock".
bool names_a_tone(const std::string& quantity) {
    return quantity.ends_with("_tone");
}

std::string sentence_of(const dictionary::Dictionary& dictionary, const Condition& condition) {
    if (names_a_tone(condition.quantity))
        return condition.quantity + " " + reference_text(dictionary, "tone", condition.value);
    return std::string{without_unit(condition.quantity)} + " " + named_value_text(condition.quantity, condition.value) +
           " " + (condition.holds ? condition.comparison : opposite_of(condition.comparison)) + " " +
           named_value_text(condition.quantity, condition.bound);
}

/// All conditions in order; of a held decision first the unmet ones, then in brackets the met ones.
std::string sentences_of(const dictionary::Dictionary& dictionary, const Explanation& explanation) {
    const bool held = explanation.verdict == "held";
    std::string text;
    std::string there;
    for (const Condition& condition : explanation.conditions) {
        std::string& into = held && condition.holds ? there : text;
        into += (into.empty() ? "" : "; ") + sentence_of(dictionary, condition);
    }
    if (there.empty()) return text;
    return text.empty() ? there : text + " (" + there + ")";
}

std::vector<Condition> conditions_of(const Reader& reader) {
    std::vector<Condition> conditions;
    const auto count = static_cast<std::size_t>(std::clamp(reader.number("condition_count"), 0.0, double{slots}));
    for (std::size_t slot = 1; slot <= count; ++slot) {
        const std::string ending = "_" + std::to_string(slot);
        conditions.push_back({reader.label("condition" + ending), reader.number("value" + ending),
                              symbol_of(reader.label("comparison" + ending)), reader.number("bound" + ending),
                              reader.number("holds" + ending) != 0.0});
    }
    return conditions;
}

}  // namespace

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
    if (!explanation.conditions.empty()) explanation.text += ": " + sentences_of(dictionary, explanation);
    explanation.suppressed = static_cast<std::uint32_t>(std::max(reader.number("suppressed"), 0.0));
    if (explanation.suppressed > 0)
        explanation.text += "; held " + std::to_string(explanation.suppressed) + " more cycles since last told";
    return explanation;
}

}  // namespace aeolis::telemetry
