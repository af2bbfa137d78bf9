// SPDX-License-Identifier: Apache-2.0
// A spreadsheet as anyone may have left it: each reader says what is wrong with it, with a line of the text, or takes
// it. The first octet chooses the sheet. The other files are the shipped ones, so that references are followed.
#include "dictionaries/dictionary.hpp"
#include "dictionaries/enumerations.hpp"
#include "dictionaries/spreadsheet/csv.hpp"
#include "dictionaries/spreadsheet/owners.hpp"
#include "dictionaries/spreadsheet/state_machines.hpp"
#include "dictionaries/spreadsheet/tables.hpp"
#include "dictionaries/spreadsheet/telemetry_plan.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <string_view>

namespace {

using namespace aeolis;

const dictionary::Dictionary& mission() {
    static const auto loaded = dictionary::load(AEOLIS_SOURCE_DIR "/dictionaries/msl");
    if (!loaded.dictionary) std::abort();
    return *loaded.dictionary;
}

std::vector<dictionary::TimelineContext::DeclaredEvent> declared_events() {
    std::vector<dictionary::TimelineContext::DeclaredEvent> events;
    for (const auto& event : mission().events)
        events.push_back({event.name, mission().packets[event.packet].fields.size() > 1});
    return events;
}

/// Whether the sheet could be read at all.
bool read(unsigned sheet, std::string_view text, dictionary::Findings& findings) {
    static const auto events = declared_events();
    static const auto enumerations = dictionary::enumerations_of(mission().packets, mission().commands);
    switch (sheet) {
    case 0: return dictionary::read_anchors(text, findings).has_value();
    case 1: return dictionary::read_tones(text, findings).has_value();
    case 2: return dictionary::read_parameters(text, findings).has_value();
    case 3:
        return dictionary::read_timeline(text, {&mission().anchors, &mission().tones, &events}, findings).has_value();
    case 4: return dictionary::read_constraints(text, {&mission().timeline, &mission().anchors}, findings).has_value();
    case 5: return dictionary::read_telemetry_plan(text, &mission().packets, findings).has_value();
    case 6: return dictionary::read_state_machines(text, &enumerations, findings).has_value();
    case 7: return dictionary::read_owners(text, &enumerations, findings).has_value();
    default: return dictionary::read_csv(text, findings).has_value();
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    const std::string_view text{reinterpret_cast<const char*>(data + 1), size - 1};
    std::vector<dictionary::Finding> all;
    dictionary::Findings findings{"sheet.csv", all};
    const bool sound = read(data[0] % 9U, text, findings);
    if (!sound && all.empty()) std::abort();  // refused without a reason
    const auto lines = static_cast<unsigned>(std::ranges::count(text, '\n') + std::ranges::count(text, '\r')) + 1;
    for (const auto& finding : all)
        if (finding.line < 1 || finding.line > lines || finding.message.empty()) std::abort();
    return 0;
}
