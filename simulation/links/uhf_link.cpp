#include "simulation/links/uhf_link.hpp"

#include "common/time.hpp"
#include "simulation/devices/recorder.hpp"

#include <cmath>

namespace aeolis::simulation {
namespace {

constexpr std::size_t transmitter_octets = 65536; // ours
constexpr const char* nominal = "nominal";

} // namespace

void UhfLink::offer(std::span<const std::uint8_t> packets) {
    for (auto packet = take_packet(packets); !packet.empty(); packet = take_packet(packets)) {
        if (waiting_octets_ + packet.size() > transmitter_octets) {
            ++lost_packets_;
            continue;
        }
        waiting_octets_ += packet.size();
        waiting_.emplace_back(packet.begin(), packet.end());
    }
}

const char* UhfLink::why_down(const Surroundings& at) {
    if (!at.transmitter_on) return "not switched on";
    const bool entered = at.e_s >= 0.0;
    if (entered && at.speed_mps < radio_.blackout_end_speed_mps) blackout_over_ = true;
    const bool plasma =
        entered && !blackout_over_ &&
        (at.altitude_m < radio_.blackout_start_altitude_m || at.speed_mps < radio_.blackout_start_speed_mps);
    return plasma ? "plasma blackout" : nullptr;
}

void UhfLink::cycle(const Surroundings& at, std::vector<Delivered>& delivered) {
    const char* down = why_down(at);
    up_ = down == nullptr;
    reason_ = up_ ? nominal : down;
    double bits_left = radio_.uhf_rate_bps * seconds_per_tick;
    const double cycle_bits = bits_left;
    while (!waiting_.empty() && bits_left > 0.0) {
        std::vector<std::uint8_t>& first = waiting_.front();
        if (!up_) first_spoilt_ = true;
        const double wanted_bits = static_cast<double>(first.size()) * 8.0 - sent_bits_of_first_;
        if (wanted_bits > bits_left) {
            sent_bits_of_first_ += bits_left;
            return;
        }
        bits_left -= wanted_bits;
        waiting_octets_ -= first.size();
        const bool lost_at_random = random_.uniform() < radio_.uhf_loss_fraction;
        if (first_spoilt_ || lost_at_random) {
            ++lost_packets_;
        } else {
            const double part = (cycle_bits - bits_left) / cycle_bits;
            delivered.push_back(
                {static_cast<std::int64_t>(std::ceil(part * seconds_per_tick * 1.0e6)), std::move(first)});
        }
        waiting_.pop_front();
        sent_bits_of_first_ = 0.0;
        first_spoilt_ = false;
    }
}

} // namespace aeolis::simulation
