// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/proximity_frame.hpp"
#include "common/tc_frame.hpp"
#include "flight/edl_comm/data_products.hpp"
#include "flight/edl_comm/realtime_queue.hpp"
#include "flight/edl_comm/sensor_tables.hpp"
#include "flight/edl_comm/telemetry_plan.hpp"
#include "flight/kernel/outbox.hpp"

#include <array>

namespace aeolis::flight {

/// Records all EDL telemetry in non-volatile memory (NVM), and sends a subset in real time. R29, R30, R52
/// The subset is bit-identical to the recording and limited by the rate of the link.
///
/// In      Record (any module), ImuReadings, RadarReturns, PhaseChanged, NvmStatus, ToneStatus, UplinkStatus,
///         ParameterPart, CloseRecording, ClockTick (64 Hz)
/// Out     packets to NVM, in order; PLTUs with some of them for the radio, within UHF's rate; CommStatus at 1
///         Hz; tables of all readings of IMU and radar; data products
/// Memory  192 packets wait for the link; RealtimeQueue decides which are dropped. Neither recording nor cycle suffers
/// Faults  a full link queue is reported once per episode (UHF_QUEUE_FULL), and drops are counted by priority in
///         CommStatus
///         NVM nearly full is reported once (NVM_FULL, and by tone); the last 64 KiB are kept for priority `first`
///         A record that no packet can hold is refused as an unexpected message
/// Closing CloseRecording is answered as verified once NVM holds all packets recorded before it, and as refused if some
///         found no room. After the last timepoint and its data product, RECORDING_CLOSED is the last packet recorded
/// Frames  A Proximity-1 frame, expedited, on this computer's own physical channel, carries whole packets. While more
///         wait, a frame is sent only when it can hold 256 octets (chosen: a quarter of a second at 8 kb/s, 5 % frame
///         overhead)
/// Names   Computer B reports its own status as CommStatusB and SyncStatusB, so that a channel belongs to one computer
/// Records are packets, each with a CRC-16; NVM is outside the computer and survives its resets.
class EdlComm {
  public:
    explicit EdlComm(const Load& load);

    void on(const Record& record, Outbox& out);
    void on(const ImuReadings& readings, Outbox& out);
    void on(const RadarReturns& returns, Outbox& out);
    void on(const PhaseChanged& change, Outbox& out);
    void on(const NvmStatus& status, Outbox& out);
    void on(const ToneStatus& status, Outbox& out);
    void on(const UplinkStatus& status, Outbox& out);
    void on(const ParameterPart& part, Outbox& out);
    void on(const CloseRecording& command, Outbox& out);
    void on(const ClockTick& tick, Outbox& out);

    std::uint32_t unrecorded_packets() const { return unrecorded_packets_; }
    const RealtimeQueue& queue() const { return queue_; }

  private:
    static constexpr std::uint16_t counts_of_string_b = 0x2000;  ///< half of the 14 bits
    static constexpr std::uint32_t nvm_reserve_octets = 65536;
    static constexpr std::size_t frame_packets_octets = 256;
    struct Stream {  // one for each APID of the dictionary, by its low 7 bits
        std::uint16_t count = 0;
        std::uint32_t since_sent = 0;
    };

    void close(Outbox& out);
    bool append_to_recording(TelemetryPriority priority, const TelemetryPacket& packet, Outbox& out);
    void offer_to_link(const TelemetryPlanRow& plan, Stream& stream, const TelemetryPacket& packet, Outbox& out);
    void radiate(Outbox& out);
    /// Octets of packets that the next frame must hold, at least.
    std::size_t frame_wanted_octets() const;
    void send_frame(Outbox& out);
    packet::CommStatus status() const;

    double octets_per_cycle_;
    String string_;
    std::uint8_t frame_sequence_ = 0;
    Plan plan_;
    EdlPhase phase_{};
    static constexpr std::size_t apids = 128;  ///< chosen: of both computers
    std::array<Stream, apids> streams_{};
    RealtimeQueue queue_;
    SensorTables tables_;
    DataProducts products_;
    double credit_octets_ = 0.0;  // octets that the link could have sent so far but has not
    std::uint32_t sent_octets_ = 0;
    std::uint32_t records_ = 0;
    std::uint32_t unrecorded_packets_ = 0;
    NvmStatus nvm_;
    bool nvm_full_reported_ = false;
    /// State of the recording. `asked`: awaits NVM's confirmation; `closing`: awaits the end of the timeline.
    enum class Closing : std::uint8_t { open, asked, closing, last_packet, closed };
    Closing closing_ = Closing::open;
    std::uint32_t octets_before_closing_ = 0;
    bool queue_full_reported_ = false;
    ToneStatus tone_;
    UplinkStatus uplink_{word_of({.lockout = true})};  // initially as of a dispatcher without uplink
};

}  // namespace aeolis::flight
