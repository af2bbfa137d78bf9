// SPDX-License-Identifier: Apache-2.0
#include "flight/edl/parameter_table.hpp"

#include "common/bytes.hpp"
#include "common/check.hpp"
#include "common/crc.hpp"
#include "common/deviation.hpp"

#include <algorithm>
#include <span>

namespace aeolis::flight {

// carry() takes the table for a block of doubles.
static_assert(sizeof(Parameters) == sizeof(double) * std::ranges::count_if(parameter_specs, [](const auto& spec) {
                                        return spec.member != nullptr;
                                    }));

std::array<std::uint8_t, parameter_rows_octets> rows_of(const Parameters& parameters) {
    std::array<std::uint8_t, parameter_rows_octets> octets{};
    BitWriter writer{octets};
    for (std::uint16_t row = 0; row < parameter_count; ++row)
        packet::ParameterRow{.parameter_number = row, .parameter_held = value_of(parameters, ParameterId{row})}.encode(
            writer);
    return octets;
}

gnc::Conditions conditions_of(const command::EDL_STAGE_PARAMETER& change) {
    gnc::Conditions conditions;
    conditions.push_back(
        gnc::below(Quantity::row_number, change.parameter, static_cast<double>(parameter_specs.size())));
    if (change.parameter >= parameter_specs.size()) return conditions;
    const ParameterSpec& spec = parameter_specs[change.parameter];
    conditions.clear();
    conditions.push_back(gnc::names(Quantity::staged_parameter, change.parameter));
    conditions.push_back(gnc::is(Quantity::parameter_changeable, spec.member != nullptr));
    conditions.push_back(gnc::at_least(Quantity::parameter_value, change.value, spec.min));
    conditions.push_back(gnc::at_most(Quantity::parameter_value, change.value, spec.max));
    return conditions;
}

CommandRefusal refusal_of(const gnc::Conditions& conditions) {
    const auto fixed = [](const gnc::Condition& condition) {
        return condition.quantity == Quantity::parameter_changeable && !condition.holds;
    };
    return std::ranges::any_of(conditions, fixed) ? CommandRefusal::fixed_at_build : CommandRefusal::bad_argument;
}

bool ParameterTable::has_room(ParameterId id) const {
    return !staged_.full() || std::ranges::find(staged_, id.value, &Change::id) != staged_.end();
}

void ParameterTable::stage(ParameterId id, double value) {
    const auto same = std::ranges::find(staged_, id.value, &Change::id);
    if (same != staged_.end())
        same->value = value;
    else
        staged_.push_back({id.value, value});
}

Parameters ParameterTable::with_staged() const {
    Parameters values = values_;
    for (const Change& change : staged_) set_value(values, ParameterId{change.id}, change.value);
    return values;
}

std::uint16_t ParameterTable::crc_with_staged() const {
    return crc16(rows_of(with_staged()));
}

double ParameterTable::deviation_with_staged() const {
    const Parameters values = with_staged();
    double sum = 0.0;
    for (const ParameterSpec& spec : parameter_specs)
        if (spec.member != nullptr) sum += deviation(values.*spec.member, built_in_.*spec.member, spec.min, spec.max);
    return sum;
}

void ParameterTable::activate(std::uint16_t version) {
    values_ = with_staged();
    version_ = version;
    changes_ = static_cast<std::uint16_t>(staged_.size());
    discard();
}

packet::ParameterTable ParameterTable::report() const {
    std::uint16_t changed = 0;
    for (const ParameterSpec& spec : parameter_specs)
        if (spec.member != nullptr && values_.*spec.member != built_in_.*spec.member) ++changed;
    return {.parameter_version = version_,
            .parameter_changes = changes_,
            .parameters_changed = changed,
            .parameters_staged = static_cast<std::uint16_t>(staged_.size()),
            .parameter_crc = crc16(rows_of(values_))};
}

}  // namespace aeolis::flight
