// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/xtce/packet_model.hpp"

#include "dictionaries/words.hpp"
#include "dictionaries/xtce/packet_grammar.hpp"
#include "dictionaries/xtce/packet_model_reader.hpp"

#include <algorithm>
#include <limits>
#include <memory>
#include <set>
#include <string_view>
#include <utility>

namespace aeolis::dictionary::xtce {
namespace {

constexpr int instance_max = std::numeric_limits<int>::max();

/// Whether a reference is to a member of the aggregate around it: an extension of Yamcs, under a prefix of its own.
std::optional<bool> is_of_aggregate(pugi::xml_node reference, Reporter& report) {
    for (const pugi::xml_attribute attribute : reference.attributes())
        if (std::string_view{attribute.name()}.ends_with(":aggregateMember"))
            return report.flag_or(reference, attribute.name(), false);
    return false;
}

}  // namespace

ModelParts::ModelParts(const Symbols& symbols_in, Reporter& report_in, const ReadAgreement& agreement_in)
    : symbols(symbols_in), report(report_in), agreement(agreement_in) {
    for (const Symbol& symbol : symbols.all())
        if (symbol.kind == Kind::parameter) parameters_.emplace(symbol.path, parameters_.size());
}

/// The type at `path` (".flags/valid", "[2].x") of a parameter; null: there is no such part, or no such type.
const Symbol* ModelParts::type_at(const Symbol& parameter, std::string_view path) const {
    const Symbol* type =
        symbols.find(Kind::parameter_type, parameter.scope, parameter.element.attribute("parameterTypeRef").value());
    while (type != nullptr && !path.empty()) {
        if (path.front() == '[') {
            const auto end = path.find(']');
            if (end == std::string_view::npos) return nullptr;
            path.remove_prefix(end + 1);
            type = symbols.find(Kind::parameter_type, type->scope, type->element.attribute("arrayTypeRef").value());
            continue;
        }
        path.remove_prefix(1);  // "." or "/"
        const std::string name{path.substr(0, path.find_first_of("./["))};
        path.remove_prefix(name.size());
        const pugi::xml_node member =
            type->element.child("MemberList").find_child_by_attribute("Member", "name", name.c_str());
        if (!member) return nullptr;
        const char* attribute = member.attribute("typeRef") ? "typeRef" : "parameterTypeRef";
        type = symbols.find(Kind::parameter_type, type->scope, member.attribute(attribute).value());
    }
    return type;
}

std::optional<ModelParts::Reference> ModelParts::parameter(const std::string& scope, pugi::xml_node at,
                                                           const char* attribute) const {
    const std::string word = at.attribute(attribute).value();
    const Symbol* symbol = symbols.find(Kind::parameter, scope, word);
    // "STATUS/flags", "STATUS.flags", "LIST[2]": the longest prefix that names a parameter, then its members.
    std::size_t end = word.size();
    while (symbol == nullptr && end > 0 && (end = word.find_last_of("/.[", end - 1)) != std::string::npos && end > 0)
        symbol = symbols.find(Kind::parameter, scope, std::string_view{word}.substr(0, end));
    const Symbol* type =
        symbol == nullptr ? nullptr : type_at(*symbol, std::string_view{word}.substr(std::min(end, word.size())));
    if (symbol == nullptr || (end < word.size() && type == nullptr)) {
        report.fault(at, "there is no parameter " + in_quotes(word));
        return std::nullopt;
    }
    const auto instance = report.integer_or(at, "instance", 0, std::numeric_limits<int>::min(), instance_max);
    if (!instance) return std::nullopt;
    if (*instance != 0) {
        report.fault(at, "instance " + std::to_string(*instance) + " of " + in_quotes(word) +
                             ", a value of another packet, is not supported");
        return std::nullopt;
    }
    std::string member = word.substr(end);
    std::ranges::replace(member, '/', '.');
    return Reference{parameters_.at(symbol->path), std::move(member), type};
}

Amount ModelParts::amount(const std::string& scope, pugi::xml_node parent) const {
    Amount unknown;
    unknown.known = false;
    pugi::xml_node fixed = parent.child("FixedValue");
    if (!fixed) fixed = parent.child("Fixed").child("FixedValue");
    if (fixed) {
        const auto value = to_number(number_digits(fixed.text().as_string()));
        if (value) return Amount::fixed(*value);
        report.fault(fixed, in_quotes(fixed.text().as_string()) + " is not a number");
        return unknown;
    }
    if (const pugi::xml_node dynamic = parent.child("DynamicValue")) {
        const pugi::xml_node reference = dynamic.child("ParameterInstanceRef");
        const pugi::xml_node line = dynamic.child("LinearAdjustment");
        Amount amount;
        const auto of_aggregate = is_of_aggregate(reference, report);
        if (!of_aggregate) return unknown;
        if (*of_aggregate) {
            amount.sibling = reference.attribute("parameterRef").value();
            std::ranges::replace(amount.sibling, '/', '.');
        } else {
            const auto found = parameter(scope, reference, "parameterRef");
            if (!found) return unknown;
            amount.parameter = found->parameter;
            amount.member = found->member;
        }
        const auto calibrated = report.flag_or(reference, "useCalibratedValue", true);
        const auto slope = report.number_or(line, "slope", 1.0);
        const auto intercept = report.number_or(line, "intercept", 0.0);
        if (!calibrated || !slope || !intercept) return unknown;
        amount.calibrated = *calibrated;
        amount.slope = *slope;
        amount.intercept = *intercept;
        return amount;
    }
    if (const pugi::xml_node list = parent.child("DiscreteLookupList")) {
        Amount amount;
        for (const pugi::xml_node each : list.children("DiscreteLookup")) {
            const auto value = report.number_or(each, "value", std::nullopt);
            amount.known = amount.known && value;
            amount.cases.push_back({condition(scope, each), value.value_or(0.0)});
        }
        if (list.attribute("defaultValue")) {
            const auto otherwise = report.number_or(list, "defaultValue", std::nullopt);
            amount.known = amount.known && otherwise;
            amount.cases.push_back({{}, otherwise.value_or(0.0)});
        }
        if (amount.cases.empty()) report.fault(list, "DiscreteLookupList has no DiscreteLookup");
        return amount.cases.empty() ? unknown : amount;
    }
    report.fault(parent, std::string{parent.name()} + " says no number that is supported");
    return unknown;
}

std::vector<Amount> read_last_indices(const ModelParts& parts, const std::string& scope, pugi::xml_node list) {
    std::vector<Amount> last;
    for (const pugi::xml_node dimension : list.children("Dimension")) {
        last.push_back(parts.amount(scope, dimension.child("EndingIndex")));
        const pugi::xml_node start = dimension.child("StartingIndex");
        if (!start || to_integer(number_digits(start.child("FixedValue").text().as_string())) == 0) continue;
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
    model.containers = read_model_containers(parts, model.parameters, types.types);
    model.types = std::move(types.types);
    return model;
}

namespace {

/// Whether a name is, or begins like, a member or an element of a composite with one of `names`: "STATUS.flags".
bool is_within(const std::string& name, const std::set<std::string>& names) {
    for (auto end = name.find_first_of("./["); end != std::string::npos; end = name.find_first_of("./[", end + 1))
        if (names.contains(name.substr(0, end))) return true;
    return false;
}

// Chosen, so that a hostile file cannot exhaust stack or time: packets are decoded no deeper either.
constexpr unsigned container_depth_max = 64;
constexpr std::size_t containers_max = 256;

/// Adds the parameters of a container, of those that it derives from and of those within it.
void add_parameters(const PacketModel& model, std::size_t container, unsigned depth, std::set<std::size_t>& seen,
                    std::set<std::size_t>& parameters) {
    if (depth == container_depth_max || seen.size() == containers_max || !seen.insert(container).second) return;
    const PacketContainer& of = model.containers[container];
    if (of.base) add_parameters(model, *of.base, depth + 1, seen, parameters);
    for (const PacketEntry& entry : of.entries) {
        if (entry.what == PacketEntry::What::parameter) parameters.insert(entry.index);
        if (entry.what == PacketEntry::What::container) add_parameters(model, entry.index, depth + 1, seen, parameters);
    }
}

/// Qualifies names that several containers, or several parameters of a packet, have: the first of the file keeps its
/// own, others are called by their path. A name that comes in different packets is left: there it is clear.
void make_names_unique(PacketModel& model) {
    std::set<std::string> containers, composite;
    for (PacketContainer& container : model.containers)
        if (!containers.insert(container.name).second) container.name = container.path.substr(1);
    for (const PacketParameter& parameter : model.parameters) {
        const auto kind = model.types[parameter.type].kind;
        if (kind == PacketType::Kind::aggregate || kind == PacketType::Kind::array) composite.insert(parameter.name);
    }
    std::set<std::size_t> by_path;
    for (std::size_t i = 0; i < model.containers.size(); ++i) {
        std::set<std::size_t> seen, parameters;
        add_parameters(model, i, 0, seen, parameters);
        std::set<std::string> taken;
        for (const std::size_t each : parameters) {
            const std::string& name = model.parameters[each].name;
            if (is_within(name, composite) || !taken.insert(name).second) by_path.insert(each);
        }
    }
    for (const std::size_t each : by_path) model.parameters[each].name = model.parameters[each].path.substr(1);
}

/// @param findings  of each document
PacketModel model_of(const std::vector<const Document*>& documents, const std::vector<Findings*>& findings,
                     const ReadAgreement& agreement) {
    Reporter report{*documents.front(), *findings.front()};
    for (std::size_t i = 1; i < documents.size(); ++i) report.add(*documents[i], *findings[i]);
    const Symbols symbols{documents, report, Symbols::Names::any};
    for (const Document* document : documents) check_grammar(*document, report);
    const ModelParts parts{symbols, report, agreement};
    ModelTypes types{parts};
    PacketModel model = read_model(name_of(documents.front()->space_system()), parts, types);
    make_names_unique(model);
    return model;
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
