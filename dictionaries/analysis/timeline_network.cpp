// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/analysis/timeline_network.hpp"

#include <algorithm>
#include <cstdlib>

namespace aeolis::dictionary {
namespace {

using From = timeline::Condition::From;
using Kind = Moment::Kind;
using Reason = ChainStep::Reason;
using timeline::triggered_per_cycle_max;

constexpr std::size_t search_nodes_max = 20'000;  // chosen: a hundred times the nodes of the landing's hardest row

std::int64_t ticks_of(double seconds) {
    return Sclk{seconds}.ticks();
}

Moment at(Kind kind, std::size_t index = 0) {
    return {kind, static_cast<std::uint16_t>(index)};
}

}  // namespace

TimelineNetwork::TimelineNetwork(const Dictionary& dictionary, std::function<bool()> stop)
    : dictionary_(dictionary), stop_(std::move(stop)),
      network_(1 + dictionary.anchors.size() + 2 * dictionary.timeline.size()), causes_(dictionary.timeline.size()) {
    add_anchors();
    for (std::size_t i = 0; i < dictionary.timeline.size(); ++i) add_timepoint(i);
    add_given();
    for (const auto& edge : network_.edges())
        horizon_ticks_ += 2 * std::abs(edge.ticks) + 1;  // twice: "as soon as" reverses an edge
}

// The nodes: do_edl, the anchors, then triggering and firing of each timepoint.
std::size_t TimelineNetwork::node(const Moment& moment) const {
    switch (moment.kind) {
    case Kind::do_edl: return 0;
    case Kind::anchor: return std::size_t{1} + moment.index;
    case Kind::triggered: return 1 + dictionary_.anchors.size() + std::size_t{2} * moment.index;
    case Kind::fired: return 2 + dictionary_.anchors.size() + std::size_t{2} * moment.index;
    }
    return 0;
}

Moment TimelineNetwork::moment(std::size_t node) const {
    const std::size_t anchors = dictionary_.anchors.size();
    if (node == 0) return at(Kind::do_edl);
    if (node <= anchors) return at(Kind::anchor, node - 1);
    return at((node - anchors) % 2 == 1 ? Kind::triggered : Kind::fired, (node - anchors - 1) / 2);
}

void TimelineNetwork::add(const Moment& from, const Moment& to, std::int64_t ticks, Reason reason, unsigned line) {
    network_.add({node(from), node(to), ticks});
    reasons_.emplace_back(reason, line);
}

void TimelineNetwork::remove_last() {
    network_.remove_last();
    reasons_.pop_back();
}

void TimelineNetwork::add_anchors() {
    for (std::size_t i = 0; i < dictionary_.anchors.size(); ++i) {
        const AnchorRow& anchor = dictionary_.anchors[i];
        if (!anchor.parent || !anchor.offset_s) continue;
        const Moment parent = at(Kind::anchor, anchor.parent->value);
        add(parent, at(Kind::anchor, i), ticks_of(*anchor.offset_s), Reason::anchor_offset, 0);
        add(at(Kind::anchor, i), parent, -ticks_of(*anchor.offset_s), Reason::anchor_offset, 0);
    }
}

void TimelineNetwork::add_timepoint(std::size_t index) {
    const TimelineRow& row = dictionary_.timeline[index];
    const Moment triggered = at(Kind::triggered, index);
    const Moment fired = at(Kind::fired, index);
    const Moment previous = index == 0 ? at(Kind::do_edl) : at(Kind::fired, index - 1);
    const auto cause = [&](const Moment& from, std::int64_t ticks, Reason reason) {
        add(from, triggered, ticks, reason, row.line);
        causes_[index].push_back(network_.edges().back());
    };

    // Only the largest offset from the previous firing matters; the order of the timeline is an offset of zero.
    std::int64_t after_previous = 0;
    Reason why = Reason::order;
    const auto [desired, minimum] = timeline::conditions_of(timeline::offsets_of(row));
    for (const auto& [condition, reason] : {std::pair{minimum, Reason::minimum}, std::pair{desired, Reason::desired}}) {
        if (condition.from != From::previous_firing || !condition.offset_s) continue;
        if (ticks_of(*condition.offset_s) <= after_previous) continue;
        after_previous = ticks_of(*condition.offset_s);
        why = reason;
    }
    cause(previous, after_previous, why);
    if (desired.from == From::anchor && desired.offset_s)
        cause(at(Kind::anchor, row.anchor->value), ticks_of(*desired.offset_s), Reason::desired);
    if (index >= triggered_per_cycle_max)
        cause(at(Kind::triggered, index - triggered_per_cycle_max), 1, Reason::cycle_limit);
    if (!desired.offset_s || !minimum.offset_s) causes_[index].clear();  // a command may define it at any time

    add(triggered, fired, 0, Reason::reply, row.line);
    add(fired, triggered, -timeline::latest_firing(Sclk{}, row.reply_timeout_s).ticks(), Reason::reply_timeout,
        row.line);
}

void TimelineNetwork::add_given() {
    for (const ConstraintRow& row : dictionary_.constraints) {
        if (row.kind == ConstraintRow::Kind::required) continue;
        if (row.minimum_s) add(row.from, row.to, ticks_of(*row.minimum_s), Reason::given, row.line);
        if (row.maximum_s) add(row.to, row.from, -ticks_of(*row.maximum_s), Reason::given, row.line);
    }
}

std::vector<ChainStep> TimelineNetwork::steps(const std::vector<EdgeIndex>& edges) const {
    std::vector<ChainStep> chain;
    chain.reserve(edges.size());
    for (const EdgeIndex index : edges) {
        const auto& edge = network_.edges()[index];
        chain.push_back({moment(edge.from), moment(edge.to), static_cast<double>(edge.ticks) * seconds_per_tick,
                         reasons_[index].first, reasons_[index].second});
    }
    return chain;
}

std::vector<ChainStep> TimelineNetwork::contradiction() const {
    return steps(network_.earliest().contradiction);
}

TimelineNetwork::Worst TimelineNetwork::least_difference(const Moment& from, const Moment& to,
                                                         std::int64_t enough_ticks) {
    Query query{node(from), node(to), enough_ticks, 0, {}, false};
    search(query);
    return std::move(query.worst);
}

std::vector<std::int64_t> TimelineNetwork::earliest_with(const Query& query, std::int64_t at_most_ticks) {
    network_.add({query.to, query.from, -at_most_ticks});
    auto schedule = network_.earliest().ticks;
    network_.remove_last();
    return schedule;
}

/// The last timepoint that is triggered later than all of its causes require.
std::optional<std::size_t> TimelineNetwork::without_cause(const std::vector<std::int64_t>& ticks) const {
    for (std::size_t i = causes_.size(); i-- > 0;) {
        const std::int64_t triggered = ticks[node(at(Kind::triggered, i))];
        const auto is_met = [&](const auto& cause) { return triggered == ticks[cause.from] + cause.ticks; };
        if (!causes_[i].empty() && std::ranges::none_of(causes_[i], is_met)) return i;
    }
    return std::nullopt;
}

// Branch and bound. Without "as soon as", the network gives a lower bound on the least difference. If the earliest
// schedule that reaches it has a cause for every firing, the schedule is valid. For a firing without a cause, each of
// its causes is tried as the one that came last. Every valid schedule is in one of these branches, and each branch
// settles that timepoint for good.
void TimelineNetwork::search(Query& query) {
    if (query.done || !network_.earliest().contradiction.empty()) return;
    const auto least = network_.least_difference(query.from, query.to);
    Worst& worst = query.worst;
    if (least && worst.found && least->ticks >= worst.ticks) return;
    const std::int64_t aim = least ? least->ticks : -horizon_ticks_ - std::abs(query.enough_ticks);
    if (stop_() || ++query.nodes > search_nodes_max) {
        const bool is_first = !worst.exhausted;
        worst.exhausted = true;
        if (!least)
            worst.open_ticks.reset();
        else if (is_first || worst.open_ticks)
            worst.open_ticks = is_first ? aim : std::min(*worst.open_ticks, aim);
        return;
    }

    const auto schedule = earliest_with(query, aim);
    const auto late = without_cause(schedule);
    if (!late) {
        // A difference beyond every sum of the offsets is unbounded. A schedule just beyond `enough_ticks` is easier to
        // read.
        const auto readable = least ? schedule : earliest_with(query, query.enough_ticks);
        const auto& shown = without_cause(readable) ? schedule : readable;
        worst.found = true;
        worst.ticks = shown[query.to] - shown[query.from];
        worst.bounded = least.has_value();
        worst.chain = least ? steps(least->edges) : std::vector<ChainStep>{};
        worst.schedule.clear();
        worst.schedule.reserve(shown.size());
        for (std::size_t i = 0; i < shown.size(); ++i)
            worst.schedule.push_back({moment(i), static_cast<double>(shown[i] - shown[0]) * seconds_per_tick});
        query.done = !least;
        return;
    }
    const Moment triggered = at(Kind::triggered, *late);
    for (const auto& cause : causes_[*late]) {
        add(triggered, moment(cause.from), -cause.ticks, Reason::as_soon_as, dictionary_.timeline[*late].line);
        search(query);
        remove_last();
    }
}

}  // namespace aeolis::dictionary
