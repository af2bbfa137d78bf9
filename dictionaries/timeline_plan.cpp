// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/timeline_plan.hpp"

#include "dictionaries/timeline_rule.hpp"

#include <algorithm>
#include <cstddef>

namespace aeolis::dictionary {

namespace {

using Basis = TimelinePrediction::Anchor::Basis;
using Unknown = TimelinePrediction::Timepoint::Unknown;

constexpr double never_s = std::numeric_limits<double>::infinity();

template <typename Values>
auto at_or_none(const Values& values, std::size_t index) {
    return index < values.size() ? values[index] : typename Values::value_type{};
}

MaybeTime time_of(MaybeOffset e_s) {
    return e_s ? MaybeTime{Sclk{*e_s}} : MaybeTime{};
}
MaybeOffset seconds_of(MaybeTime time) {
    return time.defined() ? MaybeOffset{time.get()->seconds} : MaybeOffset{};
}

/// One prediction, step by step.
class Predictor {
  public:
    Predictor(const Dictionary& dictionary, const TimelineKnowledge& known)
        : dictionary_(dictionary), known_(known), told_(dictionary.anchors.size()), before_(dictionary.anchors.size()) {
        prediction_.anchors.resize(dictionary.anchors.size());
        prediction_.timepoints.resize(dictionary.timeline.size());
    }

    TimelinePrediction predict() && {
        for (std::size_t i = 0; i < dictionary_.timeline.size(); ++i) offsets_.push_back(offsets(i));
        collect_told();
        plan_anchors();
        for (std::size_t i = 0; i < dictionary_.anchors.size(); ++i) predict_anchor(i);
        predict_timepoints();
        prediction_.latest_begin_e_s = seconds_of(timeline::latest_begin(
            offsets_.size(), [&](std::size_t row) { return offsets_[row]; },
            [&](std::size_t row) { return dictionary_.timeline[row].reply_timeout_s; },
            [&](AnchorId anchor) { return time_of(now(anchor)); }));
        return std::move(prediction_);
    }

  private:
    /// Time of an anchor as derived from firings.
    struct DerivedAnchor {
        MaybeOffset e_s;                    ///< the earliest that a firing implies: a timepoint may fire later than due
        std::optional<TimepointId> firing;  ///< the one that implies it
        double at_e_s = never_s;            ///< when the first timepoint with this anchor was triggered
        double passed_e_s = never_s;        ///< when the first timepoint after one with this anchor was triggered
    };

    std::optional<TimelineKnowledge::Firing> heard(std::size_t timepoint) const {
        return at_or_none(known_.heard, timepoint);
    }

    /// Offsets that flight has when the timepoint occurs, or had when it occurred.
    timeline::Offsets offsets(std::size_t timepoint) const {
        const auto& row = dictionary_.timeline[timepoint];
        auto offsets = timeline::offsets_of(row);
        const auto fired = heard(timepoint);
        for (const auto& change : known_.changes) {
            const auto* of = std::get_if<OffsetChange::OfTimepoint>(&change.what);
            if (of == nullptr || of->id.value != timepoint || (fired && fired->triggered_e_s <= change.since_e_s))
                continue;
            offsets.desired_s = of->desired_s;
            offsets.minimum_s = of->minimum_s;
        }
        return offsets;
    }

    void collect_told() {
        for (std::size_t i = 0; i < offsets_.size(); ++i) {
            const auto& [anchor, desired_s, minimum_s, may_be_late] = offsets_[i];
            const auto fired = heard(i);
            if (!fired) continue;
            for (std::size_t before = 0; before < i; ++before)
                if (offsets_[before].anchor) {
                    auto& passed_e_s = told_[offsets_[before].anchor->value].passed_e_s;
                    passed_e_s = std::min(passed_e_s, fired->triggered_e_s);
                }
            if (!anchor || !desired_s || may_be_late) continue;  // one that may be late says nothing of its anchor
            auto& told = told_[anchor->value];
            told.at_e_s = std::min(told.at_e_s, fired->triggered_e_s);
            const double e_s = fired->triggered_e_s - *desired_s;
            if (told.e_s && *told.e_s <= e_s) continue;
            told.e_s = e_s;
            told.firing = dictionary_.timeline[i].id;
        }
    }

    /// Parents precede their children.
    MaybeOffset by_parent(const AnchorRow& row, const std::vector<MaybeOffset>& times, MaybeOffset offset_s) const {
        if (!row.parent) return {};
        return seconds_of(timeline::anchor_time(time_of(times[row.parent->value]), offset_s));
    }

    void plan_anchors() {
        for (std::size_t i = 0; i < before_.size(); ++i) {
            const auto& row = dictionary_.anchors[i];
            before_[i] = row.name == "entry" ? MaybeOffset{0.0} : by_parent(row, before_, row.offset_s);
        }
    }

    MaybeOffset now(AnchorId anchor) const { return prediction_.anchors[anchor.value].e_s; }

    /// The latest change of an anchor's offset.
    const OffsetChange* change_of(std::size_t anchor) const {
        const OffsetChange* last = nullptr;
        for (const auto& change : known_.changes)
            if (const auto* of = std::get_if<OffsetChange::OfAnchor>(&change.what); of && of->id.value == anchor)
                last = &change;
        return last;
    }

    void predict_anchor(std::size_t i) {
        const auto& row = dictionary_.anchors[i];
        const auto& told = told_[i];
        const auto design_e_s = at_or_none(known_.design_e_s, i);
        const bool is_planned = before_[i].has_value();
        if (!is_planned && design_e_s)
            before_[i] =
                last_design_
                    ? *design_e_s + (*prediction_.anchors[*last_design_].e_s - *known_.design_e_s[*last_design_])
                    : *design_e_s;

        auto& anchor = prediction_.anchors[i];
        const auto set = [&](MaybeOffset e_s, Basis basis, bool defined) {
            anchor.e_s = e_s;
            anchor.basis = basis;
            anchor.defined = defined;
        };
        const auto parent_e_s = row.parent ? now(*row.parent) : MaybeOffset{};
        const auto from_parent = [&](MaybeOffset offset_s) {
            return seconds_of(timeline::anchor_time(time_of(parent_e_s), offset_s));
        };
        anchor.offset_s = row.offset_s;
        const auto* change = change_of(i);
        const auto changed_s = change ? std::get<OffsetChange::OfAnchor>(change->what).offset_s : MaybeOffset{};
        if (change != nullptr) anchor.offset_s = changed_s;
        const auto changed_e_s = from_parent(changed_s);
        const auto report = at_or_none(known_.reports, i);
        const bool change_counts = changed_e_s && (told.at_e_s == never_s || change->since_e_s >= told.at_e_s) &&
                                   (!report || change->since_e_s > report->at_e_s);

        if (!row.parent)
            set(known_.clock_zero_e_s, Basis::clock, true);
        else if (change_counts)
            set(changed_e_s, Basis::command, true);
        else if (report)
            set(report->anchor_e_s, Basis::report, true);
        else if (told.e_s)
            set(told.e_s, Basis::firing, true), anchor.firing = told.firing;
        else if (row.offset_s && parent_e_s)
            set(from_parent(row.offset_s), Basis::parent, prediction_.anchors[row.parent->value].defined);
        else if (is_planned)
            set(before_[i], Basis::plan, false);
        else if (before_[i])
            predict_by_design(i);
        if (design_e_s && anchor.e_s && row.parent) last_design_ = i;
    }

    void predict_by_design(std::size_t i) {
        auto& anchor = prediction_.anchors[i];
        const bool overdue = known_.now_e_s && *known_.now_e_s > *before_[i] && told_[i].passed_e_s == never_s;
        anchor.e_s = overdue ? *known_.now_e_s : std::min(*before_[i], told_[i].passed_e_s);
        anchor.basis = overdue ? Basis::overdue : Basis::design;
    }

    void predict_timepoints() {
        const std::size_t count = offsets_.size();
        std::vector<double> until_e_s(count + 1, never_s);  // when a later timepoint was triggered
        for (std::size_t i = count; i-- > 0;) {
            const auto fired = heard(i);
            until_e_s[i] = fired ? std::min(until_e_s[i + 1], fired->triggered_e_s) : until_e_s[i + 1];
        }
        MaybeOffset previous_e_s;
        std::vector<MaybeOffset> triggered_e_s(count);
        for (std::size_t i = 0; i < count; ++i) {
            const auto fired = heard(i);
            auto& point = prediction_.timepoints[i];
            const auto fifth_before_e_s = i < timeline::triggered_per_cycle_max
                                              ? MaybeOffset{}
                                              : triggered_e_s[i - timeline::triggered_per_cycle_max];
            point = timepoint(i, previous_e_s, fifth_before_e_s);
            if (!fired && point.e_s) point.e_s = std::min(*point.e_s, until_e_s[i + 1]);
            triggered_e_s[i] = fired ? fired->triggered_e_s : point.e_s;
            previous_e_s = fired ? fired->fired_e_s : point.e_s;
        }
    }

    TimelinePrediction::Timepoint timepoint(std::size_t i, MaybeOffset previous_e_s,
                                            MaybeOffset fifth_before_e_s) const {
        const auto& offsets = offsets_[i];
        MaybeOffset anchor_e_s;
        if (offsets.anchor) anchor_e_s = heard(i) ? before_[offsets.anchor->value] : now(*offsets.anchor);
        const auto due = timeline::due_times(offsets, time_of(previous_e_s), time_of(anchor_e_s));
        auto e_s = seconds_of(due.desired);
        if (!offsets.desired_s || !offsets.minimum_s) return {{}, Unknown::offset};
        if (!e_s) return {{}, offsets.anchor ? Unknown::anchor : Unknown::previous};
        // Its time has passed without "do edl", which it will follow.
        if (offsets.may_be_late && !previous_e_s && known_.now_e_s && *e_s < *known_.now_e_s)
            return {{}, Unknown::previous};
        const auto not_before = [&](MaybeOffset other_e_s) {
            if (other_e_s) e_s = std::max(*e_s, *other_e_s);
        };
        not_before(seconds_of(due.minimum));
        not_before(previous_e_s);
        if (fifth_before_e_s) not_before(*fifth_before_e_s + seconds_per_tick);
        return {e_s, Unknown::nothing};
    }

    const Dictionary& dictionary_;
    const TimelineKnowledge& known_;
    std::vector<timeline::Offsets> offsets_;  ///< by timepoint
    std::vector<DerivedAnchor> told_;         ///< by anchor
    std::vector<MaybeOffset> before_;         ///< by anchor: the prediction before anything was heard of it
    std::optional<std::size_t> last_design_;  ///< the last anchor with a time in the design
    TimelinePrediction prediction_;
};

std::vector<MaybeOffset> times_of(const TimelinePrediction& prediction) {
    std::vector<MaybeOffset> times;
    times.reserve(prediction.timepoints.size());
    for (const auto& timepoint : prediction.timepoints) times.push_back(timepoint.e_s);
    return times;
}

}  // namespace

TimelinePrediction predict(const Dictionary& dictionary, const TimelineKnowledge& known) {
    return Predictor{dictionary, known}.predict();
}

std::vector<MaybeOffset> planned_from_entry_s(const Dictionary& dictionary) {
    return times_of(predict(dictionary, {}));
}

std::vector<MaybeOffset> predicted_from_entry_s(const Dictionary& dictionary,
                                                const std::vector<MaybeOffset>& design_e_s,
                                                const std::vector<MaybeOffset>& heard_e_s) {
    TimelineKnowledge known;
    known.design_e_s = design_e_s;
    for (const auto& e_s : heard_e_s)
        known.heard.push_back(e_s ? std::optional{TimelineKnowledge::Firing{*e_s, *e_s}} : std::nullopt);
    return times_of(predict(dictionary, known));
}

}  // namespace aeolis::dictionary
