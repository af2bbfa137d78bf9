// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/ids.hpp"
#include "common/time.hpp"
#include "dictionaries/dictionary.hpp"
#include "server/shadow/expectations.hpp"
#include "telemetry/station/expected_values.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

// What ground's flight shows, as packets that ground makes itself and keeps like those of the vehicle: SpaceSystem
// "Station" of the dictionary.
namespace aeolis::server::shadow {

enum class Stand : std::uint8_t { unheard, with_the_vehicle, departed, over };

/// The packet "ShadowState".
struct ShadowState {
    Stand stand = Stand::unheard;
    std::optional<std::uint16_t> timepoint;
    struct Course {
        double altitude_m = 0.0, speed_mps = 0.0;
    };
    std::optional<Course> flight;
    std::optional<double> heard_age_s;
    struct Residual {
        double position_m = 0.0, altitude_m = 0.0, speed_mps = 0.0, attitude_deg = 0.0;
    };
    std::optional<Residual> residual;
    struct Plan {
        Expectations::Range altitude_m, speed_mps;
    };
    std::optional<Plan> plan;
    std::uint16_t departures = 0, plan_cases = 0;
};

/// The packet "ShadowMoved".
struct ShadowMoved {
    double position_m = 0.0, speed_mps = 0.0, attitude_deg = 0.0;
};

struct TimepointDeparture {
    enum class Kind : std::uint8_t { too_early, too_late, not_yet_fired };
    std::uint16_t row = 0;
    Kind kind = Kind::not_yet_fired;
    double seen_s = 0.0;  ///< from entry: it fired, or had not fired
    ExpectedTime expected;
};
struct CourseDeparture {
    Quantity quantity = Quantity::altitude_m;
    double seen_s = 0.0, observed = 0.0;
    Expectations::Range range;
};

/// Makes the packets of a run, each APID with its own count.
class ShadowPackets {
  public:
    /// The dictionary must outlive this.
    explicit ShadowPackets(const dictionary::Dictionary& dictionary);

    using Octets = std::vector<std::uint8_t>;
    Octets state(const ShadowState& state, Sclk at);
    Octets moved(const ShadowMoved& moved, Sclk at);
    /// Of no cases: it is expected no more. @param told  the timepoint was told to have fired
    Octets expects(std::uint16_t row, const ExpectedTime& time, bool told, Sclk at);
    Octets departed(const TimepointDeparture& departure, Sclk at);
    Octets departed(const CourseDeparture& departure, Sclk at);
    /// As many packets as it takes, of values in the second that begins at `second`.
    std::vector<Octets> values(std::span<const telemetry::ExpectedValue> values, Sclk second);
    Octets plan_flown(std::uint32_t cases, Sclk at);
    Octets plan_changed(Sclk at);

  private:
    Octets sealed(Apid apid, std::span<const std::uint8_t> data, Sclk at);
    Octets event(std::string_view name, std::span<const std::uint8_t> arguments, Sclk at);

    const dictionary::Dictionary& dictionary_;
    std::map<std::uint16_t, std::uint16_t> counts_;  ///< by APID
};

}  // namespace aeolis::server::shadow
