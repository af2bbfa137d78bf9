// SPDX-License-Identifier: Apache-2.0
#include "simulation/links/orbiter_pass.hpp"

#include "common/time.hpp"
#include "tests/support/catch.hpp"

#include <numeric>

namespace simulation_orbiter_pass_test {

using namespace aeolis;
using namespace aeolis::simulation;

namespace {

RelayPass ten_minutes(bool stored) {
    RelayPass row;
    row.orbiter = "mro";
    row.stored = stored;
    row.set_after_entry_s = 600.0;
    row.horizon_km = 2000.0;
    row.nearest_km = 400.0;
    row.delivery_after_set_s = 100.0;
    row.delivery_rate_bps = 64.0e3;
    return row;
}

std::vector<std::uint8_t> counted(std::size_t octets) {
    std::vector<std::uint8_t> made(octets);
    std::iota(made.begin(), made.end(), std::uint8_t{0});
    return made;
}

}  // namespace

TEST_CASE("an orbiter is in view from rise to set, and nearest half-way", "[simulation][relay]") {
    const OrbiterPass pass{ten_minutes(false), Radio{}, Random{1, 0, Stream::uhf}};
    CHECK_FALSE(pass.in_view(-0.1));
    CHECK(pass.in_view(0.0));
    CHECK_FALSE(pass.in_view(600.0));
    CHECK(pass.range_km(0.0) == Approx(2000.0));
    CHECK(pass.range_km(300.0) == Approx(400.0));
    CHECK(OrbiterPass::always().orbiter.empty());
    CHECK((OrbiterPass{OrbiterPass::always(), Radio{}, Random{1, 0, Stream::uhf}}).in_view(-1.0e9));
}

TEST_CASE("octets are lost the more the farther the orbiter is, by the square of its range", "[simulation][relay]") {
    Radio radio;
    radio.uhf_loss_fraction = 0.02;
    radio.uhf_loss_range_km = 1000.0;
    const OrbiterPass pass{ten_minutes(false), radio, Random{1, 0, Stream::uhf}};
    CHECK(pass.loss_fraction(300.0) == Approx(0.02 * 0.16));
    CHECK(pass.loss_fraction(0.0) == Approx(0.08));
    const auto spoilt = [&](double e_s) {
        OrbiterPass heard{ten_minutes(false), radio, Random{1, 0, Stream::uhf}};
        const std::vector<std::uint8_t> zeros(2'000'000, 0);
        const auto got = heard.hear(Traffic::realtime, zeros, e_s);
        return 1.0 - static_cast<double>(std::ranges::count(got, 0)) / static_cast<double>(got.size());
    };
    CHECK(spoilt(0.0) > 5.0 * spoilt(300.0));
}

TEST_CASE("a burst of errors ends by the clock, also while the vehicle has little to send", "[simulation][relay]") {
    Radio radio;
    radio.uhf_loss_fraction = 0.1;
    radio.uhf_loss_range_km = 2000.0;  // 0.1 at the horizon
    radio.uhf_burst_s = 0.2;
    OrbiterPass pass{ten_minutes(false), radio, Random{1, 0, Stream::uhf}};
    const std::vector<std::uint8_t> packet(124, 0);
    constexpr int packets = 20'000;  // one each two seconds, ten bursts' length apart
    int spoilt = 0, in_a_row = 0;
    bool before = false;
    for (int i = 0; i < packets; ++i) {
        const auto got = pass.hear(Traffic::realtime, packet, 0.0);
        const bool now = std::ranges::count(got, 0) < 120;
        spoilt += now ? 1 : 0;
        in_a_row += now && before ? 1 : 0;
        before = now;
        for (int cycle = 1; cycle < 128; ++cycle) pass.hear(Traffic::realtime, {}, 0.0);
    }
    const double part = static_cast<double>(spoilt) / packets;
    CHECK(part > 0.1);
    CHECK(part < 0.2);
    CHECK(static_cast<double>(in_a_row) / spoilt == Approx(part).margin(0.03));  // the next one is no worse off
}

TEST_CASE("a bent pipe gives at once what it hears; an orbiter that records gives it after its pass, at its rate",
          "[simulation][relay]") {
    OrbiterPass live{ten_minutes(false), Radio{}, Random{1, 0, Stream::uhf}};
    CHECK(live.hear(Traffic::realtime, counted(100), 10.0).size() == 100);
    CHECK_FALSE(live.waits());

    OrbiterPass stored{ten_minutes(true), Radio{}, Random{1, 0, Stream::uhf}};
    CHECK(stored.hear(Traffic::realtime, counted(16000), 10.0).empty());
    CHECK(stored.waits());
    CHECK(stored.deliver(Traffic::realtime, 650.0).empty());
    std::vector<std::uint8_t> delivered;
    int cycles = 0;
    for (; !stored.is_over(700.0); ++cycles) {
        const auto now = stored.deliver(Traffic::realtime, 700.0);
        delivered.insert(delivered.end(), now.begin(), now.end());
    }
    CHECK(delivered == counted(16000));
    CHECK(cycles * seconds_per_tick == Approx(2.0).margin(0.05));  // 128 kbit at 64 kb/s

    OrbiterPass both{ten_minutes(true), Radio{}, Random{1, 0, Stream::uhf}};
    both.hear(Traffic::files, counted(16000), 20.0);
    both.hear(Traffic::realtime, counted(16000), 10.0);
    std::size_t octets = 0, files_while_realtime = 0;
    for (cycles = 0; !both.is_over(700.0); ++cycles) {
        octets += both.deliver(Traffic::realtime, 700.0).size();
        const std::size_t files = both.deliver(Traffic::files, 700.0).size();
        if (octets < 16000) files_while_realtime += files;
        octets += files;
    }
    CHECK(files_while_realtime == 0);
    CHECK(cycles * seconds_per_tick == Approx(4.0).margin(0.05));  // both over the one link
}

TEST_CASE("files go at the rate of the pass, which changes as its table says", "[simulation][relay]") {
    RelayPass row = ten_minutes(false);
    const Radio radio;
    CHECK((OrbiterPass{row, radio, Random{1, 0, Stream::uhf}}).file_rate_bps(10.0) == radio.relay_rate_bps);
    row.rates = {{0.0, 128.0e3}, {120.0, 1.0e6}};
    const OrbiterPass pass{row, radio, Random{1, 0, Stream::uhf}};
    CHECK(pass.file_rate_bps(119.0) == 128.0e3);
    CHECK(pass.file_rate_bps(120.0) == 1.0e6);
}

}  // namespace simulation_orbiter_pass_test
