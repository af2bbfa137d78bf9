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

inline constexpr double stale_intervals =
    4.0;  ///< ours: so many packets in a row are not lost by chance on a link that loses few
inline constexpr double stale_chance =
    1.0e-5;  ///< ours: nor so many that the link's losses explain them less often than this
inline constexpr double stale_intervals_max = 12.0;  ///< ours: however bad the link
inline constexpr double stale_memory_s = 60.0;       ///< ours: over which the link's losses are reckoned
inline constexpr double stale_least_s = 5.0;         ///< ours: a burst of losses and the link's queue fit in

inline constexpr auto stale_severity = dictionary::Severity::warning;  ///< ours: what one acts upon may be old
inline constexpr auto lost_severity =
    dictionary::Severity::distress;  ///< ours, of a link whose silence nobody predicted: the vehicle or the ground is
                                     ///< not as one believes

/// Whether a link's packets are to be expected, the least first.
enum class LinkIs : std::uint8_t {
    down,  ///< for a reason that was predicted: nothing is due
    lost,  ///< for none, or by a fault on the ground: what is due goes on to be due
    up,
};

struct StalenessChange {
    std::size_t packet = 0;  ///< index in the dictionary's packets
    bool stale = false;
    double silent_s = 0.0;    ///< since it was last heard
    double expected_s = 0.0;  ///< interval at which it should come now; 0 when it is not stale
    std::string reason;  ///< "heard again", "not expected in landed", "the link is down: plasma blackout"; when stale
                         ///< "the link is lost: unexplained: …", empty while one is up
};

/// Tells when a packet that should come in real time does not.
///
/// In       packets, links and phase of EDL as they reach Earth, and the time on Earth, in that order
/// Out      changes, appended to `out`
/// Rule     A packet is expected at its rate (DefaultRateInStream) thinned by the rows of telemetry_plan.csv that hold
///          in every plan, once it has come at all. It is stale when nothing of it came for `stale_intervals` of that,
///          and `stale_least_s`, while a link was up or lost and the phase as it is for as long. Of a link that loses
///          much it takes more: as many intervals as losses like those before its last packet explain by
///          `stale_chance`. While all links are down nothing is expected: silence is then the link's, which says why.
///          One that is lost cannot say why: what was stale stays so, and the rest becomes it.
/// Losses   of all packets, each time one comes again that was not stale: one came of as many as were due since the
///          last. Both numbers fade with `stale_memory_s`
/// Memory   a row for each packet with a rate
class StalenessMonitor {
  public:
    /// The dictionary must outlive this.
    explicit StalenessMonitor(const dictionary::Dictionary& dictionary);

    void heard(std::size_t packet, Ert ert, std::vector<StalenessChange>& out);
    /// @param name  "uhf_live", "uhf_<orbiter>", "downlink" bring packets in real time; others are passed over
    void link(std::string_view name, LinkIs is, std::string_view reason, Ert ert, std::vector<StalenessChange>& out);
    /// @param label  of EdlPhase
    void phase(std::string_view label, Ert ert, std::vector<StalenessChange>& out);
    void pass(Ert now, std::vector<StalenessChange>& out);

  private:
    struct Expected {
        std::size_t packet = 0;
        std::vector<double>
            interval_s;             ///< by state of the vehicle; 0: none. One entry where the plan does not name it
        std::optional<Ert> last{};  ///< none: never came
        Ert since{};                ///< from then on its absence counts
        double intervals = stale_intervals;  ///< of absence that it takes, by the losses before it was last heard
        bool stale = false;
    };
    struct Link {
        LinkIs is = LinkIs::down;
        std::string reason{};
    };
    double interval_s(const Expected& expected) const;
    /// One has come again: how many of its intervals its absence now takes.
    double reckon(const Expected& expected, Ert ert);
    void clear(Expected& expected, const std::string& reason, Ert now, std::vector<StalenessChange>& out) const;
    /// Why nothing may come although it is expected; empty while a link is up.
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
