#include "simulation/mars/wind.hpp"

namespace aeolis::simulation {
namespace {

constexpr double gust_top_m = 5000.0;
constexpr double gust_east_length_m = 410.0;
constexpr double gust_north_length_m = 530.0;

} // namespace

Wind::Wind(double steady_east_mps, double steady_north_mps, double deviation_mps, Random random)
    : east_mps_(steady_east_mps + deviation_mps * random.normal()),
      north_mps_(steady_north_mps + deviation_mps * random.normal()), gust_mps_(0.5 * deviation_mps),
      east_phase_rad_(2.0 * std::numbers::pi * random.uniform()),
      north_phase_rad_(2.0 * std::numbers::pi * random.uniform()) {}

Vector3 Wind::at(const Vector3& p, double altitude_m) const {
    double east_mps = east_mps_;
    double north_mps = north_mps_;
    if (altitude_m < gust_top_m && gust_mps_ != 0.0) {
        const double fade = gust_mps_ * (1.0 - altitude_m / gust_top_m);
        east_mps += fade * std::sin(2.0 * std::numbers::pi * altitude_m / gust_east_length_m + east_phase_rad_);
        north_mps += fade * std::sin(2.0 * std::numbers::pi * altitude_m / gust_north_length_m + north_phase_rad_);
    }
    if (east_mps == 0.0 && north_mps == 0.0) return Vector3::Zero();
    const Horizon at = horizon(p);
    return east_mps * at.east + north_mps * at.north;
}

} // namespace aeolis::simulation
