// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace aeolis::telemetry {

/// Watches the clocks of another mission's packets, and finds a time for packets that hold none.
///
/// In       packets in the order of reception: which, its own time if it has one, and when it was received
/// Out      the time at which its samples stand, and a remark when a clock did what clocks do not do
/// Place    a packet without a time stands at its reception: on the axis of the first packet type that had a time, as
///          long after that type's newest packet as it was received after it; before any packet had a time, at the
///          seconds of ERT
/// Remarks  first packet of a type without a time; a clock that went back (said once the packet after it confirms it: a
///          single late packet is no restart), jumped ahead or stands still. At most `remarks_max` of each type
/// Memory   some 100 octets a packet type
class PacketClocks {
  public:
    static constexpr std::size_t remarks_max = 10;              ///< chosen
    static constexpr double jump_steps = 100.0;                 ///< chosen: as many times the largest step before
    static constexpr double jump_least_s = 60.0;                ///< chosen
    static constexpr std::uint32_t steps_known = 8;             ///< chosen: steps seen before a jump can be recognised
    static constexpr std::uint32_t still_packets = 64;          ///< chosen: packets with one time …
    static constexpr std::int64_t still_least_us = 10'000'000;  ///< … and this long, after the clock had moved

    explicit PacketClocks(std::size_t packet_types) : clocks_(packet_types) {}

    struct Place {
        Sclk sclk;
        bool by_reception = false;
        std::optional<std::string> remark{};
    };
    /// @param packet  index of its type     @param name  of the type, for remarks
    Place place(std::size_t packet, const std::string& name, std::optional<Sclk> own, Ert received);

  private:
    struct Clock {
        std::optional<double> newest_s;
        std::optional<double> fell_from_s;  ///< its last packet was earlier than the one before it, which had this time
        double largest_step_s = 0.0;
        std::uint32_t steps = 0, still = 0;
        Ert still_since;
        bool moved = false, said_untimed = false;
        std::size_t remarks = 0;
    };
    std::optional<std::string> follow(Clock& clock, const std::string& name, double sclk_s, Ert received);

    std::vector<Clock> clocks_;
    std::optional<std::size_t> reference_;  ///< the type whose clock gives a time to packets without one
    double reference_s_ = 0.0;
    Ert reference_ert_;
};

}  // namespace aeolis::telemetry
