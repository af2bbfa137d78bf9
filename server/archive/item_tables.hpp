// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/archive/records.hpp"
#include "telemetry/alarms.hpp"
#include "telemetry/text.hpp"

#include <tuple>

// Each kind of item, described once: its table, its columns, and the record's member for each column. The SQL that
// creates, fills and reads the table, the binding of records, the reading of rows and the searched text follow from it
// (item_rows.hpp). Each table begins with the item's key and its ERT in microseconds.
namespace aeolis::archive {

/// The special properties of a column.
enum class Column : std::uint8_t {
    plain,
    searched,  ///< its words are indexed in the table "search"
    optional,  ///< NULL stands for an empty text, no octets or an undefined number (NaN)
};

/// The run's number, which is also in the key; needed for an index.
struct OfRun {};

/// A link's name, stored as its number among the archive's words.
template <typename Text>
struct LinkName {
    Text& name;
};
template <typename Text>
LinkName(Text&) -> LinkName<Text>;

/// The words of an enumeration stored as text, for people who open the file with other tools: the number of its values,
/// from 0, and the word of each.
template <typename Enum>
struct EnumWords;
template <>
struct EnumWords<commands::Stage> {
    static constexpr std::size_t count = commands::stage_count;
    static const char* of(commands::Stage stage) { return commands::name_of(stage); }
};
template <>
struct EnumWords<commands::Status> {
    static constexpr std::size_t count = 4;
    static const char* of(commands::Status status) { return commands::name_of(status); }
};
template <>
struct EnumWords<dictionary::EventLevel> {
    static constexpr std::size_t count = 7;
    static const char* of(dictionary::EventLevel level) { return telemetry::name_of(level); }
};
template <>
struct EnumWords<dictionary::Severity> {
    static constexpr std::size_t count = 6;
    static const char* of(dictionary::Severity severity) { return telemetry::name_of(severity); }
};
template <>
struct EnumWords<telemetry::AlarmAct> {
    static constexpr std::size_t count = 4;
    static const char* of(telemetry::AlarmAct act) { return telemetry::name_of(act); }
};
template <>
struct EnumWords<telemetry::SituationRank> {
    static constexpr std::size_t count = telemetry::situation_ranks;
    static const char* of(telemetry::SituationRank rank) { return telemetry::name_of(rank); }
};
template <>
struct EnumWords<FiringVerdict> {
    static constexpr std::size_t count = 6;
    static const char* of(FiringVerdict verdict) { return name_of(verdict); }
};
template <>
struct EnumWords<telemetry::SilenceClass> {
    static constexpr std::size_t count = telemetry::silence_classes;
    static const char* of(telemetry::SilenceClass silence) { return telemetry::name_of(silence); }
};
template <>
struct EnumWords<Outcome> {
    static constexpr std::size_t count = 7;
    static const char* of(Outcome outcome) { return name_of(outcome); }
};
template <>
struct EnumWords<ProcedureActKind> {
    static constexpr std::size_t count = procedure_act_kinds;
    static const char* of(ProcedureActKind kind) { return name_of(kind); }
};
template <>
struct EnumWords<PositionActKind> {
    static constexpr std::size_t count = position_act_kinds;
    static const char* of(PositionActKind kind) { return name_of(kind); }
};
template <>
struct EnumWords<CarrierLock> {
    static constexpr std::size_t count = 4;
    static const char* of(CarrierLock lock) { return to_text(lock); }
};

/// Describes a kind of item. `name`: its table. `derived`: whether its rows follow from those of packets. `of_batch`:
/// the records in a batch. `columns`: calls visit(name, member, Column) for each column but key and ert_us. `parts`,
/// for a kind with a list: that list, whose own columns PartTable describes.
template <typename Record>
struct ItemTable;
template <typename Part>
struct PartTable;

template <>
struct ItemTable<PacketRecord> {
    static constexpr char name[] = "packets";
    static constexpr bool derived = true;
    static constexpr auto of_batch = &Batch::packets;
    static void columns(auto& record, auto&& visit) {
        visit("run", OfRun{});
        visit("apid", record.apid);
        visit("packet", record.packet);
        visit("sclk", record.sclk);
        visit("link", LinkName{record.link});
        visit("source", record.source);
        visit("standing", record.standing);
        visit("sampled", record.sampled);
        visit("refusal", record.refusal, Column::optional);
        visit("octets", record.octets);
    }
};

template <>
struct ItemTable<EventRecord> {
    static constexpr char name[] = "events";
    static constexpr bool derived = true;
    static constexpr auto of_batch = &Batch::events;
    static void columns(auto& record, auto&& visit) {
        visit("packet_seq", record.packet_seq);
        visit("event", record.id);
        visit("name", record.name, Column::searched);
        visit("level", record.level);
        visit("text", record.text, Column::searched);
        visit("sclk", record.sclk);
        visit("source", record.source);
        visit("duplicate", record.duplicate);
    }
};

template <>
struct ItemTable<ToneRecord> {
    static constexpr char name[] = "tones";
    static constexpr bool derived = false;
    static constexpr auto of_batch = &Batch::tones;
    static auto& parts(auto& record) { return record.best; }
    static void columns(auto& record, auto&& visit) {
        visit("start_us", record.start);
        visit("tone", record.tone);
        visit("name", record.name, Column::searched);
        visit("meaning", record.meaning, Column::searched);
        visit("likelihood", record.likelihood);
        visit("runner_up", record.runner_up);
        visit("runner_up_likelihood", record.runner_up_likelihood);
        visit("c_n0_dbhz", record.c_n0_dbhz);
        visit("doppler_hz", record.doppler_hz);
        visit("model", record.model);
        visit("sclk", record.sclk);
        visit("lock", record.lock);
        visit("spectrum", record.spectrum);
    }
};
template <>
struct PartTable<ToneLikelihood> {
    static constexpr char name[] = "tone_likelihoods";
    static void columns(auto& part, auto&& visit) {
        visit("tone", part.tone);
        visit("likelihood", part.likelihood);
    }
};

template <>
struct ItemTable<StageRecord> {
    static constexpr char name[] = "command_stages";
    static constexpr bool derived = false;
    static constexpr auto of_batch = &Batch::stages;
    static void columns(auto& record, auto&& visit) {
        visit("command", record.command);
        visit("name", record.name, Column::searched);
        visit("stage", record.stage, Column::searched);
        visit("status", record.status, Column::searched);
        visit("evidence", record.evidence, Column::searched);
        visit("arguments", record.arguments, Column::searched);
        visit("count", record.count);
        visit("held", record.held);
        visit("needs_approval", record.needs_approval);
        visit("asked_by", record.asked_by);
        visit("client_id", record.client_id, Column::searched);
        visit("octets", record.octets, Column::optional);
    }
};

template <>
struct ItemTable<FiringRecord> {
    static constexpr char name[] = "timepoint_firings";
    static constexpr bool derived = true;
    static constexpr auto of_batch = &Batch::firings;
    static void columns(auto& record, auto&& visit) {
        visit("packet_seq", record.packet_seq);
        visit("timepoint", record.timepoint);
        visit("name", record.name);
        visit("triggered_sclk", record.triggered);
        visit("fired_sclk", record.fired);
        visit("verdict", record.verdict);
        visit("source", record.source);
        visit("duplicate", record.duplicate);
    }
};

template <>
struct ItemTable<ExplanationRecord> {
    static constexpr char name[] = "explanations";
    static constexpr bool derived = true;
    static constexpr auto of_batch = &Batch::explanations;
    static auto& parts(auto& record) { return record.explanation.conditions; }
    static void columns(auto& record, auto&& visit) {
        visit("packet_seq", record.packet_seq);
        visit("sclk", record.sclk);
        visit("decision", record.explanation.decision, Column::searched);
        visit("verdict", record.explanation.verdict, Column::searched);
        visit("subject", record.explanation.subject);
        visit("text", record.explanation.text, Column::searched);
        visit("source", record.source);
        visit("duplicate", record.duplicate);
    }
};
template <>
struct PartTable<telemetry::Condition> {
    static constexpr char name[] = "explanation_conditions";
    static void columns(auto& part, auto&& visit) {
        visit("quantity", part.quantity);
        visit("value", part.value, Column::optional);
        visit("comparison", part.comparison);
        visit("bound", part.bound, Column::optional);
        visit("holds", part.holds);
    }
};

template <>
struct ItemTable<LinkRecord> {
    static constexpr char name[] = "link_changes";
    static constexpr bool derived = false;
    static constexpr auto of_batch = &Batch::links;
    static void columns(auto& record, auto&& visit) {
        visit("link", LinkName{record.link});
        visit("up", record.up);
        visit("silence", record.silence);
        visit("words", record.words);
        visit("lost", record.lost);
        visit("until_us", record.until);
    }
};

template <>
struct ItemTable<AlarmRecord> {
    static constexpr char name[] = "alarms";
    static constexpr bool derived = true;
    static constexpr auto of_batch = &Batch::alarms;
    static void columns(auto& record, auto&& visit) {
        visit("packet_seq", record.packet_seq);
        visit("channel", record.channel);
        visit("severity", record.severity);
        visit("value", record.value, Column::optional);
        visit("sclk", record.sclk);
        visit("limit_text", record.limit);
    }
};

template <>
struct ItemTable<StalenessRecord> {
    static constexpr char name[] = "staleness";
    static constexpr bool derived = false;
    static constexpr auto of_batch = &Batch::staleness;
    static void columns(auto& record, auto&& visit) {
        visit("packet", record.packet);
        visit("stale", record.stale);
        visit("silent_s", record.silent_s);
        visit("expected_s", record.expected_s);
        visit("reason", record.reason);
    }
};

template <>
struct ItemTable<SituationRecord> {
    static constexpr char name[] = "situations";
    static constexpr bool derived = false;
    static constexpr auto of_batch = &Batch::situations;
    static auto& parts(auto& record) { return record.entries; }
    static void columns(auto& record, auto&& visit) { visit("sentence", record.sentence, Column::searched); }
};
template <>
struct PartTable<telemetry::SituationEntry> {
    static constexpr char name[] = "situation_entries";
    static void columns(auto& part, auto&& visit) {
        visit("rank", part.rank);
        visit("subject", part.subject);
        visit("sentence", part.sentence);
        visit("evidence", part.evidence);
        visit("evidence_seq", part.evidence_seq);
        visit("since_us", part.since);
        visit("awaited", part.awaited);
        visit("at_us", part.at);
        visit("overdue", part.overdue);
        visit("timepoint", part.timepoint);
    }
};

template <>
struct ItemTable<AlarmActionRecord> {
    static constexpr char name[] = "alarm_actions";
    static constexpr bool derived = false;
    static constexpr auto of_batch = &Batch::alarm_actions;
    static void columns(auto& record, auto&& visit) {
        visit("alarm", record.alarm, Column::searched);
        visit("action", record.action, Column::searched);
        visit("author", record.by, Column::searched);
        visit("note", record.note, Column::searched);
        visit("until_us", record.until);
    }
};

template <>
struct ItemTable<NoteRecord> {
    static constexpr char name[] = "notes";
    static constexpr bool derived = false;
    static constexpr auto of_batch = &Batch::notes;
    static void columns(auto& record, auto&& visit) {
        visit("author", record.by, Column::searched);
        visit("text", record.text, Column::searched);
        visit("written", record.written);
        visit("sclk", record.sclk_s);
        visit("call", record.call);
        visit("position", record.position);
        visit("reads_back", record.reads_back);
    }
};

template <>
struct ItemTable<ProcedureActRecord> {
    static constexpr char name[] = "procedure_acts";
    static constexpr bool derived = false;
    static constexpr auto of_batch = &Batch::procedure_acts;
    static void columns(auto& record, auto&& visit) {
        visit("number", record.number);
        visit("kind", record.kind, Column::searched);
        visit("procedure", record.procedure, Column::searched);
        visit("step", record.step, Column::searched);
        visit("position", record.position, Column::searched);
        visit("author", record.by, Column::searched);
        visit("reason", record.reason, Column::searched);
        visit("choice", record.choice);
        visit("command", record.command);
        visit("text", record.text, Column::optional);
    }
};

template <>
struct ItemTable<ProcedureStatusRecord> {
    static constexpr char name[] = "procedure_statuses";
    static constexpr bool derived = false;
    static constexpr auto of_batch = &Batch::procedure_statuses;
    static void columns(auto& record, auto&& visit) {
        visit("number", record.number);
        visit("procedure", record.procedure);
        visit("part", record.part);
        visit("held", record.held);
        visit("status", record.status);
    }
};

template <>
struct ItemTable<PositionActRecord> {
    static constexpr char name[] = "position_acts";
    static constexpr bool derived = false;
    static constexpr auto of_batch = &Batch::position_acts;
    static void columns(auto& record, auto&& visit) {
        visit("kind", record.kind, Column::searched);
        visit("position", record.position, Column::searched);
        visit("author", record.by, Column::searched);
        visit("offered_to", record.to, Column::searched);
        visit("subject", record.subject, Column::searched);
        visit("reason", record.reason, Column::searched);
        visit("board", record.board);
    }
};

template <typename Record>
concept HasParts = requires(Record& record) { ItemTable<Record>::parts(record); };
template <HasParts Record>
using PartOf = typename std::remove_cvref_t<decltype(ItemTable<Record>::parts(std::declval<Record&>()))>::value_type;

/// A tag for a kind of item where no record is at hand.
template <typename Record_>
struct ItemKind {
    using Record = Record_;
};

/// All kinds that have a table. Samples have none: they are decommutated again from their packets.
template <template <typename> typename Of>
using OfItemKinds = std::tuple<Of<PacketRecord>, Of<EventRecord>, Of<ToneRecord>, Of<StageRecord>, Of<FiringRecord>,
                               Of<ExplanationRecord>, Of<LinkRecord>, Of<AlarmRecord>, Of<StalenessRecord>,
                               Of<SituationRecord>, Of<AlarmActionRecord>, Of<NoteRecord>, Of<ProcedureActRecord>,
                               Of<ProcedureStatusRecord>, Of<PositionActRecord>>;

/// Calls act(ItemKind<Record>) for each kind.
void for_item_kinds(auto act) {
    std::apply([&](auto... kind) { (act(kind), ...); }, OfItemKinds<ItemKind>{});
}
/// Calls act(ItemKind<Record>) for each kind until one fails; returns that Error.
Result<void> try_item_kinds(auto act) {
    Result<void> done;
    std::apply([&](auto... kind) { ((done = act(kind)).ok() && ...); }, OfItemKinds<ItemKind>{});
    return done;
}

}  // namespace aeolis::archive
