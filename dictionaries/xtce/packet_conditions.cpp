// SPDX-License-Identifier: Apache-2.0
// Conditions of any mission. One that cannot be judged is a finding, and unknown.
#include "dictionaries/words.hpp"
#include "dictionaries/xtce/packet_model_reader.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

namespace aeolis::dictionary::xtce {
namespace {

constexpr unsigned condition_depth_max = 16;  // chosen, so that a hostile file cannot exhaust the stack
constexpr unsigned base_types_max = 16;       // as of types

std::optional<Condition::Operator> operator_of(std::string_view word) {
    using enum Condition::Operator;
    word = trimmed(word);
    if (word == "==") return equal;
    if (word == "!=") return not_equal;
    if (word == "<") return less;
    if (word == "<=") return less_or_equal;
    if (word == ">") return greater;
    if (word == ">=") return greater_or_equal;
    return std::nullopt;
}

bool reads_as_number(std::string_view word) {
    return to_integer(number_digits(word)) || to_number(number_digits(word));
}

/// Whether a type, or one that it is based on, calls a value so.
bool has_label(const Symbols& symbols, const Symbol* type, std::string_view word) {
    bool zero = false, one = false;
    for (unsigned depth = 0; type != nullptr && depth < base_types_max; ++depth) {
        const pugi::xml_node element = type->element;
        for (const pugi::xml_node each : element.child("EnumerationList").children("Enumeration"))
            if (word == each.attribute("label").value() && to_integer(number_digits(each.attribute("value").value())))
                return true;
        const pugi::xml_attribute zero_word = element.attribute("zeroStringValue");
        const pugi::xml_attribute one_word = element.attribute("oneStringValue");
        if ((!zero && zero_word && word == zero_word.value()) || (!one && one_word && word == one_word.value()))
            return true;
        zero = zero || zero_word;
        one = one || one_word;
        const bool is_boolean = std::string_view{element.name()}.starts_with("Boolean");
        const pugi::xml_attribute base = element.attribute("baseType");
        if (!base) return is_boolean && ((!zero && word == "False") || (!one && word == "True"));
        type = symbols.find(Kind::parameter_type, type->scope, base.value());
    }
    return false;
}

}  // namespace

/// Completes a comparison by the value that is asked for. One that the parameter's type can never be compared with
/// leaves it unknown.
void ModelParts::compare_with(std::string_view word, const Reference& with, pugi::xml_node at,
                              Condition& condition) const {
    condition.parameter = with.parameter;
    condition.member = with.member;
    const std::string_view kind = with.type == nullptr ? "" : with.type->element.name();
    const bool is_text = kind.starts_with("String");
    condition.value = is_text ? word : trimmed(word);
    const auto refuse = [&](const std::string& why) { report.fault(at, why + ": whether it holds is not known"); };
    if (kind.starts_with("Aggregate") || kind.starts_with("Array") || kind.starts_with("Binary"))
        return refuse("a comparison with " + std::string{kind} + " " + in_quotes(name_of(with.type->element)) +
                      " is not supported");
    const bool labelled = kind.starts_with("Enumerated") || kind.starts_with("Boolean");
    condition.by_label = labelled && condition.calibrated && has_label(symbols, with.type, condition.value);
    const bool has_order = condition.op != Condition::Operator::equal && condition.op != Condition::Operator::not_equal;
    if (condition.by_label && has_order) return refuse("labels have no order");
    if (!kind.empty() && !is_text && !condition.by_label && !reads_as_number(condition.value))
        return refuse("it compares with " + in_quotes(condition.value) + ", which is neither a number nor a label of " +
                      in_quotes(name_of(with.type->element)));
    if (!is_text && !condition.by_label) condition.value = number_digits(condition.value);
    condition.form = Condition::Form::compare;
}

Condition ModelParts::comparison(const std::string& scope, pugi::xml_node element) const {
    Condition condition{.form = Condition::Form::unknown};
    const auto found = parameter(scope, element, "parameterRef");
    const auto op = operator_of(element.attribute("comparisonOperator").as_string("=="));
    if (!op)
        report.fault(element, "operator " + in_quotes(element.attribute("comparisonOperator").value()) + " is unknown");
    const auto calibrated = report.flag_or(element, "useCalibratedValue", true);
    if (!element.attribute("value")) report.fault(element, "it has no value");
    if (!found || !op || !calibrated || !element.attribute("value")) return condition;
    condition.op = *op;
    condition.calibrated = *calibrated;
    compare_with(element.attribute("value").value(), *found, element, condition);
    return condition;
}

/// Condition of a BooleanExpression: a parameter, an operator, a value.
Condition ModelParts::condition_element(const std::string& scope, pugi::xml_node element) const {
    Condition condition{.form = Condition::Form::unknown};
    const pugi::xml_node reference = element.child("ParameterInstanceRef");
    if (!element.child("Value") || reference.next_sibling("ParameterInstanceRef")) {
        report.fault(element, "a comparison of two parameters is not supported");
        return condition;
    }
    const auto found = parameter(scope, reference, "parameterRef");
    const pugi::xml_node op_element = element.child("ComparisonOperator");
    const auto op = operator_of(op_element ? op_element.text().as_string() : "==");
    if (!op) report.fault(element, "its operator is unknown");
    const auto calibrated = report.flag_or(reference, "useCalibratedValue", true);
    if (!found || !op || !calibrated) return condition;
    condition.op = *op;
    condition.calibrated = *calibrated;
    compare_with(element.child("Value").text().as_string(), *found, element, condition);
    return condition;
}

Condition ModelParts::part(const std::string& scope, pugi::xml_node element, unsigned depth) const {
    const std::string_view name = element.name();
    if (name == "Comparison") return comparison(scope, element);
    if (name == "Condition") return condition_element(scope, element);
    const bool any = name == "ORedConditions";
    if (!any && name != "ANDedConditions" && name != "ComparisonList" && name != "BooleanExpression") {
        report.fault(element, std::string{name} + " is not supported as a condition: whether it holds is not known");
        return {.form = Condition::Form::unknown};
    }
    if (depth == condition_depth_max) {
        report.fault(element, "conditions are nested deeper than " + std::to_string(condition_depth_max));
        return {.form = Condition::Form::unknown};
    }
    Condition condition{.form = any ? Condition::Form::any : Condition::Form::all};
    for (const pugi::xml_node child : element.children())
        if (child.type() == pugi::node_element) condition.parts.push_back(part(scope, child, depth + 1));
    if (condition.parts.empty()) return {};  // an empty list restricts nothing
    return condition;
}

Condition ModelParts::condition(const std::string& scope, pugi::xml_node parent) const {
    Condition found;
    bool one = false;
    for (const pugi::xml_node child : parent.children()) {
        if (child.type() != pugi::node_element) continue;
        // It says which container follows, and restricts nothing.
        if (one && std::string_view{child.name()} == "NextContainer") {
            report.fault(child, "NextContainer beside another condition is not supported: it is left out");
            continue;
        }
        if (std::exchange(one, true)) {
            report.fault(child, std::string{child.name()} +
                                    " beside another condition is not supported: whether they hold is not known");
            return {.form = Condition::Form::unknown};
        }
        found = part(scope, child, 0);
    }
    return found;
}

}  // namespace aeolis::dictionary::xtce
