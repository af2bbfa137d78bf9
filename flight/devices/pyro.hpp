// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "flight/kernel/outbox.hpp"
#include "flight/load.hpp"

namespace aeolis::flight {

/// Manager of the pyro controllers, on the 64 Hz bus.
/// In the rate group: it confirms every tick, idle or not. R5, R10, R22, R50
///
/// In       ArmPyros, FirePyro, PyroReply (interrupt), Tick, UnitsSelected
/// Out      pyros to fire, at its tick; ActionReply to Edl; PyroStatus on change, and at 1 Hz while armed; Confirm
/// Armed    starts safe, and fires nothing until ArmPyros arms it
/// Fires    each pyro over both controllers in one cycle, the selected one first. Until a controller reports that the
///          pyro fired, both are commanded again every 1/8 s, while a reply can still arrive before the time-out
/// Answers  verified when one controller fired; refused when both did not; none when commanded again
/// Faults   a pyro commanded while safe is reported (PYRO_NOT_ARMED) and refused. A controller that refuses or is
///          silent is reported once (PYRO_CONTROLLER_REFUSED, PYRO_CONTROLLER_SILENT) and costs nothing if the other
///          fires. A reply that was not due, or one more than commands, is reported (REPLY_UNEXPECTED) and not
///          forwarded
class PyroManager {
  public:
    /// Chosen: longer than the 6 cycles that a reply takes: two on the bus, two in the controller, two of jitter.
    static constexpr double retry_s = 0.125;

    explicit PyroManager(const Load&) {}

    void on(const ArmPyros& command, Outbox& out);
    void on(const FirePyro& command, Outbox& out);
    void on(const PyroReply& reply, Outbox& out);
    void on(const UnitsSelected& selected, Outbox& out);
    void on(const Tick& tick, Outbox& out);

  private:
    /// Commands to one controller for a pyro that await a reply, and its last reply.
    struct Controller {
        std::uint8_t replies_due = 0;
        bool refuses = false;
        bool refusal_told = false;
    };
    struct Shot {
        bool wanted = false;  // not over yet
        bool fired = false;
        Sclk until;
        MaybeTime next_try;  // undefined: at once
        std::array<Controller, 2> controllers{};
    };
    void fire(PyroId pyro, Shot& shot, Outbox& out);
    static void end(PyroId pyro, Shot& shot, Outbox& out);
    PyroState state(PyroId pyro) const;
    void record(Sclk now, Outbox& out);

    packet::PyroStatus recorded_;
    bool armed_ = false;
    std::array<Shot, pyro_count> shots_{};
    Unit unit_ = Unit::a;  // the selected one
};

}  // namespace aeolis::flight
