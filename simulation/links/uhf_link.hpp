#pragma once

#include "simulation/random.hpp"
#include "simulation/scenario.hpp"

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

namespace aeolis::simulation {

/// The real-time UHF link: packets leave the transmitter one after another at the link's rate. Whatever is on the air
/// while the link is down is lost; outside that, packets are lost at random at the scenario's fraction.
///
/// Memory   ours: the transmitter holds 64 KiB that wait; a packet that finds no room is lost, and counted
/// Plasma   from below the scenario's altitude or speed of its start, whichever comes first after entry, to its end
/// speed Left out: antenna patterns, orbiter geometry, hand-overs between orbiters, Doppler. (Issue D)
class UhfLink {
  public:
    /// What the link sees of the vehicle in a cycle.
    struct Surroundings {
        double e_s = 0.0;
        double altitude_m = 0.0;
        double speed_mps = 0.0;
        bool transmitter_on = false; ///< and an antenna selected
    };
    struct Delivered {
        std::int64_t left_us = 0; ///< when its last bit left, from the start of the cycle
        std::vector<std::uint8_t> octets;
    };

    UhfLink(const Radio& radio, Random random) : radio_(radio), random_(random) {}

    /// Packets given to the transmitter at the start of a cycle.
    void offer(std::span<const std::uint8_t> packets);

    /// One cycle of 1/64 s; what left it whole is added to `delivered`.
    void cycle(const Surroundings& at, std::vector<Delivered>& delivered);

    bool up() const { return up_; }
    const char* reason() const { return reason_; } ///< static text
    bool idle() const { return waiting_.empty(); }
    std::uint64_t lost_packets() const { return lost_packets_; }

  private:
    const char* why_down(const Surroundings& at);

    Radio radio_;
    Random random_;
    std::deque<std::vector<std::uint8_t>> waiting_;
    std::size_t waiting_octets_ = 0;
    double sent_bits_of_first_ = 0.0;
    bool first_spoilt_ = false;
    bool blackout_over_ = false;
    bool up_ = false;
    const char* reason_ = "not switched on";
    std::uint64_t lost_packets_ = 0;
};

} // namespace aeolis::simulation
