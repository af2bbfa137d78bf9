// SPDX-License-Identifier: Apache-2.0
#include "simulation/mars/atmosphere.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace aeolis::simulation {
namespace {

constexpr double grows_from_m = 50'000.0, grows_over_m = 15'000.0;  // of the departure. [facts] (L)

// clang-format off
/// Gale in the season of the landing, from a general circulation model. [gale-atmosphere]
constexpr std::array<AirRow, 35> gale{{
    {0,        194.541, 0.0195581    },
    {7352.94,  218.893, 0.00938476   },
    {14705.9,  200.782, 0.00518105   },
    {22058.8,  180.643, 0.00272454   },
    {29411.8,  173.902, 0.001265     },
    {36764.7,  175.245, 0.000558136  },
    {44117.6,  174.95,  0.000249716  },
    {51470.6,  169.97,  0.000113644  },
    {58823.5,  162.451, 5.14132e-05  },
    {66176.5,  150.246, 2.26365e-05  },
    {73529.4,  140.37,  9.31522e-06  },
    {80882.4,  141.065, 3.47447e-06  },
    {88235.3,  145.247, 1.28318e-06  },
    {95588.2,  148.469, 4.8883e-07   },
    {102941,   142.646, 1.99619e-07  },
    {110294,   131.164, 8.07924e-08  },
    {117647,   125.699, 3.01452e-08  },
    {125000,   126.025, 1.06699e-08  },
    {132353,   131.041, 3.77249e-09  },
    {139706,   137.403, 1.41003e-09  },
    {147059,   142.069, 5.69444e-10  },
    {154412,   144.821, 2.4457e-10   },
    {161765,   146.278, 1.10869e-10  },
    {169118,   147.021, 5.28509e-11  },
    {176471,   147.406, 2.64369e-11  },
    {183824,   147.616, 1.37981e-11  },
    {191176,   147.725, 7.6012e-12   },
    {198529,   147.785, 4.46644e-12  },
    {205882,   147.828, 2.66222e-12  },
    {213235,   147.85,  1.68757e-12  },
    {220588,   147.867, 1.09031e-12  },
    {227941,   147.876, 7.30914e-13  },
    {235294,   147.884, 4.96918e-13  },
    {242647,   147.89,  3.51821e-13  },
    {250000,   147.895, 2.45314e-13  },
}};
// clang-format on

// Square of the speed of sound over temperature: ratio of specific heats × gas constant, from the Mach numbers of the
// published trajectory, within 0.3 %. [od137]
constexpr double sound_m2ps2K = 252.0;
constexpr double bottom_m = -2000.0;
constexpr double spacing_m = 1000.0;
constexpr double top_m = 250000.0;
constexpr double wave_length_m = 30000.0;  // our assumption

}  // namespace

double at_height(std::span<const DensityScale> rows, double DensityScale::* column, double altitude_m,
                 double otherwise) {
    if (rows.empty()) return otherwise;
    if (altitude_m <= rows.front().altitude_m) return rows.front().*column;
    for (std::size_t i = 1; i < rows.size(); ++i) {
        const DensityScale& low = rows[i - 1];
        const DensityScale& high = rows[i];
        if (altitude_m <= high.altitude_m) {
            const double part = (altitude_m - low.altitude_m) / (high.altitude_m - low.altitude_m);
            return low.*column + part * (high.*column - low.*column);
        }
    }
    return rows.back().*column;
}

bool has_deviations(std::span<const DensityScale> rows) {
    return std::ranges::any_of(rows, [](const DensityScale& row) { return row.deviation > 0.0; });
}

std::vector<DensityScale> with_deviations_of(std::span<const DensityScale> believed,
                                             std::span<const DensityScale> truth) {
    if (!has_deviations(truth)) return {believed.begin(), believed.end()};
    std::vector<double> heights_m;
    for (const auto& rows : {believed, truth})
        for (const DensityScale& row : rows) heights_m.push_back(row.altitude_m);
    std::ranges::sort(heights_m);
    const auto again = std::ranges::unique(heights_m);
    heights_m.erase(again.begin(), again.end());
    std::vector<DensityScale> both;
    both.reserve(heights_m.size());
    for (const double height_m : heights_m)
        both.push_back({height_m, at_height(believed, &DensityScale::scale, height_m, 1.0),
                        at_height(truth, &DensityScale::deviation, height_m, 0.0)});
    return both;
}

Atmosphere::Atmosphere(std::span<const DensityScale> scales, std::span<const AirRow> air) {
    const std::span<const AirRow> table = air.empty() ? std::span<const AirRow>{gale} : air;
    for (std::size_t i = 0; i < rows; ++i) {
        const double altitude_m = bottom_m + spacing_m * static_cast<double>(i);
        std::size_t above = 1;
        while (above + 1 < table.size() && altitude_m > table[above].altitude_m) ++above;
        const AirRow& low = table[above - 1];
        const AirRow& high = table[above];
        const double part = (altitude_m - low.altitude_m) / (high.altitude_m - low.altitude_m);
        const double log_low = std::log(low.density_kgm3);
        log_density_[i] = log_low + part * (std::log(high.density_kgm3) - log_low) +
                          std::log(at_height(scales, &DensityScale::scale, altitude_m, 1.0));
        const double temperature_K = low.temperature_K + part * (high.temperature_K - low.temperature_K);
        speed_of_sound_mps_[i] = std::sqrt(sound_m2ps2K * temperature_K);
    }
}

Atmosphere::Atmosphere(std::span<const DensityScale> scales, std::span<const AirRow> air,
                       const Dispersions& dispersions, Random random)
    : Atmosphere(scales, air) {
    const double density_fraction = dispersions.density_fraction, drawn = random.normal();
    departure_fraction_ = 0.8 * density_fraction * drawn;
    wave_fraction_ = 0.6 * std::numbers::sqrt2 * density_fraction;
    wave_phase_rad_ = 2.0 * std::numbers::pi * random.uniform();
    if (dispersions.density_aloft_fraction > 0.0) {
        aloft_departure_ = 0.8 * dispersions.density_aloft_fraction * drawn;
        aloft_wave_ = 0.6 * std::numbers::sqrt2 * dispersions.density_aloft_fraction;
    }
    by_height_ = has_deviations(scales);
    if (!by_height_) return;
    drawn_ = drawn;
    for (std::size_t i = 0; i < rows; ++i)
        deviation_[i] = at_height(scales, &DensityScale::deviation, bottom_m + spacing_m * static_cast<double>(i), 0.0);
    departure_fraction_ = 0.8 * drawn * at_height(scales, &DensityScale::deviation, 0.0, 0.0);
    aloft_departure_ = 0.8 * drawn * at_height(scales, &DensityScale::deviation, grows_from_m + grows_over_m, 0.0);
}

Air Atmosphere::at(double altitude_m) const {
    if (altitude_m > top_m) return {0.0, speed_of_sound_mps_.back()};
    const double place = std::clamp((altitude_m - bottom_m) / spacing_m, 0.0, static_cast<double>(rows - 2));
    const auto below = static_cast<std::size_t>(place);
    const double part = place - static_cast<double>(below);
    const double log_density = log_density_[below] + part * (log_density_[below + 1] - log_density_[below]);
    return {std::exp(log_density) * departure(altitude_m) * shift_factor_,
            speed_of_sound_mps_[below] + part * (speed_of_sound_mps_[below + 1] - speed_of_sound_mps_[below])};
}

double Atmosphere::departure(double altitude_m) const {
    if (by_height_) {
        const double place = std::clamp((altitude_m - bottom_m) / spacing_m, 0.0, static_cast<double>(rows - 2));
        const auto below = static_cast<std::size_t>(place);
        const double fraction = std::lerp(deviation_[below], deviation_[below + 1], place - static_cast<double>(below));
        const double turn = std::sin(2.0 * std::numbers::pi * altitude_m / wave_length_m + wave_phase_rad_);
        return std::max(0.2, 1.0 + fraction * (0.8 * drawn_ + 0.6 * std::numbers::sqrt2 * turn));
    }
    if (wave_fraction_ == 0.0 && aloft_wave_ == 0.0) return 1.0;
    const double turn = std::sin(2.0 * std::numbers::pi * altitude_m / wave_length_m + wave_phase_rad_);
    const double below = departure_fraction_ + wave_fraction_ * turn;
    if (aloft_wave_ == 0.0) return std::max(0.2, 1.0 + departure_fraction_ + wave_fraction_ * turn);
    const double part = std::clamp((altitude_m - grows_from_m) / grows_over_m, 0.0, 1.0);
    return std::max(0.2, 1.0 + std::lerp(below, aloft_departure_ + aloft_wave_ * turn, part));
}

}  // namespace aeolis::simulation
