// SPDX-License-Identifier: Apache-2.0
#include "simulation/links/error_bursts.hpp"

#include <cmath>

namespace aeolis::simulation {

ErrorBursts::ErrorBursts(double fraction, double mean_octets, Random random)
    : bad_octets_(mean_octets), good_octets_(good_octets(fraction, mean_octets)), random_(random) {
    if (good_octets_ > 0.0) left_octets_ = drawn(good_octets_);
}

double ErrorBursts::good_octets(double fraction, double bad_octets) {
    return fraction > 0.0 ? bad_octets * (1.0 - fraction) / fraction : 0.0;
}

void ErrorBursts::set_fraction(double fraction) {
    const bool none_before = good_octets_ <= 0.0;
    good_octets_ = good_octets(fraction, bad_octets_);
    if (none_before && good_octets_ > 0.0) left_octets_ = drawn(good_octets_);
}

double ErrorBursts::drawn(double mean_octets) {
    return -mean_octets * std::log1p(-random_.uniform());
}

void ErrorBursts::spoil(std::span<std::uint8_t> octets) {
    if (good_octets_ <= 0.0) return;
    for (std::uint8_t& octet : octets) {
        while (left_octets_ < 1.0) turn();
        left_octets_ -= 1.0;
        if (bad_) octet = static_cast<std::uint8_t>(random_.bits());
    }
}

void ErrorBursts::idle(double octets) {
    if (good_octets_ <= 0.0 || octets <= 0.0) return;
    while (left_octets_ < octets) turn();
    left_octets_ -= octets;
}

void ErrorBursts::turn() {
    bad_ = !bad_;
    left_octets_ += drawn(bad_ ? bad_octets_ : good_octets_);
}

}  // namespace aeolis::simulation
