// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "telemetry/port.hpp"
#include "telemetry/station/predicted_silences.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace aeolis::telemetry {

/// What a link's silence is taken for.
enum class SilenceClass : std::uint8_t {
    light_time,    ///< nothing can have come yet
    switched_off,  ///< the plan has the transmitter off again
    blackout,
    hand_over,        ///< between antennas of the vehicle
    no_orbiter,       ///< none that hands on at once is in view
    orbiter_records,  ///< one is that delivers later
    earth_set,
    weak_carrier,
    delivered,  ///< an orbiter has given all that it recorded
    recording_complete,
    ground_fault,  ///< the station, or the way to it
    unexplained,   ///< nothing that was predicted: look at it
};
/// "plasma blackout", "Earth set", …
const char* name_of(SilenceClass silence);
/// Whether a link that is silent so should be there.
bool is_lost(SilenceClass silence);
/// "plasma blackout: predicted from E+45 s to E+98 s": as a link's change says it. No sentence: the name alone.
std::string words_of(SilenceClass silence, const std::string& sentence);

/// Says why a link brings nothing, by what ground knows: predictions, light time, which link it is, its last octet.
/// That a receiver has lost or found a link is what the port brings.
///
/// In       changes of links as they reach Earth (name, up or down), time on Earth
/// Out      the same changes, with ground's reason and whether the link is lost
/// Rate     any; a silence is judged anew with each call: when its explanation is over, it gets another
/// Margin   a prediction counts for `margin_s` on both sides, as dispersed landings come so much earlier or later
/// Rules    in this order: the plan's switching, passes, blackout, hand-over; X-band: Earth set, link budget; the
///          recording: complete, passes. Where none holds: the fault that the station has, or unexplained
/// Memory   a row a link
/// A value, as the landing is.
class SilenceClassifier {
  public:
    static constexpr double margin_s = 35.0;  ///< ours: four deviations of when Earth sets for dispersed landings
                                              ///< (docs/decisions/0027), and the coarse prediction

    static constexpr double pass_margin_s = 1.0;  ///< ours: so near its rise or set an orbiter explains a silence

    /// @param start_ert  when the run begins on Earth; what leaves the vehicle then comes a light time later
    /// @param entry_ert  when what leaves at the predicted entry is heard
    SilenceClassifier(PredictedSilences predicted, Ert start_ert, Ert entry_ert);

    /// What ground has of the recording, and when it last heard of a link.
    struct Station {
        double recording_progress = 0.0;
        std::vector<std::pair<std::string_view, Ert>> heard{};  ///< last octets, by link
        std::string fault{};  ///< of the station, or the line from it; empty: none that anyone knows of
    };
    /// @return what to tell of links now: `changes` with ground's reasons, and silences that became others. Empty:
    ///   nothing.
    std::vector<LinkState> tell(const std::vector<LinkState>& changes, Ert now, const Station& station);

  private:
    struct Silence {
        Link link;
        bool cut = false;  ///< it began while the station failed
        SilenceClass told{};
    };
    struct Explanation {
        SilenceClass silence = SilenceClass::unexplained;
        std::string sentence{};
    };
    Explanation explain(const Silence& silence, double e_s, const Station& station) const;
    Explanation explain_by_link(const Link& link, double e_s, const Station& station) const;
    Explanation explain_uhf(double e_s) const;
    Explanation explain_relay(double e_s, const Station& station) const;
    Explanation explain_x_band(double e_s) const;
    std::optional<Explanation> explain_by_passes(double e_s) const;
    LinkState told(Silence& silence, const Explanation& why, Ert ert, const Station& station) const;
    double e_s(Ert ert) const;

    PredictedSilences predicted_;
    Ert start_ert_, entry_ert_;
    bool begun_ = false;
    std::vector<Silence> silent_;
};

}  // namespace aeolis::telemetry
