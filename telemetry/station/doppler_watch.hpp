// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time_table.hpp"
#include "telemetry/port.hpp"
#include "telemetry/station/doppler_shape.hpp"
#include "telemetry/station/received.hpp"

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace aeolis::telemetry {

/// Measures how much more a carrier departs from the line of its frequency than it did before.
///
/// The line is fitted to the eight estimates that end 1.5 s before the newest, or up to 4 s where the carrier was not
/// found meanwhile. Steady curvature makes all departures alike, so the mean of 16 older ones is subtracted. Their
/// spread is part of the deviation, so that a carrier that swings proves nothing.
/// A value.
class DopplerDeparture {
  public:
    struct Departure {
        double hz = 0.0, sigma_hz = 0.0;
    };
    /// Adds an estimate; times ascend. None: no line lies before it.
    std::optional<Departure> add(double time_s, double frequency_hz, double sigma_hz);

  private:
    struct Estimate {
        double time_s, frequency_hz, sigma_hz;
    };
    struct Past {
        double time_s, hz;
    };
    static constexpr std::size_t line_estimates = 8, past_departures = 16;
    std::optional<Departure> from_line(const Estimate& newest) const;
    std::optional<Departure> beyond_past(double time_s, const Departure& departure) const;

    std::vector<Estimate> estimates_;  ///< of the last seconds
    std::vector<Past> past_;           ///< departures of the last seconds
};

/// Recognises features of the flight by the Doppler of the X-band carrier: drag, reversals of the bank, the parachute
/// and the heatshield.
///
/// In       the carrier, eight estimates a second            Out   features, each once
/// Rule     a feature is seen when the carrier departs by as much as that feature makes it, three estimates in a row,
///          4 deviations at least, within some seconds of when the predict departs so. Until then it had not: a carrier
///          that is found only after a feature does not show it. The heatshield's small step counts only after the
///          parachute was seen
/// Drag     grows by e in some seconds, over the gravity's quadratic course
/// Reversal lift points to Earth's side of the flight path or away from it, so that the rate of the Doppler takes a
///          step by an eighth to a fifth of itself. The step is sought in the logarithm of the rate over that of the
///          predict, of which the predicted reversals were taken out. So a reversal that comes when predicted is seen
///          like one that does not, and one that does not come is not
/// Left out what the predict does not show; what comes after Earth's set
/// Limits   chosen over 500 dispersed landings: docs/tones.md
/// A value.
class DopplerWatch {
  public:
    /// `predict_hz`: Doppler predicted, by seconds from `entry`. `entry`: arrival of a signal sent at the predicted
    /// entry. `reversals_s`: when the lift is predicted to change sides, on the same scale.
    DopplerWatch(const TimeTable& predict_hz, Ert entry, std::span<const double> reversals_s = {});

    std::optional<SeenByDoppler> hear(const ReceivedCarrier& carrier);
    /// When the predict shows a feature, in seconds from the predicted entry; none: it does not.
    std::optional<double> expected_s(SeenByDoppler::Feature feature) const;

  private:
    static constexpr std::size_t reversals = 4, features = 3 + reversals;
    using Departure = DopplerDeparture::Departure;
    struct Watched {
        std::optional<double> expected_s, seen_s;
        std::optional<double> below_s;  ///< when the departure last proved too little
        double first_s = 0.0;           ///< of the estimates in a row
        int in_row = 0;
        double step = 0.0;  ///< of a reversal, in the logarithm of the rate
    };
    struct Estimate {
        double time_s, frequency_hz, sigma_hz, predict_hz;
    };
    void expect_reversals(const TimeTable& predict_hz, std::span<const double> reversals_s);
    void remember(const Estimate& estimate);
    double rate_hzps() const;  ///< of the last second
    std::optional<Departure> by_drag() const;
    std::optional<Departure> by_reversal(const Watched& watched) const;
    std::optional<Departure> departure(std::size_t feature, const std::optional<Departure>& from_line) const;
    std::optional<double> first_of_three(Watched& watched, std::size_t feature, double time_s,
                                         const Departure& departure) const;
    bool may_come(std::size_t feature, double time_s) const;

    Ert entry_;
    std::array<Watched, features> watched_{};
    DopplerDeparture departure_;
    std::vector<Estimate> estimates_;   ///< of the last seconds
    std::vector<MeasuredPoint> rates_;  ///< logarithms of the rate over the predict's, without its reversals
};

}  // namespace aeolis::telemetry
