#pragma once

#include "flight/edl/decisions.hpp"
#include "flight/edl/phase.hpp"
#include "flight/gnc/edl_gnc.hpp"
#include "flight/kernel/outbox.hpp"
#include "flight/timeline/timeline.hpp"

#include <optional>

namespace aeolis::flight {

/// EdlMain: the one thread of EDL. Each 64 Hz cycle it runs the timeline, GNC exactly once, and the timeline again, so
/// that what GNC decides happens in the same cycle. R15, R17, R18, R47
///
/// In      Tick; ImuReadings, EngineReply, BridleReply, CruiseAttitude, RadarSolution; ActionReply;
///         ParametersUpdate, DoEdlCommand, SetTimepointOffsetCommand, SetAnchorOffsetCommand; InhibitEdl
/// Out     actions to the managers of devices; tones; events, firings, explanations and channels to EdlComm; Confirm
/// Gate    nothing runs before parameters came and then "do edl", in late cruise, and not too late for it. R23
///         Before the end of pre-EDL system fault protection can hold all of it, afterwards it cannot. R24
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

    void on(const ParametersUpdate& update, Outbox& out);
    void on(const DoEdlCommand& command, Outbox& out);
    void on(const SetTimepointOffsetCommand& command, Outbox& out);
    void on(const SetAnchorOffsetCommand& command, Outbox& out);

    const Timeline& timeline() const { return timeline_; }
    EdlPhase phase() const { return phase_; }

  private:
    void watch_approach(Sclk now, Outbox& out);
    void set_inhibited(bool inhibited, Outbox& out);
    void run_timeline(Sclk now, Outbox& out);
    void run_gnc(Sclk now, Outbox& out);
    void take_triggers(Sclk now, Outbox& out);
    void update_phase(Sclk now, Outbox& out);
    void record_channels(Sclk now, Outbox& out);
    packet::ParametersHeld parameters_held() const;
    MaybeTime entry() const { return timeline_.anchor_time(anchor::entry); }
    bool late_cruise(Sclk now) const;
    bool pre_edl(Sclk now) const;
    bool too_late(Sclk now) const;

    Plan plan_;
    Timeline timeline_;
    gnc::EdlGnc gnc_;
    gnc::Configuration configuration_;
    gnc::Output output_;
    DeviceInputs gnc_inputs_;  // what the device managers sent for this cycle
    double bridle_m_ = 0.0;
    std::optional<command::EDL_SET_PARAMETERS> parameters_;
    PeakDeceleration peak_deceleration_;
    HeldExplanations held_;
    gnc::Mode mode_ = gnc::Mode::off;
    EdlPhase phase_ = EdlPhase::pre_edl;
    std::uint32_t cycle_count_ = 0;
    bool inhibited_ = false;
    bool refused_to_hold_ = false;  // told once a fault, not once a report
    // As of the cycle before: their ends are events.
    bool was_pre_edl_ = true;
    bool was_late_cruise_ = false;
};

}  // namespace aeolis::flight
