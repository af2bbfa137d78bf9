// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

// Small pieces of C++ text. Names were checked by the loader: they are identifiers and no keywords.
namespace aeolis::dictionary::autocoder {

/// The first line of whatever the autocoder writes: from which mission, and `source`, what to change instead of it.
std::string made_by_autocoder(const Dictionary& dictionary, std::string_view source);

/// "0x020".
std::string hexadecimal(std::uint64_t value, unsigned digits);

/// A literal of type double: "405.0", "-0.5".
std::string double_literal(double value);

/// A std::optional<double>: a literal or "std::nullopt".
std::string optional_literal(const std::optional<double>& value);

std::string string_literal(std::string_view text);

/// The enum class of an enumerated type: edl_phase and EdlPhase both become EdlPhase.
std::string camel_case(std::string_view name);

/// The C++ type that holds a raw value: float, std::uint16_t, bool, EdlPhase.
std::string value_type(const Type& type);

}  // namespace aeolis::dictionary::autocoder
