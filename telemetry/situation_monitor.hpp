// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/ids.hpp"
#include "common/time.hpp"
#include "dictionaries/dictionary.hpp"
#include "telemetry/explanation.hpp"
#include "telemetry/situation.hpp"
#include "telemetry/station/silence_classifier.hpp"
#include "telemetry/timeline_watch.hpp"
#include "telemetry/touchdown.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace aeolis::telemetry {

/// Says what is true and matters now, from what has reached Earth and what was predicted before the landing.
///
/// It is a fold over items in their order: equal items give equal situations, live, after a restart or flown again.
/// In       facts, each with the number of its item; the time on Earth
/// Out      the ranked list for that time, the most important first
/// Rules    News stays until something follows it: a confirmed touchdown until the recording comes, and lasts from
///          then. A prediction excuses neither a silence that began without one nor a fault that the station knows.
///          A touchdown is reported by its own evidence alone, and confirmed or contradicted as touchdown.hpp has it.
///          A predicted time that has passed is overdue, and none is given where nothing is predicted
/// Memory   bounded: entries_max entries; a row a link, a timepoint, a command under way
class SituationMonitor {
  public:
    static constexpr std::size_t entries_max = 12;  ///< chosen: more is a list of alarms, which has its own panel
    static constexpr std::size_t news_max = 32;     ///< chosen: kept at once; the oldest are dropped first
    static constexpr std::size_t losses_max = 6;    ///< chosen: told at once, one a link; the oldest are dropped first
    static constexpr double uhf_late_s = 5.0;       ///< chosen: over telemetry a step may be told this much after it
    static constexpr double tone_late_s = 25.0;     ///< a symbol under way, one of its own, and its decision
    static constexpr int tone_sure = 80;            ///< chosen: a tone of less priority may be dropped for others

    /// Clocks of the run.
    struct Clocks {
        std::optional<Sclk> entry;  ///< as predicted; none: not known
        ClockCorrelation correlation;
        double light_time_s = 0.0;
    };
    /// The dictionary must outlive this and its copies.
    /// The names of events, tones, commands, timepoints and channels that the rules know.
    static std::vector<std::string_view> mission_names();

    SituationMonitor(const dictionary::Dictionary& dictionary, const Clocks& clocks);

    /// Where a fact comes from.
    struct Origin {
        std::uint64_t seq = 0;
        Ert ert;
        bool recorded = false;  ///< told by the recording
    };
    struct EventFact {
        std::string_view name, text;
        dictionary::EventLevel level{};
        Sclk sclk;
    };
    struct StageFact {
        std::uint64_t command = 0;
        std::string_view name, evidence;
        bool failed = false;  ///< the stage failed
        bool done = false;    ///< flight has executed it
    };
    /// What one packet in real time holds of the touchdown.
    struct TouchdownSample {
        Sclk sclk;
        std::optional<double> flag;                              ///< of touchdown_flag
        std::optional<double> rover_rate_rps, rover_force_mps2;  ///< of the rover's own IMU
        bool live = false;                                       ///< holds touchdown_live
    };
    /// A packet in real time. `received`: when it came over a link that keeps nothing back. The packet itself may be
    /// older, because packets wait on board for their turn.
    void heard(Sclk sclk, std::optional<Ert> received = {});
    void event(const EventFact& event, const Origin& origin);
    void fired(TimepointId timepoint, Sclk triggered, Sclk fired, const Origin& origin);
    void tone(ToneId tone, double likelihood, Sclk start, const Origin& origin);
    void link(const LinkState& state, const Origin& origin);
    void touchdown(const TouchdownSample& sample, const Origin& origin);
    void stage(const StageFact& stage, const Origin& origin);
    void alarm(ChannelId channel, dictionary::Severity severity, std::string_view limit, Sclk sclk,
               const Origin& origin);
    void explained(const Explanation& explanation, const Origin& origin);
    /// When ground's own flight expects a timepoint, in seconds from entry, and from when on it is late.
    struct ExpectedStep {
        double e_s = 0.0, late_e_s = 0.0;
    };
    /// It goes before the plan. None: ground expects it no more.
    void expected(TimepointId timepoint, const std::optional<ExpectedStep>& step);

    /// The situation at `now`; one entry at least.
    std::vector<SituationEntry> at(Ert now) const;

  private:
    struct LinkRow {
        bool up = false, lost = false;
        std::optional<SilenceClass> silence;
        std::string words;  ///< behind the class
        std::optional<Ert> until;
        Ert since;
        std::uint64_t seq = 0;
        /// When and by which item the present silence was first lost without a reason: no later prediction excuses it.
        std::optional<Ert> lost_since;
        std::uint64_t lost_seq = 0;
        std::optional<SilenceClass> outlasted;  ///< the prediction that this silence has outlasted
        std::optional<Ert> outlasted_until;
        bool station = false;  ///< is lost for the station's fault
        Ert station_since;
    };
    /// A link's, or the station's, last loss that is over: no prediction had it.
    struct Loss {
        std::string of;  ///< the link, or "station"
        Ert from{}, to{};
        std::uint64_t seq = 0;
        int times = 0;
    };
    struct Held {
        std::string decision, condition;
        std::uint64_t seq = 0;
        Ert at;
    };

    Ert seen(Sclk sclk) const;
    Ert seen(Sclk sclk, const Origin& origin) const { return clocks_.entry ? seen(sclk) : origin.ert; }
    std::string when(Ert ert) const;
    void add_news(SituationEntry entry);
    void follow(std::string_view subject);
    void designate(std::string_view text);
    void take_over(std::string_view how, Ert at, const Origin& origin, std::string evidence);
    void note_loss(const std::string& link, const LinkRow& row, Ert to, const Origin& origin);
    void note_touchdown_silence(const LinkState& state);
    void touch_down(Sclk sclk, std::string_view how, const Origin& origin, std::string evidence);
    void judge_touchdown(Sclk now, const Origin& origin);
    bool up(std::string_view link) const;
    bool telemetry_comes() const;  ///< live, whichever link brings it
    bool anything_up() const;
    Ert last_change() const;  ///< of a link
    bool tones_come() const { return up("x_band"); }

    bool awaits_begin(const LinkRow& link) const;  ///< not heard because the timeline does not run
    void add_links(std::vector<SituationEntry>& all, Ert now, bool not_heard) const;
    void add_station(std::vector<SituationEntry>& all) const;
    void add_lost(std::vector<SituationEntry>& all, const std::string& name, const LinkRow& link) const;
    void add_silent(std::vector<SituationEntry>& all, const std::string& name, const LinkRow& link, Ert now) const;
    std::string last_heard(std::size_t timepoint) const;  ///< of a known one, as evidence
    bool add_not_heard(std::vector<SituationEntry>& all, Ert now) const;
    void add_waiting(std::vector<SituationEntry>& all, Ert now) const;
    void add_step(std::vector<SituationEntry>& all, std::size_t next, Ert now) const;
    bool recording_follows() const;  ///< the confirmed touchdown, as news
    void add_recording(std::vector<SituationEntry>& all, Ert now) const;
    void add_lasting(std::vector<SituationEntry>& all, Ert now) const;

    const dictionary::Dictionary* dictionary_;
    Clocks clocks_;
    TimelineWatch timeline_;
    std::map<std::string, LinkRow, std::less<>> links_;
    std::vector<Loss> losses_;          ///< that are over: one a link at most, and the station's
    std::vector<SituationEntry> news_;  ///< news and danger, the oldest first
    std::optional<SituationEntry> backup_, landed_;
    TouchdownFacts touchdown_facts_;  ///< the newest of each kind, by the vehicle's time
    TouchdownVerdict touchdown_verdict_{};
    std::optional<SituationEntry> touchdown_told_;  ///< in place of landed_: confirmed or contradicted
    bool recording_told_ = false;                   ///< after touchdown it has begun to come, or is complete
    std::optional<Ert> last_heard_;
    std::optional<Ert> last_received_;  ///< of a link that keeps nothing back
    bool was_up_ = false;               ///< a link, ever
    struct Pass {
        Ert rises;
        std::string words;  ///< "odyssey rises at E+2:00:00"
    };
    std::optional<Pass> pass_;  ///< the last that was predicted
    bool begun_ = false;
    std::string prime_ = "A", backup_name_ = "B";
    std::optional<Ert> closes_;  ///< when the last command that can precede a planned step must have left
    std::optional<Held> held_;
    std::vector<std::optional<ExpectedStep>> expected_;  ///< by timepoint
    bool offsets_changed_ = false;  ///< by command: what was predicted for a step may no longer hold
};

}  // namespace aeolis::telemetry
