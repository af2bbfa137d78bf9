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

/// Kinds of octets on UHF: real-time data of the landing, or files of its recording.
enum class Traffic : std::uint8_t { realtime, files };

/// An orbiter's pass over the vehicle: what it hears, with errors that grow with range, and when Earth has it.
///
/// In       octets that leave the vehicle while the orbiter is in view, in order
/// Out      the same, with errors: at once, or later
/// Memory   the recorded octets that are not yet delivered
/// Left out: the orbit (range follows a parabola between rise and set), light time between orbiter and vehicle,
/// Doppler.
class OrbiterPass {
  public:
    OrbiterPass(RelayPass row, const Radio& radio, Random random);
    /// The bent pipe of a scenario without passes: always in view.
    static RelayPass always();

    const RelayPass& row() const { return row_; }
    /// `e_s`: seconds from the scenario's entry, as all times here.
    bool in_view(double e_s) const { return e_s >= row_.rise_after_entry_s && e_s < row_.set_after_entry_s; }
    bool is_over(double e_s) const { return e_s >= row_.set_after_entry_s && !waits(); }
    double range_km(double e_s) const;
    double loss_fraction(double e_s) const;
    double file_rate_bps(double e_s) const;
    /// From now on the link loses this part, where it would lose less; 0: as it is.
    void lose_at_least(double fraction) { least_loss_ = fraction; }

    /// Receives the octets of one cycle. A bent pipe returns what Earth receives of them, valid until the next call; a
    /// recording orbiter keeps them. Error bursts follow the clock, also while the vehicle sends nothing in real time.
    std::span<const std::uint8_t> hear(Traffic traffic, std::span<const std::uint8_t> octets, double e_s);
    /// A recording orbiter's delivery in this cycle, files last; valid until the next call.
    std::span<const std::uint8_t> deliver(Traffic traffic, double e_s);
    /// Whether recorded octets are still undelivered.
    bool waits() const { return waits(Traffic::realtime) || waits(Traffic::files); }
    bool delivers(double e_s) const { return waits() && e_s >= delivery_begins_s(); }

    /// Adds the link's errors to ground's octets for the vehicle.
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
    double loss_, loss_range_km_, default_rate_bps_, least_loss_ = 0.0;
    double realtime_octets_a_cycle_;
    std::array<ErrorBursts, 3> errors_;  ///< of both kinds of traffic and of the forward link
    std::array<Store, 2> stores_;
    std::vector<std::uint8_t> heard_;
    double delivery_credit_octets_ = 0.0;
};

}  // namespace aeolis::simulation
