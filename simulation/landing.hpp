// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/ids.hpp"
#include "common/result.hpp"
#include "common/time.hpp"
#include "flight/computer.hpp"
#include "simulation/draws.hpp"
#include "simulation/links/x_band_front_end.hpp"
#include "simulation/links/x_band_receiver_model.hpp"
#include "simulation/placed_state.hpp"
#include "simulation/scenario.hpp"
#include "telemetry/port.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

// A landing: the vehicle with its computers, Mars, and the links home. A value: copying it forks the landing.
namespace aeolis::simulation {

/// A delivery of ground's navigators: the scenario's truth with the knowledge error. Frame M, Mars-relative.
struct NavigationSolution {
    std::uint16_t solution_id = 1;
    Sclk epoch;
    std::array<double, 3> p_MoB_M_m{};
    std::array<double, 3> v_MB_M_mps{};
    Sclk entry;
    Target target;
    double parachute_speed_mps = 405.0;
    double heatshield_speed_mps = 142.0;
    double backshell_altitude_m = 1660.0;
};

/// A symbol sent on X-band: truth, for the run's score only.
struct SentSymbol {
    ToneId tone;
    Sclk at;         ///< its beginning on board
    Ert start, end;  ///< of its part that arrives on Earth
};

/// Whether a link works, and if not, why: truth, hidden from ground.
struct LinkTruth {
    telemetry::Link link;
    Ert ert;
    bool up = false;
    std::string reason;  ///< "plasma blackout", "Earth set", "not switched on", "no orbiter in view", "nominal"
};

/// A true event, named as in the design's table.
struct TruthEvent {
    std::string name;
    Sclk sclk;
    double e_s = 0.0;         ///< from the truth's entry interface
    double altitude_m = 0.0;  ///< descent stage's (before separation the vehicle's) above the landing radius
    double speed_mps = 0.0;   ///< planet-relative
    std::array<double, 3> p_MoB_M_m{};
};

struct TruthState {
    Sclk sclk;
    double e_s = 0.0;
    std::array<double, 3> p_MoB_M_m{};
    std::array<double, 3> v_MB_M_mps{};
    double altitude_m = 0.0, speed_mps = 0.0, sensed_mps2 = 0.0;
};

/// The part of the truth that a test or a report may want to see. Hidden from flight.
struct Inspection {
    double mass_kg = 0.0;  ///< of everything that flies on
    double propellant_kg = 0.0;
    double mach = 0.0;
    double dynamic_pressure_Pa = 0.0;
    double angle_of_attack_deg = 0.0;  ///< total, against the wind
    double bank_deg = 0.0;             ///< lift vector, positive to the right
    double density_kgm3 = 0.0;
    double thrust_N = 0.0;
    double bridle_m = 0.0;
    double swing_deg = 0.0;  ///< of the bridle, off the vertical
    std::array<double, 4> q_MB{1, 0, 0, 0};
    std::array<double, 3> rate_B_rps{};  ///< relative to inertial space
    bool uhf_on = false;                 ///< transmitter on and an antenna selected
    bool parachute_open = false;
};

enum class Outcome : std::uint8_t { running, touchdown, impact, lost, not_commanded, timeout };
/// "running", "touchdown", …
const char* name_of(Outcome outcome);

struct TouchdownReport {
    double vertical_mps = 0.0, horizontal_mps = 0.0, miss_m = 0.0, latitude_deg = 0.0, longitude_deg = 0.0;
    double tilt_deg = 0.0;  ///< of the descent stage off the vertical
};

/// Results of one 64 Hz cycle. Valid until the next step; the vectors keep their capacity.
struct CycleReport {
    int ticks_skipped = 0;                   ///< lost in it beyond its own; nil except with a venue's real-time clock
    std::span<const std::uint8_t> recorded;  ///< whole packets appended to NVM in this cycle
    std::span<const std::uint8_t> radiated;  ///< PLTUs given to the radio
    telemetry::Downlink earth;               ///< reaches Earth by the end of this cycle: all that ground is given
    std::vector<XBandField> x_band;          ///< arrives when tones are samples, or the carrier is listened to
    std::vector<SentSymbol> symbols;         ///< whose end arrives in this cycle
    std::vector<LinkTruth> links;
    std::vector<TruthEvent> events;
};

/// Events of the design's table that are decided on board. The truth takes them from the recorded event reports of the
/// same names in capitals, with their SCLK.
inline constexpr std::array<const char*, 7> decided_on_board{
    "guidance_start",          "heading_alignment",           "radar_lock", "powered_approach_start",
    "constant_velocity_start", "constant_deceleration_start", "touchdown"};

/// An on-board event's report in the recording: packets of `apid` begin their data with the event id.
struct EventReportName {
    Apid apid;
    EvrId id;
    std::string name;  ///< as in decided_on_board
};

/// The air at parachute deployment.
struct ParachuteReport {
    double mach = 0.0, dynamic_pressure_Pa = 0.0;
};

/// The closest return of the vehicle to a separated body, once clear of it; none: it never came closer.
struct SeparationReport {
    std::optional<double> heatshield_least_m, backshell_least_m;
    const char* struck = nullptr;  ///< the body that was struck
};

class Landing {
  public:
    /// `case_number` selects an independent draw of all dispersions under the same seed. Without `reports` the truth
    /// lacks the events decided on board. When the scenario draws its dispersions after the start, nothing depends on
    /// the case up to that tick; the links' random draws are case 0's throughout.
    /// `clock`: correlation of the vehicle's clock with UTC; none: runs as UTC does, from the scenario's instant of
    /// entry.
    Landing(const Scenario& scenario, std::uint64_t seed, std::uint64_t case_number = 0,
            std::vector<EventReportName> reports = {}, std::optional<ClockCorrelation> clock = {});
    Landing(const Landing&);
    Landing& operator=(const Landing&);
    Landing(Landing&&) noexcept;
    Landing& operator=(Landing&&) noexcept;
    ~Landing();

    /// Runs one cycle of 1/64 s, and any ticks that a venue's real-time clock lost in it.
    ///
    /// finished() becomes true after the outcome is known and the last packet has arrived.
    const CycleReport& step();
    /// The report of the last step.
    const CycleReport& report() const;

    /// Makes X-band reach Earth as samples of this antenna from here on.
    void listen_by(XBandFrontEnd antenna);
    /// Makes the estimates of this receiver's model reach Earth from here on, where tones are statistical.
    void listen_by(XBandReceiverModel receiver);

    /// Whether the dispersions have been drawn: at the start, or at the tick that the scenario sets.
    bool dispersed() const;
    /// Sets the case. Only before the dispersions are drawn.
    void take_case(std::uint64_t case_number);

    // ---- a landing in mid-flight, to be flown on many times ----------------------------------------------------

    /// Draws anew what lies ahead: air, wind, gusts, aerodynamics, the luck of buses and devices and, until they act,
    /// the parachute, the radar and the ground. State, masses, the IMU's errors and what navigation on board believes
    /// stay: they are the truth of this landing.
    ///
    /// With `knowledge` nothing but what navigation believes is certain: the true state departs from the present one by
    /// a draw of that, and all other errors are drawn too.
    void redraw(std::uint64_t seed, std::uint64_t case_number, const std::optional<StateKnowledge>& knowledge = {});

    /// The present state as numbers, the computer's too, unless nobody hears the landing.
    PlacedState placed_state() const;
    /// Flies on from `state`, between cruise-stage separation and touchdown. Errors of air, vehicle and instruments are
    /// this landing's. Refused: a time or a configuration outside that, a computer's state that cannot be read, a
    /// landing that is over or has no flight computer with GNC. Refused, nothing is changed.
    Result<void> place(const PlacedState& state);

    /// Moves the true state by `vehicle`, and what navigation on board believes by `navigation`, for a ground that
    /// learns where the vehicle is. Of `vehicle` the accelerometers' bias does nothing.
    void shift(const flight::NavigationShift& vehicle, const flight::NavigationShift& navigation);

    /// From here on nothing is recorded or reaches Earth, and a backup computer that ground has not enabled is off. The
    /// vehicle flies the same, in less time. Commands still reach prime.
    void fly_unheard();

    /// Sends octets from the station now; what survives the uplink reaches the vehicle a light time later.
    void uplink(std::span<const std::uint8_t> octets);

    /// Sends a PLTU for the rover from the station now; the next orbiter in view on its arrival relays it.
    void forward(std::span<const std::uint8_t> pltu);

    /// Injects a fault with the next cycle, whatever start time it states.
    void inject(Fault fault);

    /// Runs the prime computer's modules by a venue's executive from here on.
    void run_prime_by(std::shared_ptr<flight::CycleRunner> runner);

    /// Injects a fault: the prime computer restarts with the next cycle.
    void reset_prime();

    Sclk sclk() const;  ///< at the vehicle
    Scet scet() const;
    Ert ert_now() const;  ///< Earth's UTC at this moment; equal to the vehicle's SCET
    double light_time_s() const;
    ClockCorrelation correlation() const;
    const NavigationSolution& solution() const;
    TruthState truth() const;
    Outcome outcome() const;
    std::string outcome_reason() const;
    bool flown() const;  ///< the outcome is known, and the computers are off
    /// flown(), and the links are empty, and ground has confirmed the recording to the rover or no pass is left.
    bool finished() const;
    std::optional<TouchdownReport> touchdown() const;
    double peak_deceleration_mps2() const;
    std::optional<ParachuteReport> parachute() const;  ///< at deployment
    Inspection inspect() const;
    SeparationReport separation() const;
    std::vector<Draw> draws() const;  ///< the seeded errors of this case, once they are drawn
    flight::Computer::Counters counters() const;
    std::span<const std::uint8_t> recording() const;  ///< NVM so far: whole packets, one after another
    bool relaying() const;                            ///< the recording is being, or was, relayed

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace aeolis::simulation
