// SPDX-License-Identifier: Apache-2.0
#include "flight/edl_comm/realtime_queue.hpp"

#include <algorithm>
#include <numeric>

namespace aeolis::flight {

RealtimeQueue::RealtimeQueue() {
    for (std::size_t slot = packets_max; slot-- > 0;) free_.push_back(static_cast<Slot>(slot));
}

bool RealtimeQueue::offer(const TelemetryPacket& packet, TelemetryPriority priority) {
    const bool full = free_.empty();
    if (full) {
        const auto least = static_cast<std::size_t>(
            std::ranges::find_if(waiting_, [](const auto& each) { return !each.empty(); }) - waiting_.begin());
        AEOLIS_CHECK(least < waiting_.size());
        ++dropped_[std::min(least, index(priority))];
        if (least > index(priority)) return false;
        release_oldest(least);
    }
    const Slot slot = free_.back();
    free_.pop_back();
    packets_[slot] = packet;
    AEOLIS_CHECK(waiting_[index(priority)].try_push(slot));
    waiting_octets_[index(priority)] += packet.size;
    return !full;
}

const TelemetryPacket& RealtimeQueue::front() const {
    return packets_[waiting_[most_important()].front()];
}

void RealtimeQueue::pop() {
    release_oldest(most_important());
}

std::size_t RealtimeQueue::most_important() const {
    AEOLIS_CHECK(!empty());
    std::size_t most = 0;
    for (std::size_t priority = 0; priority < waiting_.size(); ++priority)
        if (!waiting_[priority].empty()) most = priority;
    return most;
}

void RealtimeQueue::release_oldest(std::size_t priority) {
    const Slot slot = waiting_[priority].front();
    waiting_[priority].pop();
    waiting_octets_[priority] -= packets_[slot].size;
    free_.push_back(slot);
}

std::uint32_t RealtimeQueue::waiting_octets() const {
    return std::accumulate(waiting_octets_.begin(), waiting_octets_.end(), std::uint32_t{0});
}

std::uint32_t RealtimeQueue::dropped() const {
    return std::accumulate(dropped_.begin(), dropped_.end(), std::uint32_t{0});
}

}  // namespace aeolis::flight
