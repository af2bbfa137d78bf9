// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/analysis/timeline_analysis.hpp"

#include "dictionaries/analysis/timeline_network.hpp"

#include <algorithm>

namespace aeolis::dictionary {
namespace {

using Kind = Moment::Kind;

double seconds_of(std::int64_t ticks) {
    return static_cast<double>(ticks) * seconds_per_tick;
}

/// Tries to prove t(to) - t(from) >= bound_s for every schedule.
BoundProof prove(TimelineNetwork& network, const Moment& from, const Moment& to, double bound_s) {
    const std::int64_t bound = Sclk{bound_s}.ticks();
    auto worst = network.least_difference(from, to, bound - 1);
    BoundProof result;
    const bool open_holds = !worst.exhausted || (worst.open_ticks && *worst.open_ticks >= bound);
    if (worst.found && worst.ticks < bound)
        result.proof = Proof::refuted;
    else if (open_holds)
        result.proof = Proof::proven;
    if (worst.found && worst.bounded && !worst.exhausted)
        result.slack_s = seconds_of(worst.ticks - bound);
    else if (worst.open_ticks && (!worst.found || worst.bounded))
        result.slack_s =
            seconds_of((worst.found ? std::min(worst.ticks, *worst.open_ticks) : *worst.open_ticks) - bound);
    result.chain = std::move(worst.chain);
    result.schedule = std::move(worst.schedule);
    return result;
}

TimelineNetwork network_of(const Dictionary& dictionary, TimelineAnalysis& analysis,
                           const std::function<bool()>& stop) {
    return {dictionary, [&analysis, &stop] { return analysis.stopped = analysis.stopped || (stop && stop()); }};
}

/// Due the moment that GNC sets its anchor: those of ground and of the plan are known before.
bool triggered_by_gnc(const Dictionary& dictionary, const TimelineRow& row) {
    if (!row.anchor || row.desired_offset_s != 0.0) return false;
    const AnchorRow& anchor = dictionary.anchors[row.anchor->value];
    return anchor.parent && !anchor.offset_s && anchor.name != "entry";
}

std::vector<HoldProof> prove_holds(Dictionary dictionary, TimelineAnalysis& analysis,
                                   const std::function<bool()>& stop) {
    std::erase_if(dictionary.constraints,
                  [](const ConstraintRow& row) { return row.kind == ConstraintRow::Kind::given; });
    auto network = network_of(dictionary, analysis, stop);
    std::vector<HoldProof> holds;
    for (std::size_t i = 0; i < dictionary.timeline.size(); ++i) {
        const TimelineRow& row = dictionary.timeline[i];
        if (!triggered_by_gnc(dictionary, row)) continue;
        for (std::size_t before = 0; before < i; ++before) {
            const TimelineRow& other = dictionary.timeline[before];
            if (other.essential) continue;
            auto claim = prove(network, {Kind::fired, other.id.value}, {Kind::anchor, row.anchor->value}, 0.0);
            holds.push_back({row.id, other.id, claim.proof, {}});
            if (claim.proof == Proof::refuted) holds.back().schedule = std::move(claim.schedule);
        }
    }
    return holds;
}

}  // namespace

bool TimelineAnalysis::all_proven() const {
    const auto is_proven = [](const auto& claim) { return claim.proof == Proof::proven; };
    return contradiction.empty() && admits_schedule && std::ranges::all_of(bounds, is_proven) &&
           std::ranges::all_of(holds, is_proven);
}

std::string moment_text(const Dictionary& dictionary, const Moment& moment) {
    switch (moment.kind) {
    case Kind::do_edl: return "do_edl";
    case Kind::anchor: return dictionary.anchors[moment.index].name + ":anchor";
    case Kind::triggered: return dictionary.timeline[moment.index].name + ":triggered";
    case Kind::fired: return dictionary.timeline[moment.index].name + ":fired";
    }
    return {};
}

TimelineAnalysis analyse_bounds(const Dictionary& dictionary, const std::function<bool()>& stop) {
    TimelineAnalysis analysis;
    auto network = network_of(dictionary, analysis, stop);
    analysis.contradiction = network.contradiction();
    if (!analysis.contradiction.empty()) return analysis;
    const Moment last{Kind::fired, static_cast<std::uint16_t>(dictionary.timeline.size() - 1)};
    const auto whole = network.least_difference(Moment{}, last, 0);
    analysis.admits_schedule = whole.found || whole.exhausted;
    if (!analysis.admits_schedule) return analysis;

    const auto prove_row = [&](std::size_t index, bool is_minimum) {
        const ConstraintRow& row = dictionary.constraints[index];
        // A maximum of to - from is a least difference of from - to.
        BoundProof bound = is_minimum ? prove(network, row.from, row.to, *row.minimum_s)
                                      : prove(network, row.to, row.from, -*row.maximum_s);
        bound.constraint = index;
        bound.is_minimum = is_minimum;
        analysis.bounds.push_back(std::move(bound));
    };
    for (std::size_t i = 0; i < dictionary.constraints.size(); ++i) {
        const ConstraintRow& row = dictionary.constraints[i];
        if (row.kind != ConstraintRow::Kind::required) continue;
        if (row.minimum_s) prove_row(i, true);
        if (row.maximum_s) prove_row(i, false);
    }
    return analysis;
}

TimelineAnalysis analyse_timeline(const Dictionary& dictionary, const std::function<bool()>& stop) {
    auto analysis = analyse_bounds(dictionary, stop);
    if (!analysis.contradiction.empty() || !analysis.admits_schedule) return analysis;
    auto network = network_of(dictionary, analysis, stop);
    for (std::size_t i = 0; i < dictionary.timeline.size(); ++i) {
        const TimelineRow& row = dictionary.timeline[i];
        if (!row.anchor || !row.desired_offset_s) continue;
        // Due at anchor + desired; free to fire at the previous firing + minimum.
        const double free_s = std::max(0.0, row.minimum_offset_s.value_or(0.0)) - *row.desired_offset_s;
        const Moment previous = i == 0 ? Moment{} : Moment{Kind::fired, static_cast<std::uint16_t>(i - 1)};
        analysis.margins.push_back(
            {row.id, prove(network, previous, {Kind::anchor, row.anchor->value}, free_s).slack_s});
    }
    analysis.holds = prove_holds(dictionary, analysis, stop);
    return analysis;
}

}  // namespace aeolis::dictionary
