// SPDX-License-Identifier: Apache-2.0
#include "commands/timeline_change.hpp"
#include "dictionaries/timeline_plan.hpp"
#include "server/archive/item_rows.hpp"
#include "server/archive/items.hpp"
#include "server/archive/reader_state.hpp"
#include "server/archive/schema.hpp"
#include "telemetry/timeline_watch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace aeolis::archive {
namespace {

// Suffix of the channels in which flight reports anchors.
constexpr std::string_view anchor_report_end = "_anchor_sclk";

// Parameter: how long before the start of EDL flight begins to refuse "do edl" [s].
constexpr std::string_view begin_margin = "do_edl_margin_s";

constexpr char packets_before_sql[] =
    "SELECT ert_us FROM packets WHERE key BETWEEN ?1 AND ?2 ORDER BY key DESC LIMIT 1";
constexpr char newest_report_sql[] =
    "SELECT octets FROM packets WHERE run = ?1 AND apid = ?2 AND source = ?3 AND sclk <= ?4 AND packet = ?5"
    " AND sampled = 1 AND ert_us <= ?6 ORDER BY sclk DESC LIMIT 1";

constexpr char expects_sql[] =
    "SELECT octets FROM packets WHERE run = ?1 AND apid = ?2 AND source = ?3 AND sclk <= ?4 AND packet = ?5"
    " AND ert_us <= ?6 ORDER BY sclk, key";

// Packet in which ground says when it expects a timepoint.
constexpr std::string_view expects_packet = "ShadowExpects";

/// The limits of what is known at an instant.
struct Cut {
    double on_board_s = std::numeric_limits<double>::infinity();  ///< SCLK
    Ert on_earth{std::numeric_limits<std::int64_t>::max()};
    bool recorded = true;

    bool holds(const FiringRecord& firing) const {
        if (firing.fired.seconds > on_board_s) return false;
        return firing.source == Source::realtime ? firing.ert <= on_earth : recorded;
    }
};

/// A firing as first known: UHF reports it before the recording, and both before a tone.
struct KnownFiring {
    const char* by = "";
    Sclk triggered, fired;
};
using KnownFirings = std::vector<std::optional<KnownFiring>>;  // by timepoint

template <typename Record>
Result<void> each_row(Reader::State& reader, RunId run, auto take) {
    auto rows = reader.query(rows_sql<Record>());
    if (!rows) return rows.error();
    (*rows)->bind(1, item_key(run, 0)).bind(2, item_key(run, sequence_max)).bind(3, std::int64_t{-1});
    for (;;) {
        auto found = (*rows)->step();
        if (!found) return found.error();
        if (!*found) return {};
        if (auto taken = take(**rows); !taken) return taken;
    }
}

/// The plan from the dictionary.
v1::TimepointList plan_of(const dictionary::Dictionary& dictionary) {
    const auto planned = planned_from_entry_s(dictionary);
    v1::TimepointList list;
    list.set_timeline_version(dictionary.timeline_version);
    for (std::size_t i = 0; i < dictionary.timeline.size(); ++i) {
        const auto& row = dictionary.timeline[i];
        auto& written = *list.add_timepoints();
        written.set_id(row.id.value);
        written.set_name(row.name);
        if (row.anchor) written.set_anchor(dictionary.anchors[row.anchor->value].name);
        if (row.desired_offset_s) written.set_desired_offset_s(*row.desired_offset_s);
        if (row.minimum_offset_s) written.set_minimum_offset_s(*row.minimum_offset_s);
        if (row.tone) written.set_tone(dictionary.tones[row.tone->value].name);
        written.set_event(row.event);
        written.set_note(row.note);
        written.set_waits_for_reply(row.reply_timeout_s.has_value());
        if (planned[i]) written.set_planned_e_s(*planned[i]);
        written.set_verdict("pending");
    }
    for (const auto& anchor : dictionary.anchors) {
        auto& written = *list.add_anchors();
        written.set_id(anchor.id.value);
        written.set_name(anchor.name);
        if (anchor.parent) written.set_parent(dictionary.anchors[anchor.parent->value].name);
        if (anchor.offset_s) written.set_offset_s(*anchor.offset_s);
    }
    return list;
}

Result<void> read_firings(Reader::State& reader, RunId run, const Cut& cut, v1::TimepointList& list,
                          KnownFirings& firings) {
    return each_row<FiringRecord>(reader, run, [&](const auto& row) -> Result<void> {
        const auto firing = read_row<FiringRecord>(row);
        if (firing.timepoint.value >= firings.size() || !cut.holds(firing)) return {};
        auto& written = *list.mutable_timepoints(firing.timepoint.value);
        const bool is_live = firing.source == Source::realtime;
        if (is_live)
            written.set_realtime_sclk(firing.fired.seconds);
        else
            written.set_recorded_sclk(firing.fired.seconds);
        written.set_verdict(name_of(firing.verdict));
        if (auto& known = firings[firing.timepoint.value]; !known || (is_live && std::string_view(known->by) != "uhf"))
            known = KnownFiring{is_live ? "uhf" : "recording", firing.triggered, firing.fired};
        return {};
    });
}

/// When a tone was decided: after its end, and not before the packets received earlier.
Result<Ert> decided_at(Reader::State& reader, RunId run, std::int64_t key, Ert end) {
    auto rows = reader.query(packets_before_sql);
    if (!rows) return rows.error();
    (*rows)->bind(1, item_key(run, 0)).bind(2, key);
    auto found = (*rows)->step();
    if (!found) return found.error();
    return *found ? std::max(end, Ert{(*rows)->integer(0)}) : end;
}

/// Adds firings without packets: by the first tone that only one timepoint requests.
Result<void> add_firings_by_tone(Reader::State& reader, RunId run, const Cut& cut, KnownFirings& firings) {
    std::map<ToneId, std::vector<std::size_t>> askers;
    for (std::size_t i = 0; i < firings.size(); ++i)
        if (const auto& tone = reader.dictionary.timeline[i].tone) askers[*tone].push_back(i);
    return each_row<ToneRecord>(reader, run, [&](const auto& row) -> Result<void> {
        const auto tone = read_row<ToneRecord>(row);
        if (!tone.tone || tone.likelihood < telemetry::tone_believed || tone.sclk.seconds > cut.on_board_s) return {};
        const auto asked = askers.find(*tone.tone);
        if (asked == askers.end() || asked->second.size() != 1 || firings[asked->second.front()]) return {};
        const auto decided = decided_at(reader, run, row.integer(0), tone.ert);
        if (!decided) return decided.error();
        if (*decided <= cut.on_earth) firings[asked->second.front()] = KnownFiring{"tone", tone.sclk, tone.sclk};
        return {};
    });
}

/// The last value of an anchor reported by flight.
Result<std::optional<dictionary::TimelineKnowledge::Report>>
report_of(Reader::State& reader, const RunInfo& run, const dictionary::AnchorRow& anchor, const Cut& cut) {
    std::optional<dictionary::TimelineKnowledge::Report> newest;
    const auto* channel = reader.dictionary.channel(anchor.name + std::string{anchor_report_end});
    if (channel == nullptr) return newest;
    for (const auto& [packet, column] : reader.columns.places(channel->id))
        for (const Source source : {Source::realtime, Source::recorded}) {
            if (source == Source::recorded && !cut.recorded) continue;
            auto rows = reader.query(newest_report_sql);
            if (!rows) return rows.error();
            (*rows)
                ->bind(1, std::int64_t{run.run.value})
                .bind(2, std::int64_t{reader.dictionary.packets[packet].apid.value})
                .bind(3, static_cast<std::int64_t>(source))
                .bind(4, cut.on_board_s)
                .bind(5, std::int64_t{packet})
                .bind(6, source == Source::realtime ? cut.on_earth.microseconds
                                                    : std::numeric_limits<std::int64_t>::max());
            auto found = (*rows)->step();
            if (!found) return found.error();
            if (!*found || !reader.decode((*rows)->octets(0), packet)) continue;
            const double at_e_s = reader.decoded.header.time - run.entry;
            const double sclk_s = reader.columns.value(reader.decoded, column);
            if (!std::isnan(sclk_s) && (!newest || at_e_s > newest->at_e_s))
                newest = dictionary::TimelineKnowledge::Report{Sclk{sclk_s} - run.entry, at_e_s};
        }
    return newest;
}

/// Offset changes executed by flight, as known on Earth at the cut.
std::vector<dictionary::OffsetChange> changes_made(const dictionary::Dictionary& dictionary,
                                                   const v1::CommandList& commands, const v1::RunState& run,
                                                   const Cut& cut) {
    std::vector<dictionary::OffsetChange> changes;
    for (const auto& command : commands.commands()) {
        const v1::Item* executed = nullptr;
        for (const auto& item : command.stages())
            if (item.command_stage().stage() == v1::CommandStage::executed && Ert{item.ert_us()} <= cut.on_earth)
                executed = &item;
        const auto* known = dictionary.command(command.name());
        if (executed == nullptr || executed->command_stage().status() != v1::CommandStage::ok || known == nullptr)
            continue;
        const auto arguments = commands::decode(*known, octets_of_hex(command.octets()));
        if (!arguments) continue;
        auto change = commands::offset_change(dictionary, command.name(), *arguments);
        if (!change) continue;
        change->since_e_s = sclk_at_ert(run, Ert{executed->ert_us()}).seconds - run.entry_sclk();
        changes.push_back(*change);
    }
    std::ranges::stable_sort(changes, {}, &dictionary::OffsetChange::since_e_s);
    return changes;
}

std::string words_of(const dictionary::Dictionary& dictionary, std::size_t timepoint,
                     dictionary::TimelinePrediction::Timepoint::Unknown unknown) {
    using Unknown = dictionary::TimelinePrediction::Timepoint::Unknown;
    const auto& row = dictionary.timeline[timepoint];
    switch (unknown) {
    case Unknown::nothing: break;
    case Unknown::offset:
        return row.desired_offset_s ? "its minimum offset is undefined" : "its desired offset is undefined";
    case Unknown::anchor:
        return "its anchor " + dictionary.anchors[row.anchor->value].name + " is neither known nor predicted";
    case Unknown::previous:
        return timepoint == 0
                   ? "it counts from \"do edl\", whose time is not known"
                   : "it counts from " + dictionary.timeline[timepoint - 1].name + ", which is not predicted";
    }
    return {};
}

const char* word_of(dictionary::TimelinePrediction::Anchor::Basis basis) {
    using Basis = dictionary::TimelinePrediction::Anchor::Basis;
    switch (basis) {
    case Basis::nothing: break;
    case Basis::clock: return "clock";
    case Basis::report: return "report";
    case Basis::firing: return "firing";
    case Basis::command: return "command";
    case Basis::parent: return "parent";
    case Basis::plan: return "plan";
    case Basis::design: return "design";
    case Basis::overdue: return "overdue";
    }
    return "";
}

void write(const dictionary::TimelinePrediction& prediction, const dictionary::Dictionary& dictionary,
           v1::TimepointList& list) {
    for (std::size_t i = 0; i < prediction.timepoints.size(); ++i) {
        const auto& [e_s, unknown] = prediction.timepoints[i];
        auto& written = *list.mutable_timepoints(static_cast<int>(i));
        if (e_s)
            written.set_predicted_e_s(*e_s);
        else
            written.set_not_predicted(words_of(dictionary, i, unknown));
    }
    for (std::size_t i = 0; i < prediction.anchors.size(); ++i) {
        const auto& anchor = prediction.anchors[i];
        auto& written = *list.mutable_anchors(static_cast<int>(i));
        const bool is_root = !dictionary.anchors[i].parent;
        written.set_state(anchor.defined ? "defined" : anchor.e_s ? "predicted" : "undefined");
        if (anchor.e_s && !is_root) written.set_e_s(*anchor.e_s);
        written.set_basis(word_of(anchor.basis));
        if (anchor.firing) written.set_fired(dictionary.timeline[anchor.firing->value].name);
        if (anchor.offset_s) written.set_current_offset_s(*anchor.offset_s);
    }
    const auto margin = std::ranges::find(dictionary.parameters, begin_margin, &dictionary::ParameterRow::name);
    if (prediction.latest_begin_e_s && margin != dictionary.parameters.end())
        list.set_begin_by_e_s(*prediction.latest_begin_e_s - margin->default_value);
}

/// Writes the times without those that moved to now because they are overdue.
void write_expected(const dictionary::Dictionary& dictionary, dictionary::TimelineKnowledge known,
                    v1::TimepointList& list) {
    known.now_e_s.reset();
    const auto expected = predict(dictionary, known);
    for (std::size_t i = 0; i < expected.timepoints.size(); ++i) {
        auto& row = *list.mutable_timepoints(static_cast<int>(i));
        const auto& e_s = expected.timepoints[i].e_s;
        if (e_s && row.has_predicted_e_s()) row.set_expected_e_s(*e_s);
    }
}

/// Writes when the flights of ground's plan expect the timepoints, as said last.
Result<void> write_flights(Reader::State& reader, RunId run, const Cut& cut, v1::TimepointList& list) {
    const auto* expects = reader.dictionary.packet(expects_packet);
    if (expects == nullptr) return {};
    const auto packet = static_cast<std::size_t>(expects - reader.dictionary.packets.data());
    auto rows = reader.query(expects_sql);
    if (!rows) return rows.error();
    (*rows)
        ->bind(1, std::int64_t{run.value})
        .bind(2, std::int64_t{expects->apid.value})
        .bind(3, static_cast<std::int64_t>(Source::realtime))
        .bind(4, cut.on_board_s)
        .bind(5, static_cast<std::int64_t>(packet))
        .bind(6, cut.on_earth.microseconds);
    const auto value = [&](std::string_view name) {
        const auto field = telemetry::field_index(*expects, name);
        return field ? reader.decoded.value[*field].value_or(0.0) : 0.0;
    };
    for (;;) {
        auto found = (*rows)->step();
        if (!found) return found.error();
        if (!*found) return {};
        if (!reader.decode((*rows)->octets(0), packet)) continue;
        const auto row = static_cast<int>(value("expected_timepoint"));
        if (row >= list.timepoints_size()) continue;
        auto& written = *list.mutable_timepoints(row);
        written.clear_flights_e_s();
        written.clear_flights_from_e_s();
        written.clear_flights_to_e_s();
        written.set_flights(static_cast<std::uint32_t>(value("expected_cases")));
        if (written.flights() == 0) continue;
        written.set_flights_e_s(value("expected_after_entry_s"));
        if (value("expected_interval_defined") == 0.0) continue;
        written.set_flights_from_e_s(value("expected_from_s"));
        written.set_flights_to_e_s(value("expected_to_s"));
    }
}

/// Writes the timepoints whose times differ with the change.
void write_moved(const dictionary::TimelinePrediction& with_change, const KnownFirings& firings,
                 v1::TimepointList& list) {
    for (std::size_t i = 0; i < firings.size(); ++i) {
        auto& row = *list.mutable_timepoints(static_cast<int>(i));
        const auto& e_s = with_change.timepoints[i].e_s;
        if (firings[i] || !e_s || !row.has_predicted_e_s()) continue;
        if (std::abs(*e_s - row.predicted_e_s()) >= seconds_per_tick) row.set_moved_e_s(*e_s);
    }
}

}  // namespace

Result<void> Reader::State::add_predicted_anchors(RunId run, v1::TimepointList& list) {
    auto rows = query("SELECT anchor, predicted_e_s FROM run_anchors WHERE run = ?1");
    if (!rows) return rows.error();
    auto& row = **rows;
    row.bind(1, std::int64_t{run.value});
    for (;;) {
        auto found = row.step();
        if (!found) return found.error();
        if (!*found) return {};
        const auto anchor = row.integer(0);
        if (anchor < list.anchors_size() && !row.is_null(1))
            list.mutable_anchors(static_cast<int>(anchor))->set_predicted_e_s(row.real(1));
    }
}

Result<v1::TimepointList> Reader::timepoints(RunId run, const TimepointQuery& query) {
    const auto state = this->run(run);
    if (!state) return state.error();
    const auto commands = timeline_commands(run);
    if (!commands) return commands.error();
    const auto instant = state_->instant(run);
    if (!instant) return instant.error();
    if (auto same = state_->same_dictionary(instant->run); !same) return same.error();
    const auto& dictionary = state_->dictionary;
    const bool has_clock = correlation_of(*state).scet != Scet{};
    Cut cut{.recorded = query.recorded};
    if (query.at) {
        cut.on_board_s = query.at->seconds;
        if (has_clock) cut.on_earth = ert_of(*state, *query.at);
    }

    auto list = plan_of(dictionary);
    if (auto done = state_->add_predicted_anchors(run, list); !done) return done.error();
    KnownFirings firings(dictionary.timeline.size());
    if (auto done = read_firings(*state_, run, cut, list, firings); !done) return done.error();
    if (auto done = add_firings_by_tone(*state_, run, cut, firings); !done) return done.error();
    const double entry_s = state->entry_sclk();
    dictionary::TimelineKnowledge known;
    for (std::size_t i = 0; i < firings.size(); ++i) {
        auto& fired = known.heard.emplace_back();
        if (!firings[i]) continue;
        auto& row = *list.mutable_timepoints(static_cast<int>(i));
        row.set_heard_by(firings[i]->by);
        row.set_triggered_sclk(firings[i]->triggered.seconds);
        fired = {firings[i]->triggered.seconds - entry_s, firings[i]->fired.seconds - entry_s};
    }
    if (entry_s == 0.0) {  // another mission, which is followed
        for (auto& row : *list.mutable_timepoints()) row.set_not_predicted("nobody knows when it enters");
        return list;
    }
    for (const auto& anchor : dictionary.anchors) {
        auto report = report_of(*state_, instant->run, anchor, cut);
        if (!report) return report.error();
        known.reports.push_back(*report);
        const auto& row = list.anchors(anchor.id.value);
        known.design_e_s.push_back(row.has_predicted_e_s() ? MaybeOffset{row.predicted_e_s()} : MaybeOffset{});
    }
    known.changes = changes_made(dictionary, *commands, *state, cut);
    known.clock_zero_e_s = -entry_s;
    if (query.at)
        known.now_e_s = query.at->seconds - entry_s;
    else if (query.now && has_clock)
        known.now_e_s = sclk_at_ert(*state, *query.now).seconds - entry_s;
    if (known.now_e_s) list.set_known_at_e_s(*known.now_e_s);
    write(predict(dictionary, known), dictionary, list);
    write_expected(dictionary, known, list);
    if (auto done = write_flights(*state_, run, cut, list); !done) return done.error();
    if (query.change) {
        known.changes.push_back(*query.change);
        list.set_command_moves(true);
        write_moved(predict(dictionary, known), firings, list);
    }
    return list;
}

}  // namespace aeolis::archive
