#include "server/archive/timeline_plan.hpp"

#include <algorithm>

namespace aeolis::archive {

namespace {

std::optional<double> sum(std::optional<double> a, std::optional<double> b) {
    if (!a || !b) return {};
    return *a + *b;
}

std::vector<std::optional<double>> anchors_from_entry_s(const dictionary::Dictionary& dictionary) {
    std::vector<std::optional<double>> anchors(dictionary.anchors.size());
    for (std::size_t i = 0; i < anchors.size(); ++i) {
        const auto& row = dictionary.anchors[i];
        if (row.name == "entry")
            anchors[i] = 0.0;
        else if (row.parent && row.parent->value < i) // anchors are in topological order
            anchors[i] = sum(anchors[row.parent->value], row.offset_s);
    }
    return anchors;
}

} // namespace

std::vector<std::optional<double>> planned_from_entry_s(const dictionary::Dictionary& dictionary) {
    const auto anchors = anchors_from_entry_s(dictionary);
    std::vector<std::optional<double>> planned(dictionary.timeline.size());
    std::optional<double> previous;
    for (std::size_t i = 0; i < planned.size(); ++i) {
        const auto& row = dictionary.timeline[i];
        const auto base = row.anchor ? anchors[row.anchor->value] : previous;
        auto fires = sum(base, row.desired_offset_s);
        if (const auto earliest = sum(previous, row.minimum_offset_s); fires && earliest)
            fires = std::max(*fires, *earliest);
        planned[i] = fires;
        previous = fires;
    }
    return planned;
}

} // namespace aeolis::archive
