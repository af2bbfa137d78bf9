// SPDX-License-Identifier: Apache-2.0
#include "simulation/links/x_band_link.hpp"

#include "simulation/vectors.hpp"

namespace aeolis::simulation {
namespace {

constexpr int symbol_ticks = 640;                           // 10 s [facts]
constexpr double modulation_index_rad = 32.0 * degree_rad;  // as in mfsk.csv; a test compares the two

}  // namespace

double XBandLink::carrier_power_db() {
    return 20.0 * std::log10(std::cos(modulation_index_rad));
}

double XBandLink::tone_power_db() {
    constexpr double first_sidebands = 8.0 / (std::numbers::pi * std::numbers::pi);
    return 10.0 * std::log10(first_sidebands) + 20.0 * std::log10(std::sin(modulation_index_rad));
}

std::optional<XBandLink::Symbol> XBandLink::cycle(std::optional<ToneId> tone, const Surroundings& at) {
    earth_up_ = at.gain && (radio_.earth_set_after_entry_s ? at.e_s < *radio_.earth_set_after_entry_s : at.earth_up);
    reason_ = earth_up_ ? "nominal" : at.gain ? "Earth set" : "not switched on";

    const bool whole = symbol_ && symbol_->ticks == symbol_ticks;
    const bool broken = symbol_ && (!earth_up_ || !tone || *tone != symbol_->tone);
    std::optional<Symbol> ended;
    if (whole || broken) symbol_.swap(ended);
    if (tone && earth_up_ && !symbol_) symbol_ = Symbol{*tone, at.now};
    if (symbol_) ++symbol_->ticks;
    return ended;
}

}  // namespace aeolis::simulation
