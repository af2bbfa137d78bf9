// SPDX-License-Identifier: Apache-2.0
#include "simulation/links/orbiter_pass.hpp"

#include "common/time.hpp"

#include <algorithm>
#include <cmath>

namespace aeolis::simulation {
namespace {

constexpr double worst_loss_fraction = 0.9;    // our assumption: more would be no link
constexpr double forward_burst_octets = 32.0;  // our assumption, as for the uplink

double octets_of_burst(const Radio& radio, Traffic traffic) {
    return radio.uhf_burst_s * (traffic == Traffic::realtime ? radio.uhf_rate_bps : radio.relay_rate_bps) / 8.0;
}

Random drawn(Random& from) {
    return {from.bits(), 0, Stream::relay};
}

}  // namespace

RelayPass OrbiterPass::always() {
    RelayPass row;
    row.rise_after_entry_s = -std::numeric_limits<double>::infinity();
    row.set_after_entry_s = std::numeric_limits<double>::infinity();
    return row;
}

OrbiterPass::OrbiterPass(RelayPass row, const Radio& radio, Random random)
    : row_(std::move(row)), loss_(radio.uhf_loss_fraction), loss_range_km_(radio.uhf_loss_range_km),
      default_rate_bps_(radio.relay_rate_bps), realtime_octets_a_cycle_(radio.uhf_rate_bps / 8.0 * seconds_per_tick),
      errors_{ErrorBursts{loss_, octets_of_burst(radio, Traffic::realtime), random},
              ErrorBursts{loss_, octets_of_burst(radio, Traffic::files), drawn(random)},
              ErrorBursts{loss_, forward_burst_octets, drawn(random)}} {}

double OrbiterPass::range_km(double e_s) const {
    const double half_s = (row_.set_after_entry_s - row_.rise_after_entry_s) / 2.0;
    if (!std::isfinite(half_s)) return row_.nearest_km;
    const double from_middle = (e_s - row_.rise_after_entry_s - half_s) / half_s;
    return row_.nearest_km + (row_.horizon_km - row_.nearest_km) * from_middle * from_middle;
}

double OrbiterPass::loss_fraction(double e_s) const {
    const double range = range_km(e_s) / loss_range_km_;
    return std::max(range > 0.0 ? std::min(loss_ * range * range, worst_loss_fraction) : loss_, least_loss_);
}

double OrbiterPass::file_rate_bps(double e_s) const {
    double bps = default_rate_bps_;
    for (const RelayPass::Rate& rate : row_.rates)
        if (e_s - row_.rise_after_entry_s >= rate.after_rise_s) bps = rate.bps;
    return bps;
}

std::span<const std::uint8_t> OrbiterPass::hear(Traffic traffic, std::span<const std::uint8_t> octets, double e_s) {
    heard_.assign(octets.begin(), octets.end());
    ErrorBursts& errors = errors_[static_cast<std::size_t>(traffic)];
    errors.set_fraction(loss_fraction(e_s));
    errors.spoil(heard_);
    if (traffic == Traffic::realtime) errors.idle(realtime_octets_a_cycle_ - static_cast<double>(octets.size()));
    if (!row_.stored) return heard_;
    auto& kept = stores_[static_cast<std::size_t>(traffic)].octets;
    kept.insert(kept.end(), heard_.begin(), heard_.end());
    return {};
}

std::span<const std::uint8_t> OrbiterPass::deliver(Traffic traffic, double e_s) {
    Store& from = stores_[static_cast<std::size_t>(traffic)];
    const std::size_t left = from.octets.size() - from.delivered;
    const bool other_first = traffic == Traffic::files && waits(Traffic::realtime);
    if (left == 0 || other_first || e_s < delivery_begins_s()) return {};
    delivery_credit_octets_ += row_.delivery_rate_bps / 8.0 * seconds_per_tick;
    const std::size_t now = std::min(left, static_cast<std::size_t>(delivery_credit_octets_));
    delivery_credit_octets_ -= static_cast<double>(now);
    from.delivered += now;
    return std::span{from.octets}.subspan(from.delivered - now, now);
}

void OrbiterPass::spoil_forward(std::span<std::uint8_t> octets, double e_s) {
    errors_.back().set_fraction(loss_fraction(e_s));
    errors_.back().spoil(octets);
}

}  // namespace aeolis::simulation
