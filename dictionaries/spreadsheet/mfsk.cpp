// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/spreadsheet/table.hpp"
#include "dictionaries/spreadsheet/tables.hpp"

#include "dictionaries/words.hpp"

#include <algorithm>
#include <array>
#include <numbers>
#include <set>
#include <string>

namespace aeolis::dictionary {
namespace {

struct MfskNumber {
    std::string_view name, unit;
    double MfskWaveform::* value;
    double per_unit;
};
constexpr std::array mfsk_numbers{
    MfskNumber{"carrier_hz", "Hz", &MfskWaveform::carrier_hz, 1.0},
    MfskNumber{"first_tone_hz", "Hz", &MfskWaveform::first_tone_hz, 1.0},
    MfskNumber{"tone_spacing_hz", "Hz", &MfskWaveform::tone_spacing_hz, 1.0},
    MfskNumber{"symbol_s", "s", &MfskWaveform::symbol_s, 1.0},
    MfskNumber{"modulation_index_deg", "deg", &MfskWaveform::modulation_index_rad, std::numbers::pi / 180.0},
};

void check_mfsk(const MfskWaveform& mfsk, Findings& findings) {
    if (mfsk.tone_spacing_hz * mfsk.symbol_s < 1.0)
        findings.add(1, "tone_spacing_hz is below 1/symbol_s: the tones are not orthogonal");
    if (mfsk.highest_tone_hz() >= 3.0 * mfsk.first_tone_hz)
        findings.add(1, "the highest tone, " + number_word(mfsk.highest_tone_hz()) +
                            " Hz, reaches the third harmonic of the lowest");
    if (mfsk.modulation_index_rad >= 0.5 * std::numbers::pi)
        findings.add(1, "modulation_index_deg is not below 90: no carrier is left");
}

}  // namespace

std::optional<MfskWaveform> read_mfsk(std::string_view text, Findings& findings) {
    const auto table = Table::read(text, {"name", "value", "unit", "text", "source"}, findings);
    if (!table) return std::nullopt;
    MfskWaveform mfsk;
    std::set<std::string_view> read;
    bool sound = true;
    for (const Sheet::Row& row : table->rows()) {
        RowReader cells{*table, row, "number", "name", findings};
        const auto known = std::ranges::find(mfsk_numbers, cells.text("name"), &MfskNumber::name);
        const auto value = cells.number("value");
        cells.required_text("text");
        cells.required_text("source");
        if (known == mfsk_numbers.end()) {
            cells.fault("is none that the waveform has");
            sound = false;
            continue;
        }
        if (!read.insert(known->name).second) cells.fault("is there twice");
        if (cells.text("unit") != known->unit)
            cells.fault("is in " + in_quotes(cells.text("unit")) + ", not in " + std::string{known->unit});
        if (value && *value <= 0.0) cells.fault("is not above 0");
        sound = sound && value && *value > 0.0;
        mfsk.*known->value = value.value_or(0.0) * known->per_unit;
    }
    for (const MfskNumber& number : mfsk_numbers)
        if (!read.contains(number.name)) {
            findings.add(1, "there is no " + std::string{number.name});
            sound = false;
        }
    if (sound) check_mfsk(mfsk, findings);
    return mfsk;
}

}  // namespace aeolis::dictionary
