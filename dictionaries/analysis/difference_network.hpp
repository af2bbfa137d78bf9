// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace aeolis::dictionary {

/// Difference constraints: moments and the least differences between them, in ticks of 1/64 s.
/// Solved exactly by longest paths (Bellman-Ford). An upper bound is a least difference in the opposite direction.
class DifferenceNetwork {
  public:
    /// t(to) - t(from) >= ticks
    struct Edge {
        std::size_t from = 0, to = 0;
        std::int64_t ticks = 0;
    };
    using EdgeIndex = std::size_t;

    explicit DifferenceNetwork(std::size_t moments) : moments_(moments) {}

    EdgeIndex add(const Edge& edge) {
        edges_.push_back(edge);
        return edges_.size() - 1;
    }
    /// Removes the edge added last.
    void remove_last() { edges_.pop_back(); }
    const std::vector<Edge>& edges() const { return edges_; }
    std::size_t moments() const { return moments_; }

    /// The solution with every moment at its earliest and none negative, or why there is no solution.
    struct Earliest {
        std::vector<std::int64_t> ticks;       ///< a time for each moment; empty when the edges contradict each other
        std::vector<EdgeIndex> contradiction;  ///< a cycle of edges whose least differences add up to more than zero
    };
    Earliest earliest() const;

    struct Path {
        std::int64_t ticks = 0;
        std::vector<EdgeIndex> edges;  ///< the edges that force `ticks`, from the first moment to the last
    };
    /// The least possible t(to) - t(from); none: no lower bound. Requires that `earliest` has a solution.
    std::optional<Path> least_difference(std::size_t from, std::size_t to) const;

  private:
    std::size_t moments_;
    std::vector<Edge> edges_;
};

}  // namespace aeolis::dictionary
