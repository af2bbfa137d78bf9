// SPDX-License-Identifier: Apache-2.0
#include "commands/timeline_change.hpp"
#include "dictionaries/timeline_plan.hpp"
#include "server/archive/item_rows.hpp"
#include "server/archive/items.hpp"
#include "server/archive/reader_state.hpp"
#include "server/archive/schema.hpp"
#include "telemetry/text.hpp"

#include <algorithm>
#include <cctype>
#include <map>
#include <tuple>

namespace aeolis::archive {
namespace {

constexpr double symbol_slack_s = 15.0;  // chosen: a symbol of 10 s begins within it after the event

/// SCLK of the first symbol with the timepoint's tone, at most symbol_slack_s before the firing.
std::optional<double> told_by_tone(const v1::ToneList& tones, const std::string& tone,
                                   std::optional<double> fired_sclk) {
    if (tone.empty()) return std::nullopt;
    for (const auto& item : tones.tones()) {
        const auto& decoded = item.tone();
        if (decoded.has_tone() && decoded.name() == tone &&
            (!fired_sclk || decoded.sclk() > *fired_sclk - symbol_slack_s))
            return decoded.sclk();
    }
    return std::nullopt;
}

std::optional<double> fired_sclk(const v1::TimepointRow& row) {
    if (row.has_recorded_sclk()) return row.recorded_sclk();
    if (row.has_realtime_sclk()) return row.realtime_sclk();
    return std::nullopt;
}

bool executed_by(const v1::CommandHistory& command, Ert by) {
    return std::ranges::any_of(command.stages(), [&](const v1::Item& item) {
        const auto& stage = item.command_stage();
        return stage.stage() == v1::CommandStage::executed && stage.status() == v1::CommandStage::ok &&
               Ert{item.ert_us()} <= by;
    });
}

/// Adds the predictions as of entry interface: from firings received live and changes executed.
/// @param commands  those that change the timeline
void add_predictions(const dictionary::Dictionary& dictionary, const v1::TimepointList& timeline,
                     const v1::CommandList& commands, const v1::RunState& run, v1::AsFlownReport& report) {
    std::optional<dictionary::Dictionary> changed;
    const Ert at_entry = ert_of(run, Sclk{run.entry_sclk()});  // when entry interface was due on Earth
    for (const auto& command : commands.commands()) {
        const auto* known = dictionary.command(command.name());
        if (known == nullptr || !executed_by(command, at_entry)) continue;
        const auto arguments = commands::decode(*known, octets_of_hex(command.octets()));
        if (!arguments) continue;
        if (!changed) changed = dictionary;
        commands::apply_offsets(*changed, command.name(), *arguments);
    }
    std::vector<std::optional<double>> heard_e_s(dictionary.timeline.size());
    for (std::size_t i = 0; i < heard_e_s.size(); ++i) {
        const auto& row = timeline.timepoints(static_cast<int>(i));
        if (row.has_realtime_sclk() && row.realtime_sclk() <= run.entry_sclk())
            heard_e_s[i] = row.realtime_sclk() - run.entry_sclk();
    }
    std::vector<std::optional<double>> design_e_s;
    for (const auto& anchor : timeline.anchors())
        design_e_s.push_back(anchor.has_predicted_e_s() ? std::optional{anchor.predicted_e_s()} : std::nullopt);
    const auto predicted = predicted_from_entry_s(changed ? *changed : dictionary, design_e_s, heard_e_s);
    for (std::size_t i = 0; i < predicted.size(); ++i)
        if (predicted[i]) report.mutable_timepoints(static_cast<int>(i))->set_predicted_e_s(*predicted[i]);
}

/// Of a run; times from entry are left out where it is not known.
struct KnownEntry {
    double sclk_s = 0.0;  ///< 0: nobody knows it
    bool is_known() const { return sclk_s != 0.0; }
};

void add_timepoints(const v1::TimepointList& timeline, const v1::ToneList& tones, const KnownEntry& entry,
                    v1::AsFlownReport& report) {
    std::optional<double> previous_sclk;
    for (const auto& row : timeline.timepoints()) {
        auto& flown = *report.add_timepoints();
        flown.set_name(row.name());
        flown.set_tone(row.tone());
        flown.set_verdict(row.verdict());
        const auto fired = fired_sclk(row);
        if (row.has_planned_e_s()) flown.set_planned_e_s(row.planned_e_s());
        if (entry.is_known() && row.has_realtime_sclk()) flown.set_realtime_e_s(row.realtime_sclk() - entry.sclk_s);
        if (entry.is_known() && row.has_recorded_sclk()) flown.set_recorded_e_s(row.recorded_sclk() - entry.sclk_s);
        if (const auto told = told_by_tone(tones, row.tone(), fired); entry.is_known() && told)
            flown.set_tone_e_s(*told - entry.sclk_s);
        if (fired && previous_sclk && row.has_minimum_offset_s())
            flown.set_margin_s(*fired - *previous_sclk - row.minimum_offset_s());
        if (fired) previous_sclk = fired;
    }
}

/// All rows of a list, page by page.
template <typename List, typename Query>
Result<List> all_of(Reader& reader, RunId run, Result<List> (Reader::*list)(RunId, const Query&), Query query) {
    List all;
    do {
        auto page = (reader.*list)(run, query);
        if (!page) return page.error();
        query.after = page->next_after();
        all.MergeFrom(*page);
    } while (query.after != 0);
    return all;
}

std::string in_small_letters(std::string name) {
    std::ranges::transform(name, name.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return name;
}

/// Adds reported events of level "activity high", live or recorded. Events that a timepoint of the same name reports
/// are left out; repeated names are numbered.
Result<void> add_events(Reader& reader, RunId run, const v1::TimepointList& timeline, const KnownEntry& entry,
                        v1::AsFlownReport& report) {
    EventQuery query;
    query.levels = {telemetry::name_of(dictionary::EventLevel::activity_hi)};
    query.duplicates = true;
    query.limit = rows_page_max;
    const auto told = all_of(reader, run, &Reader::events, query);
    if (!told) return told.error();
    const auto of_timepoint = [&](const v1::Event& event) {
        return std::ranges::any_of(timeline.timepoints(), [&](const v1::TimepointRow& row) {
            return row.event() == event.name() && row.name() == in_small_letters(event.name());
        });
    };
    std::map<std::tuple<double, std::string, std::string>, v1::AsFlownEvent> flown;  // merges both reports of an event
    std::map<std::string, int> times, number;
    for (const auto& item : told->events()) {
        const auto& event = item.event();
        if (of_timepoint(event)) continue;
        const auto [place, is_new] = flown.try_emplace({event.sclk(), event.name(), event.text()});
        auto& row = place->second;
        if (is_new) {
            row.set_name(in_small_letters(event.name()));
            row.set_text(event.text());
            ++times[row.name()];
        }
        if (!entry.is_known()) continue;
        if (event.source() == v1::SOURCE_REALTIME)
            row.set_realtime_e_s(event.sclk() - entry.sclk_s);
        else
            row.set_recorded_e_s(event.sclk() - entry.sclk_s);
    }
    for (auto& [key, row] : flown) {
        const auto anchor = std::ranges::find(timeline.anchors(), row.name(), &v1::AnchorRow::name);
        if (anchor != timeline.anchors().end() && anchor->has_predicted_e_s())
            row.set_predicted_e_s(anchor->predicted_e_s());
        if (times[row.name()] > 1) row.set_name(row.name() + '_' + std::to_string(++number[row.name()]));
        *report.add_events() = std::move(row);
    }
    return {};
}

}  // namespace

Result<v1::AsFlownReport> Reader::as_flown(RunId run) {
    auto state = this->run(run);
    if (!state) return state.error();
    const auto timeline = timepoints(run);
    if (!timeline) return timeline.error();
    const auto heard = all_of(*this, run, &Reader::tones, ToneQuery{});
    if (!heard) return heard.error();
    auto sent = commands(run);
    if (!sent) return sent.error();
    const auto changes = timeline_commands(run);
    if (!changes) return changes.error();
    auto proven = proof(run);
    if (!proven) return proven.error();
    v1::AsFlownReport report;
    const KnownEntry entry{state->entry_sclk()};
    add_timepoints(*timeline, *heard, entry, report);
    if (entry.is_known())
        add_predictions(state_->dictionary, *timeline, *changes, *state,
                        report);  // timepoints() succeeds for this dictionary only
    if (auto added = add_events(*this, run, *timeline, entry, report); !added) return added.error();
    const auto decoded =
        std::ranges::count_if(heard->tones(), [](const v1::Item& item) { return item.tone().has_tone(); });
    report.set_tones_decoded(static_cast<std::uint64_t>(decoded));
    report.set_tones_erased(static_cast<std::uint64_t>(heard->tones_size() - decoded));
    auto silent = silences(run);
    if (!silent) return silent.error();
    report.mutable_silences()->Assign(silent->begin(), silent->end());
    NoteQuery all;
    all.limit = rows_page_max;
    auto written = notes(run, all);
    if (!written) return written.error();
    *report.mutable_notes() = std::move(*written->mutable_notes());
    report.set_notes_next_after(written->next_after());
    report.set_commands_next_after(sent->next_after());
    *report.mutable_run() = std::move(*state);
    *report.mutable_commands() = std::move(*sent->mutable_commands());
    *report.mutable_proof() = std::move(*proven);
    return report;
}

Result<std::vector<v1::Silence>> Reader::silences(RunId run) {
    const auto snapshot = sqlite::Transaction::begin_read(state_->database);
    if (!snapshot) return snapshot.error();
    return state_->silences(run);
}

Result<std::vector<v1::Silence>> Reader::State::silences(RunId run) {
    auto times =
        query("SELECT correlation_scet_us + ((entry_sclk - correlation_sclk) * clock_rate + light_time_s) * 1e6"
              " FROM runs WHERE run = ?");
    if (!times) return times.error();
    (*times)->bind(1, std::int64_t{run.value});
    auto found = (*times)->step();
    if (!found) return found.error();
    if (!*found) return Error{"no run " + std::to_string(run.value)};
    const double entry_ert_us = (*times)->real(0);

    auto rows = query(rows_sql<LinkRecord>());
    if (!rows) return rows.error();
    (*rows)->bind(1, item_key(run, 0)).bind(2, item_key(run, sequence_max)).bind(3, std::int64_t{-1});
    std::vector<v1::Silence> all;
    std::map<std::string, std::size_t> silent;  ///< link, and the index of its silence
    for (;;) {
        auto next = (*rows)->step();
        if (!next) return next.error();
        if (!*next) return all;
        const auto change = read_row<LinkRecord>(**rows);
        const double e_s = (static_cast<double>(change.ert.microseconds) - entry_ert_us) * 1e-6;
        if (const auto before = silent.find(change.link); before != silent.end()) {
            all[before->second].set_to_e_s(e_s);
            silent.erase(before);
        }
        if (change.up) continue;
        silent[change.link] = all.size();
        auto& silence = all.emplace_back();
        silence.set_link(change.link);
        silence.set_reason(change.reason());
        if (change.silence) silence.set_of(static_cast<v1::LinkChange::Silence>(*change.silence));
        silence.set_from_e_s(e_s);
    }
}

}  // namespace aeolis::archive
