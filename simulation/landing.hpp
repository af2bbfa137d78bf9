// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/ids.hpp"
#include "common/time.hpp"
#include "flight/computer.hpp"
#include "simulation/links/x_band_front_end.hpp"
#include "simulation/scenario.hpp"
#include "telemetry/port.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

// A landing: the vehicle with its computer, Mars, and the links home. A value: copy it and the landing is forked.
namespace aeolis::simulation {

/// What ground's navigators deliver: the scenario's truth with the delivery's knowledge error. Frame M, Mars-relative.
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

/// A symbol that was sent on X-band: truth, for the run's score only.
struct SentSymbol {
    ToneId tone;
    Sclk at;         ///< when it began on board
    Ert start, end;  ///< of what of it arrives on Earth
};

/// Whether a link brings anything, and why it does not: truth, which ground is not told.
struct LinkTruth {
    telemetry::Link link;
    Ert ert;
    bool up = false;
    std::string reason;  ///< "plasma blackout", "Earth set", "not switched on", "no orbiter in view", "nominal"
};

/// A moment of the truth, named as in the design's table.
struct TruthEvent {
    std::string name;
    Sclk sclk;
    double e_s = 0.0;         ///< from the truth's entry interface
    double altitude_m = 0.0;  ///< descent stage's (before separation the vehicle's) above the landing radius
    double speed_mps = 0.0;   ///< planet-relative
};

struct TruthState {
    Sclk sclk;
    double e_s = 0.0;
    std::array<double, 3> p_MoB_M_m{};
    std::array<double, 3> v_MB_M_mps{};
    double altitude_m = 0.0, speed_mps = 0.0, sensed_mps2 = 0.0;
};

/// What a test or a report may want to see of the truth, and flight never does.
struct Inspection {
    double mass_kg = 0.0;  ///< of all that flies on
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
};

/// What happened in one 64 Hz cycle. The vectors live until the next step; they keep their capacity.
struct CycleReport {
    int ticks_skipped = 0;  ///< that went by in it beyond its own; nil but for a venue's real-time clock
    std::span<const std::uint8_t> recorded;  ///< whole packets appended to NVM in this cycle
    std::span<const std::uint8_t> radiated;  ///< PLTUs given to the UHF transmitter
    telemetry::Downlink earth;               ///< that reaches Earth by the end of this cycle: all that ground is given
    std::vector<XBandField> x_band;          ///< when tones come from samples: what then arrives instead of decisions
    std::vector<SentSymbol> symbols;         ///< whose end arrives by then
    std::vector<LinkTruth> links;
    std::vector<TruthEvent> events;
};

/// Events of the design's table that are decisions on board: the truth learns of them from the recorded event report of
/// the same name in capitals, and dates them by its SCLK.
inline constexpr std::array<const char*, 7> decided_on_board{
    "guidance_start",          "heading_alignment",           "radar_lock", "powered_approach_start",
    "constant_velocity_start", "constant_deceleration_start", "touchdown"};

/// How one of them is found in the recording, from the dictionary: packets of `apid` begin their data with an event id.
struct EventReportName {
    Apid apid;
    EvrId id;
    std::string name;  ///< as in decided_on_board
};

/// The air that the parachute opened into.
struct ParachuteReport {
    double mach = 0.0, dynamic_pressure_Pa = 0.0;
};

/// How near the vehicle came again to what it had let go; none: never nearer once that was clear.
struct SeparationReport {
    std::optional<double> heatshield_least_m, backshell_least_m;
    const char* struck = nullptr;  ///< the body that it came back to
};

class Landing {
  public:
    /// `case_number` selects an independent draw of all dispersions under the same seed. Without `reports` the events
    /// decided on board are missing from the truth's. When the scenario has its dispersions drawn later than at the
    /// start, up to that tick nothing depends on the case: not the links' fortune either, which is case 0's throughout.
    /// `clock`: how its clock runs against UTC; none: as UTC does, from the scenario's instant of entry.
    Landing(const Scenario& scenario, std::uint64_t seed, std::uint64_t case_number = 0,
            std::vector<EventReportName> reports = {}, std::optional<ClockCorrelation> clock = {});
    Landing(const Landing&);
    Landing& operator=(const Landing&);
    Landing(Landing&&) noexcept;
    Landing& operator=(Landing&&) noexcept;
    ~Landing();

    /// One cycle of 1/64 s, and as many ticks more as a venue's real-time clock lost in it. After the outcome is known
    /// and the last packet has arrived, finished() is true.
    const CycleReport& step();
    /// Of the last step.
    const CycleReport& report() const;

    /// X-band reaches Earth as samples of this antenna from here on.
    void listen_by(XBandFrontEnd antenna);

    /// Whether the dispersions were drawn: from the start, or since the tick at which the scenario has them drawn.
    bool dispersed() const;
    /// It will be this case's flight. Only while it has not been dispersed.
    void take_case(std::uint64_t case_number);

    /// Octets leave the station now; what the uplink leaves of them reaches the vehicle a light time later.
    void uplink(std::span<const std::uint8_t> octets);

    /// A PLTU for the rover leaves the station now; the next orbiter in view when it is there hands it down.
    void forward(std::span<const std::uint8_t> pltu);

    /// It begins with the next cycle, whatever it says itself.
    void inject(Fault fault);

    /// The prime computer's modules are run by a venue's executive from here on.
    void run_prime_by(std::shared_ptr<flight::CycleRunner> runner);

    /// A fault: the prime computer starts anew with the next cycle.
    void reset_prime();

    Sclk sclk() const;  ///< at the vehicle
    Scet scet() const;
    Ert ert_now() const;  ///< what Earth's clocks show at this moment: SCET of the vehicle's now
    double light_time_s() const;
    ClockCorrelation correlation() const;
    const NavigationSolution& solution() const;
    TruthState truth() const;
    Outcome outcome() const;
    std::string outcome_reason() const;
    bool flown() const;     ///< the outcome is known, and the computers are off
    bool finished() const;  ///< and the links are empty, and the recording is down, as ground has told the rover, or no
                            ///< pass is left
    std::optional<TouchdownReport> touchdown() const;
    double peak_deceleration_mps2() const;
    std::optional<ParachuteReport> parachute() const;  ///< at deployment
    Inspection inspect() const;
    SeparationReport separation() const;
    flight::Computer::Counters counters() const;
    std::span<const std::uint8_t> recording() const;  ///< NVM so far: whole packets, one after another
    bool recording_closed() const;                    ///< nothing will be added
    bool relaying() const;                            ///< it comes, or came, down

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace aeolis::simulation
