// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/fixed_queue.hpp"
#include "flight/commands/command_dispatcher.hpp"
#include "flight/cross_string/cross_string.hpp"
#include "flight/devices/cruise_attitude.hpp"
#include "flight/devices/descent_engines.hpp"
#include "flight/devices/imu.hpp"
#include "flight/devices/power.hpp"
#include "flight/devices/pyro.hpp"
#include "flight/devices/radar.hpp"
#include "flight/devices/telecom.hpp"
#include "flight/devices/thrusters.hpp"
#include "flight/devices/unit_selector.hpp"
#include "flight/edl/edl_main.hpp"
#include "flight/edl_bg/edl_bg.hpp"
#include "flight/edl_comm/edl_comm.hpp"
#include "flight/fault_protection/system_fault_protection.hpp"
#include "flight/kernel/loads.hpp"
#include "flight/kernel/sync.hpp"
#include "flight/load.hpp"
#include "flight/mfsk/tone_selector.hpp"

#include <array>
#include <type_traits>

namespace aeolis::flight {

inline constexpr std::size_t mailbox_messages_max = 64;  ///< chosen: twice a burst of IMU, radar and replies

/// The whole state of a flight computer: modules, mailboxes, and messages held for the next cycle.
struct ComputerState {
    ComputerState(const Load& its_load, Sclk start)
        : load(its_load), now(start), sync(load), radar(load), imu(load), edl(load), pyro(load), descent_engines(load),
          thrusters(load), power(load), telecom(load), units(load), cruise_attitude(load),
          system_fault_protection(load), cross_string(load), command_dispatcher(load), edl_bg(load), mfsk(load),
          edl_comm(load) {}

    Load load;
    Sclk now;

    Sync sync;
    RadarManager radar;
    ImuManager imu;
    EdlMain edl;
    PyroManager pyro;
    DescentEngines descent_engines;
    Thrusters thrusters;
    PowerManager power;
    TelecomManager telecom;
    UnitSelector units;
    CruiseAttitudeControl cruise_attitude;
    SystemFaultProtection system_fault_protection;
    CrossString cross_string;
    CommandDispatcher command_dispatcher;
    EdlBg edl_bg;
    ToneSelector mfsk;
    EdlComm edl_comm;

    std::array<FixedQueue<Message, mailbox_messages_max>, module_count> mailboxes;
    std::uint32_t ready = 0;  // a bit for each module that has work
    // Messages from modules outside the rate group, for the start of the next cycle under every executive.
    static constexpr std::size_t next_cycle_messages_max = 128;  ///< chosen
    FixedVector<Envelope, next_cycle_messages_max> next_cycle;
    Outbox outbox;

    std::uint32_t mailbox_overflows = 0;
    std::uint32_t unexpected_messages = 0;
    std::optional<Sclk> runs_from;  // set while it restarts after a reset
    std::optional<Sclk> ran_from;   // start of the software after the last reset
    bool forgets = false;           // starts without stored state: with it, the last start failed at once
};
static_assert(std::is_copy_constructible_v<ComputerState> && std::is_trivially_destructible_v<ComputerState>,
              "copying a computer is a snapshot");

}  // namespace aeolis::flight
