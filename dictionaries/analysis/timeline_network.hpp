// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/analysis/difference_network.hpp"
#include "dictionaries/analysis/timeline_analysis.hpp"

#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

namespace aeolis::dictionary {

/// The timeline and the given rows as a network, and the search for its worst schedules.
/// Used by timeline_analysis.hpp.
class TimelineNetwork {
  public:
    using MaybeTicks = std::optional<std::int64_t>;

    /// `stop` is called during the search; when it returns true, the search is cut short.
    TimelineNetwork(const Dictionary& dictionary, std::function<bool()> stop);

    /// Why nothing satisfies the constraints; empty when a solution exists.
    /// In that solution, timepoints may fire later than by the rule.
    std::vector<ChainStep> contradiction() const;

    /// The least difference of two moments, and how it was found.
    struct Worst {
        bool found = false;   ///< `ticks`, `chain` and `schedule` describe a valid schedule
        bool bounded = true;  ///< false: there is no least difference; the schedule may be one that reached
                              ///< `enough_ticks`
        std::int64_t ticks = 0;
        std::vector<ChainStep> chain;
        std::vector<Instant> schedule;
        bool exhausted = false;  ///< the search was cut short
        MaybeTicks open_ticks;   ///< if exhausted: lower bound of the part not searched, if any
    };
    /// Finds the least possible t(to) - t(from).
    /// If it is unbounded, returns a schedule with `enough_ticks`.
    Worst least_difference(const Moment& from, const Moment& to, std::int64_t enough_ticks);

  private:
    using EdgeIndex = DifferenceNetwork::EdgeIndex;
    struct Query {
        std::size_t from = 0, to = 0;
        std::int64_t enough_ticks = 0;
        std::size_t nodes = 0;
        Worst worst;
        bool done = false;
    };

    std::size_t node(const Moment& moment) const;
    Moment moment(std::size_t node) const;
    void add(const Moment& from, const Moment& to, std::int64_t ticks, ChainStep::Reason reason, unsigned line);
    void remove_last();
    void add_anchors();
    void add_timepoint(std::size_t index);
    void add_given();
    void search(Query& query);
    std::vector<std::int64_t> earliest_with(const Query& query, std::int64_t at_most_ticks);
    std::optional<std::size_t> without_cause(const std::vector<std::int64_t>& ticks) const;
    std::vector<ChainStep> steps(const std::vector<EdgeIndex>& edges) const;

    const Dictionary& dictionary_;
    std::function<bool()> stop_;
    DifferenceNetwork network_;
    std::int64_t horizon_ticks_ = 0;                               ///< no bounded difference is less than the negative
                                                                   ///< of this
    std::vector<std::pair<ChainStep::Reason, unsigned>> reasons_;  ///< of the edges, by index
    std::vector<std::vector<DifferenceNetwork::Edge>> causes_;     ///< of each triggering; empty: the triggering is
                                                                   ///< free
};

}  // namespace aeolis::dictionary
