// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/fixed_queue.hpp"
#include "common/fixed_vector.hpp"
#include "flight/edl/parameter_table.hpp"
#include "flight/kernel/outbox.hpp"
#include "flight/kernel/parameter_parts.hpp"
#include "flight/timeline/timeline.hpp"

#include <array>
#include <cstdint>
#include <span>

// Data products: tables too large for one packet.
// Each row is the data field of a packet of the dictionary, so that ground decodes it by the same definition. A product
// is sent in parts of equal size, each with its number and the CRC of the whole product. R30
namespace aeolis::flight {

/// Every firing of the timeline so far, as reported.
class AsFlown {
  public:
    /// Adds a record that reports a firing; a firing beyond the timeline's number of rows is left out.
    void on(const Record& firing);
    std::span<const std::uint8_t> content() const { return content_.span(); }

  private:
    static constexpr std::size_t row_octets = packet::TimepointFired::octets - tm_overhead_octets;
    FixedVector<std::uint8_t, timeline_rows_max * row_octets> content_;
};

/// IMU readings around the parachute mortar, one by one: 1 s before, 3 s after.
/// The span is chosen: inflation takes about a second, and its load peaks are what engineers ask for first.
class ImuBurst {
  public:
    static constexpr std::size_t rows_before = 200;  ///< 200 Hz
    static constexpr std::size_t rows_after = 600;

    void on(const ImuReadings& readings);
    /// Notes that the mortar has fired: keeps the readings so far, and appends the next ones.
    void begin();
    bool begun() const { return begun_; }
    bool complete() const { return begun_ && rows_.size() == (kept_ + rows_after) * row_octets; }
    /// Oldest first; empty until begun.
    std::span<const std::uint8_t> content() const { return rows_.span(); }

  private:
    static constexpr std::size_t row_octets = packet::ImuIncrements::octets - tm_overhead_octets;
    void append(const ImuSample& sample);

    std::array<ImuSample, rows_before> before_{};  // a ring
    std::uint64_t heard_ = 0;                      // until begun
    std::size_t kept_ = 0;                         // rows from before the mortar
    FixedVector<std::uint8_t, (rows_before + rows_after) * row_octets> rows_;
    bool begun_ = false;
};

/// Makes the products and sends their parts, at most one a cycle, so that no cycle is long.
class DataProducts {
  public:
    void on(const Record& record);
    void on(const ImuReadings& readings);
    void on(const PhaseChanged& change);
    /// Takes the table of parameters to be dumped. It replaces an older one that is not sent yet, or only in part.
    void on(const ParameterPart& part);

    /// Sends the next part, if one is due; it is recorded like every packet.
    void cycle(Outbox& out);

    std::uint16_t made() const { return made_; }
    /// Whether the last timepoint has fired and every product is sent.
    bool complete() const { return timeline_complete_ && !sending_ && due_.empty(); }

  private:
    struct Sending {
        packet::DataProduct part;  // kind, id, size and CRC are constant; number and content change
        std::size_t octets = 0;
    };
    void begin_next();
    std::span<const std::uint8_t> content(ProductKind kind) const;

    AsFlown as_flown_;
    ImuBurst imu_burst_;
    ReceivedParameters table_;
    std::array<std::uint8_t, parameter_rows_octets> table_rows_{};
    bool table_due_ = false;
    EdlPhase phase_{};
    bool imu_burst_due_ = false;  // requested, once
    FixedQueue<ProductKind, 4> due_;
    std::optional<Sending> sending_;
    std::uint16_t made_ = 0;
    bool timeline_complete_ = false;
};

}  // namespace aeolis::flight
