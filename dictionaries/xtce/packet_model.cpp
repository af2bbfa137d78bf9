// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/xtce/packet_model.hpp"

#include "dictionaries/words.hpp"
#include "dictionaries/xtce/packet_model_reader.hpp"

#include <algorithm>
#include <memory>
#include <string_view>
#include <utility>

namespace aeolis::dictionary::xtce {
namespace {

constexpr unsigned condition_depth_max = 16;  // chosen, so that a hostile file cannot exhaust the stack

std::optional<Condition::Operator> operator_of(std::string_view word) {
    using enum Condition::Operator;
    if (word.empty() || word == "==") return equal;
    if (word == "!=") return not_equal;
    if (word == "<") return less;
    if (word == "<=") return less_or_equal;
    if (word == ">") return greater;
    if (word == ">=") return greater_or_equal;
    return std::nullopt;
}

/// Whether a reference is to a member of the aggregate around it: an extension of Yamcs, under a prefix of its own.
bool is_of_aggregate(pugi::xml_node reference) {
    return std::ranges::any_of(reference.attributes(), [](const pugi::xml_attribute attribute) {
        return std::string_view{attribute.name()}.ends_with(":aggregateMember") && attribute.as_bool();
    });
}

}  // namespace

ModelParts::ModelParts(const Symbols& symbols_in, Reporter& report_in, const ReadAgreement& agreement_in)
    : symbols(symbols_in), report(report_in), agreement(agreement_in) {
    for (const Symbol& symbol : symbols.all())
        if (symbol.kind == Kind::parameter) parameters_.emplace(symbol.path, parameters_.size());
}

/// Whether `path` (".flags/valid", "[2].x") leads to a part of the parameter's type.
bool ModelParts::has_member(const Symbol& parameter, std::string_view path) const {
    const Symbol* type =
        symbols.find(Kind::parameter_type, parameter.scope, parameter.element.attribute("parameterTypeRef").value());
    while (type != nullptr && !path.empty()) {
        if (path.front() == '[') {
            const auto end = path.find(']');
            if (end == std::string_view::npos) return false;
            path.remove_prefix(end + 1);
            type = symbols.find(Kind::parameter_type, type->scope, type->element.attribute("arrayTypeRef").value());
            continue;
        }
        path.remove_prefix(1);  // "." or "/"
        const std::string name{path.substr(0, path.find_first_of("./["))};
        path.remove_prefix(name.size());
        const pugi::xml_node member =
            type->element.child("MemberList").find_child_by_attribute("Member", "name", name.c_str());
        if (!member) return false;
        const char* attribute = member.attribute("typeRef") ? "typeRef" : "parameterTypeRef";
        type = symbols.find(Kind::parameter_type, type->scope, member.attribute(attribute).value());
    }
    return type != nullptr;
}

std::optional<ModelParts::Reference> ModelParts::parameter(const std::string& scope, pugi::xml_node at,
                                                           const char* attribute) const {
    const std::string word = at.attribute(attribute).value();
    const Symbol* symbol = symbols.find(Kind::parameter, scope, word);
    // "STATUS/flags", "STATUS.flags", "LIST[2]": the longest prefix that names a parameter, then its members.
    std::size_t end = word.size();
    while (symbol == nullptr && end > 0 && (end = word.find_last_of("/.[", end - 1)) != std::string::npos && end > 0)
        symbol = symbols.find(Kind::parameter, scope, std::string_view{word}.substr(0, end));
    if (symbol == nullptr || (end < word.size() && !has_member(*symbol, std::string_view{word}.substr(end)))) {
        report.fault(at, "there is no parameter " + in_quotes(word));
        return std::nullopt;
    }
    const auto instance = at.attribute("instance").as_int(0);
    if (instance != 0) {
        report.fault(at, "instance " + std::to_string(instance) + " of " + in_quotes(word) +
                             ", a value of another packet, is not supported");
        return std::nullopt;
    }
    std::string member = word.substr(end);
    std::ranges::replace(member, '/', '.');
    return Reference{parameters_.at(symbol->path), std::move(member)};
}

Condition ModelParts::comparison(const std::string& scope, pugi::xml_node element) const {
    Condition condition{.form = Condition::Form::unknown};
    const auto found = parameter(scope, element, "parameterRef");
    const auto op = operator_of(element.attribute("comparisonOperator").value());
    if (!op)
        report.fault(element, "operator " + in_quotes(element.attribute("comparisonOperator").value()) + " is unknown");
    if (!found || !op) return condition;
    condition.form = Condition::Form::compare;
    condition.parameter = found->parameter;
    condition.member = found->member;
    condition.op = *op;
    condition.calibrated = element.attribute("useCalibratedValue").as_bool(true);
    condition.value = element.attribute("value").value();
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
    const auto op = operator_of(element.child("ComparisonOperator").text().as_string());
    if (!op) report.fault(element, "its operator is unknown");
    if (!found || !op) return condition;
    condition.form = Condition::Form::compare;
    condition.parameter = found->parameter;
    condition.member = found->member;
    condition.op = *op;
    condition.calibrated = reference.attribute("useCalibratedValue").as_bool(true);
    condition.value = element.child("Value").text().as_string();
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

Amount ModelParts::amount(const std::string& scope, pugi::xml_node parent) const {
    Amount unknown;
    unknown.known = false;
    pugi::xml_node fixed = parent.child("FixedValue");
    if (!fixed) fixed = parent.child("Fixed").child("FixedValue");
    if (fixed) {
        const auto value = to_number(fixed.text().as_string());
        if (value) return Amount::fixed(*value);
        report.fault(fixed, in_quotes(fixed.text().as_string()) + " is not a number");
        return unknown;
    }
    if (const pugi::xml_node dynamic = parent.child("DynamicValue")) {
        const pugi::xml_node reference = dynamic.child("ParameterInstanceRef");
        const pugi::xml_node line = dynamic.child("LinearAdjustment");
        Amount amount;
        if (is_of_aggregate(reference)) {
            amount.sibling = reference.attribute("parameterRef").value();
            std::ranges::replace(amount.sibling, '/', '.');
        } else {
            const auto found = parameter(scope, reference, "parameterRef");
            if (!found) return unknown;
            amount.parameter = found->parameter;
            amount.member = found->member;
        }
        amount.calibrated = reference.attribute("useCalibratedValue").as_bool(true);
        amount.slope = line.attribute("slope").as_double(1.0);
        amount.intercept = line.attribute("intercept").as_double(0.0);
        return amount;
    }
    if (const pugi::xml_node list = parent.child("DiscreteLookupList")) {
        Amount amount;
        for (const pugi::xml_node each : list.children("DiscreteLookup"))
            amount.cases.push_back({condition(scope, each), each.attribute("value").as_double()});
        return amount;
    }
    report.fault(parent, std::string{parent.name()} + " says no number that is supported");
    return unknown;
}

std::vector<Amount> read_last_indices(const ModelParts& parts, const std::string& scope, pugi::xml_node list) {
    std::vector<Amount> last;
    for (const pugi::xml_node dimension : list.children("Dimension")) {
        last.push_back(parts.amount(scope, dimension.child("EndingIndex")));
        const pugi::xml_node start = dimension.child("StartingIndex");
        if (!start || std::string_view{start.child("FixedValue").text().as_string()} == "0") continue;
        parts.report.fault(start, "an array that does not begin at 0 is not supported: packets are read up to it");
        last.back().known = false;
    }
    return last;
}

PacketModel read_model(const std::string& name, const ModelParts& parts, ModelTypes& types) {
    PacketModel model;
    model.name = name;
    for (const Symbol& symbol : parts.symbols.all())
        if (symbol.kind == Kind::parameter)
            model.parameters.push_back(
                {name_of(symbol.element), symbol.path, types.of(symbol.scope, symbol.element, "parameterTypeRef"),
                 parts.condition(symbol.scope, symbol.element.child("ParameterProperties").child("ValidityCondition")),
                 parts.report.line(symbol.element)});
    model.containers = read_model_containers(parts);
    model.types = std::move(types.types);
    return model;
}

namespace {

/// @param findings  of each document
PacketModel model_of(const std::vector<const Document*>& documents, const std::vector<Findings*>& findings,
                     const ReadAgreement& agreement) {
    Reporter report{*documents.front(), *findings.front()};
    for (std::size_t i = 1; i < documents.size(); ++i) report.add(*documents[i], *findings[i]);
    const Symbols symbols{documents, report, Symbols::Names::any};
    const ModelParts parts{symbols, report, agreement};
    ModelTypes types{parts};
    return read_model(name_of(documents.front()->space_system()), parts, types);
}

}  // namespace

std::optional<PacketModel> read_packet_model(const std::string& text, Findings& findings) {
    const auto document = Document::parse(text, findings);
    if (!document) return std::nullopt;
    return model_of({document.get()}, {&findings}, {});
}

std::optional<PacketModel> read_packet_model(const std::vector<XtceText>& texts, std::vector<Finding>& findings,
                                             const ReadAgreement& agreement) {
    std::vector<std::unique_ptr<Document>> documents;
    std::vector<Findings> of_each;
    of_each.reserve(texts.size());
    for (const XtceText& text : texts) {
        auto document = Document::parse(text.text, of_each.emplace_back(text.file, findings));
        if (!document) return std::nullopt;
        documents.push_back(std::move(document));
    }
    if (documents.empty()) return std::nullopt;
    std::vector<const Document*> parsed;
    std::vector<Findings*> into;
    for (std::size_t i = 0; i < documents.size(); ++i) {
        parsed.push_back(documents[i].get());
        into.push_back(&of_each[i]);
    }
    return model_of(parsed, into, agreement);
}

}  // namespace aeolis::dictionary::xtce
