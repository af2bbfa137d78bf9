// SPDX-License-Identifier: Apache-2.0
// Numbers and flags of elements: what is not one is a finding and never a number.
#include "dictionaries/words.hpp"
#include "dictionaries/xtce/document.hpp"

namespace aeolis::dictionary::xtce {

std::string_view number_digits(std::string_view word) {
    word = trimmed(word);
    const bool is_sign = word.size() > 1 && word[0] == '+' && (word[1] == '.' || (word[1] >= '0' && word[1] <= '9'));
    return is_sign ? word.substr(1) : word;
}

std::optional<double> Reporter::number_or(pugi::xml_node element, const char* attribute,
                                          std::optional<double> otherwise) {
    const pugi::xml_attribute found = element.attribute(attribute);
    if (!found && otherwise) return otherwise;
    const auto value = to_number(number_digits(found.value()));
    if (!found)
        fault(element, std::string{element.name()} + " has no " + attribute);
    else if (!value)
        fault(element, std::string{attribute} + " " + in_quotes(found.value()) + " is not a number");
    return value;
}

std::optional<std::int64_t> Reporter::integer_or(pugi::xml_node element, const char* attribute,
                                                 std::optional<std::int64_t> otherwise, std::int64_t min,
                                                 std::int64_t max) {
    const pugi::xml_attribute found = element.attribute(attribute);
    if (!found && otherwise) return otherwise;
    const auto value = to_integer(number_digits(found.value()));
    if (value && *value >= min && *value <= max) return value;
    if (!found)
        fault(element, std::string{element.name()} + " has no " + attribute);
    else
        fault(element, std::string{attribute} + " " + in_quotes(found.value()) + " is not a whole number from " +
                           std::to_string(min) + " to " + std::to_string(max));
    return std::nullopt;
}

std::optional<bool> Reporter::flag_or(pugi::xml_node element, const char* attribute, bool otherwise) {
    const pugi::xml_attribute found = element.attribute(attribute);
    if (!found) return otherwise;
    const std::string_view word = trimmed(found.value());
    if (word == "true" || word == "1") return true;
    if (word == "false" || word == "0") return false;
    fault(element, std::string{attribute} + " " + in_quotes(found.value()) + " is neither true nor false");
    return std::nullopt;
}

}  // namespace aeolis::dictionary::xtce
