// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulation/links/transmitter.hpp"
#include "simulation/scenario.hpp"

#include <cstdint>
#include <span>

namespace aeolis::simulation {

/// The vehicle's UHF link during landing: octets leave its transmitter at the link's rate.
///
/// Octets sent in plasma, or while the antenna is switched, are lost. The link knows neither frames nor receivers
/// (orbiter_pass.hpp).
///
/// Memory   the transmitter's; what finds no room is counted
/// Plasma   from below the scenario's altitude or speed of its start, whichever comes first after entry, to its end
///          speed
/// Left out: antenna patterns
class UhfLink {
  public:
    /// The vehicle's state in a cycle that the link depends on.
    struct Surroundings {
        double e_s = 0.0;
        double altitude_m = 0.0;
        double speed_mps = 0.0;
        bool transmitter_on = false;     ///< and an antenna selected
        bool parachute_antenna = false;  ///< false: the entry antenna
    };

    explicit UhfLink(const Radio& radio) : radio_(radio), transmitter_(radio.uhf_rate_bps) {}

    /// Gives octets to the transmitter at the start of a cycle.
    void offer(std::span<const std::uint8_t> octets) { lost_octets_ += transmitter_.offer(octets); }

    /// Runs one cycle of 1/64 s; returns the octets that can be heard, valid until the next call.
    std::span<const std::uint8_t> cycle(const Surroundings& at);

    bool up() const { return up_; }
    const char* reason() const { return reason_; }              ///< static text
    std::uint64_t lost_octets() const { return lost_octets_; }  ///< for lack of room, or while the link was down

  private:
    const char* why_down(const Surroundings& at);

    Radio radio_;
    Transmitter transmitter_;
    double hand_over_left_s_ = 0.0;
    bool parachute_antenna_ = false;
    bool blackout_over_ = false;
    bool up_ = false;
    const char* reason_ = "not switched on";
    std::uint64_t lost_octets_ = 0;
};

}  // namespace aeolis::simulation
