// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/fixed_queue.hpp"
#include "flight/cross_string/state_frame.hpp"
#include "flight/edl/decisions.hpp"
#include "flight/edl/gnc_health.hpp"
#include "flight/edl/parameter_table.hpp"
#include "flight/edl/phase.hpp"
#include "flight/edl/unverified_actions.hpp"
#include "flight/gnc/edl_gnc.hpp"
#include "flight/kernel/outbox.hpp"
#include "flight/timeline/change_guard.hpp"
#include "flight/timeline/constraint_monitor.hpp"
#include "flight/timeline/timeline.hpp"

#include <algorithm>
#include <limits>
#include <optional>

namespace aeolis::flight {

/// EdlMain: the one thread of EDL. R15, R17, R18, R47
/// Each 64 Hz cycle it runs the timeline, GNC exactly once, and the timeline again, so that GNC's decisions take effect
/// in the same cycle.
///
/// In      StatePart and Resume: continue from the state of another computer, or from before a restart. R32, R33
///         Tick; ImuReadings, EngineReply, BridleReply, CruiseAttitude, RadarSolution; ActionReply;
///         ParametersUpdate, DoEdlCommand, SetTimepointOffsetCommand, SetAnchorOffsetCommand, ResumePrimeCommand;
///         StageParameterCommand, ActivateParametersCommand, DiscardParametersCommand, DumpParametersCommand;
///         InhibitEdl
/// Out     actions to the device managers; tones; events, firings, explanations and channels to EdlComm; Confirm;
///         the table of parameters to EdlBg and MFSK when it changes, and to EdlComm when it is to be dumped
/// Gate    nothing runs before parameters and then "do edl" were received, the latter in late cruise and in time. R23
/// Ground may change the table of parameters until GNC is enabled, as a whole or not at all. R25
/// Changes of the timeline are judged on arrival, and refused where they are unsafe. R51
/// Roles   prime flies, and sends its state each cycle; Second Chance keeps recent IMU readings until it must take
///         over; a prime that was restarted after cruise-stage separation stands by, until ground orders it on.
///         R32, R33, R34
/// Hold    system fault protection can hold EDL until the end of pre-EDL, not afterwards. R24
class EdlMain {
  public:
    explicit EdlMain(const Load& load);

    void on(const Tick& tick, Outbox& out);

    void on(const ImuReadings& readings, Outbox& out);
    void on(const EngineReply& reply, Outbox& out);
    void on(const BridleReply& reply, Outbox& out);
    void on(const CruiseAttitude& attitude, Outbox& out);
    void on(const gnc::RadarSolution& solution, Outbox& out);
    void on(const ActionReply& reply, Outbox& out);
    void on(const InhibitEdl& wish, Outbox& out);
    void on(const UnitsSelected& selected, Outbox& out);

    void on(const ParametersUpdate& update, Outbox& out);
    void on(const StageParameterCommand& command, Outbox& out);
    void on(const ActivateParametersCommand& command, Outbox& out);
    void on(const DiscardParametersCommand& command, Outbox& out);
    void on(const DumpParametersCommand& command, Outbox& out);
    void on(const DoEdlCommand& command, Outbox& out);
    void on(const SetTimepointOffsetCommand& command, Outbox& out);
    void on(const SetAnchorOffsetCommand& command, Outbox& out);
    void on(const SelectPrimeCommand& command, Outbox& out);
    void on(const ResumePrimeCommand& command, Outbox& out);

    void on(const StatePart& part, Outbox& out);
    void on(const Resume& resume, Outbox& out);

    /// For the test venue "all but GNC": in the next cycle, `told` replaces EdlGnc's output. R36
    void replace_gnc(const gnc::Output& told) { instead_of_gnc_ = told; }
    const gnc::Configuration& configuration() const { return configuration_; }

    void shift_navigation(const NavigationShift& by) { gnc_.shift_navigation(by); }

    /// From here on tells the other computer no state: nobody listens. For simulations of many cases.
    void tell_no_state() { tells_state_ = false; }

    /// Whether this computer leaves the landing to the other one.
    bool stands_by() const { return activity_ != Activity::flies; }

    /// State for another computer. Left out: a present fault, which is reported again, and the monitor.
    template <typename Exchange>
    void carry(Exchange& exchange) {
        exchange(parameters_, table_, timeline_, change_guard_, configuration_, unverified_, gnc_, peak_deceleration_,
                 gnc_health_, mode_, phase_, bridle_m_, was_pre_edl_, was_late_cruise_);
    }

    const Timeline& timeline() const { return timeline_; }
    const ParameterTable& parameter_table() const { return table_; }
    EdlPhase phase() const { return phase_.state(); }

  private:
    enum class Activity : std::uint8_t { flies, tracks, stands_by };

    void tell_state(Sclk now, Outbox& out);
    void restart(Sclk now, Outbox& out);
    void stand_by(bool is, Outbox& out);
    void explain_stand_by(Sclk told, Outbox& out) const;
    void tell_phase(Outbox& out) const;
    void take_over(const StateHeader& prime, Sclk now, Outbox& out);
    void go_on(Outbox& out);
    void watch_approach(Sclk now, Outbox& out);
    void set_inhibited(bool inhibited, Outbox& out);
    /// The reason why entry cannot be set to `said`. `navigated`: the time of entry by navigation.
    std::optional<timeline::Unsafe> unsafe_entry(Sclk said, MaybeTime navigated, Sclk now);
    static void refuse(const timeline::Unsafe& unsafe, const CommandTag& tag, Outbox& out);
    void run_timeline(Sclk now, Outbox& out);
    void run_gnc(Sclk now, Outbox& out);
    void take_triggers(Sclk now, Outbox& out);
    void update_phase(Sclk now, Outbox& out);
    void record_channels(Sclk now, Outbox& out);
    packet::ParametersHeld parameters_held() const;
    /// Whether ground may still change the table of parameters. If not, the command is refused here.
    bool may_change_table(const CommandTag& tag, Outbox& out) const;
    void table_changed(Outbox& out);
    void fly_by_table(Outbox& out);
    /// Reports, once GNC is enabled, the staged changes that can no longer be activated.
    void tell_not_activated(Outbox& out) const;
    std::uint8_t reset_count() const {
        return static_cast<std::uint8_t>(
            std::min<std::uint32_t>(load_.resets, std::numeric_limits<std::uint8_t>::max()));
    }
    MaybeTime entry() const { return timeline_.anchor_time(anchor::entry); }
    bool late_cruise(Sclk now) const;
    bool pre_edl(Sclk now) const;
    bool separated(Sclk now) const;
    bool too_late(Sclk now) const;

    Load load_;
    Activity activity_;
    Timeline timeline_;
    ConstraintMonitor constraint_monitor_{constraint_specs};
    UnverifiedActions unverified_;
    ChangeGuard change_guard_{constraint_specs};
    gnc::EdlGnc gnc_;
    gnc::Configuration configuration_;
    gnc::Output output_;
    std::optional<gnc::Output> instead_of_gnc_;
    DeviceInputs gnc_inputs_;  // inputs from the device managers for this cycle
    StateAssembly assembly_;
    std::optional<StateFrame> state_of_another_;
    std::uint32_t revision_ = 0;
    FixedQueue<ImuReadings, 64> recent_readings_;  // of the last second, for what prime's last state does not cover
    double bridle_m_ = 0.0;
    EngineReply engines_;  // the last one
    packet::GncConfiguration recorded_configuration_;
    std::optional<command::EDL_SET_PARAMETERS> parameters_;
    ParameterTable table_;
    PeakDeceleration peak_deceleration_;
    GncHealth gnc_health_;
    HeldExplanations held_;
    gnc::Mode mode_ = gnc::Mode::off;
    Phase phase_;
    UnitSelection units_;  // kept only for a computer that takes over
    std::uint32_t cycle_count_ = 0;
    bool inhibited_ = false;
    bool tells_state_ = true;
    bool designation_pending_ = false;  // both computers are about to restart: nothing begins before that
    bool refused_to_hold_ = false;      // reported once per fault, not once per report
    // Values of the previous cycle: the ends of these phases are events.
    bool was_pre_edl_ = true;
    bool was_late_cruise_ = false;
};

}  // namespace aeolis::flight
