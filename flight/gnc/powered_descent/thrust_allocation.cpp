#include "flight/gnc/powered_descent/thrust_allocation.hpp"

#include <algorithm>
#include <cmath>

namespace aeolis::flight::gnc::powered_descent {

std::array<double, 8> throttles_for(double thrust_N, int engines, double engine_max_thrust_N, double& given_N) {
    const double each_N = std::clamp(thrust_N / engines, engine_used_min_N, engine_used_max_N);
    given_N = each_N * engines;
    std::array<double, 8> throttle{};
    const std::size_t stride = engines == 4 ? 2 : 1;
    for (std::size_t i = 0; i < throttle.size(); i += stride)
        throttle[i] = each_N / engine_max_thrust_N;
    return throttle;
}

Thrust allocate(const Vector3& specific_force_M, const Vector3& up_M, double mass_kg, int engines,
                double engine_max_thrust_N) {
    const double up = std::max(specific_force_M.dot(up_M), 0.0);
    const Vector3 level = specific_force_M - specific_force_M.dot(up_M) * up_M;
    // Lift comes before sidestep: beyond the tilt limit, or of thrust, it is the level part that gives way.
    const double most_level =
        std::min(std::tan(tilt_max_rad) * up,
                 std::sqrt(std::max(std::pow(engines * engine_used_max_N / mass_kg, 2) - up * up, 0.0)));
    const double norm = level.norm();
    const Vector3 wanted = up * up_M + (norm > most_level ? Vector3(level * (most_level / norm)) : level);
    Thrust thrust;
    const double magnitude = wanted.norm();
    thrust.direction_M = magnitude > 1.0e-6 ? Vector3(wanted / magnitude) : up_M;
    thrust.throttle = throttles_for(magnitude * mass_kg, engines, engine_max_thrust_N, thrust.magnitude_N);
    return thrust;
}

} // namespace aeolis::flight::gnc::powered_descent
