#pragma once

#include "simulation/random.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

namespace aeolis::simulation {

/// A radio channel that is clear and spoilt in turn, each for a random number of octets (exponentially distributed): a
/// spoilt octet arrives as any octet. Of frames of n octets the fraction
///   1 − clear / (clear + burst) · exp(−n / clear)
/// is lost, clear and burst being the means. Source: [gilbert-1960], with mean lengths in place of probabilities.
class BurstLoss {
  public:
    struct Means {
        double clear_octets = 0.0; ///< 0: never spoilt
        double burst_octets = 0.0;
    };
    BurstLoss(const Means& means, Random random) : means_(means), random_(random) { begin(false); }

    /// What arrives of `octets`, in place.
    void carry(std::span<std::uint8_t> octets) {
        if (means_.clear_octets <= 0.0) return;
        while (!octets.empty()) {
            const auto now = static_cast<std::size_t>(std::min(std::ceil(left_octets_), static_cast<double>(octets.size())));
            if (spoilt_)
                for (std::uint8_t& octet : octets.first(now)) octet = static_cast<std::uint8_t>(random_.bits());
            octets = octets.subspan(now);
            left_octets_ -= static_cast<double>(now);
            if (left_octets_ <= 0.0) begin(!spoilt_);
        }
    }

  private:
    void begin(bool spoilt) {
        spoilt_ = spoilt;
        left_octets_ = -std::log1p(-random_.uniform()) * (spoilt ? means_.burst_octets : means_.clear_octets);
    }

    Means means_;
    Random random_;
    bool spoilt_ = false;
    double left_octets_ = 0.0;
};

} // namespace aeolis::simulation
