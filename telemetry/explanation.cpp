// SPDX-License-Identifier: Apache-2.0
#include "telemetry/explanation.hpp"

#include "dictionaries/state_machine_events.hpp"
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

/// The row of a number in a packet, where there is such a row.
template <typename Rows>
const auto* row_of(const Rows& rows, double number) {
    const bool is_there = number >= 0.0 && number < static_cast<double>(rows.size());
    return is_there ? &rows[static_cast<std::size_t>(number)] : nullptr;
}

/// The name of a numbered row; the number where there is none.
template <typename Rows>
std::string name_in(const Rows& rows, double number) {
    const auto* row = row_of(rows, number);
    return row != nullptr && !row->name.empty() ? row->name : named_value_text("number", number);
}

/// Words as a name: “late cruise”.
std::string quoted(const std::string& name) {
    return "“" + in_words(name) + "”";
}

/// The label of a number in the enumerated fields of that name, "edl_phase"; none where no packet has such a field.
std::optional<std::string> label_in(const dictionary::Dictionary& dictionary, std::string_view name, double number) {
    for (const dictionary::Packet& packet : dictionary.packets) {
        const auto field = field_index(packet, name);
        if (!field || packet.fields[*field].type.kind != dictionary::ValueKind::enumerated) continue;
        return number_text(packet.fields[*field].type, number);
    }
    return std::nullopt;
}

std::string event_in(const dictionary::Dictionary& dictionary, std::string_view machine, double number) {
    for (const dictionary::StateMachineTable& table : dictionary.state_machines) {
        if (table.name != machine) continue;
        const auto events = dictionary::events_of(table);
        if (const std::string* event = row_of(events, number)) return *event;
    }
    return named_value_text("number", number);
}

/// The name that a decision's subject stands for; empty where the decision needs none.
std::string subject_of(const dictionary::Dictionary& dictionary, std::string_view decision, double number) {
    if (decision == "timepoint") return name_in(dictionary.timeline, number);
    if (decision == "tone") return name_in(dictionary.tones, number);
    if (decision == "sub_constraint") return reference_text(dictionary, "constraint", number);
    if (decision == "command") return reference_text(dictionary, "opcode", number);
    if (decision == "device_lost") return label_in(dictionary, "device", number).value_or("");
    if (decision == "bank_reversal") return named_value_text("number", number);
    // "edl_phase", "gnc_mode": the subject is the new value of the field of that name.
    return label_in(dictionary, decision, number).value_or("");
}

/// What a condition names rather than measures, by the ending of its quantity; none for an amount.
std::optional<std::string> named_by(const dictionary::Dictionary& dictionary, std::string_view quantity,
                                    double number) {
    if (quantity.ends_with("_tone"))
        return row_of(dictionary.tones, number) != nullptr ? quoted(name_in(dictionary.tones, number))
                                                           : named_value_text("number", number);
    if (quantity.ends_with("_timepoint")) return name_in(dictionary.timeline, number);
    if (quantity == "staged_parameter") return name_in(dictionary.parameters, number);
    if (quantity == "unsafe_anchor") return name_in(dictionary.anchors, number);
    if (quantity == "previous_mode") return label_in(dictionary, "gnc_mode", number);
    if (quantity == "previous_phase") return label_in(dictionary, "edl_phase", number);
    if (quantity == "mode_event") return event_in(dictionary, "GncMode", number);
    if (quantity == "phase_event") return event_in(dictionary, "EdlPhase", number);
    return std::nullopt;
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

/// Whether a condition compares a fact, which is or is not.
bool is_fact(const Condition& condition) {
    const auto is_bit = [](double value) { return value == 0.0 || value == 1.0; };
    return condition.comparison == "==" && is_bit(condition.value) && is_bit(condition.bound);
}

/// The name by whose ending an explanation's amounts are written: of a parameter's value the parameter's own.
std::string name_of_amount(const dictionary::Dictionary& dictionary, const Explanation& explanation,
                           const std::string& quantity) {
    if (quantity != "parameter_value") return quantity;
    const auto& conditions = explanation.conditions;
    const auto staged = std::ranges::find(conditions, "staged_parameter", &Condition::quantity);
    return staged != conditions.end() ? name_in(dictionary.parameters, staged->value) : quantity;
}

std::string sentence_of(const dictionary::Dictionary& dictionary, const Explanation& explanation,
                        const Condition& condition) {
    const std::string& quantity = condition.quantity;
    if (const auto name = named_by(dictionary, quantity, condition.value))
        return in_words(quantity) + " " + in_words(*name);
    if (is_fact(condition)) return in_words(quantity) + (condition.value != 0.0 ? ": yes" : ": no");
    const std::string amount = name_of_amount(dictionary, explanation, quantity);
    const auto [value, bound] = told_apart(amount, condition.value, condition.bound);
    return in_words(without_unit(quantity)) + " " + value + " " +
           (condition.holds ? condition.comparison : opposite_of(condition.comparison)) + " " + bound;
}

/// All conditions in order; of a decision that was held or refused first the unmet ones, then in brackets the others.
std::string sentences_of(const dictionary::Dictionary& dictionary, const Explanation& explanation) {
    const bool unmet_first = explanation.verdict == "held" || explanation.verdict == "refused";
    std::string text;
    std::string there;
    for (const Condition& condition : explanation.conditions) {
        std::string& into = unmet_first && condition.holds ? there : text;
        into += (into.empty() ? "" : "; ") + sentence_of(dictionary, explanation, condition);
    }
    if (there.empty()) return text;
    return text.empty() ? there : text + " (" + there + ")";
}

/// "parachute deploy decided", "command EDL_DO_EDL refused", "GNC mode changed to range control"
std::string opening_of(const Explanation& explanation) {
    const std::string decision = in_words(explanation.decision);
    if (explanation.subject.empty()) return decision + " " + explanation.verdict;
    const bool mnemonic = explanation.decision == "command";
    const std::string subject = mnemonic                         ? explanation.subject
                                : explanation.decision == "tone" ? quoted(explanation.subject)
                                                                 : in_words(explanation.subject);
    if (explanation.decision == "device_lost") return subject + " taken as lost";
    if (explanation.verdict == "changed") return decision + " changed to " + subject;
    return decision + " " + subject + " " + explanation.verdict;
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

    explanation.text = opening_of(explanation);
    if (!explanation.conditions.empty()) explanation.text += ": " + sentences_of(dictionary, explanation);
    explanation.suppressed = static_cast<std::uint32_t>(std::max(reader.number("suppressed"), 0.0));
    if (explanation.suppressed > 0)
        explanation.text += "; held " + std::to_string(explanation.suppressed) + " cycles untold";
    return explanation;
}

}  // namespace aeolis::telemetry
