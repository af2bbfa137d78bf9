// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/alarms.pb.h"
#include "aeolis/v1/items.pb.h"
#include "aeolis/v1/lists.pb.h"
#include "aeolis/v1/plan.pb.h"
#include "aeolis/v1/run.pb.h"
#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"
#include "dictionaries/timeline_plan.hpp"
#include "server/archive/audit.hpp"
#include "server/archive/forecasts.hpp"
#include "server/archive/layouts.hpp"
#include "server/archive/records.hpp"
#include "telemetry/alarm_register.hpp"
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

/// Octets of encoded rows after which a page ends before its limit of rows: at most 8 MiB as JSON, where an empty field
/// takes some 20 characters. The stream's pages of items have a limit of rows only.
inline constexpr std::size_t page_octets_max = 512 << 10;
inline constexpr std::size_t items_page_max = 10'000;      ///< items in one answer: about 2 MB encoded
inline constexpr std::size_t packets_page_max = 1'000;     ///< packets with their fields in one answer: about 1 MB
inline constexpr std::size_t rows_page_max = 10'000;       ///< events, explanations in one answer
inline constexpr std::size_t commands_page_max = 1'000;    ///< commands with their stages in one answer
inline constexpr std::size_t channels_max = 64;            ///< channels in one series query
inline constexpr std::size_t exact_samples_max = 200'000;  ///< samples of one channel in one exact answer; beyond: thin
inline constexpr std::size_t thinned_points_max = 20'000;  ///< points in one thinned answer
inline constexpr std::size_t rows_scanned_max = 200'000;   ///< rows read for one page of a filtered list

/// A range of SCLK, both ends included; none: open. A reversed range is an Error.
struct SclkRange {
    std::optional<double> from_s, to_s;
};

struct ItemPage {
    std::vector<v1::Item> items;    ///< in order of seq
    Sequence complete_through = 0;  ///< every item up to here is in `items`, or not after `after`
    bool more = false;
    Sequence after = 0;  ///< newest first: every item after this up to complete_through is in `items`
};

struct SeriesQuery {
    std::vector<std::string> channels;  ///< names or aliases
    SclkRange range;
    std::optional<std::size_t> points;  ///< thin to at most this many; none: exact
    std::optional<Source> source{};     ///< only samples of this source; none: both, each sample once
    bool provenance = false;            ///< add the origin of every sample, and the gaps
};

/// Verdicts of comparing a packet with the other path. Nothing counts as missing in the recording until all of it is
/// down: "pending".
inline constexpr std::array<const char*, 7> verdicts{
    "identical", "differs", "missing_in_recording", "never_seen_live", "not_decoded", "pending", "made_on_ground"};

struct PacketQuery {
    std::optional<std::string> name;  ///< of the packet: "GncNavigation"
    SclkRange range;
    std::string verdict;  ///< only packets with this verdict; empty: all
    Sequence after = 0;
    std::size_t limit = 100;
    bool fields = true;
    Order order{};
};

struct EventQuery {
    SclkRange range;
    std::vector<std::string> levels;  ///< empty: all
    std::string text;         ///< words of name or text, or prefixes of words, in any order and case; empty: all
    bool duplicates = false;  ///< include recorded ones that were also seen in real time
    Sequence after = 0;
    std::size_t limit = 1'000;
    Order order{};
};

struct ToneQuery {
    SclkRange range;
    std::string text;  ///< words of name or meaning, as in EventQuery
    Sequence after = 0;
    std::size_t limit = rows_page_max;
    Order order{};
};

struct CommandQuery {
    SclkRange range;          ///< commands with a stage between the range's ends as seen on Earth
    std::string text;         ///< words of a stage, as in EventQuery
    std::uint64_t after = 0;  ///< number of a command
    std::size_t limit = commands_page_max;
    Order order{};
};

/// The octets of links that are to be exported.
struct RawQuery {
    bool packets = false;             ///< the packets found in it; false: the octets as they came
    std::string link;                 ///< empty: of all
    std::optional<Ert> from{}, to{};  ///< received between these, both included
};
/// Octets of a link in one piece: as received together, or a packet.
struct RawPiece {
    std::string link;
    Ert ert;
    std::uint64_t first = 0;  ///< octets of the link before it; of a packet: its number in the run
    std::vector<std::uint8_t> octets;
};
/// Pieces by link and order of reception; packets by order of reception.
struct RawPage {
    std::vector<RawPiece> pieces;
    bool last = true;
};
inline constexpr std::size_t raw_page_max = 64;  ///< chosen: 4 MB at most, octets and packets being of 64 kB at most
/// A link of which octets are kept.
struct RawLink {
    std::string link;
    std::uint64_t first = 0;  ///< octets before the oldest that is kept
    std::uint64_t octets = 0;
    bool stream = false;  ///< pieces of a stream; false: datagrams, or recorded before this was noted
};

struct RunQuery {
    std::uint32_t after = 0;  ///< number of a run
    std::size_t limit = 1'000;
    Order order = Order::newest_first;
};

struct InterventionQuery {
    std::uint64_t after = 0;  ///< place of a request in the run
    std::size_t limit = 1'000;
    Order order{};
};

struct TimepointQuery {
    std::optional<Sclk> at{};  ///< as known when this time was received from the vehicle; none: as known now
    std::optional<Ert> now{};  ///< of the current run: an overdue timepoint is predicted no earlier than now
    bool recorded = true;      ///< include what only the recording has
    std::optional<dictionary::OffsetChange> change{};  ///< a change to be previewed
};

struct ExplanationQuery {
    SclkRange range;
    std::string decision;  ///< empty: all
    std::string text;      ///< words, as in EventQuery
    bool duplicates = false;
    Sequence after = 0;
    std::size_t limit = 1'000;
    Order order{};
};

struct NoteQuery {
    std::string text;  ///< words, as in EventQuery
    Sequence after = 0;
    std::size_t limit = 1'000;
    Order order{};
};

struct ChannelValue {
    ChannelId channel;
    double value = 0.0;  ///< NaN: undefined, or a text
    Sclk sclk;
    Source source{};
    std::optional<std::string> text{};  ///< the exact value of a channel that needs_text(); none: undefined
    // Only in latest():
    Sequence seq = 0;  ///< of the packet
    Ert ert{};
    bool sclk_by_reception = false;
};

/// The position of a walk through samples, and the width of its time windows.
struct SampleCursor {
    double from_s = 0.0, to_s = 0.0, width_s = 0.0;
};
struct SamplePage {
    std::vector<ChannelValue> samples;
    std::optional<SampleCursor> next;  ///< for the next page; none: this was the last
};

/// Answers queries to an archive, during and after its writer's work.
///
/// In       run, names, ranges: anything a client may send        Out   the schema's messages, or an Error in words
/// Sees     what was committed before the query. Samples are read from segments; those not yet in a segment are
///          decommutated again from the packets, so that nothing durable is missing
/// Limits   those above; a longer answer is refused or comes in pages. A page goes on after `after`, in its order; 0:
///          it is the first. Its next_after is where the next page goes on; 0: it was the last
/// Threads  one owner per Reader; many Readers may be open. The dictionary must outlive it
class Reader {
  public:
    /// Opens the archive for reading.
    /// @param other  the mission that the dictionary belongs to, when it is another mission; it must outlive this too
    static Result<Reader> open(const std::filesystem::path& file, const dictionary::Dictionary& dictionary,
                               const telemetry::OtherMission* other = nullptr);

    Reader(Reader&&) noexcept;
    Reader& operator=(Reader&&) noexcept;
    ~Reader();

    /// Sets the stop condition: a query in progress ends with an Error soon after `stop` returns true. Null: never.
    void stop_when(std::function<bool()> stop);
    /// Whether a query has been stopped since.
    bool stopped() const;
    /// Whether the file was removed or replaced under its name: answers are from the old file; open a new Reader.
    bool outdated() const;

    /// A page of runs. A run in progress is `running`; the rehearsal fills in its pace and clocks.
    Result<v1::RunList> runs(const RunQuery& query = {});
    Result<v1::RunState> run(RunId run);

    /// The links of which octets are kept as they came.
    Result<std::vector<RawLink>> raw_links(RunId run);
    /// A page of the octets of links. @param after the last piece of the page before; none: the first page
    Result<RawPage> raw(RunId run, const RawQuery& query, const std::optional<RawPiece>& after);

    /// The kinds of items to include. complete_through counts excluded ones as given.
    struct ItemKinds {
        bool samples = true;
        bool packets = true;
        bool procedures = true;             ///< their statuses
        std::size_t octets_max = SIZE_MAX;  ///< of packets and samples, encoded, after which a page ends
    };
    /// The items after `after`, in order, of all kinds, as they were published.
    Result<ItemPage> items(RunId run, Sequence after, std::size_t limit);
    Result<ItemPage> items(RunId run, Sequence after, std::size_t limit, ItemKinds kinds);
    /// The newest items before `before`, or of all when that is 0, the newest first.
    Result<ItemPage> newest_items(RunId run, Sequence before, std::size_t limit, ItemKinds kinds);
    Result<Sequence> last_seq(RunId run);
    /// What is needed to fly a run again, in whatever state it is.
    Result<FlownRun> flown(RunId run);
    /// The same of an interrupted run, which it lets continue. Fails when the run was not interrupted.
    Result<FlownRun> cut_off(RunId run);
    /// What people added to a run, in the order of numbers.
    Result<std::vector<Annotation>> annotations(RunId run);
    /// Those of them that are acts on procedures.
    Result<std::vector<ProcedureActRecord>> all_procedure_acts(RunId run);
    /// Those that are acts on positions.
    Result<std::vector<PositionActRecord>> all_position_acts(RunId run);
    /// The scenario of a run of this dictionary, as Protobuf text. The Error says why there is none.
    Result<std::string> scenario_text(RunId run);

    /// The channels of a series query, each once, and the largest number of samples that series() would give. Fails
    /// when series() would fail for one of the channels.
    struct SeriesSize {
        std::vector<std::string> channels;
        std::size_t samples = 0;
    };
    Result<SeriesSize> series_size(RunId run, const SeriesQuery& query);
    /// Live and recorded samples as one series in order of SCLK, each sample once. Exact series have undefined samples,
    /// too; thinned ones leave them out. With an open end each series also has the newest sample (latest()).
    Result<v1::ChannelSeriesList> series(RunId run, const SeriesQuery& query);
    /// A formula of channels as one series, at the times of its first channel. Each other channel counts with its
    /// newest value up to then. It is exact, or thinned to the minimum and maximum of equal intervals. Memory does not
    /// grow with the number of samples. Where a channel or the result is undefined, so is the sample; a thinned series
    /// leaves it out.
    Result<v1::ChannelSeries> derived(RunId run, const std::string& expression, const SclkRange& range,
                                      std::optional<std::size_t> points);
    /// Passes all samples of the channels in a range to `take`, in order of SCLK, some thousands at a time. Memory does
    /// not grow with the range. No channels: all. Ends with the Error that `take` returns.
    using TakeSamples = std::function<Result<void>(std::span<const ChannelValue> samples)>;
    Result<void> each_sample(RunId run, const std::vector<std::string>& channels, const SclkRange& range,
                             const TakeSamples& take);
    /// One page of these samples, in order of SCLK: about ten thousand, and where the next page begins. Samples
    /// received after the first page was read are in no page.
    Result<SamplePage> sample_page(RunId run, const std::vector<std::string>& channels, const SclkRange& range,
                                   const std::optional<SampleCursor>& after = {});
    /// The newest sample of every channel up to `at` (none: of the whole run), undefined ones too. In our mission the
    /// newest is that by its clock; in another, by reception, because its clocks may restart.
    Result<std::vector<ChannelValue>> latest(RunId run, std::optional<Sclk> at);

    /// A channel as the flight that ground keeps has it, one value a second where it changes. A value that has lasted is
    /// said again a second before it changes, so that a line between two of them is what was expected.
    struct ExpectedSeries {
        std::vector<double> sclk_s, value;
    };
    /// Of each channel, in the order given; without undefined values. Empty: ground kept no such flight.
    Result<std::vector<ExpectedSeries>> expected_values(RunId run, const std::vector<ChannelId>& channels,
                                                        const SclkRange& range);
    Result<v1::PacketList> packets(RunId run, const PacketQuery& query);
    /// The octets of packets of real links after `after`, as they were received. `after` becomes the last one's number.
    Result<std::vector<std::vector<std::uint8_t>>> received_octets(RunId run, Sequence& after, std::size_t limit);
    /// Passes the octets of each packet of the run's recording to `take`, in the order of receipt.
    using TakePacket = std::function<void(std::span<const std::uint8_t> packet)>;
    Result<void> each_recorded_packet(RunId run, const TakePacket& take);
    Result<v1::EventList> events(RunId run, const EventQuery& query);
    Result<v1::ToneList> tones(RunId run, const ToneQuery& query);
    Result<v1::ExplanationList> explanations(RunId run, const ExplanationQuery& query);
    Result<v1::CommandList> commands(RunId run, const CommandQuery& query = {});
    /// All commands of the run that change the timeline.
    Result<v1::CommandList> timeline_commands(RunId run);
    /// Changes of alarms and actions on them, a page at a time.
    Result<v1::AlarmList> alarms(RunId run, Sequence after, std::size_t limit, Order order = {});
    /// All alarms that are not normal, the most severe first. Refused for a run of another dictionary.
    /// @param now  time on Earth; none: when the run's newest packet was received
    Result<v1::AlarmList> alarm_states(RunId run, std::optional<Ert> now);
    /// The names of all links of all runs.
    Result<std::vector<std::string>> links();
    /// Whether `act` is permitted on the alarm of that name. The Error says why not.
    Result<void> may(RunId run, const std::string& alarm, telemetry::AlarmAct act, Ert now);
    /// When the run's newest packet was received.
    Result<Ert> newest_ert(RunId run);
    Result<v1::NoteList> notes(RunId run, const NoteQuery& query);
    /// The newest status of each procedure of the run, by number, as known at `at` by the clock on Earth.
    Result<std::vector<v1::Item>> procedures(RunId run, std::optional<Ert> at = {});
    /// The newest act on a position of the run, as known at `at` by the clock on Earth; none: there was none.
    Result<std::optional<v1::Item>> newest_position_act(RunId run, std::optional<Ert> at = {});
    /// All acts on positions of the run, oldest first; `at` as above.
    Result<std::vector<v1::Item>> position_acts(RunId run, std::optional<Ert> at = {});
    /// Whether a procedure of the number was begun in the run.
    Result<bool> has_procedure(RunId run, std::uint32_t number);
    /// What people did with a procedure of the run, oldest first; empty: it has none of the number.
    Result<std::vector<v1::Item>> procedure_acts(RunId run, std::uint32_t number);
    /// The interventions of instructors in the run. Those being rehearsed see them only once the run is over.
    Result<v1::InterventionList> interventions(RunId run, const InterventionQuery& query = {});
    /// The instructor's plan that the run began with; no text: it has none.
    Result<v1::InstructorPlan> instructor_plan(RunId run);
    /// The jumps of time of a rehearsal, in order; of one that was cut off within it how far it was to go.
    Result<std::vector<v1::Jump>> jumps(RunId run);
    /// The timeline: planned times, firings as far as known, and predictions from what was known.
    Result<v1::TimepointList> timepoints(RunId run, const TimepointQuery& query = {});
    Result<v1::RecordingSummary> recording(RunId run);
    /// When the newest packet of each kind was stale, by all that came live and with the recording. Empty before any of
    /// the recording has come. Refused for a run of another dictionary.
    Result<v1::RecordedStaleness> recorded_staleness(RunId run);
    /// Compares each live packet and tone with the recording, in totals. Takes as long as reading all packets.
    Result<v1::ProofReport> proof(RunId run);
    /// The as-flown report that a review of the landing starts from, with the first page of commands and of notes.
    /// Takes as long as proof().
    Result<v1::AsFlownReport> as_flown(RunId run);
    /// The silences of each link and their reported reasons, by their beginning.
    Result<std::vector<v1::Silence>> silences(RunId run);

    Result<std::vector<AuditEntry>> audit(std::uint64_t after, std::size_t limit, Order order = {});
    /// A page of a run's forecasts, and one of them: see forecasts.hpp.
    Result<std::vector<ForecastRecord>> forecasts(RunId run, bool truths, std::uint64_t after, std::size_t limit,
                                                  Order order);
    Result<std::optional<ForecastRecord>> forecast(RunId run, std::uint64_t number);
    /// The layouts of the owner, the one saved longest ago first.
    Result<std::vector<LayoutRecord>> layouts(const std::string& owner);

    struct State;  ///< reader_state.hpp: shared by the reader's parts

  private:
    explicit Reader(std::unique_ptr<State> state);
    Result<void> add_tones(RunId run, bool complete, v1::ProofReport& report);
    Result<void> add_counters(RunId run, v1::ProofReport& report);
    Result<void> add_sequences(RunId run, v1::ProofReport& report);
    Result<telemetry::AlarmRegister> alarm_register(RunId run, std::vector<v1::Item>& changes);
    std::unique_ptr<State> state_;
};

}  // namespace aeolis::archive
