// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/items.pb.h"
#include "aeolis/v1/run.pb.h"
#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"
#include "dictionaries/timeline_plan.hpp"
#include "server/archive/audit.hpp"
#include "server/archive/records.hpp"
#include "telemetry/alarm_desk.hpp"
#include "telemetry/other_mission.hpp"

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace aeolis::archive {

inline constexpr std::size_t items_page_max = 10'000;      ///< items in one answer: some 2 MB encoded
inline constexpr std::size_t packets_page_max = 1'000;     ///< packets with their fields in one answer: about 1 MB
inline constexpr std::size_t rows_page_max = 10'000;       ///< events, explanations in one answer
inline constexpr std::size_t channels_max = 64;            ///< channels in one series query
inline constexpr std::size_t exact_samples_max = 200'000;  ///< samples of one channel in one exact answer; more: thin
inline constexpr std::size_t thinned_points_max = 20'000;  ///< points asked for when thinning
inline constexpr std::size_t rows_scanned_max = 200'000;   ///< rows looked at for one page of a filtered list

/// From and to, both included; none: open. Upside down is an Error.
struct SclkRange {
    std::optional<double> from_s, to_s;
};

struct ItemPage {
    std::vector<v1::Item> items;    ///< in order of seq
    Sequence complete_through = 0;  ///< every item up to here has been given, or lies before `after`
    bool more = false;
};

struct SeriesQuery {
    std::vector<std::string> channels;  ///< names or aliases
    SclkRange range;
    std::optional<std::size_t> points;  ///< thin to at most so many; none: exact
    std::optional<Source> source{};     ///< only what came so; none: both, each sample once
    bool provenance = false;            ///< with the origin of every sample, and the gaps
};

/// Verdicts on a unit against the other path. Before the whole recording is down, nothing is missing in it: pending.
inline constexpr std::array<const char*, 6> verdicts{"identical",       "differs",     "missing_in_recording",
                                                     "never_seen_live", "not_decoded", "pending"};

struct PacketQuery {
    std::optional<std::string> name;  ///< of the packet: "GncNavigation"
    SclkRange range;
    std::string verdict;  ///< only units of this one, by name; empty: all
    Sequence after = 0;
    std::size_t limit = 100;
    bool fields = true;
};

struct EventQuery {
    SclkRange range;
    std::vector<std::string> levels;  ///< empty: all
    std::string text;                 ///< words of name or text, or their beginnings, in any order and case; empty: all
    bool duplicates = false;          ///< also those of the recording that were seen in real time
    Sequence after = 0;
    std::size_t limit = 1'000;
};

struct ToneQuery {
    SclkRange range;
    std::string text;  ///< words of name or meaning, as in EventQuery
    Sequence after = 0;
    std::size_t limit = rows_page_max;
};

struct CommandQuery {
    SclkRange range;   ///< with a stage that is dated between when Earth heard of its beginning and when of its end
    std::string text;  ///< words of a stage, as in EventQuery
};

struct TimepointQuery {
    std::optional<Sclk> at{};  ///< as it was known when the vehicle was heard at this time; none: as it is known
    std::optional<Ert> now{};  ///< of a run that goes on: what is overdue comes now at the earliest
    bool recorded = true;      ///< with what only the recording tells
    std::optional<dictionary::OffsetChange> change{};  ///< what a command would change
};

struct ExplanationQuery {
    SclkRange range;
    std::string decision;  ///< empty: all
    std::string text;      ///< words, as in EventQuery
    bool duplicates = false;
    Sequence after = 0;
    std::size_t limit = 1'000;
};

struct NoteQuery {
    std::string text;  ///< words, as in EventQuery
    Sequence after = 0;
    std::size_t limit = 1'000;
};

struct ChannelValue {
    ChannelId channel;
    double value = 0.0;
    Sclk sclk;
    Source source{};
};

/// How far a walk through samples has come, and how wide its windows of time are.
struct SampleCursor {
    double from_s = 0.0, to_s = 0.0, width_s = 0.0;
};
struct SamplePage {
    std::vector<ChannelValue> samples;
    std::optional<SampleCursor> next;  ///< to ask on; none: that was all
};

/// Questions to an archive, while its writer goes on or after.
///
/// In       run, names, ranges: anything a client may send        Out   the schema's messages, or an Error in words
/// Sees     what was committed before the question was asked. Samples are read from segments and, for what is not yet
///          in a segment, made again from the raw units, so that nothing durable is missing.
/// Limits   those above; an answer that would be longer is refused or comes in pages
/// Threads  one owner a Reader; many Readers may be open. The dictionary must outlive it.
class Reader {
  public:
    /// @param other  the mission whose dictionary that is, where it is not ours; it must outlive this as well
    static Result<Reader> open(const std::filesystem::path& file, const dictionary::Dictionary& dictionary,
                               const telemetry::OtherMission* other = nullptr);

    Reader(Reader&&) noexcept;
    Reader& operator=(Reader&&) noexcept;
    ~Reader();

    /// A question that is being answered ends with an Error soon after `stop` says so. Null: never.
    void stop_when(std::function<bool()> stop);
    /// Whether that has happened since.
    bool stopped() const;
    /// The file no longer has its name: answers are from what it was, a new Reader sees what it is.
    bool outdated() const;

    /// All runs, newest first. A run that goes on is `running`; pace and clocks are the rehearsal's to fill in.
    Result<v1::RunList> runs();
    Result<v1::RunState> run(RunId run);

    /// Items with a larger sequence number, of all kinds, as they were published. Units and samples can be left out:
    /// complete_through counts them as given.
    struct ItemKinds {
        bool samples = true;
        bool units = true;
    };
    Result<ItemPage> items(RunId run, Sequence after, std::size_t limit);
    Result<ItemPage> items(RunId run, Sequence after, std::size_t limit, ItemKinds kinds);
    Result<Sequence> last_seq(RunId run);
    /// Fails when that run was not interrupted.
    Result<CutOffRun> cut_off(RunId run);

    /// Live and recorded as one series in order of SCLK, each sample once. Undefined values are left out: gaps.
    Result<v1::ChannelSeriesList> series(RunId run, const SeriesQuery& query);
    /// A formula of channels as one series, at the times of the first channel in it; of each other channel the newest
    /// value up to then counts. Exact, or thinned to the least and the largest of equal intervals; takes the same
    /// memory however many samples there are. What is undefined (NaN) is left out.
    Result<v1::ChannelSeries> derived(RunId run, const std::string& expression, const SclkRange& range,
                                      std::optional<std::size_t> points);
    /// All samples of the channels in a range, in order of SCLK, some thousands at a time; takes the same memory for a
    /// minute as for a year. No channel named: all. Ends with the error that `take` gives.
    using TakeSamples = std::function<Result<void>(std::span<const ChannelValue> samples)>;
    Result<void> each_sample(RunId run, const std::vector<std::string>& channels, const SclkRange& range,
                             const TakeSamples& take);
    /// The first of them, in order of SCLK, some ten thousand, and where the rest begins; or what follows a page. What
    /// came after the first page was asked for belongs to none.
    Result<SamplePage> sample_page(RunId run, const std::vector<std::string>& channels, const SclkRange& range,
                                   const std::optional<SampleCursor>& after = {});
    /// The newest value of every channel up to `at` (none: of all), undefined ones left out.
    Result<std::vector<ChannelValue>> latest(RunId run, std::optional<Sclk> at);

    Result<v1::PacketList> packets(RunId run, const PacketQuery& query);
    Result<v1::EventList> events(RunId run, const EventQuery& query);
    Result<v1::ToneList> tones(RunId run, const ToneQuery& query);
    Result<v1::ExplanationList> explanations(RunId run, const ExplanationQuery& query);
    Result<v1::CommandList> commands(RunId run, const CommandQuery& query = {});
    /// What changed about alarms, and what was done about them, a page at a time.
    Result<v1::AlarmList> alarms(RunId run, Sequence after, std::size_t limit);
    /// All alarms that are not normal, the most severe first. Refused for a run of another dictionary.
    /// @param now  on Earth; none: when the run's newest unit came
    Result<v1::AlarmList> alarm_states(RunId run, std::optional<Ert> now);
    /// Names of all links that any run had.
    Result<std::vector<std::string>> links();
    /// An Error says why `act` may not be done about the alarm of that name.
    Result<void> may(RunId run, const std::string& alarm, telemetry::AlarmAct act, Ert now);
    /// When the run's newest unit came.
    Result<Ert> newest_ert(RunId run);
    Result<v1::NoteList> notes(RunId run, const NoteQuery& query);
    /// What instructors did to the run, in order: for those who are rehearsed only once it is over.
    Result<v1::InterventionList> interventions(RunId run);
    /// The timeline: planned, fired as far as it is known, and predicted from what was known.
    Result<v1::TimepointList> timepoints(RunId run, const TimepointQuery& query = {});
    Result<v1::RecordingSummary> recording(RunId run);
    /// Each unit and tone that was seen live against the recording, in totals; takes as long as reading all units.
    Result<v1::ProofReport> proof(RunId run);
    /// All that a review of the landing begins with; as long as proof().
    Result<v1::AsFlownReport> as_flown(RunId run);

    /// In order, of those after `after`.
    Result<std::vector<AuditEntry>> audit(std::uint64_t after, std::size_t limit);

    struct State;  ///< reader_state.hpp: shared by the reader's parts

  private:
    explicit Reader(std::unique_ptr<State> state);
    Result<void> add_tones(RunId run, bool complete, v1::ProofReport& report);
    Result<void> add_counters(RunId run, v1::ProofReport& report);
    Result<telemetry::AlarmDesk> alarm_desk(RunId run, std::vector<v1::Item>& changes);
    std::unique_ptr<State> state_;
};

}  // namespace aeolis::archive
