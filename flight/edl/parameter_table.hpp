// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/fixed_vector.hpp"
#include "common/ids.hpp"
#include "common/space_packet.hpp"
#include "flight/gnc/quantities.hpp"
#include "generated/dictionary_flight.hpp"
#include "generated/parameters.hpp"

#include <array>
#include <cstdint>

// The table of parameters that flight flies by (parameters.csv), and the changes that ground has staged for it.
//
// In       EDL_STAGE_PARAMETER one by one, then EDL_ACTIVATE_PARAMETERS for all of them, or EDL_DISCARD_PARAMETERS
// Rule     a change is within the range of its row, and its row may change; the table is replaced whole or not at all,
//          and only by one whose deviations from the one built in add up to no more than one range
// Memory   one value a row, and up to 32 staged changes: the largest number that EDL_ACTIVATE_PARAMETERS can name
// R25, R48
namespace aeolis::flight {

inline constexpr std::size_t staged_changes_max = 32;

/// The value held of any parameter, also of one that is fixed at build. The table has a row `id`.
constexpr double value_of(const Parameters& parameters, ParameterId id) {
    const ParameterSpec& spec = parameter_specs[id.value];
    return spec.member != nullptr ? parameters.*spec.member : spec.fixed;
}

/// Sets a parameter. Does nothing when it is fixed at build, or when the table has no such row.
constexpr void set_value(Parameters& parameters, ParameterId id, double value) {
    if (id.value < parameter_count && parameter_specs[id.value].member != nullptr)
        parameters.*parameter_specs[id.value].member = value;
}

inline constexpr std::size_t parameter_rows_octets =
    parameter_count * (packet::ParameterRow::octets - tm_overhead_octets);
/// The content of the table's data product: each parameter as a packet::ParameterRow, by id.
std::array<std::uint8_t, parameter_rows_octets> rows_of(const Parameters& parameters);

/// The conditions under which a change may be staged: its row exists and may change, and the value is within its range.
gnc::Conditions conditions_of(const command::EDL_STAGE_PARAMETER& change);
/// The reason for refusing a change whose conditions do not hold.
CommandRefusal refusal_of(const gnc::Conditions& conditions);

class ParameterTable {
  public:
    /// @param built_in  what the vehicle was loaded with: the defaults of parameters.csv, unless its mission has others
    explicit ParameterTable(const Parameters& built_in) : values_(built_in), built_in_(built_in) {}

    const Parameters& values() const { return values_; }
    const Parameters& built_in() const { return built_in_; }
    std::uint16_t version() const { return version_; }  ///< ground's number; 0: as built in
    std::size_t staged() const { return staged_.size(); }

    /// Whether a change of this parameter can be staged. A second change of the same parameter replaces the first.
    bool has_room(ParameterId id) const;
    void stage(ParameterId id, double value);
    void discard() { staged_.clear(); }
    /// CRC of the table that activation would make.
    std::uint16_t crc_with_staged() const;
    /// Sum of that table's deviations from the one built in (common/deviation.hpp).
    double deviation_with_staged() const;
    /// Takes all staged changes into the table.
    void activate(std::uint16_t version);

    packet::ParameterTable report() const;

    /// State for another computer, without the built-in values, which are the same there.
    template <typename Exchange>
    void carry(Exchange& exchange) {
        exchange.departures(values_, built_in_);
        exchange(version_, changes_, staged_);
    }

  private:
    struct Change {
        std::uint16_t id = 0;
        double value = 0.0;

        template <typename Exchange>
        void carry(Exchange& exchange) {
            exchange(id, value);
        }
    };
    Parameters with_staged() const;

    Parameters values_, built_in_;
    std::uint16_t version_ = 0;
    std::uint16_t changes_ = 0;  ///< by which the version was made
    FixedVector<Change, staged_changes_max> staged_;
};

}  // namespace aeolis::flight
