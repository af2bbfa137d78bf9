// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/random.hpp"

#include <cstdint>
#include <span>

namespace aeolis::simulation {

/// Errors of a link come in bursts: within one an octet is anything, between them all arrive as they were sent. Lengths
/// of bursts, and of the times between, are exponential ([gilbert-1960], with mean lengths in place of probabilities).
class ErrorBursts {
  public:
    /// `fraction` of all octets are in bursts, 0 … below 1, of `mean_octets` on average, above 0.
    ErrorBursts(double fraction, double mean_octets, Random random);

    /// From here on another part of all octets; a burst, or a good stretch, that has begun ends as it was drawn.
    void set_fraction(double fraction);

    void spoil(std::span<std::uint8_t> octets);
    /// Nothing is sent for as long as so many octets take: a burst goes on, and ends, all the same.
    void idle(double octets);

  private:
    double drawn(double mean_octets);
    void turn();
    static double good_octets(double fraction, double bad_octets);

    double bad_octets_, good_octets_;  ///< means; no good_octets_: no bursts at all
    Random random_;
    bool bad_ = false;
    double left_octets_ = 0.0;  ///< of the state it is in
};

}  // namespace aeolis::simulation
