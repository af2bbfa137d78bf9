// SPDX-License-Identifier: Apache-2.0
#include "simulation/links/fast_normal.hpp"

#include <cmath>
#include <numbers>
#include <vector>

namespace aeolis::simulation {
namespace {

/// Quantiles of the normal distribution at the middles of 65 536 equal parts, by Newton's method from part to part.
std::vector<float> normal_quantiles() {
    constexpr int parts = 65536;
    std::vector<float> quantiles(parts);
    double x = 0.0;
    double squares = 0.0;
    for (int i = parts / 2; i < parts; ++i) {
        const double probability = (i + 0.5) / parts;
        for (int step = 0; step < 6; ++step) {
            const double above = 0.5 * std::erfc(x / std::numbers::sqrt2) - (1.0 - probability);
            const double density = std::exp(-0.5 * x * x) / std::sqrt(2.0 * std::numbers::pi);
            x += above / density;
        }
        quantiles[static_cast<std::size_t>(i)] = static_cast<float>(x);
        squares += 2.0 * x * x;
    }
    const auto to_unit = static_cast<float>(1.0 / std::sqrt(squares / parts));
    for (int i = parts / 2; i < parts; ++i) {
        quantiles[static_cast<std::size_t>(i)] *= to_unit;
        quantiles[static_cast<std::size_t>(parts - 1 - i)] = -quantiles[static_cast<std::size_t>(i)];
    }
    return quantiles;
}

const std::vector<float>& quantiles() {
    static const std::vector<float> once = normal_quantiles();
    return once;
}

}  // namespace

FastNormal::FastNormal(std::uint64_t seed, std::uint64_t case_number, Stream stream)
    : random_(seed, case_number, stream), quantiles_(quantiles().data()) {}

void FastNormal::draw() {
    const std::uint64_t bits = random_.bits();
    const float a = quantiles_[bits & 0xffff], b = quantiles_[bits >> 16 & 0xffff];
    const float c = quantiles_[bits >> 32 & 0xffff], d = quantiles_[bits >> 48];
    const float ab = a + b, amb = a - b, cd = c + d, cmd = c - d;
    quartet_ = {0.5F * (ab + cd), 0.5F * (amb + cmd), 0.5F * (ab - cd), 0.5F * (amb - cmd)};
    next_ = 0;
}

}  // namespace aeolis::simulation
