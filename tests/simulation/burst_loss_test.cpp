#include "simulation/links/burst_loss.hpp"
#include "telemetry/pltu_receiver.hpp"
#include "tests/support/catch.hpp"

#include <vector>

using namespace aeolis;
using namespace aeolis::simulation;

TEST_CASE("frames are lost in bursts at the fraction that the means imply, and the others are found", "[simulation]") {
    const BurstLoss::Means means{6000.0, 150.0};
    BurstLoss channel{means, Random{1, 0, Stream::uhf}};
    telemetry::PltuReceiver receiver;
    const std::vector<std::uint8_t> data(200, 0x42);
    constexpr int frames = 100000;
    std::uint64_t found = 0;
    for (int i = 0; i < frames; ++i) {
        std::vector<std::uint8_t> pltu(pltu_octets_max);
        pltu.resize(write_pltu({.spacecraft = 76, .sequence = static_cast<std::uint8_t>(i)}, data, pltu));
        channel.carry(pltu);
        receiver.receive(pltu);
        while (receiver.next()) ++found;
    }
    const double length = static_cast<double>(data.size() + pltu_overhead_octets);
    const double expected =
        1.0 - means.clear_octets / (means.clear_octets + means.burst_octets) * std::exp(-length / means.clear_octets);
    const double lost = 1.0 - static_cast<double>(found) / frames;
    CHECK(lost == Approx(expected).epsilon(0.05));
    // In bursts: fewer gaps than frames lost.
    CHECK(static_cast<double>(receiver.counters().gaps) < 0.9 * lost * frames);
    CHECK(receiver.counters().missing_frames == frames - found);
}

TEST_CASE("a channel without bursts changes nothing, and the same seed spoils the same octets", "[simulation]") {
    std::vector<std::uint8_t> octets(5000, 0x42), a = octets, b = octets;
    BurstLoss clear{{}, Random{1, 0, Stream::uhf}};
    clear.carry(a);
    CHECK(a == octets);
    BurstLoss whole{{300.0, 50.0}, Random{1, 0, Stream::uhf}};
    BurstLoss parts = whole;
    whole.carry(a);
    for (std::size_t at = 0; at < b.size(); at += 7) parts.carry(std::span{b}.subspan(at, std::min<std::size_t>(7, b.size() - at)));
    CHECK(a == b);
    CHECK(a != octets);
}
