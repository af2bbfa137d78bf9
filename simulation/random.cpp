// SPDX-License-Identifier: Apache-2.0
#include "simulation/random.hpp"

#include <cmath>
#include <numbers>

namespace aeolis::simulation {
namespace {

constexpr std::uint64_t golden_gamma = 0x9e3779b97f4a7c15ULL;

constexpr std::uint64_t mix(std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
}

}  // namespace

Random::Random(std::uint64_t seed, std::uint64_t case_number, Stream stream)
    : state_(mix(mix(mix(seed + golden_gamma) + case_number + golden_gamma) + static_cast<std::uint64_t>(stream))) {}

std::uint64_t Random::bits() {
    state_ += golden_gamma;
    return mix(state_);
}

double Random::uniform() {
    return static_cast<double>(bits() >> 11) * 0x1.0p-53;
}

double Random::normal() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * uniform());
}

std::array<double, 3> Random::normal3() {
    std::array<double, 3> values{};
    for (double& value : values) value = normal();
    return values;
}

}  // namespace aeolis::simulation
