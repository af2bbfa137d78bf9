// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/timeline_plan.hpp"

#include <algorithm>

namespace aeolis::dictionary {

namespace {

std::optional<double> sum(std::optional<double> a, std::optional<double> b) {
    if (!a || !b) return {};
    return *a + *b;
}

using Times = std::vector<std::optional<double>>;

Times anchors_from_entry_s(const Dictionary& dictionary) {
    Times anchors(dictionary.anchors.size());
    for (std::size_t i = 0; i < anchors.size(); ++i) {
        const auto& row = dictionary.anchors[i];
        if (row.name == "entry")
            anchors[i] = 0.0;
        else if (row.parent && row.parent->value < i)  // anchors are in topological order
            anchors[i] = sum(anchors[row.parent->value], row.offset_s);
    }
    return anchors;
}

/// What firings tell of their anchors. A timepoint can be later than its anchor says, never earlier: the earliest tells
/// it best.
Times told_anchors(const Dictionary& dictionary, const Times& heard_e_s) {
    Times told(dictionary.anchors.size());
    for (std::size_t i = 0; i < heard_e_s.size(); ++i) {
        const auto& row = dictionary.timeline[i];
        if (!heard_e_s[i] || !row.anchor || !row.desired_offset_s) continue;
        auto& anchor = told[row.anchor->value];
        const double at = *heard_e_s[i] - *row.desired_offset_s;
        anchor = anchor ? std::min(*anchor, at) : at;
    }
    return told;
}

struct Anchors {
    Times before;  ///< until something was heard of each itself
    Times now;
};

Anchors predicted_anchors(const Dictionary& dictionary, const Times& design_e_s, const Times& told) {
    Anchors anchors{anchors_from_entry_s(dictionary), Times(dictionary.anchors.size())};
    std::optional<std::size_t> last;  ///< of those that the design predicts
    for (std::size_t i = 0; i < anchors.now.size(); ++i) {
        const auto& row = dictionary.anchors[i];
        const auto predicted = i < design_e_s.size() ? design_e_s[i] : std::nullopt;
        if (!anchors.before[i] && predicted)
            anchors.before[i] = last ? *predicted + (*anchors.now[*last] - *design_e_s[*last])
                                     : *predicted;  // by its distance to the last
        const bool from_parent = row.parent && row.parent->value < i && row.offset_s && anchors.now[row.parent->value];
        anchors.now[i] = told[i]       ? told[i]
                         : from_parent ? sum(anchors.now[row.parent->value], row.offset_s)
                                       : anchors.before[i];
        if (predicted) last = i;
    }
    return anchors;
}

/// The rule of R11 over these anchors; what has been heard of counts from when it fired.
Times fires_from_entry_s(const Dictionary& dictionary, const Anchors& anchors, const Times& heard_e_s) {
    Times all(dictionary.timeline.size());
    std::optional<double> previous;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const auto& row = dictionary.timeline[i];
        const auto heard = i < heard_e_s.size() ? heard_e_s[i] : std::nullopt;
        const auto& anchor_times = heard ? anchors.before : anchors.now;
        auto fires = sum(row.anchor ? anchor_times[row.anchor->value] : previous, row.desired_offset_s);
        if (const auto earliest = sum(previous, row.minimum_offset_s); fires && earliest)
            fires = std::max(*fires, *earliest);
        all[i] = fires;
        previous = heard ? heard : fires;
    }
    return all;
}

}  // namespace

std::vector<std::optional<double>> planned_from_entry_s(const Dictionary& dictionary) {
    const auto planned = anchors_from_entry_s(dictionary);
    return fires_from_entry_s(dictionary, {planned, planned}, {});
}

std::vector<std::optional<double>> predicted_from_entry_s(const Dictionary& dictionary,
                                                          const std::vector<std::optional<double>>& design_e_s,
                                                          const std::vector<std::optional<double>>& heard_e_s) {
    return fires_from_entry_s(
        dictionary, predicted_anchors(dictionary, design_e_s, told_anchors(dictionary, heard_e_s)), heard_e_s);
}

}  // namespace aeolis::dictionary
