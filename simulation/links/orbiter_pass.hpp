// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/links/error_bursts.hpp"
#include "simulation/scenario.hpp"

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace aeolis::simulation {

/// Octets on UHF are the landing's own, or files of its recording.
enum class Traffic : std::uint8_t { realtime, files };

/// A pass of an orbiter over the vehicle: what it hears, spoilt the more the farther it is, and when Earth has it.
///
/// In       octets that leave the vehicle while it is in view, in order     Out   the same, spoilt: at once, or later
/// Memory   what it has recorded and not delivered
/// Left out: its orbit; range runs along a parabola between rise and set. Light time from orbiter to vehicle, Doppler.
class OrbiterPass {
  public:
    OrbiterPass(RelayPass row, const Radio& radio, Random random);
    /// The bent pipe of a scenario without passes: always in view, wherever it is.
    static RelayPass always();

    const RelayPass& row() const { return row_; }
    /// `e_s`: seconds from the scenario's entry, as all times here.
    bool in_view(double e_s) const { return e_s >= row_.rise_after_entry_s && e_s < row_.set_after_entry_s; }
    bool is_over(double e_s) const { return e_s >= row_.set_after_entry_s && !waits(); }
    double range_km(double e_s) const;
    double loss_fraction(double e_s) const;
    double file_rate_bps(double e_s) const;

    /// What is sent in one cycle, of a bent pipe what Earth receives of it, good until the next call; an orbiter that
    /// records keeps it. Bursts of errors last by the clock, also while the vehicle has nothing to send in real time.
    std::span<const std::uint8_t> hear(Traffic traffic, std::span<const std::uint8_t> octets, double e_s);
    /// What an orbiter that records delivers in this cycle, files after all else; good until the next call.
    std::span<const std::uint8_t> deliver(Traffic traffic, double e_s);
    /// Something that it recorded is not delivered yet.
    bool waits() const { return waits(Traffic::realtime) || waits(Traffic::files); }
    bool delivers(double e_s) const { return waits() && e_s >= delivery_begins_s(); }

    /// What of ground's octets reaches the vehicle.
    void spoil_forward(std::span<std::uint8_t> octets, double e_s);

  private:
    struct Store {
        std::vector<std::uint8_t> octets;
        std::size_t delivered = 0;
    };

    double delivery_begins_s() const { return row_.set_after_entry_s + row_.delivery_after_set_s; }
    bool waits(Traffic traffic) const {
        const Store& store = stores_[static_cast<std::size_t>(traffic)];
        return store.delivered < store.octets.size();
    }

    RelayPass row_;
    double loss_, loss_range_km_, default_rate_bps_;
    double realtime_octets_a_cycle_;
    std::array<ErrorBursts, 3> errors_;  ///< of both kinds of traffic, and of the forward link
    std::array<Store, 2> stores_;
    std::vector<std::uint8_t> heard_;
    double delivery_credit_octets_ = 0.0;
};

}  // namespace aeolis::simulation
