// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/kept.pb.h"
#include "common/time.hpp"
#include "dictionaries/dictionary.hpp"
#include "server/shadow/forecast.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

// When ground expects each timepoint to fire, and what it expects to be told meanwhile: from dispersed flights of its
// plan, narrowed by what was heard since.
namespace aeolis::server::shadow {

/// The courses of the cases, as they are kept with a run. @param entry  the scenario's
v1::PlanEnsemble ensemble_of(std::span<const Course> courses, std::uint32_t order, Sclk from, Sclk entry);

/// A time with the interval that holds it in 99 of 100 flights, in seconds from the scenario's entry.
struct ExpectedTime {
    double e_s = 0.0;
    struct Interval {
        double from = 0.0, to = 0.0;
    };
    std::optional<Interval> interval_99;  ///< none: of too few cases (prospect.hpp, values_for_99)
    Interval tolerated;                   ///< outside of it the vehicle departs: beyond all cases
    std::uint32_t cases = 0;              ///< that fired it
    bool operator==(const ExpectedTime&) const;
};

/// What is compared with the plan second by second.
enum class Quantity : std::uint8_t { altitude_m, speed_mps, range_rate_mps };
inline constexpr std::size_t quantities = 3;

/// In       an ensemble; timepoints that fired, as they were told
/// Out      expected times of the others. Each is predicted from the two latest that were told and that differ between
///          cases, by least squares over the cases; its interval is that of the cases' residuals, free of any
///          distribution. So it narrows as the landing proceeds
/// Memory   cases × timepoints, some hundred kilobytes
class Expectations {
  public:
    /// The dictionary must outlive this. @param entry  the scenario's
    Expectations(const dictionary::Dictionary& dictionary, Sclk entry);

    void take(const v1::PlanEnsemble& ensemble);
    /// The plan was changed: until another ensemble is taken, nothing is expected.
    void withdraw();
    void fired(std::size_t row, Sclk at);

    bool known() const { return cases_ > 0; }
    /// Whether enough flights were made to say that the vehicle departs from all of them.
    bool tell_departures() const;
    std::uint32_t cases() const { return cases_; }
    const std::optional<Sclk>& told(std::size_t row) const { return told_[row]; }

    /// When the row is expected to fire, or was, from what was told of the rows before; none: not known, or no case
    /// fires it.
    std::optional<ExpectedTime> expected(std::size_t row) const;

    struct Range {
        double least = 0.0, median = 0.0, most = 0.0;
        /// Outside of it the vehicle departs.
        double tolerated_from() const { return least - margin(); }
        double tolerated_to() const { return most + margin(); }

      private:
        double margin() const;
    };
    /// Of all cases, about that time; none: beyond the time at which the first of them ends.
    std::optional<Range> range(Quantity quantity, Sclk at) const;

  private:
    static constexpr double never = -1.0e9;
    std::vector<std::size_t> regressors(std::size_t before) const;

    Sclk entry_;
    std::vector<std::optional<Sclk>> told_;   ///< by row
    std::vector<std::vector<double>> fired_;  ///< by row, by case, in seconds from entry
    std::vector<double> spread_s_;            ///< by row: standard deviation
    std::uint32_t cases_ = 0;
    double first_e_s_ = 0.0;
    std::array<std::vector<Range>, quantities> ranges_;
};

}  // namespace aeolis::server::shadow
