// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/words.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace aeolis::dictionary {
namespace {

// C++20's keywords and alternative operators, sorted.
constexpr std::array keywords = std::to_array<std::string_view>(
    {"alignas",     "alignof",  "and",        "and_eq",    "asm",       "auto",         "bitand",
     "bitor",       "bool",     "break",      "case",      "catch",     "char",         "char16_t",
     "char32_t",    "char8_t",  "class",      "co_await",  "co_return", "co_yield",     "compl",
     "concept",     "const",    "const_cast", "consteval", "constexpr", "constinit",    "continue",
     "decltype",    "default",  "delete",     "do",        "double",    "dynamic_cast", "else",
     "enum",        "explicit", "export",     "extern",    "false",     "float",        "for",
     "friend",      "goto",     "if",         "inline",    "int",       "long",         "mutable",
     "namespace",   "new",      "noexcept",   "not",       "not_eq",    "nullptr",      "operator",
     "or",          "or_eq",    "private",    "protected", "public",    "register",     "reinterpret_cast",
     "requires",    "return",   "short",      "signed",    "sizeof",    "static",       "static_assert",
     "static_cast", "struct",   "switch",     "template",  "this",      "thread_local", "throw",
     "true",        "try",      "typedef",    "typeid",    "typename",  "union",        "unsigned",
     "using",       "virtual",  "void",       "volatile",  "wchar_t",   "while",        "xor",
     "xor_eq"});

constexpr bool is_letter(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}
constexpr bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

}  // namespace

std::string_view trimmed(std::string_view word) {
    constexpr std::string_view white = " \t\r\n";
    const auto first = word.find_first_not_of(white);
    if (first == std::string_view::npos) return {};
    return word.substr(first, word.find_last_not_of(white) - first + 1);
}

std::optional<double> to_number(std::string_view word) {
    double value = 0.0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || end != word.data() + word.size() || !std::isfinite(value)) return std::nullopt;
    return value;
}

std::optional<std::int64_t> to_integer(std::string_view word) {
    const bool hexadecimal = word.starts_with("0x") || word.starts_with("0X");
    if (hexadecimal) word.remove_prefix(2);
    if (hexadecimal && word.starts_with("-")) return std::nullopt;
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value, hexadecimal ? 16 : 10);
    if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
    return value;
}

std::string number_word(double value) {
    std::array<char, 32> text{};
    const auto result = std::to_chars(text.data(), text.data() + text.size(), value);
    return {text.data(), result.ptr};
}

bool is_taken_in_packets(std::string_view name) {
    constexpr std::array taken{"apid", "octets", "encode", "id", "level", "out"};
    return std::ranges::find(taken, name) != taken.end();
}

bool is_taken_in_commands(std::string_view name) {
    constexpr std::array taken{"opcode", "argument_octets", "decode"};
    return std::ranges::find(taken, name) != taken.end();
}

std::optional<std::string> unusable_as_identifier(std::string_view name) {
    if (name.empty()) return "is empty";
    if (!is_letter(name.front())) return "does not begin with a letter";
    if (!std::ranges::all_of(name, [](char c) { return is_letter(c) || is_digit(c) || c == '_'; }))
        return "has characters other than letters, digits and underscores";
    if (name.find("__") != std::string_view::npos) return "has two underscores in a row, which C++ reserves";
    if (std::ranges::binary_search(keywords, name)) return "is a keyword of C++";
    return std::nullopt;
}

}  // namespace aeolis::dictionary
