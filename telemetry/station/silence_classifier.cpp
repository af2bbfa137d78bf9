// SPDX-License-Identifier: Apache-2.0
#include "telemetry/station/silence_classifier.hpp"

#include "common/entry_time.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <utility>

namespace aeolis::telemetry {
namespace {

constexpr double search_s = 10.0;  // chosen: twice the receiver's longest search

bool holds(const PredictedSilences::Window& window, double e_s) {
    return e_s >= window.from_s - SilenceClassifier::margin_s && e_s <= window.to_s + SilenceClassifier::margin_s;
}

}  // namespace

SilenceClassifier::SilenceClassifier(PredictedSilences predicted, Ert start_ert, Ert entry_ert)
    : predicted_(std::move(predicted)), start_ert_(start_ert), entry_ert_(entry_ert) {}

double SilenceClassifier::e_s(Ert ert) const {
    return static_cast<double>(ert.microseconds - entry_ert_.microseconds) * 1e-6;
}
Ert SilenceClassifier::ert_of(double e_s) const {
    return {entry_ert_.microseconds + static_cast<std::int64_t>(e_s * 1e6)};
}

std::vector<LinkState> SilenceClassifier::tell(const std::vector<LinkState>& changes, Ert now, const Station& station) {
    std::vector<LinkState> all;
    if (!std::exchange(begun_, true) && predicted_.light_time_s > 0.0) {
        const Ert first{start_ert_.microseconds + static_cast<std::int64_t>(predicted_.light_time_s * 1e6)};
        for (const Link& link : {uhf_live_link, x_band_telemetry_link, x_band_link}) {
            if (link == x_band_telemetry_link && !predicted_.x_band_tones_s) continue;
            all.push_back(
                told(silent_.emplace_back(Silence{link}),
                     {SilenceClass::light_time,
                      "what leaves the vehicle at the start is here at " + day_of_year_text(first), e_s(first)},
                     start_ert_, station));
        }
    }
    for (const LinkState& change : changes) {
        const auto known = std::ranges::find(silent_, change.link, &Silence::link);
        if (change.up) {
            if (known != silent_.end()) silent_.erase(known);
            all.push_back(change);
            continue;
        }
        const bool told_of = known != silent_.end();
        Silence& silence = told_of ? *known : silent_.emplace_back(Silence{change.link, !station.fault.empty()});
        const Explanation why = explain(silence, e_s(change.ert), station);
        if (!told_of || silence.told != why.silence || silence.told_fault != why.fault)
            all.push_back(told(silence, why, change.ert, station));
    }
    for (Silence& silence : silent_) {
        if (!station.fault.empty()) silence.fault_e_s = e_s(now);
        const Explanation why = explain(silence, e_s(now), station);
        const bool begins =
            silence.told == SilenceClass::light_time &&
            now.microseconds - start_ert_.microseconds < static_cast<std::int64_t>(predicted_.light_time_s * 1e6);
        if ((why.silence != silence.told || why.fault != silence.told_fault) && !begins)
            all.push_back(told(silence, why, now, station));
    }
    return all;
}

LinkState SilenceClassifier::told(Silence& silence, const Explanation& why, Ert ert, const Station& station) const {
    silence.told = why.silence;
    silence.told_fault = why.fault;
    std::string sentence = why.sentence;
    if (why.fault) sentence += (sentence.empty() ? "" : "; ") + station.fault;
    if (why.silence == SilenceClass::unexplained) {
        const auto last =
            std::ranges::find(station.heard, silence.link.name, [](const auto& heard) { return heard.first; });
        if (last != station.heard.end())
            sentence += fmt::format("; its last octet left at {}", from_entry_text(e_s(last->second)));
    }
    const auto until = why.until_e_s ? std::optional(ert_of(*why.until_e_s)) : std::nullopt;
    return {silence.link, ert, false, sentence, is_lost(why.silence) || why.fault, until, why.silence};
}

SilenceClassifier::Explanation SilenceClassifier::explain(const Silence& silence, double e_s,
                                                          const Station& station) const {
    auto why = explain_by_link(silence.link, e_s, station);
    // An orbiter whose delivery the station's outage interrupts has not delivered.
    const bool predicted =
        why.silence != SilenceClass::unexplained && !(why.silence == SilenceClass::delivered && silence.cut);
    if (!predicted && !station.fault.empty()) return {SilenceClass::ground_fault, station.fault};
    if (!predicted && silence.link == x_band_link && silence.fault_e_s && e_s < *silence.fault_e_s + search_s)
        return {SilenceClass::ground_fault, "the receiver searches for the carrier again"};
    why.fault = !station.fault.empty() && !is_over(why.silence);
    return why;
}

SilenceClassifier::Explanation SilenceClassifier::explain_by_link(const Link& link, double e_s,
                                                                  const Station& station) const {
    if (link == x_band_link) return explain_x_band(e_s);
    if (link == x_band_telemetry_link) return explain_x_band_telemetry(e_s);
    if (link == relay_link) return explain_relay(e_s, station);
    if (link == uhf_live_link) return explain_uhf(e_s);
    return {SilenceClass::delivered, "nothing more comes until the orbiter's next pass"};
}

/// The explanation before a transmitter is due; none from then on.
std::optional<SilenceClassifier::Explanation> SilenceClassifier::not_begun(std::string_view words,
                                                                           std::optional<double> begin_s, double e_s) {
    if (!begin_s || e_s >= *begin_s + margin_s) return {};
    return Explanation{SilenceClass::not_begun, fmt::format("{} {}", words, from_entry_text(*begin_s)), begin_s};
}

/// The explanation by passes; none while a bent pipe is in view.
std::optional<SilenceClassifier::Explanation> SilenceClassifier::explain_by_passes(double e_s) const {
    if (predicted_.passes.empty()) return {};
    const PredictedSilences::OrbiterPass *recording = nullptr, *next = nullptr;
    for (const PredictedSilences::OrbiterPass& pass : predicted_.passes) {
        const bool in_view = e_s >= pass.rise_s + pass_margin_s && e_s < pass.set_s - pass_margin_s;
        if (in_view && !pass.stored) return {};
        if (in_view) recording = &pass;
        if (pass.rise_s > e_s && !pass.stored && (next == nullptr || pass.rise_s < next->rise_s)) next = &pass;
    }
    if (recording != nullptr)
        return Explanation{
            SilenceClass::orbiter_records,
            fmt::format("{} delivers from {}", recording->orbiter, from_entry_text(recording->delivery_s)),
            recording->delivery_s};
    if (next != nullptr)
        return Explanation{SilenceClass::no_orbiter,
                           fmt::format("{} rises at {}", next->orbiter, from_entry_text(next->rise_s)), next->rise_s};
    return Explanation{SilenceClass::no_orbiter, "no further pass is planned"};
}

SilenceClassifier::Explanation SilenceClassifier::explain_uhf(double e_s) const {
    const auto& blackout = predicted_.blackout;
    const auto hand_over_s = predicted_.hand_over_s, stop_s = predicted_.uhf_stop_s;
    const auto begins = not_begun("planned at", predicted_.uhf_start_s, e_s);
    if (begins && e_s < *predicted_.uhf_start_s) return *begins;
    if (stop_s && e_s >= *stop_s - margin_s)
        return {SilenceClass::switched_off, "planned at " + from_entry_text(*stop_s)};
    if (const auto why = explain_by_passes(e_s)) return *why;
    if (begins) return *begins;
    if (blackout && holds(*blackout, e_s))
        return {
            SilenceClass::blackout,
            fmt::format("predicted from {} to {}", from_entry_text(blackout->from_s), from_entry_text(blackout->to_s)),
            blackout->to_s};
    if (hand_over_s && holds({*hand_over_s, *hand_over_s}, e_s))
        return {SilenceClass::hand_over, "planned at " + from_entry_text(*hand_over_s)};
    return {SilenceClass::unexplained, "nothing is predicted to silence it now"};
}

SilenceClassifier::Explanation SilenceClassifier::explain_relay(double e_s, const Station& station) const {
    if (station.recording_progress >= 1.0) return {SilenceClass::recording_complete, {}};
    if (const auto why = explain_by_passes(e_s)) return *why;
    return {SilenceClass::unexplained, "the recording is not complete"};
}

SilenceClassifier::Explanation SilenceClassifier::explain_x_band(double e_s) const {
    if (const auto why = not_begun("X-band sends telemetry until", predicted_.x_band_tones_s, e_s)) return *why;
    if (predicted_.earth_set_s && e_s >= *predicted_.earth_set_s - margin_s)
        return {SilenceClass::earth_set, "predicted at " + from_entry_text(*predicted_.earth_set_s)};
    if (predicted_.carrier_weak)
        return {SilenceClass::weak_carrier, "the link's budget has it below what a lock needs"};
    return {SilenceClass::unexplained, "nothing is predicted to silence it now"};
}

SilenceClassifier::Explanation SilenceClassifier::explain_x_band_telemetry(double e_s) const {
    const auto tones_s = predicted_.x_band_tones_s;
    if (tones_s && e_s >= *tones_s - pass_margin_s)
        return {SilenceClass::switched_off, "X-band sends tones from " + from_entry_text(*tones_s)};
    return {SilenceClass::unexplained, "nothing is predicted to silence it now"};
}

}  // namespace aeolis::telemetry
