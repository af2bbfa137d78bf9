// SPDX-License-Identifier: Apache-2.0
#include "simulation/random.hpp"
#include "telemetry/mfsk/symbol_sequence.hpp"
#include "tests/support/catch.hpp"

#include <cmath>

namespace telemetry_symbol_sequence_test {

using namespace aeolis;
using namespace aeolis::telemetry;

namespace {

constexpr int symbol_hops = 80;
constexpr std::int64_t hop_samples = 100;

struct Sent {
    int begin_hop;
    std::uint8_t tone;
};

/// Hops with E/N0 = `symbol_energy` a symbol; those from `dark_from` to `dark_to` are not seen.
std::vector<DecidedSymbol> decided(const std::vector<Sent>& sent, int hops, double symbol_energy, int dark_from = 0,
                                   int dark_to = 0, std::uint64_t seed = 1) {
    simulation::Random random{seed, 0, simulation::Stream::x_band};
    SymbolSequence sequence{symbol_hops, hop_samples};
    std::vector<DecidedSymbol> out;
    const double energy = symbol_energy / symbol_hops, deviation = std::sqrt(0.5 * energy);
    for (int h = 0; h < hops; ++h) {
        HopEvidence hop;
        hop.first_sample = h * hop_samples;
        hop.found = h < dark_from || h >= dark_to;
        if (hop.found) {
            hop.lock = CarrierLock::locked;
            hop.energy = energy;
            hop.total_n0_hz = 100.0;
            for (auto& sum : hop.sums)
                sum = {static_cast<float>(deviation * random.normal()),
                       static_cast<float>(deviation * random.normal())};
            for (const Sent& each : sent)
                if (h >= each.begin_hop && h < each.begin_hop + symbol_hops)
                    hop.sums[each.tone] += std::polar(static_cast<float>(energy), 0.3F * each.tone);
        }
        sequence.push(hop, out);
    }
    sequence.finish(out);
    return out;
}

void check_all(const std::vector<Sent>& sent, const std::vector<DecidedSymbol>& out, int within_hops) {
    REQUIRE(out.size() == sent.size());
    for (std::size_t i = 0; i < sent.size(); ++i) {
        CHECK(out[i].tone == sent[i].tone);
        CHECK(std::abs(out[i].first_sample - sent[i].begin_hop * hop_samples) <= within_hops * hop_samples);
    }
}

}  // namespace

TEST_CASE("symbols are found where they begin: back to back, after pauses, the same tone twice", "[tones][R31]") {
    const std::vector<Sent> sent{{10, 3}, {90, 3}, {170, 255}, {261, 0}, {341, 1}, {421, 77}, {560, 78}, {640, 78}};
    check_all(sent, decided(sent, 800, 360.0), 1);
    check_all(sent, decided(sent, 800, 40.0), 8);
}

TEST_CASE("a long run of symbols without a pause keeps its beginnings", "[tones]") {
    std::vector<Sent> sent;
    for (int i = 0; i < 60; ++i) sent.push_back({37 + i * symbol_hops, static_cast<std::uint8_t>(i * 37)});
    check_all(sent, decided(sent, 5000, 360.0), 1);
}

TEST_CASE("no symbol is made of noise", "[tones]") {
    CHECK(decided({}, 4000, 360.0).empty());
    CHECK(decided({}, 4000, 30.0).empty());
    CHECK(decided({}, 4000, 2.0).empty());
    SymbolSequence nothing{symbol_hops, hop_samples};
    std::vector<DecidedSymbol> out;
    nothing.finish(out);
    CHECK(out.empty());
}

TEST_CASE("a symbol is known from what of it was seen, and says how much that was", "[tones]") {
    const std::vector<Sent> sent{{100, 9}};
    const auto half_dark = decided(sent, 400, 360.0, 120, 170);
    check_all(sent, half_dark, 20);
    CHECK(half_dark[0].seen_fraction == Approx(0.4).margin(0.2));
    CHECK(half_dark[0].lock == CarrierLock::searching);

    const auto begun_before = decided({{-40, 9}}, 300, 360.0);
    REQUIRE(begun_before.size() == 1);
    CHECK(begun_before[0].tone == 9);
    CHECK(decided(sent, 400, 360.0, 90, 190).empty());
}

TEST_CASE("a symbol that could be either of two tones is erased", "[tones]") {
    // Half a symbol of each of two tones, no more apart than noise.
    simulation::Random random{4, 0, simulation::Stream::x_band};
    SymbolSequence sequence{symbol_hops, hop_samples};
    std::vector<DecidedSymbol> out;
    for (int h = 0; h < 300; ++h) {
        HopEvidence hop;
        hop.first_sample = h * hop_samples;
        hop.found = h >= 100 && h < 180;
        hop.energy = hop.found ? 0.5 : 0.0;
        if (hop.found) {
            hop.sums[7] = {0.42F, 0.0F};
            hop.sums[8] = {0.0F, 0.42F};
        }
        sequence.push(hop, out);
    }
    sequence.finish(out);
    REQUIRE(out.size() == 1);
    CHECK_FALSE(out[0].tone);
    CHECK(out[0].evidence.best[0].likelihood == Approx(0.5).margin(0.01));
}

}  // namespace telemetry_symbol_sequence_test
