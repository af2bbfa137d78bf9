// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/random.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

namespace aeolis::simulation {

/// Normal deviates for millions of noise samples a second.
///
/// The four 16-bit parts of a draw are looked up among the 65 536 quantiles of the normal distribution, then turned by
/// a Hadamard matrix, which fills the gaps between quantiles. Mean 0, deviation 1, uncorrelated; a deviate reaches 8.6.
/// Copies continue alike. Source: our design, on the bits of [steele-2014].
class FastNormal {
  public:
    FastNormal(std::uint64_t seed, std::uint64_t case_number, Stream stream);

    float operator()() {
        if (next_ == 4) draw();
        return quartet_[next_++];
    }

  private:
    void draw();

    Random random_;
    const float* quantiles_;  ///< static
    std::array<float, 4> quartet_{};
    std::size_t next_ = 4;
};

}  // namespace aeolis::simulation
