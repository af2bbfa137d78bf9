// SPDX-License-Identifier: Apache-2.0
#include "telemetry/timeline_watch.hpp"

#include "dictionaries/timeline_plan.hpp"

#include <algorithm>

namespace aeolis::telemetry {

TimelineWatch::TimelineWatch(const dictionary::Dictionary& dictionary)
    : dictionary_(&dictionary), known_(dictionary.timeline.size()), fired_e_s_(dictionary.timeline.size()),
      triggered_e_s_(dictionary.timeline.size()), planned_e_s_(dictionary::planned_from_entry_s(dictionary)),
      of_tone_(dictionary.tones.size()) {
    for (const auto& tone : dictionary.tones) {
        // A twin of Second Chance tells what prime's tone tells. R35
        const bool twin = tone.set == dictionary::ToneSet::second_chance;
        const std::string name = twin && tone.name.starts_with(dictionary::second_chance_prefix)
                                     ? tone.name.substr(dictionary::second_chance_prefix.size())
                                     : tone.name;
        const dictionary::TimelineRow* only = nullptr;
        std::size_t askers = 0;
        for (const auto& row : dictionary.timeline)
            if (row.tone && dictionary.tones[row.tone->value].name == name) only = &row, ++askers;
        if (askers == 1) of_tone_[tone.id.value] = only->id;
    }
    predict();
    foreseen_e_s_ = predicted_e_s_;
}

void TimelineWatch::fired(TimepointId timepoint, double triggered_e_s, double fired_e_s, bool recorded,
                          std::uint64_t seq) {
    const std::size_t row = timepoint.value;
    if (row >= known_.size() || fired_e_s_[row]) return;
    if (!known_[row] || known_[row]->by_tone) known_[row] = Known{triggered_e_s, false, recorded, seq};
    triggered_e_s_[row] = triggered_e_s;
    fired_e_s_[row] = fired_e_s;
    predict();
}

std::optional<TimepointId> TimelineWatch::tone(ToneId tone, double likelihood, double e_s, std::uint64_t seq) {
    if (tone.value >= of_tone_.size() || !of_tone_[tone.value]) return {};
    const TimepointId told = *of_tone_[tone.value];
    if (known_[told.value]) return {};
    known_[told.value] = Known{e_s, true, false, seq, likelihood};
    return told;
}

std::optional<std::size_t> TimelineWatch::last() const {
    for (std::size_t row = known_.size(); row-- > 0;)
        if (known_[row]) return row;
    return {};
}

std::optional<std::size_t> TimelineWatch::next(int priority) const {
    const auto before = last();
    for (std::size_t row = before ? *before + 1 : 0; row < known_.size(); ++row)
        if (const auto tone = dictionary_->timeline[row].tone;
            tone && dictionary_->tones[tone->value].priority >= priority)
            return row;
    return {};
}

std::optional<std::size_t> TimelineWatch::row_of(std::string_view name) const {
    const auto found = std::ranges::find(dictionary_->timeline, name, &dictionary::TimelineRow::name);
    if (found == dictionary_->timeline.end()) return {};
    return static_cast<std::size_t>(found - dictionary_->timeline.begin());
}

void TimelineWatch::predict() {
    dictionary::TimelineKnowledge known;
    known.design_e_s = dictionary_->predicted_anchor_e_s;
    known.heard.resize(known_.size());
    for (std::size_t row = 0; row < known_.size(); ++row)
        if (fired_e_s_[row]) known.heard[row] = {*triggered_e_s_[row], *fired_e_s_[row]};
    predicted_e_s_.clear();
    for (const auto& timepoint : dictionary::predict(*dictionary_, known).timepoints)
        predicted_e_s_.push_back(timepoint.e_s);
}

}  // namespace aeolis::telemetry
