#include "commands/timeline_change.hpp"
#include "server/archive/reader_state.hpp"
#include "server/archive/row_reader.hpp"
#include "server/archive/schema.hpp"
#include "server/archive/timeline_plan.hpp"

#include <algorithm>
#include <map>

namespace aeolis::archive {
namespace {

constexpr double symbol_slack_s = 15.0; // ours: a symbol of 10 s begins within it of what it tells

/// When the symbol began that told of a timepoint, in SCLK: the first with its tone, not long before it fired.
std::optional<double> told_by_tone(const v1::ToneList& tones, const std::string& tone, std::optional<double> fired_sclk) {
    if (tone.empty()) return std::nullopt;
    for (const auto& item : tones.tones()) {
        const auto& decoded = item.tone();
        if (decoded.has_tone() && decoded.name() == tone && (!fired_sclk || decoded.sclk() > *fired_sclk - symbol_slack_s))
            return decoded.sclk();
    }
    return std::nullopt;
}

std::optional<double> fired_sclk(const v1::TimepointRow& row) {
    if (row.has_recorded_sclk()) return row.recorded_sclk();
    if (row.has_realtime_sclk()) return row.realtime_sclk();
    return std::nullopt;
}

/// When entry interface was due, as Earth's clock shows it when what happens there comes home.
Ert entry_heard_at(const v1::RunState& run) {
    const auto scet = scet_from_day_of_year(run.clock().scet()).value_or(Scet{});
    const ClockCorrelation clock{Sclk{run.clock().sclk()}, scet, run.clock().rate(), run.clock().leap_seconds(), run.clock().version()};
    return {clock.scet_of(Sclk{run.entry_sclk()}).microseconds + static_cast<std::int64_t>(run.light_time_s() * 1.0e6)};
}

bool executed_by(const v1::CommandHistory& command, Ert by) {
    return std::ranges::any_of(command.stages(), [&](const v1::Item& item) {
        const auto& stage = item.command_stage();
        const auto at = ert_from_day_of_year(stage.at());
        return stage.stage() == "executed" && stage.status() == "ok" && at && *at <= by;
    });
}

std::vector<std::uint8_t> octets_of_hex(std::string_view hex) {
    std::vector<std::uint8_t> octets;
    const auto digit = [](char c) { return static_cast<unsigned>(c <= '9' ? c - '0' : c - 'a' + 10); };
    for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
        octets.push_back(static_cast<std::uint8_t>(digit(hex[i]) << 4U | digit(hex[i + 1])));
    return octets;
}

/// The prediction of entry interface: firings that UHF had told of by then, and changes of offsets that were executed.
void add_predictions(const dictionary::Dictionary& dictionary, const v1::TimepointList& timeline, const v1::CommandList& commands,
                     const v1::RunState& run, v1::AsFlownReport& report) {
    std::optional<dictionary::Dictionary> changed;
    const Ert at_entry = entry_heard_at(run);
    for (const auto& command : commands.commands()) {
        const auto* known = dictionary.command(command.name());
        if (known == nullptr || !commands::changes_offsets(command.name()) || !executed_by(command, at_entry)) continue;
        const auto arguments = commands::decode(*known, octets_of_hex(command.octets()));
        if (!arguments) continue;
        if (!changed) changed = dictionary;
        commands::apply_offsets(*changed, command.name(), *arguments);
    }
    std::vector<std::optional<double>> heard_e_s(dictionary.timeline.size());
    for (std::size_t i = 0; i < heard_e_s.size(); ++i) {
        const auto& row = timeline.timepoints(static_cast<int>(i));
        if (row.has_realtime_sclk() && row.realtime_sclk() <= run.entry_sclk()) heard_e_s[i] = row.realtime_sclk() - run.entry_sclk();
    }
    const auto predicted = predicted_from_entry_s(changed ? *changed : dictionary, heard_e_s);
    for (std::size_t i = 0; i < predicted.size(); ++i)
        if (predicted[i]) report.mutable_timepoints(static_cast<int>(i))->set_predicted_e_s(*predicted[i]);
}

void add_timepoints(const v1::TimepointList& timeline, const v1::ToneList& tones, double entry_sclk, v1::AsFlownReport& report) {
    std::optional<double> previous_sclk;
    for (const auto& row : timeline.timepoints()) {
        auto& flown = *report.add_timepoints();
        flown.set_name(row.name());
        flown.set_tone(row.tone());
        flown.set_verdict(row.verdict());
        const auto fired = fired_sclk(row);
        if (row.has_planned_e_s()) flown.set_planned_e_s(row.planned_e_s());
        if (row.has_realtime_sclk()) flown.set_realtime_e_s(row.realtime_sclk() - entry_sclk);
        if (row.has_recorded_sclk()) flown.set_recorded_e_s(row.recorded_sclk() - entry_sclk);
        if (const auto told = told_by_tone(tones, row.tone(), fired)) flown.set_tone_e_s(*told - entry_sclk);
        if (fired && previous_sclk && row.has_minimum_offset_s()) flown.set_margin_s(*fired - *previous_sclk - row.minimum_offset_s());
        if (fired) previous_sclk = fired;
    }
}

} // namespace

Result<v1::AsFlownReport> Reader::as_flown(RunId run) {
    auto state = this->run(run);
    if (!state) return state.error();
    const auto timeline = timepoints(run);
    if (!timeline) return timeline.error();
    const auto heard = tones(run, {});
    if (!heard) return heard.error();
    auto sent = commands(run);
    if (!sent) return sent.error();
    auto proven = proof(run);
    if (!proven) return proven.error();
    v1::AsFlownReport report;
    add_timepoints(*timeline, *heard, state->entry_sclk(), report);
    add_predictions(state_->dictionary, *timeline, *sent, *state, report); // timepoints() gave it for this dictionary only
    const auto decoded = std::ranges::count_if(heard->tones(), [](const v1::Item& item) { return item.tone().has_tone(); });
    report.set_tones_decoded(static_cast<std::uint64_t>(decoded));
    report.set_tones_erased(static_cast<std::uint64_t>(heard->tones_size() - decoded));
    if (auto done = add_silences(run, report); !done) return done.error();
    NoteQuery all;
    all.limit = rows_page_max;
    auto written = notes(run, all);
    if (!written) return written.error();
    *report.mutable_notes() = std::move(*written->mutable_notes());
    *report.mutable_run() = std::move(*state);
    *report.mutable_commands() = std::move(*sent->mutable_commands());
    *report.mutable_proof() = std::move(*proven);
    return report;
}

Result<void> Reader::add_silences(RunId run, v1::AsFlownReport& report) {
    auto snapshot = sqlite::Transaction::begin_read(state_->database);
    if (!snapshot) return snapshot.error();
    auto times = state_->query("SELECT correlation_scet_us + ((entry_sclk - correlation_sclk) * coalesce(rate, 1.0) + light_time_s) * 1e6 FROM runs LEFT JOIN run_clocks USING (run) WHERE run = ?");
    if (!times) return times.error();
    (*times)->bind(1, std::int64_t{run.value});
    auto found = (*times)->step();
    if (!found) return found.error();
    if (!*found) return Error{"no run " + std::to_string(run.value)};
    const double entry_ert_us = (*times)->real(0);

    auto rows = state_->query(row::link_rows);
    if (!rows) return rows.error();
    (*rows)->bind(1, item_key(run, 0)).bind(2, item_key(run, sequence_max)).bind(3, std::int64_t{-1});
    std::map<std::string, int> silent; ///< a link, and its silence in the report
    for (;;) {
        auto next = (*rows)->step();
        if (!next) return next.error();
        if (!*next) return {};
        const LinkRecord change = row::link(**rows);
        const double e_s = (static_cast<double>(change.ert.microseconds) - entry_ert_us) * 1e-6;
        if (const auto before = silent.find(change.link); before != silent.end()) {
            report.mutable_silences(before->second)->set_to_e_s(e_s);
            silent.erase(before);
        }
        if (change.up) continue;
        silent[change.link] = report.silences_size();
        auto& silence = *report.add_silences();
        silence.set_link(change.link);
        silence.set_reason(change.reason);
        silence.set_from_e_s(e_s);
    }
}

} // namespace aeolis::archive
