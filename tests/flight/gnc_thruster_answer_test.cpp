// SPDX-License-Identifier: Apache-2.0
#include "flight/gnc/attitude/thruster_answer.hpp"

#include "flight/devices/effectors.hpp"
#include "tests/support/catch.hpp"

#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace flight_gnc_thruster_answer_test {

using namespace aeolis;
using namespace aeolis::flight;
using namespace aeolis::flight::gnc;
constexpr aeolis::flight::Parameters parameters;

namespace {

const Inertia inertia{4500.0, 5000.0};

/// When a pulse that is commanded in a cycle turns the vehicle: in the second cycle behind it, or half of it there and
/// half in the next, as thruster_answer.hpp has it.
enum class Comes : std::uint8_t { at_once, in_halves };

/// A vehicle whose thrusters give `obeyed` of what is commanded; what else turns it, and how its gyros err, is given as
/// a rate.
struct Turning {
    explicit Turning(double obeyed_part = 1.0, Comes as = Comes::at_once) : obeyed(obeyed_part), comes(as) {}

    double obeyed;
    Comes comes;
    Vector3 rate = Vector3::Zero();
    std::array<Vector3, 3> coming{Vector3::Zero(), Vector3::Zero(), Vector3::Zero()};  // by the cycles from now on
    ThrusterAnswer answer;

    /// One cycle with a pulse of `on_s` by thruster `number`, none for 0 s.
    std::optional<double> cycle(std::size_t number, double on_s, const Vector3& otherwise = Vector3::Zero(),
                                bool heard = true) {
        rate += std::exchange(coming[0], coming[1]);
        coming[1] = std::exchange(coming[2], Vector3::Zero());
        const auto said = answer.feel(parameters, heard ? std::optional<Vector3>{rate + otherwise} : std::nullopt);
        ThrusterCommand pulses;
        pulses.on_s[number] = on_s;
        const Effector by = entry_thrusters()[number];
        const Vector3 impulse =
            obeyed * thruster_force_N * on_s * to_vector(by.position_B_m).cross(to_vector(by.direction_B));
        const Vector3 turn{impulse.x() / inertia.across, impulse.y() / inertia.across, impulse.z() / inertia.along_z};
        const double first = comes == Comes::at_once ? 1.0 : 0.5;
        coming[1] += first * turn;
        coming[2] += (1.0 - first) * turn;
        answer.command(pulses, inertia);
        return said;
    }
    /// What is said of `count` full pulses by thrusters in turn, four cycles apart.
    template <typename Otherwise>
    std::vector<double> pulse(int count, const Otherwise& otherwise) {
        std::vector<double> all;
        for (int i = 0; i < 4 * count; ++i)
            if (const auto said = cycle(static_cast<std::size_t>(i / 4) % thruster_count,
                                        i % 4 == 0 ? seconds_per_tick : 0.0, otherwise(i)))
                all.push_back(*said);
        return all;
    }
    std::vector<double> pulse(int count) {
        return pulse(count, [](int) -> Vector3 { return Vector3::Zero(); });
    }
};

}  // namespace

TEST_CASE("of thrusters that obey about all is felt, of those that do not nothing, and of some what they give",
          "[gnc][attitude][R27]") {
    for (const Comes comes : {Comes::at_once, Comes::in_halves})
        for (const double obeyed : {1.0, 0.0, 0.5}) {
            Turning vehicle{obeyed, comes};
            const auto said = vehicle.pulse(200);
            REQUIRE(said.size() >= 2);
            for (const double part : said) CHECK(part == Approx(obeyed).margin(0.02));  // a window may end in a pulse
        }
}

TEST_CASE("what turns the vehicle slowly is not taken for thrusters", "[gnc][attitude]") {
    for (const double obeyed : {1.0, 0.0}) {
        Turning vehicle{obeyed};
        // It swings by 30°/s in two seconds, about an axis that the thrusters push about too.
        const auto said = vehicle.pulse(
            200, [](int i) -> Vector3 { return 0.5 * std::sin(3.14 * i * seconds_per_tick) * Vector3{0.6, 0.8, 0.0}; });
        REQUIRE(said.size() >= 2);
        for (const double part : said) CHECK(part == Approx(obeyed).margin(0.15));
    }
}

TEST_CASE("a torque that is commanded on and on is judged about the axis of symmetry, which nothing else turns",
          "[gnc][attitude][R27]") {
    for (const double obeyed : {1.0, 0.0}) {
        Turning vehicle{obeyed};
        std::vector<double> said;
        for (int i = 0; i < 640; ++i)
            if (const auto part = vehicle.cycle(0, seconds_per_tick)) said.push_back(*part);
        REQUIRE(said.size() >= 2);
        for (const double part : said) CHECK(part == Approx(obeyed).margin(0.05));
    }
}

TEST_CASE("nothing is said before enough is commanded, or while the IMU is silent", "[gnc][attitude]") {
    Turning still;
    for (int i = 0; i < 6400; ++i) CHECK_FALSE(still.cycle(0, 0.0, Vector3{0.001 * (i % 2), 0.0, 0.0}));
    Turning deaf;
    for (int i = 0; i < 6400; ++i)
        CHECK_FALSE(deaf.cycle(0, i % 4 == 0 ? seconds_per_tick : 0.0, Vector3::Zero(), false));
    Turning gaps;  // two cycles after each silent one have no changes of the rate either
    for (int i = 0; i < 6400; ++i) CHECK_FALSE(gaps.cycle(0, seconds_per_tick, Vector3::Zero(), i % 3 != 0));
}

TEST_CASE("what was commanded before a new beginning need not be felt", "[gnc][attitude]") {
    Turning vehicle{0.0};
    vehicle.pulse(10);
    vehicle.answer.forget();
    vehicle.obeyed = 1.0;
    for (const double part : vehicle.pulse(200)) CHECK(part == Approx(1.0).margin(0.02));
}

}  // namespace flight_gnc_thruster_answer_test
