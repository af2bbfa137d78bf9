#pragma once

#include "common/time.hpp"
#include "simulation/devices/recorder.hpp"

#include <cstdint>
#include <span>

namespace aeolis::simulation {

/// After landing the recording comes down as the space packets it is made of, in order, at the relay's rate; one
/// endless pass. (Issue D replaces it by files and passes.)
class RelayLink {
  public:
    explicit RelayLink(double rate_bps) : rate_bps_(rate_bps) {}

    /// One cycle over the recording so far: calls `deliver(left_us, packet)` for what left it whole; `left_us` counts
    /// from the start of the cycle.
    template <typename Deliver>
    void cycle(std::span<const std::uint8_t> recording, Deliver&& deliver) {
        const double cycle_bits = rate_bps_ * seconds_per_tick;
        credit_bits_ += cycle_bits;
        auto left = recording.subspan(sent_octets_);
        while (true) {
            const auto packet = take_packet(left);
            if (packet.empty()) {
                credit_bits_ = 0.0; // idle time is not saved up
                return;
            }
            const double bits = static_cast<double>(packet.size()) * 8.0;
            if (bits > credit_bits_) return;
            credit_bits_ -= bits;
            sent_octets_ += packet.size();
            deliver(static_cast<std::int64_t>((1.0 - credit_bits_ / cycle_bits) * seconds_per_tick * 1.0e6), packet);
        }
    }

    std::size_t sent_octets() const { return sent_octets_; }

  private:
    double rate_bps_;
    double credit_bits_ = 0.0;
    std::size_t sent_octets_ = 0;
};

} // namespace aeolis::simulation
