// SPDX-License-Identifier: Apache-2.0
#include "common/space_packet.hpp"
#include "simulation/devices/recorder.hpp"
#include "simulation/links/error_bursts.hpp"
#include "simulation/links/tone_detection.hpp"
#include "simulation/links/uhf_link.hpp"
#include "simulation/links/x_band_link.hpp"
#include "simulation/mars/earth.hpp"
#include "tests/support/catch.hpp"

namespace simulation_links_test {

using namespace aeolis;
using namespace aeolis::simulation;

namespace {

std::vector<std::uint8_t> packet_of(std::size_t octets, std::uint16_t count = 0) {
    std::vector<std::uint8_t> packet(octets);
    seal_tm_packet(packet, Apid{0x10}, count, Sclk{397501715.0}, 1);
    return packet;
}

UhfLink::Surroundings coasting() {
    return {-300.0, 800000.0, 5500.0, true};
}

}  // namespace

TEST_CASE("UHF carries its rate and no more, octet for octet", "[simulation][uhf]") {
    Radio radio;
    radio.uhf_rate_bps = 8000.0;
    UhfLink link{radio};
    std::vector<std::uint8_t> offered, arrived;
    for (int i = 0; i < 100; ++i) {
        const auto packet = packet_of(100, static_cast<std::uint16_t>(i));
        offered.insert(offered.end(), packet.begin(), packet.end());
        link.offer(packet);
    }
    for (int cycle = 0; cycle < 64 * 5; ++cycle) {
        const auto octets = link.cycle(coasting());
        arrived.insert(arrived.end(), octets.begin(), octets.end());
    }
    CHECK(arrived.size() == 5000);  // 5 s at 1000 octets a second
    CHECK(std::equal(arrived.begin(), arrived.end(), offered.begin()));
}

TEST_CASE("an idle UHF link saves nothing up, and what finds no room is counted", "[simulation][uhf]") {
    Radio radio;
    radio.uhf_rate_bps = 8000.0;
    UhfLink link{radio};
    for (int cycle = 0; cycle < 640; ++cycle) CHECK(link.cycle(coasting()).empty());
    link.offer(std::vector<std::uint8_t>(70000));
    CHECK(link.lost_octets() == 70000 - 65536);
    CHECK(link.cycle(coasting()).size() <= 16);
}

TEST_CASE("UHF is down in plasma, when switched off, and what is on the air then is lost", "[simulation][uhf]") {
    Radio radio;
    radio.uhf_rate_bps = 16 * 8 * 64;  // one packet a cycle
    UhfLink link{radio};
    const auto cycle = [&](UhfLink::Surroundings at) {
        link.offer(packet_of(16));
        const std::size_t arrived = link.cycle(at).size();
        CHECK(arrived == (link.up() ? 16 : 0));
        return link.up();
    };
    CHECK_FALSE(cycle({-300.0, 800000.0, 5500.0, false}));
    CHECK(std::string{link.reason()} == "not switched on");
    CHECK(link.lost_octets() == 16);
    CHECK(cycle(coasting()));
    CHECK(cycle({10.0, 115000.0, 5855.0, true}));
    CHECK_FALSE(cycle({46.0, 64000.0, 5868.0, true}));
    CHECK(std::string{link.reason()} == "plasma blackout");
    CHECK_FALSE(cycle({97.0, 20000.0, 2401.0, true}));
    CHECK(cycle({98.0, 19500.0, 2399.0, true}));
    CHECK(cycle({300.0, 3000.0, 85.0, true}));
    CHECK(link.lost_octets() == 48);
}

TEST_CASE("UHF spoils the scenario's part of the octets, in bursts of the scenario's length", "[simulation][uhf]") {
    constexpr std::size_t octets = 4'000'000;
    ErrorBursts errors{0.05, 200.0, Random{1, 0, Stream::uhf}};
    std::vector<std::uint8_t> air(octets, 0);
    errors.spoil(air);
    // One octet in 256 of a burst is right by chance; a stretch of 20 that are not spoilt ends a burst.
    const auto spoilt = static_cast<std::size_t>(octets - static_cast<std::size_t>(std::ranges::count(air, 0)));
    CHECK(static_cast<double>(spoilt) / octets == Approx(0.05 * 255.0 / 256.0).epsilon(0.1));
    std::size_t bursts = 0, since = 1000;
    for (const std::uint8_t octet : air) {
        if (octet != 0 && since > 20) ++bursts;
        since = octet == 0 ? since + 1 : 0;
    }
    CHECK(static_cast<double>(spoilt) / static_cast<double>(bursts) == Approx(200.0).epsilon(0.15));
    ErrorBursts none{0.0, 200.0, Random{1, 0, Stream::uhf}};
    std::vector<std::uint8_t> clean(1000, 7);
    none.spoil(clean);
    CHECK(std::ranges::count(clean, 7) == 1000);
}

TEST_CASE("a full recorder refuses whole packets and counts them", "[simulation][recorder]") {
    Recorder recorder{1000};
    const std::vector<std::uint8_t> much(990);
    REQUIRE(recorder.append(much));
    CHECK_FALSE(recorder.append(packet_of(16)));
    CHECK(recorder.octets().size() == much.size());
    CHECK(recorder.refused_octets() == 16);
}

TEST_CASE("tone decisions err as theory says for 256 non-coherent tones", "[simulation][tones]") {
    // Tone power to noise density for a symbol error of 1e-2 and 1e-3 in 10 s: 2.36 and 3.53 dB-Hz.
    // [proakis-digital-communications]
    Random random{7, 0, Stream::x_band};
    const auto errors = [&](double c_n0_dbhz, int symbols) {
        int wrong = 0;
        for (int i = 0; i < symbols; ++i)
            wrong += detect_tone(i % 256, c_n0_dbhz, 10.0, random).best[0].tone != i % 256;
        return wrong;
    };
    CHECK(errors(2.36, 20000) == Approx(200.0).margin(45.0));
    CHECK(errors(3.53, 20000) == Approx(20.0).margin(14.0));
    CHECK(errors(18.5, 1000) == 0);
}

TEST_CASE("the likelihood of a tone is the share of decisions that are right", "[simulation][tones]") {
    Random random{8, 0, Stream::x_band};
    double promised = 0.0;
    int right = 0;
    for (int i = 0; i < 8000; ++i) {
        const ToneDecision decision = detect_tone(17, 0.5, 10.0, random);
        promised += decision.best[0].likelihood;
        right += decision.best[0].tone == 17;
    }
    CHECK(promised == Approx(right).epsilon(0.03));
}

TEST_CASE("X-band sends a symbol for 10 s at most, breaks it off with its tone, and sends none after Earth set",
          "[simulation][tones]") {
    XBandLink link{Radio{}};
    std::vector<XBandLink::Symbol> ended;
    std::int64_t tick = 0;
    const auto send = [&](std::optional<ToneId> tone, int ticks) {
        for (int i = 0; i < ticks; ++i, ++tick) {
            const double e_s = static_cast<double>(tick) / 64.0 + 200.0;
            const XBandLink::Surroundings at{Sclk::from_ticks(tick), e_s, e_s < 299.0, 1.0};
            if (auto symbol = link.cycle(tone, at)) ended.push_back(*symbol);
        }
    };
    send(ToneId{42}, 640);
    send(ToneId{42}, 640);
    send(ToneId{43}, 100);
    send({}, 10);
    REQUIRE(ended.size() == 3);
    CHECK(ended[0].tone == ToneId{42});
    CHECK(ended[1].started - ended[0].started == 10.0);
    CHECK(ended[2].tone == ToneId{43});
    CHECK(ended[2].ticks == 100);
    ended.clear();
    send({}, 99 * 64 - static_cast<int>(tick) - 320);
    send(ToneId{44}, 640);  // Earth sets in its middle
    send(ToneId{45}, 640);
    REQUIRE(ended.size() == 1);
    CHECK(ended[0].ticks == 320);
    CHECK(std::string{link.reason()} == "Earth set");
    (void)link.cycle({}, {Sclk::from_ticks(tick), 0.0, true, {}});
    CHECK_FALSE(link.earth_up());
    CHECK(std::string{link.reason()} == "not switched on");
}

TEST_CASE("a scenario may set Earth earlier or later than the terrain does", "[simulation][tones]") {
    Radio radio;
    radio.earth_set_after_entry_s = 100.0;
    XBandLink link{radio};
    (void)link.cycle({}, {Sclk{0.0}, 99.0, false, 1.0});
    CHECK(link.earth_up());
    (void)link.cycle({}, {Sclk{1.0}, 100.0, true, 1.0});
    CHECK_FALSE(link.earth_up());
    CHECK(std::string{link.reason()} == "Earth set");
}

TEST_CASE(
    "Earth sets behind highlands: at -2.0 degrees from 8.2 km, lower from higher, at the horizontal from below them",
    "[simulation][earth][R31]") {
    constexpr double radius_m = 3391148.0;
    // A vehicle somewhere on the meridian of Earth's place, so far away that Earth stands at `elevation`.
    const auto up = [&](double altitude_m, double elevation_deg) {
        const Vector3 earth = earth_direction_M(0.0);
        const Vector3 across = earth.cross(Vector3::UnitZ()).normalized();
        const double angle = elevation_deg * degree_rad;
        const Vector3 position = (radius_m + altitude_m) * (std::sin(angle) * earth + std::cos(angle) * across);
        return earth_is_up(position, 0.0, radius_m);
    };
    CHECK(up(8200.0, -1.99));
    CHECK_FALSE(up(8200.0, -2.01));
    CHECK(up(11900.0, -3.2));
    CHECK_FALSE(up(11900.0, -3.5));
    CHECK(up(5000.0, 0.01));
    CHECK_FALSE(up(5000.0, -0.01));
}

TEST_CASE("Earth stands where the published geometry has it", "[simulation][earth]") {
    // Elevation at entry 9.05°, one-way Doppler at 8.4 GHz −451 kHz at E+30 s. [od137]
    const Vector3 entry = place(-3.9226 * degree_rad, 126.703 * degree_rad, 3522200.0);
    CHECK(earth_elevation_rad(entry, 0.0) / degree_rad == Approx(9.05).margin(0.05));
    const Vector3 site = place(-4.6019 * degree_rad, 137.4102 * degree_rad, 3391148.0);
    CHECK(earth_elevation_rad(site, 431.0) / degree_rad == Approx(-2.53).margin(0.05));
    const double landed_hz = -earth_range_rate_mps(site, Vector3::Zero(), 431.0) / 299792458.0 * 8.4e9;
    CHECK(landed_hz == Approx(-299300.0).margin(1000.0));
}

}  // namespace simulation_links_test
