#pragma once

#include "common/fixed_queue.hpp"
#include "flight/edl_comm/telemetry_plan.hpp"
#include "flight/kernel/outbox.hpp"

#include <array>

namespace aeolis::flight {

/// All EDL telemetry: everything is recorded in non-volatile memory, and ground gets a subset of the same packets, bit
/// for bit, as fast as the link is. R29, R30
///
/// In      Record (any module), PhaseChanged, NvmStatus, ToneStatus, ClockTick (64 Hz)
/// Out     packets to NVM, in order; packets to the UHF transmitter within its rate; CommStatus at 1 Hz
/// Memory  128 urgent and 32 ordinary packets wait for the link; one that finds no room is dropped from real time,
///         never from the recording, and counted (uhf_dropped_packets)
/// Faults  NVM nearly full: channel packets stop, said once (NVM_FULL); the last 64 KiB are kept for events, firings
///         and explanations
class EdlComm {
  public:
    explicit EdlComm(const Load& load);

    void on(const Record& record, Outbox& out);
    void on(const PhaseChanged& change, Outbox& out);
    void on(const NvmStatus& status, Outbox& out);
    void on(const ToneStatus& status, Outbox& out);
    void on(const ClockTick& tick, Outbox& out);

    std::uint32_t unrecorded_packets() const { return unrecorded_packets_; }

  private:
    static constexpr std::uint16_t counts_of_string_b = 0x2000;  ///< half of the 14 bits
    static constexpr std::uint32_t nvm_reserve_octets = 65536;
    static constexpr std::size_t packet_max = tm_overhead_octets + record_octets_max;
    struct Packet {
        std::uint16_t size = 0;
        std::array<std::uint8_t, packet_max> octets{};
    };
    struct Stream {  // one for each APID of the dictionary, by its low 7 bits
        std::uint16_t count = 0;
        std::uint32_t since_sent = 0;
    };

    bool append_to_recording(Apid apid, const Packet& packet, Outbox& out);
    void offer_to_link(Apid apid, Stream& stream, const Packet& packet);
    void radiate(Outbox& out);

    double octets_per_cycle_;
    Plan plan_;
    EdlPhase phase_{};
    std::array<Stream, 128> streams_{};
    FixedQueue<Packet, 128> urgent_;
    FixedQueue<Packet, 32> ordinary_;
    double credit_octets_ = 0.0;  // what the link could have sent and has not yet
    std::uint32_t queued_octets_ = 0;
    std::uint32_t sent_octets_ = 0;
    std::uint32_t dropped_packets_ = 0;
    std::uint32_t records_ = 0;
    std::uint32_t unrecorded_packets_ = 0;
    NvmStatus nvm_;
    bool nvm_full_reported_ = false;
    ToneStatus tone_;
};

}  // namespace aeolis::flight
