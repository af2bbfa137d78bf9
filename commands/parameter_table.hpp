// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"

#include <cstdint>
#include <string_view>
#include <vector>

// The parameter table as ground means it: the values built in, and the changes made to them. Flight compares the CRC
// with that of its own table before it activates one. R25
namespace aeolis::commands {

class ParameterTable {
  public:
    /// As built. `dictionary` outlives the table.
    explicit ParameterTable(const dictionary::Dictionary& dictionary);

    /// Sets the value of a row. Fails, naming what is wrong, where the row may not change or the value is out of its
    /// range; so would flight.
    [[nodiscard]] Result<void> set(ParameterId id, double value);

    /// Whether the table may fly: fails where its deviations from the one built in add up to more than one range, and
    /// names the largest. Flight refuses to activate such a table too.
    [[nodiscard]] Result<void> may_fly() const;

    /// CRC-16 over each row in order, its number in 16 bits and its value as a binary64: as of the data product that
    /// dumps the table, and the channel parameter_crc.
    std::uint16_t crc() const;

  private:
    const dictionary::Dictionary& dictionary_;
    std::vector<double> values_;
};

}  // namespace aeolis::commands
