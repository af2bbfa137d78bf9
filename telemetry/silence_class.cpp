// SPDX-License-Identifier: Apache-2.0
#include "telemetry/silence_class.hpp"

#include <array>

namespace aeolis::telemetry {
namespace {

constexpr std::array<const char*, silence_classes> silence_names{
    "light_time", "not_begun",    "switched_off", "blackout",           "hand_over",    "no_orbiter", "orbiter_records",
    "earth_set",  "weak_carrier", "delivered",    "recording_complete", "ground_fault", "unexplained"};
constexpr std::array<const char*, silence_classes> silence_titles{
    "light time",         "not begun",       "switched off", "plasma blackout",  "antenna hand-over",
    "no orbiter in view", "orbiter records", "Earth set",    "carrier too weak", "delivered",
    "recording complete", "ground fault",    "unexplained"};
static_assert(silence_classes == static_cast<std::size_t>(SilenceClass::unexplained) + 1);

}  // namespace

const char* name_of(SilenceClass silence) {
    return silence_names[static_cast<std::size_t>(silence)];
}

const char* title_of(SilenceClass silence) {
    return silence_titles[static_cast<std::size_t>(silence)];
}

bool is_over(SilenceClass silence) {
    return silence == SilenceClass::switched_off || silence == SilenceClass::delivered ||
           silence == SilenceClass::recording_complete;
}

bool is_lost(SilenceClass silence) {
    return silence == SilenceClass::ground_fault || silence == SilenceClass::unexplained;
}

std::string reason_text(std::optional<SilenceClass> silence, const std::string& words) {
    if (!silence) return words;
    return words.empty() ? title_of(*silence) : std::string(title_of(*silence)) + ": " + words;
}

}  // namespace aeolis::telemetry
