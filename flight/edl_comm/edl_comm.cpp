// SPDX-License-Identifier: Apache-2.0
#include "flight/edl_comm/edl_comm.hpp"

#include "common/space_packet.hpp"

#include <algorithm>

namespace aeolis::flight {
namespace {

static_assert(packet::CommStatusB::octets == packet::CommStatus::octets &&
                  packet::SyncStatusB::octets == packet::SyncStatus::octets,
              "the same fields, under names of computer B");

/// APID of a packet on this computer. Status that both computers send at all times has a name for each; everything else
/// belongs to the vehicle, whichever computer flies it.
Apid apid_of(String string, Apid apid) {
    if (string == String::a) return apid;
    if (apid == packet::CommStatus::apid) return packet::CommStatusB::apid;
    if (apid == packet::SyncStatus::apid) return packet::SyncStatusB::apid;
    return apid;
}

/// What EdlComm says when it closes the recording.
bool is_last(const Record& record) {
    return record.apid == evr::RECORDING_CLOSED::apid &&
           read_bits(record.data, 0, 16) == evr::RECORDING_CLOSED::id.value;
}

constexpr double bits_per_octet = 8.0;

}  // namespace

EdlComm::EdlComm(const Load& load)
    : octets_per_cycle_(load.uhf_rate_bps / bits_per_octet * seconds_per_tick), string_(load.string),
      plan_(load.telemetry_plan) {
    // The computers count from different numbers, so that no packet of one has the identity of one of the other's.
    if (load.string == String::b)
        for (Stream& stream : streams_) stream.count = counts_of_string_b;
}

void EdlComm::on(const Record& record, Outbox& out) {
    if (record.size > record_octets_max) {
        const auto type = static_cast<std::uint8_t>(Message{record}.index());
        return out.event(evr::UNEXPECTED_MESSAGE{.module_number = static_cast<std::uint8_t>(ModuleId::edl_comm),
                                                 .message_type = type});
    }
    TelemetryPacket packet;
    packet.size = static_cast<std::uint16_t>(record.size + tm_overhead_octets);
    std::copy_n(record.data.begin(), record.size, packet.octets.begin() + tm_data_offset_octets);
    const Apid apid = apid_of(string_, record.apid);
    auto& stream = streams_[apid.value % streams_.size()];
    seal_tm_packet(std::span{packet.octets}.first(packet.size), apid, stream.count, record.time, dictionary_id);
    stream.count = (stream.count + 1) & packet_count_mask;
    const TelemetryPlanRow& plan = planned(plan_, apid);
    // Only recorded packets may be sent: real time stays a subset of the recording.
    if (append_to_recording(plan.priority, packet, out)) offer_to_link(plan, stream, packet, out);
    if (is_last(record)) closing_ = Closing::closed;
    products_.on(record);
}

void EdlComm::on(const CloseRecording&, Outbox& out) {
    if (closing_ == Closing::open) closing_ = Closing::asked;
    octets_before_closing_ = nvm_.used_octets + static_cast<std::uint32_t>(out.bus().nvm.size());
}

void EdlComm::close(Outbox& out) {
    if (closing_ == Closing::asked && nvm_.used_octets >= octets_before_closing_) {
        closing_ = Closing::closing;
        const Evidence evidence = nvm_full_reported_ ? Evidence::refused : Evidence::verified;
        out.send(ModuleId::edl, ActionReply{ReplyKind::recording, 0, evidence});
    }
    if (closing_ == Closing::closing && products_.complete()) {
        closing_ = Closing::last_packet;
        out.event(evr::RECORDING_CLOSED{.used_octets = nvm_.used_octets});
        out.send(ModuleId::mfsk, ToneRequest{tone::recording_closed, out.now()});
    }
}

bool EdlComm::append_to_recording(TelemetryPriority priority, const TelemetryPacket& packet, Outbox& out) {
    if (closing_ == Closing::closed) return false;
    auto& nvm = out.bus().nvm;
    const std::uint64_t kept_free_octets = priority == TelemetryPriority::first ? 0 : nvm_reserve_octets;
    if (nvm_.used_octets + nvm.size() + packet.size + kept_free_octets > nvm_.capacity_octets ||
        nvm.size() + packet.size > nvm.capacity()) {
        ++unrecorded_packets_;
        if (!nvm_full_reported_) {
            nvm_full_reported_ = true;
            out.event(evr::NVM_FULL{.used_octets = nvm_.used_octets});
            out.send(ModuleId::mfsk, ToneRequest{tone::recording_fault, out.now()});
        }
        return false;
    }
    nvm.append(packet.span());
    ++records_;
    return true;
}

void EdlComm::offer_to_link(const TelemetryPlanRow& plan, Stream& stream, const TelemetryPacket& packet, Outbox& out) {
    const std::uint32_t every = every_in(plan.every, phase_);
    if (every == 0 || ++stream.since_sent < every) return;
    stream.since_sent = 0;
    if (queue_.offer(packet, plan.priority) || queue_full_reported_) return;
    queue_full_reported_ = true;
    out.event(evr::UHF_QUEUE_FULL{.lost = queue_.dropped()});
}

void EdlComm::radiate(Outbox& out) {
    // An idle link accumulates credit for one frame at most.
    constexpr std::size_t saved_octets =
        pltu_overhead_octets + std::max(frame_packets_octets, telemetry_packet_octets_max);
    credit_octets_ = std::min(credit_octets_, static_cast<double>(saved_octets)) + octets_per_cycle_;
    for (std::size_t frames = 0; !queue_.empty() && frames < RealtimeQueue::packets_max; ++frames) {
        const std::size_t wanted_octets = pltu_overhead_octets + frame_wanted_octets();
        if (static_cast<double>(wanted_octets) > credit_octets_ ||
            out.bus().uhf.size() + wanted_octets > out.bus().uhf.capacity())
            break;
        send_frame(out);
    }
    // The episode ends when half of the room is free again (chosen, so that it is not reported for every packet).
    if (queue_.waiting() <= RealtimeQueue::packets_max / 2) queue_full_reported_ = false;
}

std::size_t EdlComm::frame_wanted_octets() const {
    return std::max<std::size_t>(queue_.front().size,
                                 std::min<std::size_t>(queue_.waiting_octets(), frame_packets_octets));
}

void EdlComm::send_frame(Outbox& out) {
    auto& uhf = out.bus().uhf;
    const auto affordable = static_cast<std::size_t>(credit_octets_) - pltu_overhead_octets;
    const std::size_t room =
        std::min({affordable, uhf.capacity() - uhf.size() - pltu_overhead_octets, proximity_data_octets_max});
    FixedVector<std::uint8_t, proximity_data_octets_max> packets;
    while (!queue_.empty() && packets.size() + queue_.front().size <= room) {
        packets.append(queue_.front().span());
        queue_.pop();
    }
    const ProximityHeader header{.spacecraft = spacecraft_id,
                                 .physical_channel = static_cast<std::uint8_t>(string_ == String::b),
                                 .sequence = frame_sequence_++};
    std::array<std::uint8_t, pltu_octets_max> pltu{};
    const std::size_t size = write_pltu(header, packets.span(), pltu);
    uhf.append(std::span{pltu}.first(size));
    credit_octets_ -= static_cast<double>(size);
    sent_octets_ += static_cast<std::uint32_t>(size);
}

void EdlComm::on(const ImuReadings& readings, Outbox& out) {
    tables_.on(readings, out);
    products_.on(readings);
}

void EdlComm::on(const RadarReturns& returns, Outbox& out) {
    tables_.on(returns, out);
}

void EdlComm::on(const PhaseChanged& change, Outbox& out) {
    phase_ = change.phase;
    tables_.on(change, out);
    products_.on(change);
}

void EdlComm::on(const NvmStatus& status, Outbox&) {
    nvm_ = status;
}

void EdlComm::on(const ParameterPart& part, Outbox&) {
    products_.on(part);
}

void EdlComm::on(const ToneStatus& status, Outbox&) {
    tone_ = status;
}

void EdlComm::on(const UplinkStatus& status, Outbox&) {
    uplink_ = status;
}

void EdlComm::on(const ClockTick& tick, Outbox& out) {
    if (at_resolution(tick.now, 1) == tick.now) out.record(status());
    products_.cycle(out);
    close(out);
    radiate(out);
}

packet::CommStatus EdlComm::status() const {
    const std::uint32_t low_octets = queue_.waiting_octets(TelemetryPriority::low);
    return {.nvm_used_octets = nvm_.used_octets,
            .nvm_records = records_,
            .uhf_sent_octets = sent_octets_,
            .uhf_queue_octets = queue_.waiting_octets() - low_octets,
            .uhf_dropped_packets = queue_.dropped(),
            .tone_current = tone_.tone,
            .tone_requests = tone_.outstanding,
            .uhf_dropped_first_packets = queue_.dropped(TelemetryPriority::first),
            .uhf_dropped_high_packets = queue_.dropped(TelemetryPriority::high),
            .uhf_dropped_normal_packets = queue_.dropped(TelemetryPriority::normal),
            .uhf_dropped_low_packets = queue_.dropped(TelemetryPriority::low),
            .uhf_waiting_packets = static_cast<std::uint8_t>(queue_.waiting()),
            .uhf_low_queue_octets = low_octets,
            .nvm_unrecorded_packets = unrecorded_packets_,
            .products_made = products_.made(),
            .clcw = uplink_.clcw};
}

}  // namespace aeolis::flight
