// SPDX-License-Identifier: Apache-2.0
#include "common/aeroshell.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>

namespace aeolis {
namespace {

constexpr double aeroshell_degree_rad = std::numbers::pi / 180.0;
constexpr std::array<double, 6> table_angles_deg{0.0, 2.0, 4.0, 6.0, 11.0, 16.0};

struct CoefficientRow {
    double mach;
    std::array<double, 6> lift;  ///< magnitude; the source's axes give it a sign
    std::array<double, 6> drag;
};

// clang-format off
/// 70° sphere-cone against Mach and total angle of attack. [sphere-cone-aerodynamics]
constexpr std::array<CoefficientRow, 33> coefficient_table{{
    {0.4,  {{0, 0.0362, 0.0729, 0.1051, 0.1894, 0.2672}}, {{1.0441, 1.0464, 1.0453, 1.0398, 1.0311, 1.0112}}},
    {0.6,  {{0, 0.0382, 0.0764, 0.1096, 0.1955, 0.2758}}, {{1.0943, 1.0949, 1.0903, 1.0926, 1.0779, 1.0562}}},
    {0.8,  {{0, 0.0407, 0.0785, 0.1172, 0.2071, 0.2904}}, {{1.1618, 1.1633, 1.1569, 1.1601, 1.1532, 1.1237}}},
    {0.9,  {{0, 0.0428, 0.085, 0.1237, 0.2182, 0.3066}}, {{1.2146, 1.2152, 1.2261, 1.2241, 1.2129, 1.1834}}},
    {1,    {{0, 0.0519, 0.0976, 0.1394, 0.2389, 0.3439}}, {{1.302, 1.3069, 1.3248, 1.3236, 1.3124, 1.3046}}},
    {1.2,  {{0, 0.0594, 0.1057, 0.148, 0.2596, 0.3732}}, {{1.4136, 1.4263, 1.426, 1.4248, 1.4214, 1.4041}}},
    {1.5,  {{0, 0.0579, 0.1062, 0.1495, 0.2712, 0.3955}}, {{1.5356, 1.5457, 1.5454, 1.5408, 1.5313, 1.5114}}},
    {2,    {{0, 0.0503, 0.1017, 0.1495, 0.2692, 0.3793}}, {{1.5702, 1.5691, 1.5662, 1.5546, 1.5183, 1.4621}}},
    {3,    {{0, 0.0498, 0.1017, 0.15, 0.2687, 0.3773}}, {{1.5763, 1.5751, 1.5714, 1.5616, 1.5174, 1.4499}}},
    {4,    {{0, 0.0503, 0.1027, 0.151, 0.2702, 0.3732}}, {{1.5849, 1.5838, 1.5774, 1.5685, 1.5218, 1.4439}}},
    {5,    {{0, 0.0503, 0.1017, 0.1515, 0.2712, 0.3707}}, {{1.5962, 1.595, 1.5869, 1.5771, 1.5261, 1.4404}}},
    {6.3,  {{0, 0.0508, 0.1042, 0.1535, 0.2717, 0.3682}}, {{1.6074, 1.6045, 1.5982, 1.5875, 1.533, 1.4352}}},
    {8.8,  {{0, 0.0529, 0.1062, 0.1571, 0.2717, 0.3621}}, {{1.6273, 1.6253, 1.6155, 1.604, 1.5373, 1.4335}}},
    {9.8,  {{0, 0.0524, 0.1077, 0.1581, 0.2717, 0.3626}}, {{1.6351, 1.6331, 1.6259, 1.6143, 1.5391, 1.4378}}},
    {10.8, {{0, 0.0534, 0.1077, 0.1586, 0.2722, 0.3631}}, {{1.642, 1.6409, 1.6321, 1.6187, 1.5443, 1.4387}}},
    {11.8, {{0, 0.0529, 0.1093, 0.1596, 0.2727, 0.3621}}, {{1.6481, 1.6469, 1.6397, 1.6247, 1.5477, 1.4413}}},
    {12.8, {{0, 0.0539, 0.1103, 0.1601, 0.2722, 0.3636}}, {{1.6541, 1.6521, 1.6458, 1.6299, 1.5486, 1.443}}},
    {13.9, {{0, 0.0544, 0.1093, 0.1611, 0.2722, 0.3636}}, {{1.6619, 1.6582, 1.6518, 1.6342, 1.552, 1.4456}}},
    {15,   {{0, 0.0554, 0.1113, 0.1606, 0.2727, 0.3641}}, {{1.6732, 1.6712, 1.6587, 1.642, 1.5555, 1.4499}}},
    {16,   {{0, 0.0569, 0.1123, 0.1611, 0.2717, 0.3641}}, {{1.6853, 1.6824, 1.6717, 1.6472, 1.559, 1.4534}}},
    {17,   {{0, 0.0564, 0.1123, 0.1611, 0.2722, 0.3641}}, {{1.6965, 1.6937, 1.6769, 1.6515, 1.5624, 1.4551}}},
    {18.1, {{0, 0.0579, 0.1118, 0.1596, 0.2712, 0.3636}}, {{1.7078, 1.7015, 1.683, 1.6533, 1.5633, 1.4586}}},
    {19.2, {{0, 0.0569, 0.1113, 0.1596, 0.2717, 0.3631}}, {{1.7182, 1.7092, 1.6856, 1.6567, 1.5667, 1.4603}}},
    {20.3, {{0, 0.0564, 0.1118, 0.1586, 0.2712, 0.3631}}, {{1.726, 1.7136, 1.689, 1.6602, 1.5693, 1.4595}}},
    {21.3, {{0, 0.0554, 0.1093, 0.1591, 0.2702, 0.3626}}, {{1.7277, 1.7153, 1.6908, 1.6611, 1.5702, 1.4612}}},
    {22.4, {{0, 0.0544, 0.1088, 0.1581, 0.2717, 0.3631}}, {{1.7277, 1.717, 1.6916, 1.6645, 1.5719, 1.4612}}},
    {23.4, {{0, 0.0544, 0.1082, 0.1586, 0.2707, 0.3631}}, {{1.7268, 1.7179, 1.6942, 1.6645, 1.5702, 1.4629}}},
    {24.5, {{0, 0.0544, 0.1082, 0.1571, 0.2702, 0.3621}}, {{1.726, 1.717, 1.6951, 1.6654, 1.5719, 1.4612}}},
    {25.5, {{0, 0.0534, 0.1077, 0.1571, 0.2702, 0.3621}}, {{1.7268, 1.7179, 1.696, 1.6663, 1.5711, 1.4612}}},
    {26.4, {{0, 0.0534, 0.1082, 0.1566, 0.2692, 0.3606}}, {{1.726, 1.717, 1.6934, 1.6645, 1.5711, 1.4612}}},
    {27.2, {{0, 0.0534, 0.1082, 0.1566, 0.2687, 0.3616}}, {{1.726, 1.717, 1.6925, 1.6645, 1.5711, 1.4603}}},
    {28,   {{0, 0.0544, 0.1072, 0.1561, 0.2692, 0.3601}}, {{1.7242, 1.7136, 1.6925, 1.6628, 1.5711, 1.4585}}},
    {30,   {{0, 0.0529, 0.1047, 0.153, 0.2646, 0.3601}}, {{1.7026, 1.6954, 1.7011, 1.6619, 1.5702, 1.45}}},
}};
// clang-format on

constexpr double lift_slope_beyond_table = 0.6;  // our assumption
constexpr double lift_of_flight =
    1.04;  // our assumption: lift-to-drag of the published trajectory over the table's, 1.01 … 1.07
constexpr double largest_lift_angle_deg = 30.0;  // our assumption: beyond it lift fades to zero at 90°

struct Place {
    std::size_t below;
    double part;
};

Place aeroshell_place_of(std::span<const CoefficientRow> rows, double mach) {
    if (mach <= rows.front().mach) return {0, 0.0};
    if (mach >= rows.back().mach) return {rows.size() - 2, 1.0};
    std::size_t low = 0, high = rows.size() - 1;
    while (high - low > 1) {
        const std::size_t middle = (low + high) / 2;
        (rows[middle].mach <= mach ? low : high) = middle;
    }
    return {low, (mach - rows[low].mach) / (rows[high].mach - rows[low].mach)};
}

double by_angle(const std::array<double, 6>& values, double angle_deg, double slope_beyond) {
    std::size_t below = 0;
    while (below + 2 < table_angles_deg.size() && angle_deg > table_angles_deg[below + 1]) ++below;
    const double slope = (values[below + 1] - values[below]) / (table_angles_deg[below + 1] - table_angles_deg[below]);
    if (angle_deg <= table_angles_deg.back()) return values[below] + slope * (angle_deg - table_angles_deg[below]);
    return values.back() + slope_beyond * slope * (angle_deg - table_angles_deg.back());
}

}  // namespace

AeroCoefficients aeroshell_coefficients(double mach, double angle_of_attack_rad) {
    const double angle_deg = std::abs(angle_of_attack_rad) / aeroshell_degree_rad;
    const double used_deg = std::min(angle_deg, largest_lift_angle_deg);
    const Place at = aeroshell_place_of(coefficient_table, mach);
    const auto between = [&](const std::array<double, 6>& low, const std::array<double, 6>& high, double slope_beyond) {
        const double value = by_angle(low, used_deg, slope_beyond);
        return value + at.part * (by_angle(high, used_deg, slope_beyond) - value);
    };
    const CoefficientRow& low = coefficient_table[at.below];
    const CoefficientRow& high = coefficient_table[at.below + 1];
    AeroCoefficients coefficients{between(low.drag, high.drag, 1.0),
                                  lift_of_flight * between(low.lift, high.lift, lift_slope_beyond_table)};
    if (angle_deg > largest_lift_angle_deg)
        coefficients.lift *= std::max(0.0, (90.0 - angle_deg) / (90.0 - largest_lift_angle_deg));
    return coefficients;
}

}  // namespace aeolis
