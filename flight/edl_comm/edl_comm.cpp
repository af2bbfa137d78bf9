#include "flight/edl_comm/edl_comm.hpp"

#include "common/space_packet.hpp"

#include <algorithm>

namespace aeolis::flight {

EdlComm::EdlComm(const Load& load)
    : octets_per_cycle_(load.uhf_rate_bps / 8.0 * seconds_per_tick), plan_(load.telemetry_plan) {
    // So that a unit of one computer never has the name of one of the other's.
    if (load.string == String::b)
        for (Stream& stream : streams_) stream.count = counts_of_string_b;
}

void EdlComm::on(const Record& record, Outbox& out) {
    Packet packet;
    packet.size = static_cast<std::uint16_t>(record.size + tm_overhead_octets);
    std::copy_n(record.data.begin(), record.size, packet.octets.begin() + tm_data_offset_octets);
    auto& stream = streams_[record.apid.value % streams_.size()];
    seal_tm_packet(std::span{packet.octets}.first(packet.size), record.apid, stream.count, record.time, dictionary_id);
    stream.count = (stream.count + 1) & 0x3FFF;
    // Only what is recorded may be sent: real time stays a subset of the recording.
    if (append_to_recording(record.apid, packet, out)) offer_to_link(record.apid, stream, packet);
}

bool EdlComm::append_to_recording(Apid apid, const Packet& packet, Outbox& out) {
    auto& nvm = out.bus().nvm;
    const std::uint32_t kept_free_octets = goes_first(apid) ? 0 : nvm_reserve_octets;
    if (nvm_.used_octets + nvm.size() + packet.size + kept_free_octets > nvm_.capacity_octets ||
        nvm.size() + packet.size > nvm.capacity()) {
        ++unrecorded_packets_;
        if (!nvm_full_reported_) out.event(evr::NVM_FULL{.used_octets = nvm_.used_octets});
        nvm_full_reported_ = true;
        return false;
    }
    nvm.append(std::span{packet.octets}.first(packet.size));
    ++records_;
    return true;
}

void EdlComm::offer_to_link(Apid apid, Stream& stream, const Packet& packet) {
    bool queued = true;
    if (goes_first(apid)) {
        queued = urgent_.try_push(packet);
    } else {
        const std::uint32_t every = realtime_every(plan_, phase_, apid);
        if (every == 0 || ++stream.since_sent < every) return;
        stream.since_sent = 0;
        queued = ordinary_.try_push(packet);
    }
    if (queued)
        queued_octets_ += packet.size;
    else
        ++dropped_packets_;
}

void EdlComm::radiate(Outbox& out) {
    auto& uhf = out.bus().uhf;
    // A link that was idle does not save up more than one largest packet.
    credit_octets_ = std::min(credit_octets_ + octets_per_cycle_, static_cast<double>(packet_max) + octets_per_cycle_);
    const auto send_from = [&](auto& queue) {
        while (!queue.empty()) {
            const Packet& packet = queue.front();
            if (packet.size > credit_octets_ || uhf.size() + packet.size > uhf.capacity()) return;
            uhf.append(std::span{packet.octets}.first(packet.size));
            credit_octets_ -= packet.size;
            queued_octets_ -= packet.size;
            sent_octets_ += packet.size;
            queue.pop();
        }
    };
    send_from(urgent_);
    if (urgent_.empty()) send_from(ordinary_);
}

void EdlComm::on(const PhaseChanged& change, Outbox&) {
    phase_ = change.phase;
}

void EdlComm::on(const NvmStatus& status, Outbox&) {
    nvm_ = status;
}

void EdlComm::on(const ToneStatus& status, Outbox&) {
    tone_ = status;
}

void EdlComm::on(const ClockTick& tick, Outbox& out) {
    if (at_resolution(tick.now, 1) == tick.now)
        out.record(packet::CommStatus{.nvm_used_octets = nvm_.used_octets,
                                      .nvm_records = records_,
                                      .uhf_sent_octets = sent_octets_,
                                      .uhf_queue_octets = queued_octets_,
                                      .uhf_dropped_packets = dropped_packets_,
                                      .tone_current = tone_.tone,
                                      .tone_requests = tone_.outstanding});
    radiate(out);
}

}  // namespace aeolis::flight
