// SPDX-License-Identifier: Apache-2.0
#include "common/navigation_message.hpp"

#include "tests/support/catch.hpp"

#include <cmath>
#include <random>

namespace common_navigation_message_test {

using namespace aeolis;

namespace {

// The standard's own example of an orbit ephemeris, typed anew [ccsds-502.0-b-3], its omitted lines left out.
const std::string orbit_example = R"(CCSDS_OEM_VERS = 3.0
CREATION_DATE  = 1996-11-04T17:22:31
ORIGINATOR     = NASA/JPL

META_START
OBJECT_NAME          = MARS GLOBAL SURVEYOR
OBJECT_ID            = 1996-062A
CENTER_NAME          = MARS BARYCENTER
REF_FRAME            = J2000
TIME_SYSTEM          = TAI
START_TIME           = 1996-12-18T12:00:00.331
USEABLE_START_TIME   = 1996-12-18T12:10:00.331
USEABLE_STOP_TIME    = 1996-12-28T21:23:00.331
STOP_TIME            = 1996-12-28T21:28:00.331
INTERPOLATION        = HERMITE
INTERPOLATION_DEGREE = 7
META_STOP

COMMENT for scheduling purposes only
1996-12-18T12:00:00.331 2789.619 -280.045 -1746.755 4.73372 -2.49586 -1.04195
1996-12-18T12:01:00.331 2783.419 -308.143 -1877.071 5.18604 -2.42124 -1.99608
1996-12-18T12:02:00.331 2776.033 -336.859 -2008.682 5.63678 -2.33951 -1.94687
1996-12-28T21:28:00.331 -3881.024 563.959 -682.773 -3.28827 -3.66735 1.63861

META_START
OBJECT_NAME          = MARS GLOBAL SURVEYOR
OBJECT_ID            = 1996-062A
CENTER_NAME          = MARS BARYCENTER
REF_FRAME            = J2000
TIME_SYSTEM          = TAI
START_TIME           = 1996-12-28T21:29:07.267
STOP_TIME            = 1996-12-30T01:28:02.267
META_STOP
1996-12-28T21:29:07.267 -2432.166 -063.042 1742.754 7.33702 -3.495867 -1.041945
1996-12-30T01:28:02.267 2164.375 1115.811 -688.131 -3.53328 -2.88452 0.88535

COVARIANCE_START
EPOCH = 1996-12-28T21:29:07.267
COV_REF_FRAME = EME2000
3.3313494e-04
4.6189273e-04 6.7824216e-04
COVARIANCE_STOP
)";

// The standard's example of an attitude ephemeris, typed anew [ccsds-504.0-b-2].
const std::string attitude_example = R"(CCSDS_AEM_VERS = 2.0
CREATION_DATE = 2002-11-04T17:22:31
ORIGINATOR = NASA/JPL
MESSAGE_ID = A7015Z3

META_START
COMMENT to be used for attitude reconstruction only
OBJECT_NAME = MARS GLOBAL SURVEYOR
OBJECT_ID = 1996-062A
CENTER_NAME = MARS BARYCENTER
REF_FRAME_A = EME2000
REF_FRAME_B = SC_BODY_1
TIME_SYSTEM = UTC
START_TIME = 1996-11-28T21:29:07.2555
USEABLE_START_TIME = 1996-11-28T22:08:02.5555
USEABLE_STOP_TIME = 1996-11-30T01:18:02.5555
STOP_TIME = 1996-11-30T01:28:02.5555
ATTITUDE_TYPE = QUATERNION
INTERPOLATION_METHOD = hermite
INTERPOLATION_DEGREE = 7
META_STOP

DATA_START
1996-11-28T21:29:07.2555 0.56748 0.03146 0.45689 0.68427
1996-11-28T22:08:03.5555 0.42319 -0.45697 0.23784 0.74533
1996-11-30T01:28:02.5555 0.74563 -0.45375 0.36875 0.31964
DATA_STOP
)";

std::string with(std::string text, const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    REQUIRE(at != std::string::npos);
    return text.replace(at, from.size(), to);
}

std::string refusal(const std::string& text) {
    const auto read = read_orbit_message(text);
    return read ? "read" : read.error().message;
}

}  // namespace

TEST_CASE("the standard's orbit ephemeris is read", "[navigation_message]") {
    const auto read = read_orbit_message(orbit_example);
    REQUIRE(read.ok());
    REQUIRE(read->size() == 2);
    const Ephemeris& first = read->front();
    CHECK(first.object == "MARS GLOBAL SURVEYOR");
    CHECK(first.frame == "J2000");
    CHECK(first.degree == 7);
    REQUIRE(first.states.size() == 4);
    CHECK(first.states[1].position_km == std::array{2783.419, -308.143, -1877.071});
    CHECK(first.states[3].velocity_kmps == std::array{-3.28827, -3.66735, 1.63861});
    CHECK(calendar_text(first.states[0].time, TimeSystem::tai) == "1996-12-18T12:00:00.331000");
    CHECK(calendar_text(first.start, TimeSystem::tai) == "1996-12-18T12:10:00.331000");
    CHECK((*read)[1].states.size() == 2);
}

TEST_CASE("the standard's attitude ephemeris is read, the scalar last, and with the scalar first where it says so",
          "[navigation_message]") {
    const auto read = read_attitude_message(attitude_example);
    REQUIRE(read.ok());
    REQUIRE(read->size() == 1);
    CHECK(read->front().frame_b == "SC_BODY_1");
    CHECK(read->front().states[0].q_BA == std::array{0.68427, -0.56748, -0.03146, -0.45689});
    const auto first =
        read_attitude_message(with(attitude_example, "ATTITUDE_TYPE = QUATERNION",
                                   "ATTITUDE_DIR = B2A\nQUATERNION_TYPE = FIRST\nATTITUDE_TYPE = QUATERNION"));
    REQUIRE(first.ok());
    CHECK(first->front().states[0].q_BA == std::array{0.56748, 0.03146, 0.45689, 0.68427});
}

TEST_CASE("the quaternion of a turn of axes by 90 degrees about z takes x to minus y, as the standard's example says",
          "[navigation_message]") {
    const auto read = read_attitude_message(
        with(with(attitude_example, "0.56748 0.03146 0.45689 0.68427", "0.0 0.0 0.70710678 0.70710678"),
             "USEABLE_START_TIME = 1996-11-28T22:08:02.5555\n", ""));
    REQUIRE(read.ok());
    const auto& [w, x, y, z] = read->front().states[0].q_BA;
    // First column of the matrix: where [1, 0, 0] in A is in B.
    CHECK(std::abs(w * w + x * x - y * y - z * z) < 1e-7);
    CHECK(std::abs(2.0 * (x * y + w * z) - -1.0) < 1e-7);
    CHECK(std::abs(2.0 * (x * z - w * y)) < 1e-7);
}

TEST_CASE("what is written is read again, to the last decimal of the text", "[navigation_message][property]") {
    std::mt19937 random{19};
    const auto any = [&](double scale) { return scale * (static_cast<double>(random()) / 2147483648.0 - 1.0); };
    Ephemeris ephemeris;
    ephemeris.object = "MSL", ephemeris.object_id = "2011-070A", ephemeris.centre = "MARS", ephemeris.frame = "EME2000";
    AttitudeHistory history;
    history.object = "MSL", history.object_id = "2011-070A", history.centre = "MARS";
    history.frame_a = "EME2000", history.frame_b = "SC_BODY_1";
    EphemerisTime time{397501364.5942};
    for (int i = 0; i < 200; ++i) {
        time = time + 0.125 + std::abs(any(1.0));
        ephemeris.states.push_back({time, {any(4e3), any(4e3), any(4e3)}, {any(6.0), any(6.0), any(6.0)}});
        std::array q{any(1.0), any(1.0), any(1.0), any(1.0)};
        const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
        for (double& part : q) part /= length;
        history.states.push_back({time, q, std::array{any(1.0), any(1.0), any(1.0)}});
    }
    ephemeris.start = history.start = ephemeris.states.front().time;
    ephemeris.stop = history.stop = time;
    const MessageHeader header{time, "AEOLIS", "a rehearsal"};
    const auto orbit = read_orbit_message(orbit_message({ephemeris}, header));
    REQUIRE(orbit.ok());
    const auto attitude = read_attitude_message(attitude_message({history}, header));
    REQUIRE(attitude.ok());
    for (std::size_t i = 0; i < 200; ++i) {
        const auto& state = orbit->front().states.at(i);
        CHECK(std::abs(state.time - ephemeris.states[i].time) < 1e-6);
        const auto& turned = attitude->front().states.at(i);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            CHECK(std::abs(state.position_km.at(axis) - ephemeris.states[i].position_km.at(axis)) < 6e-7);
            CHECK(std::abs(state.velocity_kmps.at(axis) - ephemeris.states[i].velocity_kmps.at(axis)) < 6e-10);
            CHECK(std::abs(turned.w_AB_B_rps->at(axis) - history.states[i].w_AB_B_rps->at(axis)) < 2e-10);
        }
        for (std::size_t part = 0; part < 4; ++part)
            CHECK(std::abs(turned.q_BA.at(part) - history.states[i].q_BA.at(part)) < 6e-11);
    }
}

TEST_CASE("what a message lacks, doubles or contradicts is refused with its line", "[navigation_message]") {
    CHECK_THAT(refusal(""), Catch::Contains("CCSDS_OEM_VERS"));
    CHECK_THAT(refusal(attitude_example), Catch::Contains("line 1: ") && Catch::Contains("CCSDS_AEM_VERS"));
    CHECK_THAT(refusal(with(orbit_example, "= 3.0", "= 9.0")), Catch::Contains("line 1: version 9.0 is not read"));
    CHECK_THAT(refusal(with(orbit_example, "REF_FRAME            = J2000\n", "")),
               Catch::Contains("line 16: ") && Catch::Contains("no REF_FRAME"));
    CHECK_THAT(refusal(with(orbit_example, "= TAI", "= UT1")), Catch::Contains("TIME_SYSTEM UT1 is not read"));
    CHECK_THAT(refusal(with(orbit_example, "2783.419", "2783,419")),
               Catch::Contains("line 21: '2783,419' is no number"));
    CHECK_THAT(refusal(with(orbit_example, "2783.419", "nan")), Catch::Contains("'nan' is no number"));
    CHECK_THAT(refusal(with(orbit_example, "T12:01:00", "T12:00:00")),
               Catch::Contains("line 21: the instant is not after"));
    CHECK_THAT(refusal(with(orbit_example, " -1.99608", "")), Catch::Contains("line 21: a state has 6 numbers"));
    CHECK_THAT(refusal(with(orbit_example, "OBJECT_ID ", "OBJECT_NR ")),
               Catch::Contains("line 7: keyword OBJECT_NR is not known"));
    CHECK_THAT(refusal(with(orbit_example, "INTERPOLATION_DEGREE = 7", "INTERPOLATION_DEGREE = 70")),
               Catch::Contains("'70' is not 1 to 27"));
    CHECK_THAT(refusal(orbit_example + "META_START\n"), Catch::Contains("ends within a segment"));
    const auto of_attitude = [](const std::string& text) {
        const auto read = read_attitude_message(text);
        return read ? "read" : read.error().message;
    };
    CHECK_THAT(of_attitude(with(attitude_example, "= QUATERNION", "= SPIN")),
               Catch::Contains("ATTITUDE_TYPE SPIN is not read"));
    CHECK_THAT(of_attitude(with(attitude_example, "0.56748", "0.96748")), Catch::Contains("not of unit length"));
    CHECK_THAT(of_attitude(with(attitude_example, "DATA_STOP\n", "")), Catch::Contains("ends within a segment"));
}

TEST_CASE("a message of which octets are changed or lines are lost is read or refused, never more",
          "[navigation_message][property]") {
    std::mt19937 random{23};
    for (int i = 0; i < 3'000; ++i) {
        std::string text = random() % 2 == 0 ? orbit_example : attitude_example;
        for (std::size_t k = 0; k < 1 + random() % 5; ++k) {
            const auto at = random() % text.size();
            if (random() % 3 == 0)
                text.erase(at, random() % 60);
            else
                text[at] = static_cast<char>(random() % 128);
            if (text.empty()) text = " ";
        }
        const auto orbit = read_orbit_message(text);
        if (orbit)
            for (const auto& segment : *orbit) CHECK_FALSE(segment.states.empty());
        const auto attitude = read_attitude_message(text);
        if (attitude)
            for (const auto& segment : *attitude) CHECK_FALSE(segment.states.empty());
    }
}

}  // namespace common_navigation_message_test
