// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/analysis/difference_network.hpp"

#include "common/check.hpp"

#include <algorithm>
#include <limits>

namespace aeolis::dictionary {
namespace {

constexpr std::int64_t unreached = std::numeric_limits<std::int64_t>::min();
constexpr DifferenceNetwork::EdgeIndex no_edge = std::numeric_limits<DifferenceNetwork::EdgeIndex>::max();

/// One sweep over all edges. Returns the moment moved last; none when nothing moved.
std::optional<std::size_t> relax(const std::vector<DifferenceNetwork::Edge>& edges, std::vector<std::int64_t>& ticks,
                                 std::vector<DifferenceNetwork::EdgeIndex>& reached_by) {
    std::optional<std::size_t> moved;
    for (std::size_t i = 0; i < edges.size(); ++i) {
        const auto& edge = edges[i];
        if (ticks[edge.from] == unreached || ticks[edge.from] + edge.ticks <= ticks[edge.to]) continue;
        ticks[edge.to] = ticks[edge.from] + edge.ticks;
        reached_by[edge.to] = i;
        moved = edge.to;
    }
    return moved;
}

}  // namespace

DifferenceNetwork::Earliest DifferenceNetwork::earliest() const {
    std::vector<std::int64_t> ticks(moments_, 0);
    std::vector<EdgeIndex> reached_by(moments_, no_edge);
    std::optional<std::size_t> moved;
    for (std::size_t sweep = 0; sweep <= moments_; ++sweep) {
        moved = relax(edges_, ticks, reached_by);
        if (!moved) return {std::move(ticks), {}};
    }
    // A move even after as many sweeps as there are moments means a cycle: walking back that many edges reaches it.
    std::size_t on_ring = *moved;
    for (std::size_t step = 0; step < moments_; ++step) on_ring = edges_[reached_by[on_ring]].from;
    Earliest none;
    std::size_t at = on_ring;
    do {
        none.contradiction.push_back(reached_by[at]);
        at = edges_[reached_by[at]].from;
    } while (at != on_ring);
    std::ranges::reverse(none.contradiction);
    return none;
}

std::optional<DifferenceNetwork::Path> DifferenceNetwork::least_difference(std::size_t from, std::size_t to) const {
    std::vector<std::int64_t> ticks(moments_, unreached);
    std::vector<EdgeIndex> reached_by(moments_, no_edge);
    ticks[from] = 0;
    for (std::size_t sweep = 0; relax(edges_, ticks, reached_by); ++sweep)
        AEOLIS_CHECK(sweep <= moments_);  // otherwise a cycle: the edges have no solution
    if (ticks[to] == unreached) return std::nullopt;
    Path path{ticks[to], {}};
    for (std::size_t at = to; at != from; at = edges_[reached_by[at]].from) path.edges.push_back(reached_by[at]);
    std::ranges::reverse(path.edges);
    return path;
}

}  // namespace aeolis::dictionary
