// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/fixed_queue.hpp"
#include "common/fixed_vector.hpp"
#include "flight/kernel/outbox.hpp"
#include "flight/timeline/timeline.hpp"

#include <array>
#include <cstdint>
#include <span>

// Data products: tables too large for one packet. Each row is the data field of a packet of the dictionary, so that the
// ground reads it by the same words. A product goes as parts of equal size, each with its number and the CRC of all.
// R30
namespace aeolis::flight {

/// Every firing of the timeline so far, as it was reported.
class AsFlown {
  public:
    /// A record that reports a firing; one more than a timeline has rows is left out.
    void on(const Record& firing);
    std::span<const std::uint8_t> content() const { return content_.span(); }

  private:
    static constexpr std::size_t row_octets = packet::TimepointFired::octets - tm_overhead_octets;
    FixedVector<std::uint8_t, timeline_rows_max * row_octets> content_;
};

/// What the IMU sensed around the parachute's mortar, reading by reading: 1 s before, 3 s after. Ours: inflation takes
/// about a second and its load peaks are what engineers ask for first.
class ImuBurst {
  public:
    static constexpr std::size_t rows_before = 200;  ///< 200 Hz
    static constexpr std::size_t rows_after = 600;

    void on(const ImuReadings& readings);
    /// The mortar fired: what was read is kept, and what comes now follows it.
    void begin();
    bool begun() const { return begun_; }
    bool complete() const { return begun_ && rows_ == kept_ + rows_after; }
    /// Oldest first; once begun.
    std::span<const std::uint8_t> content() const { return std::span{octets_}.first(rows_ * row_octets); }

  private:
    static constexpr std::size_t row_octets = packet::ImuIncrements::octets - tm_overhead_octets;
    std::array<std::uint8_t, (rows_before + rows_after) * row_octets> octets_{};
    std::size_t rows_ = 0;
    std::size_t oldest_ = 0;  // before it has begun, the rows are a ring
    std::size_t kept_ = 0;    // rows from before the mortar
    bool begun_ = false;
};

/// Makes the two products and hands out their parts, at most one a cycle, so that no cycle is long.
class DataProducts {
  public:
    void on(const Record& record);
    void on(const ImuReadings& readings);
    void on(const PhaseChanged& change);

    /// The next part, if one is due: recorded like every packet.
    void cycle(Outbox& out);

    std::uint16_t made() const { return made_; }

  private:
    struct Sending {
        packet::DataProduct part;  // kind, id, size and CRC stand; number and content change
        std::size_t octets = 0;
    };
    void begin_next();
    std::span<const std::uint8_t> content(ProductKind kind) const;

    AsFlown as_flown_;
    ImuBurst imu_burst_;
    EdlPhase phase_{};
    bool imu_burst_due_ = false;  // was asked for: once
    FixedQueue<ProductKind, 4> due_;
    std::optional<Sending> sending_;
    std::uint16_t made_ = 0;
};

}  // namespace aeolis::flight
