// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/kernel/outbox.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace aeolis::flight {

/// Gathers rows, each the data field of a `Row`, into packets of the recording, so that many rows share one header.
template <typename Packet, typename Row, auto Content>
class SensorTable {
  public:
    void add(const Row& row, Outbox& out) {
        BitWriter writer{std::span{packet_.*Content}.subspan(packet_.table_rows * row_octets, row_octets)};
        row.encode(writer);
        if (++packet_.table_rows == rows_max) flush(out);
    }
    /// Records the rows so far, if there are any.
    void flush(Outbox& out) {
        if (packet_.table_rows > 0) out.record(packet_);
        packet_ = empty();
    }

  private:
    static constexpr Packet empty() {
        Packet packet;
        packet.row_apid = Row::apid.value;
        return packet;
    }
    static constexpr std::size_t row_octets = Row::octets - tm_overhead_octets;
    static constexpr std::size_t rows_max = (Packet{}.*Content).size() / row_octets;
    static_assert(rows_max * row_octets == (Packet{}.*Content).size(), "a whole number of rows");

    Packet packet_ = empty();
};

/// Every reading of the IMU and of the radar's beams through EDL, as received. R52
///
/// They are recorded from separation of the cruise stage to the end of fly-away. In cruise, a day of readings would
/// fill NVM eight times.
class SensorTables {
  public:
    void on(const ImuReadings& readings, Outbox& out);
    void on(const RadarReturns& returns, Outbox& out);
    void on(const PhaseChanged& change, Outbox& out);

  private:
    bool in_edl_ = false;
    SensorTable<packet::ImuTable, packet::ImuIncrements, &packet::ImuTable::imu_rows> imu_;
    SensorTable<packet::RadarTable, packet::BeamReading, &packet::RadarTable::radar_rows> radar_;
};

/// A reading of the IMU as a row of a table.
packet::ImuIncrements row_of(const ImuSample& sample);

}  // namespace aeolis::flight
