// SPDX-License-Identifier: Apache-2.0
#include "server/archive/pyramid.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace aeolis::archive::pyramid {

namespace {
using Number = double Extremes::*;
constexpr std::array<Number, 4> numbers{&Extremes::least, &Extremes::least_sclk_s, &Extremes::largest,
                                        &Extremes::largest_sclk_s};
static_assert(std::endian::native == std::endian::little, "numbers are stored as they stand in memory");
}  // namespace

std::vector<std::uint8_t> octets_of_nodes(std::span<const Extremes> nodes) {
    std::vector<std::uint8_t> octets(nodes.size() * node_octets);
    std::uint8_t* into = octets.data();
    for (const Number number : numbers)
        for (const Extremes& node : nodes) {
            std::memcpy(into, &(node.*number), sizeof(double));
            into += sizeof(double);
        }
    for (const Extremes& node : nodes) {
        std::memcpy(into, &node.defined, sizeof node.defined);
        into += sizeof node.defined;
    }
    return octets;
}

Extremes node_of(std::span<const std::uint8_t> octets, std::size_t nodes, std::size_t index) {
    Extremes node;
    for (std::size_t i = 0; i < numbers.size(); ++i)
        std::memcpy(&(node.*numbers[i]), octets.data() + (i * nodes + index) * sizeof(double), sizeof(double));
    std::memcpy(&node.defined, octets.data() + numbers.size() * nodes * sizeof(double) + index * sizeof node.defined,
                sizeof node.defined);
    return node;
}

void Builder::add(const SegmentRecord& segment, std::vector<PyramidRecord>& full) {
    const Key key{segment.packet, segment.source};
    auto& series = series_[key];
    if (series.channels.empty()) series.channels = segment.channels;
    auto& level = series.of.front();
    const std::size_t samples = segment.sclk_s.size();
    for (std::size_t from = 0; from < samples; from += node_samples) {
        const std::size_t to = std::min<std::size_t>(samples, from + node_samples);
        const auto [first, last] = std::minmax_element(segment.sclk_s.begin() + static_cast<std::ptrdiff_t>(from),
                                                       segment.sclk_s.begin() + static_cast<std::ptrdiff_t>(to));
        level.first_sclk_s.push_back(*first);
        level.last_sclk_s.push_back(*last);
        for (std::size_t c = 0; c < segment.channels.size(); ++c) {
            auto& node = level.nodes.emplace_back();
            for (std::size_t i = from; i < to; ++i)
                if (const double value = segment.values[c * samples + i]; !std::isnan(value))
                    node.add(value, segment.sclk_s[i]);
        }
        if (level.first_sclk_s.size() == block_nodes) close(key, series, 1, full);
    }
}

void Builder::seal(std::vector<PyramidRecord>& out) {
    for (auto& [key, series] : series_)
        for (unsigned level = 1; level <= levels; ++level)
            if (series.of[level - 1].first_sclk_s.size() > fan_out) close(key, series, level, out);
}

void Builder::close(const Key& key, Series& series, unsigned level, std::vector<PyramidRecord>& out) {
    auto& closed = series.of[level - 1];
    const std::size_t nodes = closed.first_sclk_s.size(), channels = series.channels.size();
    PyramidRecord block;
    block.packet = key.first;
    block.source = key.second;
    block.level = static_cast<std::uint8_t>(level);
    block.position = closed.position++;
    block.channels = series.channels;
    block.nodes.resize(nodes * channels);
    for (std::size_t node = 0; node < nodes; ++node)
        for (std::size_t c = 0; c < channels; ++c) block.nodes[c * nodes + node] = closed.nodes[node * channels + c];
    block.first_sclk_s = std::move(closed.first_sclk_s);
    block.last_sclk_s = std::move(closed.last_sclk_s);
    closed.first_sclk_s.clear();
    closed.last_sclk_s.clear();
    closed.nodes.clear();
    if (level < levels) {
        auto& above = series.of[level];
        for (std::size_t from = 0; from < nodes; from += fan_out) {
            const std::size_t to = std::min<std::size_t>(nodes, from + fan_out);
            const auto at = [&](const std::vector<double>& times, std::size_t i) {
                return times.begin() + static_cast<std::ptrdiff_t>(i);
            };
            above.first_sclk_s.push_back(*std::min_element(at(block.first_sclk_s, from), at(block.first_sclk_s, to)));
            above.last_sclk_s.push_back(*std::max_element(at(block.last_sclk_s, from), at(block.last_sclk_s, to)));
            for (std::size_t c = 0; c < channels; ++c) {
                auto& node = above.nodes.emplace_back();
                for (std::size_t i = from; i < to; ++i) node.add(block.nodes[c * nodes + i]);
            }
        }
    }
    out.push_back(std::move(block));
    if (level < levels && series.of[level].first_sclk_s.size() == block_nodes) close(key, series, level + 1, out);
}

}  // namespace aeolis::archive::pyramid
