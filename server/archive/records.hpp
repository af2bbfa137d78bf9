// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "commands/lifecycle.hpp"
#include "common/ids.hpp"
#include "common/time.hpp"
#include "common/tone_evidence.hpp"
#include "dictionaries/dictionary.hpp"
#include "telemetry/alarm_register.hpp"
#include "telemetry/explanation.hpp"
#include "telemetry/packet_identity.hpp"
#include "telemetry/silence_class.hpp"
#include "telemetry/situation.hpp"
#include "telemetry/station/link_ledger.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

// The records of the archive as plain values: one struct per table. A batch is committed whole or not at all.
namespace aeolis::archive {

using RunId = Id<struct RunTag, std::uint32_t>;

/// Number of an item within its run, from 1, in the order of arrival. Published only once durable.
using Sequence = std::uint64_t;

/// The order of a list, by the numbers of its rows.
enum class Order : std::uint8_t { oldest_first, newest_first };

/// Numbers equal those of Source in schema/aeolis/v1/items.proto.
enum class Source : std::uint8_t { realtime = 1, recorded = 2, ground = 3 };

/// A range of octets or numbers in a buffer of the batch.
struct Slice {
    std::size_t first = 0;
    std::size_t count = 0;
};

/// The members common to all items.
struct ItemRecord {
    Sequence seq = 0;
    Ert ert;  ///< when all of it had reached Earth; for items made on Earth, when made
};

/// A packet as received. Its samples, if any, are the item seq + 1: they are decommutated again from the octets.
struct PacketRecord : ItemRecord {
    Apid apid;
    std::optional<std::uint16_t> packet;  ///< index of its definition in the dictionary; none: not decoded
    std::string refusal;                  ///< why not decoded, or not to its end
    Sclk sclk;
    std::string link;  ///< "uhf_live", "uhf_<orbiter>", "relay", …
    Source source{};
    telemetry::Standing standing{};
    bool sampled = false;  ///< its values are in the series
    Slice octets;          ///< in Batch::octets

    /// Whether the packet was seen before with the same octets.
    bool duplicate() const {
        return standing == telemetry::Standing::again || standing == telemetry::Standing::duplicate;
    }
};

/// An exact value that a double does not hold: text, or a whole number of more than 53 bits.
struct SampleText {
    std::size_t column = 0;
    std::string text;
};

/// The values of one sampled packet, one column per channel; NaN where undefined. Only for publishing and for segments:
/// it has no row of its own.
struct SampleRecord : ItemRecord {
    std::uint16_t packet = 0;
    Sclk sclk;
    Source source{};
    Slice values;                     ///< in Batch::values
    std::vector<SampleText> texts{};  ///< of columns whose channel needs_text(), where defined
    bool sclk_by_reception = false;   ///< the packet holds no time
};

struct EventRecord : ItemRecord {
    Sequence packet_seq = 0;
    EvrId id;
    std::string name;
    dictionary::EventLevel level{};
    std::string text;
    Sclk sclk;
    Source source{};
    bool duplicate = false;
};

struct ToneRecord : ItemRecord {
    Ert start;                   ///< start of the symbol; its end is the ERT
    std::optional<ToneId> tone;  ///< none: erasure
    std::string name, meaning;
    double likelihood = 0.0;
    std::optional<ToneId> runner_up;
    double runner_up_likelihood = 0.0;
    double c_n0_dbhz = 0.0;
    double doppler_hz = 0.0;
    std::string model;
    Sclk sclk;                                  ///< SCLK when the symbol began, corrected for light time
    CarrierLock lock = CarrierLock::searching;  ///< the worst within the symbol
    std::vector<ToneLikelihood> best;           ///< the five likeliest, likeliest first; or empty
    std::optional<ToneSpectrum> spectrum;       ///< only of a decision from samples
};

/// A stage of a command. A command's first record carries its arguments, octets and client_id.
struct StageRecord : ItemRecord {
    std::uint64_t command = 0;  ///< number of the command in its run, from 1
    std::string name;
    commands::Stage stage{};
    commands::Status status{};
    std::string evidence;
    std::string arguments;
    std::uint32_t count = 0;
    std::vector<std::uint8_t> octets;
    bool held = false, needs_approval = false;  ///< of a pending `released`: what it waits for
    std::string asked_by;                       ///< the sender of a command that needs approval, who may not give it
    std::string client_id;                      ///< the client's own; empty: none
};

/// How a timepoint ended, as flight reports it; `unknown`: flight reported another word.
enum class FiringVerdict : std::uint8_t { unknown, completed, verified, unverified, no_operation, refused };
/// Its name in the dictionary, the API and the archive.
const char* name_of(FiringVerdict verdict);
FiringVerdict firing_verdict(std::string_view word);

struct FiringRecord : ItemRecord {
    Sequence packet_seq = 0;
    TimepointId timepoint;
    std::string name;
    FiringVerdict verdict{};
    Sclk triggered, fired;
    Source source{};
    bool duplicate = false;
};

struct ExplanationRecord : ItemRecord {
    Sequence packet_seq = 0;
    Sclk sclk;
    telemetry::Explanation explanation;
    Source source{};
    bool duplicate = false;
};

struct LinkRecord : ItemRecord {
    std::string link;
    bool up = false;
    std::string words;
    bool lost = false;         ///< down although it should be up
    std::optional<Ert> until;  ///< when it is predicted to be heard again
    std::optional<telemetry::SilenceClass> silence{};

    std::string reason() const { return telemetry::reason_text(silence, words); }
};

struct AlarmRecord : ItemRecord {
    Sequence packet_seq = 0;
    ChannelId channel;
    dictionary::Severity severity{};  ///< none: cleared
    double value = 0.0;
    Sclk sclk;
    std::string limit;
};

/// A packet of which nothing comes in real time any more, or that is received again.
struct StalenessRecord : ItemRecord {
    std::uint16_t packet = 0;  ///< index in the dictionary's packets
    bool stale = false;
    double silent_s = 0.0;
    double expected_s = 0.0;  ///< above 0: it is due, and missing; else its absence is explained
    std::string reason;
};

/// What is true and matters, from this item to the next of its kind.
struct SituationRecord : ItemRecord {
    std::string sentence;  ///< of the first entry
    std::vector<telemetry::SituationEntry> entries;
};

/// An action on an alarm, identified by the alarm's name.
struct AlarmActionRecord : ItemRecord {
    std::string alarm;
    telemetry::AlarmAct action{};
    std::string note, by;
    Ert until;  ///< of shelve only
};

/// A line of the shift log, or a remark on an instant.
struct NoteRecord : ItemRecord {
    std::string text, by;
    std::string written;  ///< wall clock, ISO 8601
    std::optional<double> sclk_s;
    std::string call;              ///< the id of a standard call; empty: it is none
    std::string position;          ///< from which the call is made or read back
    std::uint64_t reads_back = 0;  ///< the number of the item whose call it reads back; 0: none
};

enum class ProcedureActKind : std::uint8_t { begin, tick, sign, choose, skip, sent, hold, release, acknowledge, stop };
inline constexpr std::size_t procedure_act_kinds = 10;
/// Its name in the API and in the archive.
const char* name_of(ProcedureActKind kind);
std::optional<ProcedureActKind> procedure_act_kind(std::string_view name);

/// What a person did with a procedure of the run.
struct ProcedureActRecord : ItemRecord {
    std::uint32_t number = 0;  ///< of the procedure in the run, from 1
    ProcedureActKind kind{};
    std::string procedure;  ///< its id
    std::string text;       ///< of `begin`: the file that is followed; else empty
    std::string step;       ///< or watchdog; empty: the whole procedure
    std::string position, by, reason;
    std::optional<std::uint32_t> choice;  ///< of `choose`
    std::uint64_t command = 0;            ///< of `sent`
};

/// A procedure of the run as it stands, from this item to the next of its number.
struct ProcedureStatusRecord : ItemRecord {
    std::uint32_t number = 0;
    std::string procedure, part, held;
    std::vector<std::uint8_t> status;  ///< all of it, as packed() of procedure_status.hpp makes it
};

enum class PositionActKind : std::uint8_t { take, offer, leave, poll, go, no_go };
inline constexpr std::size_t position_act_kinds = 6;
/// Its name in the API and in the archive.
const char* name_of(PositionActKind kind);
std::optional<PositionActKind> position_act_kind(std::string_view name);

/// What a person did with a position of the control room.
struct PositionActRecord : ItemRecord {
    PositionActKind kind{};
    std::string position, by, to, subject, reason;
    std::vector<std::uint8_t> board;  ///< how the room stands behind it: v1::PositionBoard, serialized
};

inline constexpr std::size_t segment_samples = 1024;  ///< samples in a full segment; limits.md

/// Samples of one packet and source, column by column. Written once, when full or at the end of the run: only the last
/// segment of a series may hold less than segment_samples.
struct SegmentRecord {
    std::uint16_t packet = 0;
    Source source{};
    std::uint64_t position = 0;                          ///< number within its series, from 0
    Sequence first_packet_seq = 0, last_packet_seq = 0;  ///< sequence numbers of its first and last sampled packet
    std::vector<double> sclk_s;                          ///< in the order of receipt
    std::vector<ChannelId> channels;
    std::vector<double> values;  ///< channel by channel, sclk_s.size() each; NaN: undefined
};

/// Extremes of one channel over a stretch of samples: all of it that a plot can show.
struct Extremes {
    double least = 0.0, least_sclk_s = 0.0, largest = 0.0, largest_sclk_s = 0.0;
    std::uint32_t defined = 0;  ///< samples that are not NaN; 0: the other members are 0

    void add(const Extremes& later);
    /// Adds one sample, not NaN.
    void add(double value, double sclk_s) { add({value, sclk_s, value, sclk_s, 1}); }
};

/// A block of nodes of one level in a series' pyramid (pyramid.hpp).
struct PyramidRecord {
    std::uint16_t packet = 0;
    Source source{};
    std::uint8_t level = 0;                         ///< from 1
    std::uint64_t position = 0;                     ///< number within its level, from 0
    std::vector<double> first_sclk_s, last_sclk_s;  ///< smallest and largest time, per node
    std::vector<ChannelId> channels;
    std::vector<Extremes> nodes;  ///< channel by channel, first_sclk_s.size() each
};

/// Totals of comparing real time with the recording, and the fraction of the recording that is down.
struct RecordingTotals {
    std::uint64_t recorded = 0, recorded_octets = 0, realtime = 0, realtime_not_recorded = 0, realtime_differs = 0,
                  never_seen_live = 0, not_decoded = 0;
    double progress = 0.0;
};

using telemetry::LinkTotals, telemetry::merge;

/// Octets of a link as received, good and bad. They have no sequence number; only the items made from them have.
struct RawRecord {
    static constexpr std::size_t octets_max = 65536;        ///< pieces of a stream are joined up to here
    static constexpr std::int64_t joined_us_max = 250'000;  ///< chosen: and as long as they came within this time
    std::string link;
    Ert begun, ert;           ///< of the first and of the last piece of them
    std::uint64_t first = 0;  ///< number of octets of this link before them in the run
    std::vector<std::uint8_t> octets;
    bool datagram = false;  ///< not joined with another
};
/// Octets kept of each link of a run by default; chosen. When there are more, the oldest are removed.
inline constexpr std::uint64_t raw_octets_kept = std::uint64_t{1} << 30U;

/// The instant of another run from which a run goes on otherwise.
struct ForkPoint {
    RunId run;
    std::uint64_t cycle = 0;  ///< cycles of 1/64 s flown before it
    double e_s = 0.0;         ///< of the vehicle's clock
    std::uint64_t seed = 0;   ///< of the errors that are drawn anew from there on; 0: the run's own errors
};

struct RunStart {
    std::string scenario, title;
    std::string venue = "rehearsal";
    std::uint64_t seed = 0;
    std::uint64_t case_number = 0;
    double pace = 0.0;
    std::string started;  ///< wall clock, ISO 8601
    Sclk start, entry;    ///< entry as predicted
    ClockCorrelation correlation;
    double light_time_s = 0.0;
    std::string tone_model;
    std::string scenario_text;  ///< the whole scenario as Protobuf text: with the seed, the run can be flown again
    std::vector<std::pair<std::string, double>> solution;  ///< ground's navigation solution
    std::optional<ForkPoint> forked_from;
};

/// How a run ended; `running`: it has not, or was cut off.
enum class Outcome : std::uint8_t { running, touchdown, impact, lost, not_commanded, timeout, stopped };
/// Its name in the API and in the archive.
const char* name_of(Outcome outcome);

struct RunEnd {
    Outcome outcome = Outcome::running;
    std::string reason;
    std::string digest;
    std::string ended;  ///< wall clock, ISO 8601
};

/// A controller's request that the gateway took, or an intervention or note of an instructor. With the scenario and the
/// seed, these requests determine the run.
struct RequestRecord {
    std::uint64_t cycle = 0;  ///< cycles of 1/64 s flown before it
    std::string request;      ///< as kept_text() writes it
};

/// A run with all that is needed to fly it again.
struct FlownRun {
    RunId run;
    std::string scenario_text, started;
    std::uint64_t seed = 0, case_number = 0;
    ClockCorrelation clock;               ///< used by the run, whatever the dictionary's file says now
    Sequence last_seq = 0;                ///< durable, and perhaps published
    std::vector<RequestRecord> requests;  ///< in the order taken
    std::vector<Sequence> annotations;    ///< items made by people: flying does not produce them again
    std::optional<ForkPoint> forked_from;
};

/// A person's addition to a run, in progress or over.
using Annotation = std::variant<NoteRecord, AlarmActionRecord, ProcedureActRecord, PositionActRecord>;

/// The items and rows that become durable together.
struct Batch {
    Sequence first_seq = 0, last_seq = 0;  ///< of all items in it; both 0 when it has none
    std::vector<std::uint8_t> octets;
    std::vector<double> values;
    std::vector<PacketRecord> packets;
    std::vector<SampleRecord> samples;
    std::vector<EventRecord> events;
    std::vector<ToneRecord> tones;
    std::vector<StageRecord> stages;
    std::vector<FiringRecord> firings;
    std::vector<ExplanationRecord> explanations;
    std::vector<LinkRecord> links;
    std::vector<AlarmRecord> alarms;
    std::vector<StalenessRecord> staleness;
    std::vector<SituationRecord> situations;
    std::vector<AlarmActionRecord> alarm_actions;
    std::vector<NoteRecord> notes;
    std::vector<ProcedureActRecord> procedure_acts;
    std::vector<ProcedureStatusRecord> procedure_statuses;
    std::vector<PositionActRecord> position_acts;
    std::vector<SegmentRecord> segments;
    std::vector<RequestRecord> requests;
    std::vector<PyramidRecord> pyramid;
    std::optional<RecordingTotals> totals;
    std::vector<LinkTotals> link_totals;  ///< only those that changed
    std::vector<RawRecord> raw;
    std::size_t raw_octets = 0;                ///< in them
    std::uint64_t raw_kept = raw_octets_kept;  ///< of each link of the run
    std::optional<RunEnd> end;

    bool empty() const {
        return last_seq == 0 && segments.empty() && requests.empty() && !totals && link_totals.empty() && raw.empty() &&
               !end;
    }
    void add(Annotation annotation);
    void clear();  ///< keeps the capacity
};

}  // namespace aeolis::archive
