// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

// The parameter table as ground intends it: the values built in, and the changes made to them. Before flight activates
// a table, it compares the CRC with that of its own. R25
namespace aeolis::commands {

class ParameterTable {
  public:
    /// Starts with the defaults of parameters.csv, but for those that the vehicle was loaded with instead, each within
    /// its range. `dictionary` must outlive the table.
    explicit ParameterTable(const dictionary::Dictionary& dictionary,
                            std::span<const std::pair<ParameterId, double>> loaded = {});

    /// Sets the value of a row. Fails, with the reason, when the row is fixed or the value is outside its range; flight
    /// refuses the same.
    [[nodiscard]] Result<void> set(ParameterId id, double value);

    /// Checks whether the table may fly. Fails when its deviations from the table built in add up to more than one
    /// range, and names the largest. Flight refuses to activate such a table too.
    [[nodiscard]] Result<void> check_deviations() const;

    /// CRC-16 over the rows in order, each with its number in 16 bits and its value as a binary64. The data product
    /// that dumps the table and the channel parameter_crc have the same CRC.
    std::uint16_t crc() const;

  private:
    const dictionary::Dictionary& dictionary_;
    std::vector<double> built_in_, values_;
};

}  // namespace aeolis::commands
