// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"
#include "server/rehearsal/companion.hpp"
#include "server/rehearsal/rehearsal.hpp"
#include "server/shadow/ensemble_flight.hpp"
#include "server/shadow/expectations.hpp"
#include "server/shadow/ground_flight.hpp"
#include "server/shadow/heard_flight.hpp"
#include "server/shadow/shadow_packets.hpp"
#include "simulation/scenario.hpp"

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace aeolis::server::shadow {

/// The flight that ground keeps beside a run: the same flight software in the world as ground knows it, with the
/// commands that were sent, moved every ten seconds to what the vehicle told. It lags behind the vehicle by the light
/// time, and so is where the vehicle was when it sent what arrives now; in silence it flies on.
///
/// In       what ground received, what was sent; dispersed flights of the plan, once they are made
/// Out      once a second its state, the values of its channels and the vehicle's residuals against it; by how much it
///          was moved, when timepoints are expected, and where the vehicle departs from the plan (shadow_packets.hpp)
/// Truth    none: a run whose hidden things differ gives the same until what is received differs. R57
/// Cost     that of a second landing, on the run's thread
/// Faults   a flight that comes to its end, or whose check fails, says so, and the run goes on. Where a command that
///          was sent is refused in it, it says that it departed, and nothing is expected by it any more
class Shadow final : public Companion {
  public:
    /// The dictionary must outlive this. @param order  of the plan's flights; no cases: none are made
    Shadow(const simulation::Scenario& scenario, const simulation::NavigationSolution& solution,
           const ClockCorrelation& clock, const dictionary::Dictionary& dictionary, const ForecastOrder& order);

    void take(std::uint64_t cycle, const v1::KeptRequest& request) override;
    Made hear(const telemetry::Received& received, Ert now) override;
    void go_live() override { live_ = true; }

    const Expectations& expectations() const { return expectations_; }
    const Rehearsal& flight() const { return *flight_; }

  private:
    /// A cycle of the own flight in which it told where it is.
    struct Own {
        NavigatedState truth, told;
    };
    struct Sent {
        std::uint64_t cycle = 0;
        v1::KeptRequest request;
    };
    /// How long a quantity has been outside of what is tolerated.
    struct Excess {
        std::optional<Sclk> since;
        std::uint32_t seen = 0;  ///< values since then
        bool told = false;
    };

    Made make(const telemetry::Received& received, Ert now);
    void step();
    void note_values(const telemetry::Decoded& decoded);
    void say_values(std::vector<ShadowPackets::Octets>& out);
    void hold_against(const NavigatedState& state, std::vector<ShadowPackets::Octets>& out);
    void look_at_firings(std::vector<ShadowPackets::Octets>& out);
    void look_at_stands(std::vector<ShadowPackets::Octets>& out);
    void look_at(Quantity quantity, double value, double doubt, Sclk at, std::vector<ShadowPackets::Octets>& out);
    void look_at_carrier(const telemetry::Received& received, Ert now, std::vector<ShadowPackets::Octets>& out);
    void depart();
    void go_astray();
    void departs(const TimepointDeparture& departure, std::vector<ShadowPackets::Octets>& out);
    void expect_again(std::vector<ShadowPackets::Octets>& out);
    void plan(Made& made, std::vector<ShadowPackets::Octets>& out);
    ShadowState state() const;
    double altitude_m(const std::array<double, 3>& p_MoB_M_m) const;

    simulation::Scenario scenario_;
    const dictionary::Dictionary& dictionary_;
    ForecastOrder order_;
    std::unique_ptr<Rehearsal> flight_;
    std::uint64_t cycles_ = 0, lag_;  ///< of the run; of the flight behind it
    std::deque<Sent> sent_;           ///< not yet flown
    std::deque<Own> own_;             ///< of late
    HeardFlight heard_, own_told_;
    telemetry::PacketDecoder decoder_;
    /// By channel: the second of its last sample, the value as said last, and what is to be said.
    std::vector<std::int64_t> second_of_;
    std::vector<std::optional<double>> value_said_;
    std::vector<bool> ever_said_;
    std::vector<telemetry::ExpectedValue> changed_;
    std::optional<Sclk> held_, moved_;  ///< the state held against last; when the flight was moved last
    std::optional<ShadowState::Residual> residual_;
    std::optional<Sclk> residual_at_;
    Expectations expectations_;
    std::vector<std::optional<ExpectedTime>> said_;  ///< by row: the expected time as told last
    std::vector<bool> said_told_;
    std::size_t firings_seen_ = 0, stands_seen_ = 0;
    std::array<Excess, quantities> excess_;
    std::set<std::size_t> departed_rows_;
    std::optional<std::size_t> late_row_;  ///< seen late once
    std::uint16_t departures_ = 0;
    bool over_told_ = false, live_ = false, lost_ = false;
    bool astray_ = false;  ///< it departed, or a command that was sent is refused in this flight
    bool pending_flown_ = false, pending_changed_ = false, expectations_changed_ = false;
    std::uint32_t plan_number_ = 0;  ///< of the last ensemble that was ordered, or should be
    bool plan_wanted_ = true;        ///< one should be ordered
    std::unique_ptr<EnsembleFlight> ensemble_;
    ShadowPackets packets_;
};

/// Shadows of rehearsals, as many flights of the plan each as `order` says. A scenario that has none: `ground_flight`.
MakeCompanion make_shadows(const dictionary::Dictionary& dictionary, const ForecastOrder& order);

}  // namespace aeolis::server::shadow
