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

inline constexpr auto stale_severity = dictionary::Severity::warning;  ///< chosen: decisions may rest on old values
/// Severity of a link's unpredicted silence. Chosen: the vehicle or the ground is not in the state assumed.
inline constexpr auto lost_severity = dictionary::Severity::distress;

/// Whether a link's packets are expected; the least expectation first.
enum class LinkIs : std::uint8_t {
    down,  ///< for a predicted reason: nothing is due
    lost,  ///< unexplained, or by a fault on the ground: packets stay due
    up,
};

struct StalenessChange {
    std::size_t packet = 0;  ///< index in the dictionary's packets
    bool stale = false;
    double silent_s = 0.0;    ///< since it was last received
    double expected_s = 0.0;  ///< interval at which it is due now; 0 when it is not stale
    std::string reason;  ///< "heard again", "not expected in landed", "the link is down: plasma blackout"; when stale
                         ///< "the link is lost: unexplained: …", empty while one is up
};

/// Detects missing real-time packets.
///
/// In       packets, links and phase of EDL as they reach Earth, and the time on Earth, in that order
/// Out      changes, appended to `out`
/// Rule     A packet is expected at its rate (DefaultRateInStream), thinned by the rows of telemetry_plan.csv that hold
///          in every plan, once it has been received at all. It is stale when it was absent for `stale_intervals` of
///          its intervals, and for `stale_least_s`, while a link was up or lost and the phase unchanged. A link with
///          heavy losses is allowed more: as many intervals as its losses before the last packet explain with a
///          probability of `stale_chance`. While all links are down nothing is expected: the silence is then the
///          link's, which has a reason. A lost link has none: stale packets stay stale, and the others become stale.
/// Losses   over all packets, at each reception after no staleness: one received of as many as were due since the last.
///          Both numbers fade with `stale_memory_s`
/// Memory   a row for each packet with a rate
class StalenessMonitor {
  public:
    /// The dictionary must outlive this.
    explicit StalenessMonitor(const dictionary::Dictionary& dictionary);

    void heard(std::size_t packet, Ert ert, std::vector<StalenessChange>& out);
    /// @param name  "uhf_live", "x_band_telemetry", "uhf_<orbiter>", "downlink" bring packets in real time; others are
    ///              ignored
    void link(std::string_view name, LinkIs is, std::string_view reason, Ert ert, std::vector<StalenessChange>& out);
    /// @param label  of EdlPhase
    void phase(std::string_view label, Ert ert, std::vector<StalenessChange>& out);
    void pass(Ert now, std::vector<StalenessChange>& out);

  private:
    struct Expected {
        std::size_t packet = 0;
        std::vector<double>
            interval_s;  ///< by state of the vehicle; 0: not expected. One entry when the plan does not name it
        std::optional<Ert> last{};           ///< none: never received
        Ert since{};                         ///< its absence counts from then on
        double intervals = stale_intervals;  ///< absent until it is stale, by the losses before its last reception
        bool stale = false;
    };
    struct Link {
        LinkIs is = LinkIs::down;
        std::string reason{};
    };
    double interval_s(const Expected& expected) const;
    /// Updates the losses on a reception; returns the absent intervals that the packet is now allowed.
    double reckon(const Expected& expected, Ert ert);
    void clear(Expected& expected, const std::string& reason, Ert now, std::vector<StalenessChange>& out) const;
    /// Why expected packets may be missing; empty while a link is up.
    std::string lost_for() const;

    std::vector<Expected> expected_;
    std::map<std::string, Link, std::less<>> links_;
    LinkIs best_ = LinkIs::down;     ///< of all links
    double due_ = 0.0, came_ = 0.0;  ///< packets
    Ert reckoned_{};
    std::string phase_;
    std::optional<std::size_t> state_;  ///< of the vehicle; none: not known
};

}  // namespace aeolis::telemetry
