// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/random.hpp"

#include <cstdint>
#include <span>

namespace aeolis::simulation {

/// Error bursts of a link: within a burst an octet takes any value, between bursts octets arrive unchanged. Lengths of
/// bursts and gaps are exponential ([gilbert-1960], with mean lengths in place of probabilities).
class ErrorBursts {
  public:
    /// `fraction` of all octets is in bursts, 0 … below 1; a burst has `mean_octets` on average, above 0.
    ErrorBursts(double fraction, double mean_octets, Random random);

    /// Sets another fraction from here on; the present burst or gap keeps its drawn length.
    void set_fraction(double fraction);

    void spoil(std::span<std::uint8_t> octets);
    /// Lets the time of `octets` pass without sending; bursts begin and end meanwhile.
    void idle(double octets);

  private:
    double drawn(double mean_octets);
    void turn();
    static double good_octets(double fraction, double bad_octets);

    double bad_octets_, good_octets_;  ///< means; good_octets_ of 0: no bursts
    Random random_;
    bool bad_ = false;
    double left_octets_ = 0.0;  ///< of the present burst or gap
};

}  // namespace aeolis::simulation
