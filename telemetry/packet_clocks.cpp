// SPDX-License-Identifier: Apache-2.0
#include "telemetry/packet_clocks.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

namespace aeolis::telemetry {
namespace {

constexpr double seconds_per_us = 1e-6;

std::string seconds_text(double seconds) {
    std::array<char, 32> text{};
    const auto end = std::to_chars(text.data(), text.data() + text.size(), seconds);
    return {text.data(), end.ptr};
}

}  // namespace

std::optional<std::string> PacketClocks::follow(Clock& clock, const std::string& name, double sclk_s, Ert received) {
    std::optional<std::string> remark;
    if (!clock.newest_s) return remark;
    const double before_s = *clock.newest_s, step_s = sclk_s - before_s;
    const auto went = [&](const char* how, double from_s, double to_s) {
        return "the clock of packet " + name + " " + how + " from " + seconds_text(from_s) + " s to " +
               seconds_text(to_s) + " s";
    };
    if (clock.fell_from_s) {
        const double from_s = *clock.fell_from_s;
        clock.fell_from_s.reset();
        if (sclk_s < from_s) {
            remark = went("went back", from_s, before_s) + ": what follows stands at the new times";
            clock.steps = 0;
            clock.largest_step_s = 0.0;
        }
    }
    if (step_s < 0.0) {
        clock.fell_from_s = before_s;
    } else if (step_s > 0.0) {
        if (clock.steps >= steps_known && step_s > std::max(jump_least_s, jump_steps * clock.largest_step_s))
            remark = went("jumped", before_s, sclk_s);
        clock.largest_step_s = std::max(clock.largest_step_s, step_s);
        ++clock.steps;
    }
    if (step_s != 0.0) {
        clock.moved = true;
        clock.still = 0;
    } else {
        if (clock.still++ == 0) clock.still_since = received;
        if (clock.moved && clock.still >= still_packets &&
            received.microseconds - clock.still_since.microseconds >= still_least_us) {
            remark = "the clock of packet " + name + " stands still at " + seconds_text(sclk_s) + " s";
            clock.moved = false;
        }
    }
    return remark;
}

PacketClocks::Place PacketClocks::place(std::size_t packet, const std::string& name, std::optional<Sclk> own,
                                        Ert received) {
    Clock& clock = clocks_[packet];
    Place place;
    if (own) {
        place.sclk = *own;
        place.remark = follow(clock, name, own->seconds, received);
        clock.newest_s = own->seconds;
        if (!reference_) reference_ = packet;
        if (*reference_ == packet) {
            reference_s_ = own->seconds;
            reference_ert_ = received;
        }
    } else {
        place.by_reception = true;
        const auto since_us = received.microseconds - (reference_ ? reference_ert_.microseconds : 0);
        place.sclk = Sclk{reference_s_ + static_cast<double>(since_us) * seconds_per_us};
        if (!std::exchange(clock.said_untimed, true))
            place.remark = "packet " + name + " holds no time: its samples stand at their reception";
    }
    if (place.remark && clock.remarks++ >= remarks_max) place.remark.reset();
    return place;
}

}  // namespace aeolis::telemetry
