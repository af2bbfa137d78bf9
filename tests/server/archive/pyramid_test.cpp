// SPDX-License-Identifier: Apache-2.0
#include "server/archive/pyramid.hpp"
#include "tests/support/catch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>

namespace archive_pyramid_test {

using namespace aeolis;
using namespace aeolis::archive;

namespace {

constexpr std::size_t channels = 2;

/// Samples of one series, some undefined, times now and then a step back.
struct Series {
    std::vector<double> sclk_s;
    std::vector<double> values[channels];

    explicit Series(std::size_t samples) {
        std::mt19937_64 random(3);
        for (std::size_t i = 0; i < samples; ++i) {
            sclk_s.push_back(100.0 + static_cast<double>(i) / 64.0 - (random() % 50 == 0 ? 0.5 : 0.0));
            for (auto& column : values)
                column.push_back(random() % 9 == 0 ? std::numeric_limits<double>::quiet_NaN()
                                                   : static_cast<double>(random() % 1000));
        }
    }
    Extremes extremes(std::size_t channel, std::size_t from, std::size_t to) const {
        Extremes found;
        for (std::size_t i = from; i < std::min(to, sclk_s.size()); ++i)
            if (const double value = values[channel][i]; !std::isnan(value)) found.add(value, sclk_s[i]);
        return found;
    }
    std::vector<PyramidRecord> blocks() const {
        pyramid::Builder builder;
        std::vector<PyramidRecord> blocks;
        for (std::size_t first = 0; first < sclk_s.size(); first += segment_samples) {
            SegmentRecord segment;
            segment.source = Source::realtime;
            segment.position = first / segment_samples;
            segment.channels = {ChannelId{4}, ChannelId{7}};
            const auto count = static_cast<std::ptrdiff_t>(std::min(segment_samples, sclk_s.size() - first));
            const auto from = static_cast<std::ptrdiff_t>(first);
            segment.sclk_s.assign(sclk_s.begin() + from, sclk_s.begin() + from + count);
            for (const auto& column : values)
                segment.values.insert(segment.values.end(), column.begin() + from, column.begin() + from + count);
            builder.add(segment, blocks);
        }
        builder.seal(blocks);
        const std::size_t sealed = blocks.size();
        builder.seal(blocks);
        CHECK(blocks.size() == sealed);  // a second seal has nothing to say
        return blocks;
    }
};

bool same(const Extremes& a, const Extremes& b) {
    return a.defined == b.defined && a.least == b.least && a.least_sclk_s == b.least_sclk_s && a.largest == b.largest &&
           a.largest_sclk_s == b.largest_sclk_s;
}

}  // namespace

TEST_CASE("each node of the pyramid tells span and extremes of its samples, on every level", "[archive][pyramid]") {
    const auto samples = static_cast<std::size_t>(GENERATE(1, 1024, 1025, 2100, 32 * 1024, 300'001));
    const Series series(samples);
    std::map<unsigned, std::uint64_t> reached;  // nodes by level
    for (const auto& block : series.blocks()) {
        const auto size = static_cast<std::size_t>(pyramid::samples_of_node(block.level));
        const std::size_t nodes = block.first_sclk_s.size();
        REQUIRE(block.position * pyramid::block_nodes == reached[block.level]);  // none left out, full but for the last
        REQUIRE(nodes <= pyramid::block_nodes);
        REQUIRE(block.nodes.size() == nodes * channels);
        for (std::size_t node = 0; node < nodes; ++node) {
            const std::size_t from = (reached[block.level] + node) * size;
            REQUIRE(from < samples);
            const auto first = series.sclk_s.begin() + static_cast<std::ptrdiff_t>(from);
            const auto last = series.sclk_s.begin() + static_cast<std::ptrdiff_t>(std::min(samples, from + size));
            REQUIRE(block.first_sclk_s[node] == *std::min_element(first, last));
            REQUIRE(block.last_sclk_s[node] == *std::max_element(first, last));
            for (std::size_t c = 0; c < channels; ++c)
                REQUIRE(same(block.nodes[c * nodes + node], series.extremes(c, from, from + size)));
        }
        reached[block.level] += nodes;
    }
    // One segment needs no block; two have one over both.
    CHECK(reached[1] ==
          (samples <= segment_samples ? 0 : (samples + pyramid::node_samples - 1) / pyramid::node_samples));
    CHECK((reached[3] > 0) == (samples > 100'000));
}

TEST_CASE("nodes come back from their octets as they were", "[archive][pyramid]") {
    const double infinity = std::numeric_limits<double>::infinity();
    const std::vector<Extremes> nodes{{-1.5, 10.0, 7.0, 11.0, 128}, {}, {-infinity, 1.0, infinity, 2.0, 3}};
    const auto octets = pyramid::octets_of_nodes(nodes);
    CHECK(octets.size() == nodes.size() * pyramid::node_octets);
    for (std::size_t i = 0; i < nodes.size(); ++i) CHECK(same(pyramid::node_of(octets, nodes.size(), i), nodes[i]));
}

}  // namespace archive_pyramid_test
