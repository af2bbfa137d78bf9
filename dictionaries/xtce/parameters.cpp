// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/xtce/parameters.hpp"

#include "dictionaries/words.hpp"

#include <algorithm>
#include <array>

namespace aeolis::dictionary::xtce {
namespace {

constexpr std::size_t channels_max = 4096;  // chosen
constexpr std::array comparisons{"==", "!=", "<", "<=", ">", ">="};

/// Value of a label of the parameter's enumeration, or of a number.
std::optional<double> value_of(const Parameter& parameter, const std::string& word) {
    if (parameter.type)
        for (const EnumValue& entry : parameter.type->enumeration)
            if (entry.label == word) return static_cast<double>(entry.value);
    return to_number(word);
}

std::string text_of(const Parameter& parameter, const Precondition& condition, const std::string& word) {
    const std::string what = parameter.element.attribute("shortDescription").as_string(parameter.name.c_str());
    const bool is_flag = parameter.type && parameter.type->kind == ValueKind::boolean;
    if (!is_flag) return what + " must be " + condition.comparison + " " + word;
    const bool wanted = (condition.value != 0.0) == (condition.comparison == "==");
    return what + " must be " + (wanted ? "true" : "false");
}

std::string channel_alias(pugi::xml_node parameter, Reporter& report) {
    const pugi::xml_node set = parameter.child("AliasSet");
    report.expect(set, {"Alias"}, {});
    std::string channel;
    for (const pugi::xml_node alias : set.children("Alias")) {
        report.expect(alias, {}, {"nameSpace", "alias"});
        if (std::string_view{alias.attribute("nameSpace").value()} == "channel")
            channel = alias.attribute("alias").value();
    }
    return channel;
}

/// Path of the flag in the ValidityCondition, empty when there is none or it is wrong.
std::string validity_flag(const Symbols& symbols, const Symbol& symbol, Reporter& report) {
    const pugi::xml_node properties = symbol.element.child("ParameterProperties");
    report.expect(properties, {"ValidityCondition"}, {});
    const pugi::xml_node condition = properties.child("ValidityCondition");
    if (!condition) return {};
    report.expect(condition, {"Comparison"}, {});
    const pugi::xml_node comparison = condition.child("Comparison");
    report.expect(comparison, {}, {"parameterRef", "value", "comparisonOperator", "useCalibratedValue"});
    if (std::string_view{comparison.attribute("value").value()} != "1" ||
        std::string_view{comparison.attribute("comparisonOperator").as_string("==")} != "==") {
        report.fault(condition, "parameter " + in_quotes(name_of(symbol.element)) +
                                    ": a validity condition other than a flag == 1 is not supported");
        return {};
    }
    const std::string reference = comparison.attribute("parameterRef").value();
    const Symbol* flag = symbols.find(Kind::parameter, symbol.scope, reference);
    if (flag != nullptr) return flag->path;
    report.fault(comparison, "there is no parameter " + in_quotes(reference));
    return {};
}

class Channels {
  public:
    Channels(Parameters& parameters, Reporter& report) : parameters_(parameters), report_(report) {}

    void add(Parameter& parameter, const std::string& alias) {
        unique(names_, parameter.name, parameter.element, "channel");
        unique(names_, alias, parameter.element, "channel alias");
        if (parameters_.channels.size() == channels_max)
            report_.fault(parameter.element, "more than " + std::to_string(channels_max) + " channels");
        if (parameters_.channels.size() >= channels_max) return;
        const ChannelId id{static_cast<std::uint16_t>(parameters_.channels.size())};
        parameter.channel = id;
        parameters_.channels.push_back({id, parameter.name, alias,
                                        parameter.element.attribute("shortDescription").value(),
                                        parameter.type.value_or(Type{})});
        parameters_.channel_elements.push_back(parameter.element);
    }

  private:
    void unique(std::map<std::string, unsigned>& seen, const std::string& name, pugi::xml_node element,
                const char* what) {
        const auto [first, added] = seen.emplace(name, report_.line(element));
        if (!added)
            report_.fault(element, std::string{what} + " " + in_quotes(name) + " is there twice, first in line " +
                                       std::to_string(first->second));
    }

    Parameters& parameters_;
    Reporter& report_;
    std::map<std::string, unsigned> names_;
};

}  // namespace

std::optional<Precondition> read_comparison(const Symbols& symbols, const Parameters& parameters,
                                            const std::string& scope, pugi::xml_node comparison, const std::string& of,
                                            Reporter& report) {
    report.expect(comparison, {}, {"parameterRef", "value", "comparisonOperator", "useCalibratedValue"});
    const auto fault = [&](const std::string& message) {
        report.fault(comparison, of + ": " + message);
        return std::nullopt;
    };
    const std::string reference = comparison.attribute("parameterRef").value();
    const Symbol* found = symbols.find(Kind::parameter, scope, reference);
    if (found == nullptr) return fault("there is no parameter " + in_quotes(reference));
    const Parameter& parameter = parameters.by_path.at(found->path);
    if (!parameter.channel) return fault(in_quotes(reference) + " is no channel: its value is not known");
    Precondition condition{*parameter.channel, comparison.attribute("comparisonOperator").as_string("=="), 0.0, {}};
    if (std::ranges::find(comparisons, condition.comparison) == comparisons.end())
        return fault("comparison " + in_quotes(condition.comparison) + " is unknown");
    if (!parameter.type) return std::nullopt;  // already reported
    const std::string word = comparison.attribute("value").value();
    const auto value = value_of(parameter, word);
    if (!value) return fault("value " + in_quotes(word) + " is neither a number nor a label");
    condition.value = *value;
    condition.text = text_of(parameter, condition, word);
    return condition;
}

Parameters read_parameters(const Symbols& symbols, const Types& types, Reporter& report) {
    Parameters parameters;
    Channels channels{parameters, report};
    for (const Symbol& symbol : symbols.all()) {
        if (symbol.kind != Kind::parameter) continue;
        report.expect(symbol.element, {"LongDescription", "AliasSet", "ParameterProperties"},
                      {"name", "shortDescription", "parameterTypeRef"});
        Parameter parameter;
        parameter.name = name_of(symbol.element);
        parameter.path = symbol.path;
        parameter.element = symbol.element;
        if (const auto why = unusable_as_identifier(parameter.name))
            report.fault(symbol.element, "parameter " + in_quotes(parameter.name) + " " + *why);
        parameter.type = types.of(Kind::parameter_type, symbol.scope, symbol.element, "parameterTypeRef", report);
        parameter.valid_by = validity_flag(symbols, symbol, report);
        const std::string alias = channel_alias(symbol.element, report);
        if (!alias.empty() && parameter.type && parameter.type->binary)
            report.fault(symbol.element, "parameter " + in_quotes(parameter.name) + ": binary data are no channel");
        else if (!alias.empty())
            channels.add(parameter, alias);
        parameters.by_path.emplace(symbol.path, std::move(parameter));
    }
    return parameters;
}

}  // namespace aeolis::dictionary::xtce
