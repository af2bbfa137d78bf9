// SPDX-License-Identifier: Apache-2.0
// Measures how many octets of Reed-Solomon codeblocks one core corrects in a second: (255,223), interleaved 4, dual
// basis.
//
// Goals: 20 MB/s without errors; 5 MB/s with as many wrong symbols in every code word as can be corrected, or more.
// For comparison, each line ends with the rate of the least work that any decoder does for a clean block: copying it
// through a table of symbols.
#include "telemetry/reed_solomon.hpp"
#include "tests/support/octets.hpp"
#include "tests/support/reed_solomon_encoder.hpp"

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <vector>

namespace {

using namespace aeolis;
using Octets = std::vector<std::uint8_t>;

constexpr telemetry::ReedSolomonCode code{.check_symbols = 32, .interleave = 4};
constexpr std::size_t blocks = 4000, different_blocks = 50;

/// The best of five, by processor time of this process.
template <typename Pass>
double mb_per_s(std::size_t octets, Pass run_pass) {
    double best = 0.0;
    for (int pass = 0; pass < 5; ++pass) {
        const std::clock_t start = std::clock();
        run_pass();
        const double took_s = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
        best = std::max(best, static_cast<double>(octets) / took_s / 1.0e6);
    }
    return best;
}

void damage(Octets& block, std::size_t errors, std::mt19937& random) {
    const std::size_t symbols = block.size() / code.interleave;
    for (std::size_t word = 0; word < code.interleave; ++word)
        for (std::size_t i = 0; i < errors; ++i) {
            const std::size_t segment = symbols / errors;  // with one wrong symbol in each
            const std::size_t place = i * segment + random() % segment;
            block[word + place * code.interleave] ^= static_cast<std::uint8_t>(1 + random() % 255);
        }
}

struct Load {
    const char* name;
    std::size_t errors;  ///< in each code word
    double goal_mb_per_s;
};

}  // namespace

int main() {
    std::mt19937 random{1};
    std::vector<Octets> clean;
    for (std::size_t i = 0; i < different_blocks; ++i)
        clean.push_back(test::codeblock_of(test::random_octets(random, code.data_octets_max()), code));
    const std::size_t octets = blocks * clean[0].size();
    Octets copy(clean[0].size());
    const double limit = mb_per_s(octets, [&] {
        for (std::size_t i = 0; i < blocks; ++i)
            std::ranges::transform(clean[i % clean.size()], copy.begin(), test::from_dual);
    });
    bool met = true;
    for (const Load& load : {Load{"no errors", 0, 20.0}, Load{"1 wrong symbol a word", 1, 5.0},
                             Load{"16 wrong symbols a word", 16, 5.0}, Load{"40: uncorrectable", 40, 5.0}}) {
        std::vector<Octets> sent = clean;
        for (Octets& block : sent) damage(block, load.errors, random);
        bool right = true;
        const double rate = mb_per_s(octets, [&] {
            for (std::size_t i = 0; i < blocks; ++i) {
                copy = sent[i % sent.size()];
                const auto found = telemetry::correct_codeblock(code, copy);
                const bool beyond = load.errors > code.check_symbols / 2;
                right = right &&
                        (beyond ? found.uncorrectable_words == code.interleave
                                : found.symbols == code.interleave * load.errors && copy == clean[i % clean.size()]);
            }
        });
        std::printf("%-24s %7.1f MB/s   goal %.0f   ratio %5.2f   copied through a table %6.0f MB/s%s\n", load.name,
                    rate, load.goal_mb_per_s, rate / load.goal_mb_per_s, limit, right ? "" : "   WRONG");
        met = met && right && rate >= load.goal_mb_per_s;
    }
    return met ? 0 : 1;
}
