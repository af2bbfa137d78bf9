// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"
#include "dictionaries/dictionary.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace aeolis::telemetry {

inline constexpr double stale_intervals = 4.0;       ///< our assumption: a good link loses fewer in a row by chance
inline constexpr double stale_chance = 1.0e-5;       ///< our assumption: below this, losses are no explanation
inline constexpr double stale_intervals_max = 12.0;  ///< our assumption: the limit for any link
inline constexpr double stale_memory_s = 60.0;       ///< our assumption: the link's losses are averaged over this time
inline constexpr double stale_least_s = 5.0;         ///< our assumption: covers a burst of losses and the link's queue
inline constexpr double link_down_s = 1.0;           ///< chosen: one link takes over from the other in less
inline constexpr double rhythm_fades = 0.9;          ///< chosen: an interval counts for some ten receptions after it

inline constexpr auto stale_severity = dictionary::Severity::warning;  ///< chosen: decisions may rest on old values
/// Severity of a link's unpredicted silence. Chosen: the vehicle or the ground is not in the state assumed.
inline constexpr auto lost_severity = dictionary::Severity::distress;

/// Whether a link's packets are expected; the least expectation first.
enum class LinkIs : std::uint8_t {
    down,  ///< for a predicted reason: nothing is due
    lost,  ///< unexplained, or by a fault on the ground: packets stay due
    up,
};

/// The staleness of a packet: whether its newest values are still of now.
enum class Staleness : std::uint8_t {
    current,
    explained,  ///< nothing can come, or nothing is due yet: no alarm
    missing,    ///< due and absent: an alarm
};

struct StalenessChange {
    std::size_t packet = 0;  ///< index in the dictionary's packets
    Staleness is = Staleness::current;
    double silent_s = 0.0;    ///< since it was last received
    double expected_s = 0.0;  ///< interval at which it is due now; above 0 when it is missing, and then alone
    /// current "heard again"; explained "the link is down: plasma blackout", "not expected in landed"; missing
    /// "the link is lost: unexplained: …", empty while one is up
    std::string reason;
};

/// Detects real-time packets that no longer arrive.
///
/// In       packets, links and phase of EDL as they reach Earth, and the time on Earth, in that order
/// Out      changes, appended to `out`. A packet that was never received has none, nor has one without channels, as
///          an event: it has no value that could be of now
/// Missing  A packet is expected at its rate (DefaultRateInStream), thinned by the rows of telemetry_plan.csv that hold
///          in every plan, once it has been received at all. It is missing when it was absent for `stale_intervals` of
///          its intervals, and for `stale_least_s`, while a link was up or lost and the phase unchanged. A link with
///          heavy losses is allowed more: as many intervals as its losses before the last packet explain with a
///          probability of `stale_chance`. While all links are down nothing is expected: the silence is then the
///          link's, which has a reason. A lost link has none: missing packets stay so, and the others become missing
///          when they are due
/// Explained  Every packet once all links have been down or lost for `link_down_s`, if lost until it is missing: what
///          comes over no link is not of now, however patient its rate; one that the phase does not promise after
///          `stale_least_s`; one without a promise once the links are lost, or, for a mission without a plan, after
///          `stale_intervals` of the longest interval at which it came lately; one that the ground makes, after
///          `stale_least_s`
/// Losses   over all packets, at each reception of one that is not missing: one received of as many as were due since
///          the last. Both numbers fade with `stale_memory_s`
/// Memory   a row for each packet
class StalenessMonitor {
  public:
    /// The dictionary must outlive this.
    explicit StalenessMonitor(const dictionary::Dictionary& dictionary);

    void heard(std::size_t packet, Ert ert, std::vector<StalenessChange>& out);
    /// A packet that the ground makes itself: no link brings it.
    void made_on_ground(std::size_t packet, Ert ert, std::vector<StalenessChange>& out);
    /// @param name  "uhf_live", "x_band_telemetry", "uhf_<orbiter>", "downlink" bring packets in real time; others are
    ///              ignored
    void link(std::string_view name, LinkIs is, std::string_view reason, Ert ert, std::vector<StalenessChange>& out);
    /// @param label  of EdlPhase
    void phase(std::string_view label, Ert ert, std::vector<StalenessChange>& out);
    void pass(Ert now, std::vector<StalenessChange>& out);

  private:
    struct Row {
        std::size_t packet = 0;
        /// By state of the vehicle; 0: not expected. One entry when the plan does not name it, none without a promise.
        std::vector<double> interval_s{};
        std::optional<Ert> last{};           ///< none: never received
        Ert since{};                         ///< its absence counts from then on
        double intervals = stale_intervals;  ///< absent until it is missing, by the losses before its last reception
        double rhythm_s = 0.0;               ///< the longest interval between its receptions lately
        bool of_ground = false;
        bool has_channels = false;
        Staleness is = Staleness::current;
    };
    struct Link {
        LinkIs is = LinkIs::down;
        std::string reason{};
    };
    double interval_s(const Row& row) const;
    /// Updates the losses on a reception; returns the absent intervals that the packet is now allowed.
    double reckon(const Row& row, Ert ert);
    void change(Row& row, Staleness to, std::string reason, Ert now, std::vector<StalenessChange>& out) const;
    void judge(Row& row, Ert now, std::vector<StalenessChange>& out) const;
    bool nothing_comes(double absent_s, Ert now) const;
    /// Why nothing comes: "the link is down: plasma blackout", "the link is lost: …"; empty while one is up.
    std::string silent_for() const;

    std::vector<Row> rows_;  ///< by packet
    bool by_rhythm_;         ///< there is no plan: a packet without a rate is judged by its rhythm
    std::map<std::string, Link, std::less<>> links_;
    LinkIs best_ = LinkIs::down;  ///< of all links
    std::string down_for_;        ///< why, as said by the link that went down last
    Ert best_since_{};
    double due_ = 0.0, came_ = 0.0;  ///< packets
    Ert reckoned_{};
    std::string phase_;
    std::optional<std::size_t> state_;  ///< of the vehicle; none: not known
};

/// How long nothing of a packet may come by any way before its last values are no longer of now: four of the slowest
/// interval that the plan promises live, `stale_least_s` at least. None: no rate is known.
std::optional<double> stale_after_s(const dictionary::Dictionary& dictionary, std::size_t packet);
/// The same of a recording, which holds each packet that the vehicle makes, not thinned for the link.
std::optional<double> stale_in_recording_after_s(const dictionary::Dictionary& dictionary, std::size_t packet);

/// Whether the reason of a missing packet names a lost link with these words of its own.
bool names_lost_link(std::string_view reason, std::string_view link_reason);

}  // namespace aeolis::telemetry
