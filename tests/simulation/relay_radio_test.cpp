// SPDX-License-Identifier: Apache-2.0
#include "simulation/devices/relay_radio.hpp"

#include "common/space_packet.hpp"
#include "common/time.hpp"
#include "tests/support/catch.hpp"

namespace simulation_relay_radio_test {

using namespace aeolis;
using namespace aeolis::simulation;

namespace {

std::vector<std::uint8_t> recording_of(std::size_t packets) {
    std::vector<std::uint8_t> recording;
    for (std::size_t i = 0; i < packets; ++i) {
        std::vector<std::uint8_t> packet(250);
        seal_tm_packet(packet, Apid{0x10}, static_cast<std::uint16_t>(i), Sclk{1000.0}, 1);
        recording.insert(recording.end(), packet.begin(), packet.end());
    }
    return recording;
}

}  // namespace

TEST_CASE("the rover sends at the rate of the pass, and nothing without one", "[simulation][relay]") {
    RelayRadio radio{0.0};
    const auto octets = recording_of(4000);
    const flight::RecordingDelivery::Recording recording{octets, true};
    for (int i = 0; i < 640; ++i) CHECK(radio.cycle(recording, 0.0).empty());
    std::size_t sent = 0;
    for (int i = 0; i < 64 * 10; ++i) sent += radio.cycle(recording, 128.0e3).size();
    CHECK(static_cast<double>(sent) == Approx(160'000.0).epsilon(0.02));
}

TEST_CASE("without any answer the ends of the files are announced again, and it is not done", "[simulation][relay]") {
    RelayRadio radio{100.0};
    const auto octets = recording_of(100);
    const flight::RecordingDelivery::Recording recording{octets, true};
    int times = 0;
    for (int i = 0; i < 64; ++i) radio.cycle(recording, 2.0e6);  // all of it
    for (int i = 0; i < 64 * 1000; ++i) times += !radio.cycle(recording, 2.0e6).empty();
    CHECK(times == 4);  // the end every 210 s
    CHECK_FALSE(radio.done(recording));
}

}  // namespace simulation_relay_radio_test
