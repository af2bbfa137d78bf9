// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/autocoder/cpp_text.hpp"

#include "dictionaries/words.hpp"

#include <array>
#include <cstdio>

namespace aeolis::dictionary::autocoder {
namespace {

std::string integer_type(const Type& type) {
    const bool is_signed = type.encoding == Encoding::twos_complement;
    const unsigned bits = type.bits <= 8 ? 8 : type.bits <= 16 ? 16 : type.bits <= 32 ? 32 : 64;
    return std::string{"std::"} + (is_signed ? "int" : "uint") + std::to_string(bits) + "_t";
}

}  // namespace

std::string made_by_autocoder(const Dictionary& dictionary, std::string_view source) {
    return "// Made by the autocoder from the dictionary of " + dictionary.mission + ". Not to be edited: change " +
           std::string{source} + ".\n";
}

std::string hexadecimal(std::uint64_t value, unsigned digits) {
    std::array<char, 24> text{};
    std::snprintf(text.data(), text.size(), "0x%0*llX", static_cast<int>(digits),
                  static_cast<unsigned long long>(value));
    return text.data();
}

std::string double_literal(double value) {
    std::string text = number_word(value);
    if (text.find_first_of(".e") == std::string::npos) text += ".0";
    return text;
}

std::string optional_literal(const std::optional<double>& value) {
    return value ? double_literal(*value) : "std::nullopt";
}

std::string string_literal(std::string_view text) {
    std::string literal = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') literal += '\\';
        literal += c;
    }
    return literal + '"';
}

std::string camel_case(std::string_view name) {
    std::string camel;
    bool upper = true;
    for (const char c : name) {
        if (c == '_') {
            upper = true;
            continue;
        }
        camel += upper && c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
        upper = false;
    }
    return camel;
}

std::string value_type(const Type& type) {
    if (type.encoding == Encoding::ieee754) return type.bits == 32 ? "float" : "double";
    if (type.kind == ValueKind::enumerated) return camel_case(type.name);
    if (type.kind == ValueKind::boolean) return "bool";
    return integer_type(type);
}

}  // namespace aeolis::dictionary::autocoder
