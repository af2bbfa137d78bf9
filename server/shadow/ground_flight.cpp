// SPDX-License-Identifier: Apache-2.0
#include "server/shadow/ground_flight.hpp"

#include "server/archive/kept_request.hpp"
#include "server/rehearsal/kept_requests.hpp"
#include "server/rehearsal/nominal_flight.hpp"
#include "simulation/mars/atmosphere.hpp"
#include "simulation/mars/point_mass.hpp"
#include "simulation/vectors.hpp"
#include "telemetry/packet_stream.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

namespace aeolis::server::shadow {
namespace {

using flight::NavigationShift;

// Chosen: what a velocity by radar and a height by radar leave unknown. The place on the map stays as unknown as the
// solution left it.
constexpr double by_radar_m = 5.0, by_radar_mps = 0.1;
constexpr double never_drawn_s = -1.0e6;  // a negative time before entry lies after it

simulation::Quaternion quaternion(const std::array<double, 4>& q) {
    return simulation::Quaternion{q[0], q[1], q[2], q[3]}.normalized();
}

/// Holds the ground's flight against what the vehicle told, cycle by cycle.
class Holder {
  public:
    Holder(Rehearsal& rehearsal, const HeardFlight& heard, const dictionary::Dictionary& dictionary)
        : rehearsal_(rehearsal), states_(heard.states()), own_(dictionary), before_(state_of(rehearsal.landing())) {}

    /// After each cycle.
    void look() {
        telemetry::PacketStream packets{rehearsal_.landing().report().recorded};
        while (const auto packet = packets.next()) own_.hear(*packet);
        if (next_ < states_.size() && states_[next_].sclk == before_.sclk) {
            const NavigatedState& state = states_[next_];
            const auto own = own_.states();
            const bool navigates = !own.empty() && own.back().sclk == state.sclk;
            rehearsal_.shift(shift_to(before_, state), navigates ? shift_to(own.back(), state) : NavigationShift{});
            held_ = state.sclk;
        }
        while (next_ < states_.size() && states_[next_].sclk <= before_.sclk) ++next_;
        before_ = state_of(rehearsal_.landing());
    }
    std::optional<Sclk> held() const { return held_; }
    /// What the ground's flight tells of itself.
    const HeardFlight& own() const { return own_; }

  private:
    Rehearsal& rehearsal_;
    std::vector<NavigatedState> states_;
    std::size_t next_ = 0;
    HeardFlight own_;
    NavigatedState before_;  ///< the truth of that flight before the cycle
    std::optional<Sclk> held_;
};

/// What the vehicle has told and the ground's flight does not, or where their timelines stand apart; empty: nothing.
std::string departure(const HeardFlight& heard, const HeardFlight& own, Sclk entry,
                      const dictionary::Dictionary& dictionary) {
    constexpr const char* therefore = ": the flight that ground expects is not the vehicle's, and nothing can be "
                                      "forecast from it";
    for (const auto& told : heard.warnings()) {
        const bool expected =
            std::ranges::any_of(own.warnings(), [&](const auto& each) { return each.name == told.name; });
        if (!expected)
            return fmt::format("at E{:+.1f} s the vehicle told {}, which nothing made ground expect{}",
                               told.sclk - entry, told.name, therefore);
    }
    if (heard.stands().empty()) return {};
    const TimelineStand& stand = heard.stands().back();
    const auto expected = own.stand_by(stand.sclk);
    if (!expected || expected->timepoint == stand.timepoint) return {};
    const auto name = [&](std::uint16_t row) {
        return row < dictionary.timeline.size() ? dictionary.timeline[row].name : std::string{"no timepoint"};
    };
    return fmt::format("at E{:+.1f} s the vehicle's timeline stood at {}, and that of the flight that ground expects "
                       "at {}: ask again when the vehicle has told more",
                       stand.sclk - entry, name(stand.timepoint), name(expected->timepoint));
}

}  // namespace

simulation::Scenario ground_scenario(const simulation::Scenario& scenario) {
    simulation::Scenario ground = expected_scenario(scenario);
    ground.name = scenario.name;
    // How large errors may be: published, and drawn by the cases alone.
    ground.dispersions = scenario.dispersions;
    ground.density_scale = simulation::with_deviations_of(ground.density_scale, scenario.density_scale);
    ground.disperse_before_entry_s = never_drawn_s;
    return ground;
}

NavigationShift shift_to(const NavigatedState& from, const NavigatedState& to) {
    NavigationShift by;
    by.p_MoB_M_m = simulation::array3(simulation::vector3(to.p_MoB_M_m) - simulation::vector3(from.p_MoB_M_m));
    by.v_MB_M_mps = simulation::array3(simulation::vector3(to.v_MB_M_mps) - simulation::vector3(from.v_MB_M_mps));
    by.q_BB = simulation::array4(quaternion(from.q_MB).conjugate() * quaternion(to.q_MB));
    return by;
}

NavigatedState state_of(const simulation::Landing& landing) {
    const auto truth = landing.truth();
    return {truth.sclk, truth.p_MoB_M_m, truth.v_MB_M_mps, landing.inspect().q_MB};
}

std::unique_ptr<Rehearsal> begin_ground_flight(const simulation::Scenario& scenario,
                                               const simulation::NavigationSolution& solution,
                                               const ClockCorrelation& clock,
                                               const dictionary::Dictionary& dictionary) {
    auto rehearsal = std::make_unique<Rehearsal>(ground_scenario(scenario), 1, 0, dictionary,
                                                 std::shared_ptr<flight::CycleRunner>{}, clock);
    const auto& landing = rehearsal->landing();
    const simulation::PointMass start =
        simulation::coast({simulation::vector3(solution.p_MoB_M_m), simulation::vector3(solution.v_MB_M_mps)},
                          landing.sclk() - solution.epoch);
    NavigatedState begin = state_of(landing);
    begin.p_MoB_M_m = simulation::array3(start.p_MoB_M);
    begin.v_MB_M_mps = simulation::array3(start.v_MB_M);
    rehearsal->shift(shift_to(state_of(landing), begin), {});
    rehearsal->send_solution(solution);
    return rehearsal;
}

simulation::StateKnowledge knowledge_by(const HeardFlight& heard, std::optional<Sclk> told,
                                        const simulation::Scenario& scenario) {
    const auto& errors = scenario.dispersions;
    simulation::StateKnowledge knowledge{errors.knowledge_position_m, errors.knowledge_velocity_mps};
    if (told && heard.radar_locked_by(*told)) {
        knowledge.velocity_mps = by_radar_mps;
        knowledge.height_m = by_radar_m;
    }
    return knowledge;
}

Result<GroundFlight> fly_by_ground(const simulation::Scenario& scenario, const simulation::NavigationSolution& solution,
                                   const archive::FlownRun& run, const HeardFlight& heard, Instant instant,
                                   const dictionary::Dictionary& dictionary, const std::function<bool()>& stop) {
    GroundFlight flight;
    flight.rehearsal = begin_ground_flight(scenario, solution, run.clock, dictionary);
    Rehearsal& rehearsal = *flight.rehearsal;

    archive::FlownRun sent = run;
    std::erase_if(sent.requests, [](const archive::RequestRecord& request) {
        const auto kept = archive::kept_request(request.request);
        return !kept.has_command() && !kept.has_verdict();
    });
    Holder holder{rehearsal, heard, dictionary};
    const FlyAgain how{instant.cycle, instant.with_requests, stop, [&](const telemetry::Received&) -> Result<void> {
                           holder.look();
                           return {};
                       }};
    if (const auto there = fly_again(rehearsal, sent, how); !there)
        return Error{"the flight that ground expects: " + there.error().message};
    if (auto why = departure(heard, holder.own(), scenario.entry_sclk, dictionary); !why.empty())
        return Error{std::move(why)};
    if (rehearsal.finished())
        return Error{fmt::format("the flight that ground expects is over by then, at E{:+.1f} s: {}",
                                 rehearsal.clocks().e_s(), rehearsal.outcome_reason())};

    flight.heard = holder.held();
    flight.knowledge = knowledge_by(heard, flight.heard, scenario);
    return flight;
}

}  // namespace aeolis::server::shadow
