// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/random.hpp"
#include "simulation/scenario.hpp"

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace aeolis::simulation {

struct Air {
    double density_kgm3 = 0.0;
    double speed_of_sound_mps = 0.0;
};

/// A column of rows by height: linear between them, held outside; without rows `otherwise`.
double at_height(std::span<const DensityScale> rows, double DensityScale::* column, double altitude_m,
                 double otherwise);
/// Whether any row has a deviation of density.
bool has_deviations(std::span<const DensityScale> rows);
/// What is believed of the scale of density, with the deviations that the truth's cases have.
std::vector<DensityScale> with_deviations_of(std::span<const DensityScale> believed,
                                             std::span<const DensityScale> truth);

/// The air above the landing site: the scenario's table or that of Gale (see atmosphere.cpp), its scale by height, and
/// a case's departure.
///
/// Tables are sampled every kilometre.
/// Density is interpolated exponentially, temperature and scale linearly; outside the table its last layers continue.
/// Range −1 … 250 km above the landing radius; above 250 km there is no air.
/// The departure is our assumption: four fifths of the scenario's fraction at all heights alike, three fifths as a wave
/// over height. Where the scenario has a fraction of its own aloft, the departure goes evenly to it from 50 to 65 km.
/// [facts] Where its scale has deviations by height, the fraction is theirs.
class Atmosphere {
  public:
    /// Without departure. `air`: empty: Gale's.
    explicit Atmosphere(std::span<const DensityScale> scales, std::span<const AirRow> air = {});
    Atmosphere(std::span<const DensityScale> scales, std::span<const AirRow> air, const Dispersions& dispersions,
               Random random);

    Air at(double altitude_m) const;
    /// From now on the air is so many times as dense at all heights.
    void shift(double factor) { shift_factor_ = factor; }
    /// The case's departure: at all heights alike, and the phase of its wave over height.
    double departure_fraction() const { return departure_fraction_; }
    double wave_phase_rad() const { return wave_phase_rad_; }
    double aloft_departure() const { return aloft_departure_; }
    /// Where deviations go by height: what was drawn, in standard deviations; else none.
    std::optional<double> drawn_sigmas() const { return by_height_ ? std::optional{drawn_} : std::nullopt; }

  private:
    static constexpr std::size_t rows = 257;  ///< scale and table together, every kilometre from −2 km
    double departure(double altitude_m) const;

    std::array<double, rows> log_density_{};
    std::array<double, rows> speed_of_sound_mps_{};
    std::array<double, rows> deviation_{};  ///< by height, where `by_height_`
    bool by_height_ = false;
    double drawn_ = 0.0;  ///< of the part of the departure that is alike at all heights, in standard deviations
    double departure_fraction_ = 0.0, wave_fraction_ = 0.0, wave_phase_rad_ = 0.0;
    double shift_factor_ = 1.0;
    double aloft_departure_ = 0.0, aloft_wave_ = 0.0;  ///< as above, from 65 km up
};

}  // namespace aeolis::simulation
