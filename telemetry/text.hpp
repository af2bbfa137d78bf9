// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"
#include "telemetry/decommutator.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// Telemetry in words. Pure functions of the dictionary and one decoded packet.
namespace aeolis::telemetry {

/// A value without unit: a number, the label of an enumeration, "true"/"false", "undefined".
///
/// Digits suit the unit (metres and m/s to a tenth, degrees to a hundredth, …; chosen).
std::string number_text(const dictionary::Type& type, std::optional<double> value);

/// A value with its unit: "404.6 m/s", "parachute_descent", "undefined".
std::string value_text(const dictionary::Type& type, std::optional<double> value);

/// The name of a dictionary entry given by number in a field.
///
/// Fields: "opcode", "timepoint", "anchor", "tone", "constraint". "EDL_DO_EDL", "14 parachute_mortar"; of a constraint
/// its two moments and its line; an unknown number alone.
std::string reference_text(const dictionary::Dictionary& dictionary, std::string_view field, double number);

/// A name as people say it: "straighten_up" is "straighten up", "gnc_mode" is "GNC mode".
std::string in_words(std::string_view name);

/// For a number whose unit is only in the ending of its name, "speed_mps": "speed" and "12.3 m/s".
///
/// As people say it: from 100 km on in kilometres, from an hour on in hours, minutes and seconds; slow speeds to a
/// hundredth, and long times to a tenth.
std::string_view without_unit(std::string_view name);  ///< "speed"
std::string named_value_text(std::string_view name, double value, int more_decimals = 0);
/// A duration in the same notation, to a tenth of a second: "9.5 s", "90 s", "2 h 5 min".
std::string span_text(double span_s);
/// Two amounts of one kind, with as many more decimals as tell them apart when they differ: "1.963 m/s2", "1.960 m/s2".
std::pair<std::string, std::string> told_apart(std::string_view name, double value, double other);

const char* name_of(dictionary::EventLevel level);  ///< "ACTIVITY_HI"

/// The event of an event report; null for other packets.
const dictionary::Event* event_of(const dictionary::Dictionary& dictionary, const Decoded& decoded);

/// The event's format with its arguments inserted, references by name; braces without a matching argument stay.
std::string event_text(const dictionary::Dictionary& dictionary, const dictionary::Event& event,
                       const Decoded& decoded);

}  // namespace aeolis::telemetry
