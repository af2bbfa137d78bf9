// SPDX-License-Identifier: Apache-2.0
#include "telemetry/silence_class.hpp"

#include <array>

namespace aeolis::telemetry {
namespace {

struct SilenceWords {
    SilenceClass silence;
    const char *name, *title;
};
constexpr std::array<SilenceWords, silence_classes> silence_words{
    {{SilenceClass::light_time, "light_time", "light time"},
     {SilenceClass::not_begun, "not_begun", "not begun"},
     {SilenceClass::switched_off, "switched_off", "switched off"},
     {SilenceClass::blackout, "blackout", "plasma blackout"},
     {SilenceClass::hand_over, "hand_over", "antenna hand-over"},
     {SilenceClass::no_orbiter, "no_orbiter", "no orbiter in view"},
     {SilenceClass::orbiter_records, "orbiter_records", "orbiter records"},
     {SilenceClass::earth_set, "earth_set", "Earth set"},
     {SilenceClass::weak_carrier, "weak_carrier", "carrier too weak"},
     {SilenceClass::delivered, "delivered", "delivered"},
     {SilenceClass::recording_complete, "recording_complete", "recording complete"},
     {SilenceClass::ground_fault, "ground_fault", "ground fault"},
     {SilenceClass::unexplained, "unexplained", "unexplained"}}};

/// Whether each class stands at the place of its number.
consteval bool silences_in_order() {
    for (std::size_t i = 0; i < silence_words.size(); ++i)
        if (silence_words[i].silence != static_cast<SilenceClass>(i)) return false;
    return true;
}
static_assert(silences_in_order());
static_assert(silence_classes == static_cast<std::size_t>(SilenceClass::unexplained) + 1);

}  // namespace

const char* name_of(SilenceClass silence) {
    return silence_words[static_cast<std::size_t>(silence)].name;
}

const char* title_of(SilenceClass silence) {
    return silence_words[static_cast<std::size_t>(silence)].title;
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
