// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/fixed_vector.hpp"
#include "flight/cross_string/state_exchange.hpp"
#include "flight/devices/device_messages.hpp"
#include "flight/kernel/state_parts.hpp"

// A computer's EDL state as it crosses to the other computer, and as it is kept over a restart.
//
//   dictionary id 2 | size of all 2 | header | state | checksum 8
namespace aeolis::flight {

/// What others must know of a state without reading it.
struct StateHeader {
    Sclk time;
    std::uint32_t revision = 0;  ///< grows with what a restart must not forget: parameters, "do edl", timepoints
    bool begun = false;          ///< "do edl" was accepted
    bool pre_edl = true;
    bool touchdown = false;
    UnitSelection units{};  ///< that are addressed

    template <typename Exchange>
    void carry(Exchange& exchange) {
        exchange(time, revision, begun, pre_edl, touchdown, units);
    }
};

/// Whole frames only: made by this build of the flight software, of the right size, not one bit changed.
class StateFrame {
  public:
    std::span<const std::uint8_t> octets() const { return octets_.span(); }
    bool empty() const { return octets_.empty(); }

    /// The state that `carry` says, framed.
    template <typename State>
    static StateFrame of(StateHeader header, State& state) {
        std::array<std::uint8_t, state_octets_max> room{};
        StateExchange exchange{std::span{room}.subspan(prefix_octets, room.size() - prefix_octets - checksum_octets)};
        exchange(header, state);
        AEOLIS_CHECK(exchange.ok());
        StateFrame frame;
        frame.seal(room, prefix_octets + exchange.size());
        return frame;
    }

    /// None when the octets are no whole frame of ours.
    static std::optional<StateFrame> read(std::span<const std::uint8_t> octets);

    StateHeader header() const { return header_of(octets()); }
    /// Of octets that are a frame, or may be.
    static StateHeader header_of(std::span<const std::uint8_t> octets);

    /// False when the state does not fill the frame: then nothing may be believed.
    template <typename State>
    [[nodiscard]] bool restore(State& state) const {
        StateHeader header;
        StateExchange exchange{content()};
        exchange(header, state);
        return exchange.ok() && exchange.size() == content().size();
    }

    /// In pieces that fit a message, in order.
    template <typename Send>
    void in_parts(Send&& send) const {
        state_parts(octets(), header().time, send);
    }

  private:
    static constexpr std::size_t prefix_octets = 4;
    static constexpr std::size_t checksum_octets = 8;

    void seal(std::span<std::uint8_t> room, std::size_t checksum_at);
    std::span<const std::uint8_t> content() const {
        return octets().subspan(prefix_octets, octets_.size() - prefix_octets - checksum_octets);
    }

    FixedVector<std::uint8_t, state_octets_max> octets_;
};

/// Puts pieces together again. One that is out of order drops what came before it.
class StateAssembly {
  public:
    /// The frame that this piece completes, if it does.
    std::optional<StateFrame> on(const StatePart& part);

    /// The same for who only passes it on: true when this piece is the last, octets() then being all, unread.
    bool take(const StatePart& part);
    std::span<const std::uint8_t> octets() const { return octets_.span(); }

  private:
    FixedVector<std::uint8_t, state_octets_max> octets_;
    std::uint8_t next_ = 0;
    Sclk time_;
};

}  // namespace aeolis::flight
