// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

// Small pieces of C++ text. The loader has checked that all names are identifiers and no keywords.
namespace aeolis::dictionary::autocoder {

/// The first line of every generated file: names the mission and `source`, the file to edit instead.
std::string made_by_autocoder(const Dictionary& dictionary, std::string_view source);

/// Fixed-width hexadecimal literal: "0x020".
std::string hexadecimal(std::uint64_t value, unsigned digits);

/// Literal of type double: "405.0", "-0.5".
std::string double_literal(double value);

/// Initialiser of a std::optional<double>: a literal or "std::nullopt".
std::string optional_literal(const std::optional<double>& value);

std::string string_literal(std::string_view text);

/// Name of an enumerated type's enum class: edl_phase and EdlPhase both become EdlPhase.
std::string camel_case(std::string_view name);

/// C++ type that holds a raw value: float, std::uint16_t, bool, EdlPhase.
std::string value_type(const Type& type);

}  // namespace aeolis::dictionary::autocoder
