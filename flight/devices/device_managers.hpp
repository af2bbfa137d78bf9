#pragma once

#include "flight/kernel/outbox.hpp"
#include "flight/load.hpp"

// The managers of the devices: each is the only one that commands its device, turns its interrupts into messages and
// its replies into answers for the timeline. Those in the rate group confirm every tick, idle or not. R5, R10, R22
namespace aeolis::flight {

/// Landing radar. In: RadarReturns (interrupt), Tick. Out: RadarReturns to EdlBg once a cycle when there are any.
class RadarManager {
  public:
    explicit RadarManager(const Load&) {}

    void on(const RadarReturns& returns, Outbox& out);
    void on(const Tick& tick, Outbox& out);

  private:
    RadarReturns latest_;
};

/// IMU. In: ImuReadings at 200 Hz (3 or 4 a cycle), Tick. Out: ImuReadings to Edl before its turn, and to EdlComm.
class ImuManager {
  public:
    explicit ImuManager(const Load&) {}

    void on(const ImuReadings& readings, Outbox& out);
    void on(const Tick& tick, Outbox& out);

  private:
    ImuReadings latest_;
};

/// Pyros. In: FirePyro, PyroReply, Tick. Out: fires at its tick; ActionReply to Edl.
class PyroManager {
  public:
    explicit PyroManager(const Load&) {}

    void on(const FirePyro& command, Outbox& out);
    void on(const PyroReply& reply, Outbox& out);
    void on(const Tick& tick, Outbox& out);

  private:
    FixedVector<PyroId, 8> due_;
};

/// Descent engines and the bridle's brake. In: RunEngines, PayOutBridle, EngineReply, BridleReply, Tick.
/// Out: engine commands at its tick; EngineReply and BridleReply on to Edl; ActionReply when running, when payed out.
class DescentEngines {
  public:
    explicit DescentEngines(const Load&) {}

    void on(const RunEngines& command, Outbox& out);
    void on(const PayOutBridle& command, Outbox& out);
    void on(const EngineReply& reply, Outbox& out);
    void on(const BridleReply& reply, Outbox& out);
    void on(const Tick& tick, Outbox& out);

  private:
    EngineCommand command_;
    bool pay_out_ = false;
    bool running_ = false;
    bool payed_out_ = false;
};

/// Thrusters. In: PointVehicle, EnableThrusters, ThrusterReply, Tick. Out: attitude command at its tick; ActionReply.
class Thrusters {
  public:
    explicit Thrusters(const Load&) {}

    void on(const PointVehicle& command, Outbox& out);
    void on(const EnableThrusters& command, Outbox& out);
    void on(const ThrusterReply& reply, Outbox& out);
    void on(const Tick& tick, Outbox& out);

  private:
    AttitudeCommand attitude_;
};

/// Power switches and telecom settings; outside the rate group. In: SetSwitch, SwitchReply. Out: ActionReply. R28
class PowerManager {
  public:
    explicit PowerManager(const Load&) {}

    void on(const SetSwitch& command, Outbox& out);
    void on(const SwitchReply& reply, Outbox& out);
};

}  // namespace aeolis::flight
