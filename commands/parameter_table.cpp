// SPDX-License-Identifier: Apache-2.0
#include "commands/parameter_table.hpp"

#include "commands/number.hpp"
#include "common/bytes.hpp"
#include "common/crc.hpp"
#include "common/deviation.hpp"

#include <array>

namespace aeolis::commands {

ParameterTable::ParameterTable(const dictionary::Dictionary& dictionary,
                               std::span<const std::pair<ParameterId, double>> loaded)
    : dictionary_(dictionary) {
    for (const dictionary::ParameterRow& row : dictionary.parameters) built_in_.push_back(row.default_value);
    for (const auto& [id, value] : loaded) built_in_.at(id.value) = value;
    values_ = built_in_;
}

Result<void> ParameterTable::set(ParameterId id, double value) {
    if (id.value >= values_.size()) return Error{"parameters.csv has no row " + std::to_string(id.value)};
    const dictionary::ParameterRow& row = dictionary_.parameters[id.value];
    if (row.change == dictionary::ParameterRow::Change::build)
        return Error{row.name + " is fixed when flight is built"};
    if (!(value >= row.min && value <= row.max))
        return Error{row.name + ": " + shortest_text(value) + " is outside " + shortest_text(row.min) + " to " +
                     shortest_text(row.max) + (row.unit == "1" ? "" : " " + row.unit)};
    values_[id.value] = value;
    return {};
}

Result<void> ParameterTable::check_deviations() const {
    double sum = 0.0, largest = 0.0;
    std::string largest_name;
    for (const dictionary::ParameterRow& row : dictionary_.parameters) {
        const double part = deviation(values_[row.id.value], built_in_[row.id.value], row.min, row.max);
        sum += part;
        if (part <= largest) continue;
        largest = part;
        largest_name = row.name;
    }
    if (sum <= table_deviation_max) return {};
    return Error{"the changes together are too large: as fractions of their ranges they add up to " +
                 shortest_text(sum) + ", at most " + shortest_text(table_deviation_max) + "; the largest, " +
                 largest_name + ", has " + shortest_text(largest)};
}

std::uint16_t ParameterTable::crc() const {
    constexpr std::size_t row_octets = 10;  // number 2, value 8
    std::vector<std::uint8_t> octets(values_.size() * row_octets);
    BitWriter writer{octets};
    for (std::size_t row = 0; row < values_.size(); ++row) {
        writer.put(row, 16);
        writer.put_double(values_[row]);
    }
    return crc16(octets);
}

}  // namespace aeolis::commands
