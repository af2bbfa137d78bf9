// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "telemetry/port.hpp"
#include "telemetry/silence_class.hpp"
#include "telemetry/station/predicted_silences.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace aeolis::telemetry {

/// Explains why a link is silent from ground's knowledge: predictions, light time, the link, its last octet.
///
/// The port reports whether a receiver has lost or found a link.
/// In       changes of links as they reach Earth (name, up or down), time on Earth
/// Out      the same changes, with ground's reason and whether the link is lost
/// Rate     any; each call judges silences anew: when an explanation ends, another replaces it
/// Margin   a prediction counts for `margin_s` on both sides, since dispersed landings come that much earlier or later.
///          The clock alone ends X-band's telemetry: that counts from `pass_margin_s` before
/// Rules    in this order: the plan's switching, passes, blackout, hand-over; X-band: the plan's switching, Earth set,
///          link budget; the recording: complete, passes. If none holds: the station's fault, or unexplained. A fault
///          of the station is reported beside a prediction too, and the link is then lost: a prediction excuses no
///          fault
/// Memory   a row a link
/// A value, like the landing.
class SilenceClassifier {
  public:
    /// Chosen: four deviations of Earth set over dispersed landings (docs/decisions/0027), and the coarse prediction.
    static constexpr double margin_s = 35.0;
    static constexpr double pass_margin_s = 1.0;  ///< chosen: this near its rise or set an orbiter explains a silence

    /// @param start_ert  when the run begins on Earth; signals sent then arrive a light time later
    /// @param entry_ert  when a signal sent at the predicted entry arrives
    SilenceClassifier(PredictedSilences predicted, Ert start_ert, Ert entry_ert);

    /// The station's knowledge: received part of the recording, last octets of links, its fault.
    struct Station {
        double recording_progress = 0.0;
        std::vector<std::pair<std::string_view, Ert>> heard{};  ///< last octets, by link
        std::string fault{};  ///< of the station, or the line from it; empty: none known
    };
    /// @return the links' reports now: `changes` with ground's reasons, and silences whose cause has changed. May be
    /// empty.
    std::vector<LinkState> tell(const std::vector<LinkState>& changes, Ert now, const Station& station);

  private:
    struct Silence {
        Link link;
        bool cut = false;  ///< began while the station had a fault
        SilenceClass told{};
        bool told_fault = false;            ///< beside a prediction
        std::optional<double> fault_e_s{};  ///< when the station last had a fault meanwhile
    };
    struct Explanation {
        SilenceClass silence = SilenceClass::unexplained;
        std::string sentence{};
        std::optional<double> until_e_s{};  ///< when it ends, as predicted
        bool fault = false;                 ///< the station has a fault as well
    };
    Explanation explain(const Silence& silence, double e_s, const Station& station) const;
    Explanation explain_by_link(const Link& link, double e_s, const Station& station) const;
    Explanation explain_uhf(double e_s) const;
    Explanation explain_relay(double e_s, const Station& station) const;
    Explanation explain_x_band(double e_s) const;
    Explanation explain_x_band_telemetry(double e_s) const;
    std::optional<Explanation> explain_by_passes(double e_s) const;
    static std::optional<Explanation> not_begun(std::string_view words, std::optional<double> begin_s, double e_s);
    LinkState told(Silence& silence, const Explanation& why, Ert ert, const Station& station) const;
    double e_s(Ert ert) const;
    Ert ert_of(double e_s) const;

    PredictedSilences predicted_;
    Ert start_ert_, entry_ert_;
    bool begun_ = false;
    std::vector<Silence> silent_;
};

}  // namespace aeolis::telemetry
