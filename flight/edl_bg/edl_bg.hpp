// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/gnc/navigation/radar_batch.hpp"
#include "flight/kernel/outbox.hpp"
#include "flight/kernel/parameter_parts.hpp"
#include "flight/load.hpp"

#include <optional>

namespace aeolis::flight {

/// EdlBg: averages radar data over 5 s for the navigation filter, and checks parameters. R25, R47
/// Outside the rate group: its messages arrive at the start of the next cycle.
///
/// In      RadarReturns (64 Hz while the radar is on), NavigatedAttitude, ClockTick; SetParametersCommand;
///         StageParameterCommand, ActivateParametersCommand, DiscardParametersCommand, DumpParametersCommand;
///         ParameterPart
/// Out     RadarSolution to Edl at 1 Hz, GncRadar; ParametersUpdate to Edl, or the outcome "refused". Commands of the
///         table of parameters go on to Edl in their order, a change that may not be staged is refused
/// Faults  no solution for radar_gap_max_s (the first: radar_patience_s), while Edl wants them, is reported once
///         (RADAR_LOST). The averages outlive the last beam by 5 s; navigation then continues without radar
class EdlBg {
  public:
    explicit EdlBg(const Load& load) : as_built_(load.parameters), parameters_(load.parameters) {}

    void on(const RadarReturns& returns, Outbox& out);
    void on(const NavigatedAttitude& attitude, Outbox& out);
    void on(const SetParametersCommand& command, Outbox& out);
    void on(const StageParameterCommand& command, Outbox& out);
    void on(const ActivateParametersCommand& command, Outbox& out);
    void on(const DiscardParametersCommand& command, Outbox& out);
    void on(const DumpParametersCommand& command, Outbox& out);
    void on(const ParameterPart& part, Outbox& out);
    void on(const ClockTick& tick, Outbox& out);

  private:
    void watch_radar(Sclk now, Outbox& out);

    Parameters as_built_;  ///< by which a solution is judged, whatever table flies
    ReceivedParameters parameters_;
    gnc::RadarBatch batch_;
    RadarReturns latest_;  ///< of this cycle; their attitude arrives after them
    bool navigated_ = false;
    bool radar_locked_ = false;
    bool radar_lost_ = false;
    Sclk attitude_at_;  ///< Edl sends the attitude while it wants the radar
    Sclk solved_at_;    ///< time of the last solution; before the first, when Edl began to want one
    std::uint16_t solutions_ = 0;
};

}  // namespace aeolis::flight
