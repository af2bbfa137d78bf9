// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/fixed_vector.hpp"
#include "flight/cross_string/state_exchange.hpp"
#include "flight/devices/device_messages.hpp"
#include "flight/kernel/state_parts.hpp"

// A computer's EDL state, framed for the line to the other computer and for storage over a restart.
//
//   dictionary id 2 | size of the frame 2 | header | state | checksum 8
namespace aeolis::flight {

/// Properties of a state that others use without reading the state itself.
struct StateHeader {
    Sclk time;
    std::uint32_t revision = 0;  ///< changes with everything that must survive a restart: parameters, "do edl",
                                 ///< timepoints
    bool begun = false;          ///< "do edl" was accepted
    bool separated = false;      ///< from the cruise stage: prime no longer starts anew
    bool touchdown = false;
    UnitSelection units{};  ///< units addressed

    template <typename Exchange>
    void carry(Exchange& exchange) {
        exchange(time, revision, begun, separated, touchdown, units);
    }
};

/// A whole frame: from this build of the flight software, of the right size, with a correct checksum.
class StateFrame {
  public:
    std::span<const std::uint8_t> octets() const { return octets_.span(); }
    bool empty() const { return octets_.empty(); }

    /// Frames the state that `state.carry` lists.
    template <typename State>
    static StateFrame of(StateHeader header, State& state) {
        StateFrame frame;
        frame.octets_.resize(state_octets_max);
        StateExchange exchange{
            frame.octets_.span().subspan(prefix_octets, state_octets_max - prefix_octets - checksum_octets)};
        exchange(header, state);
        AEOLIS_CHECK(exchange.ok());
        frame.seal(prefix_octets + exchange.size());
        return frame;
    }

    /// None when the octets are not a whole frame of this build.
    static std::optional<StateFrame> read(std::span<const std::uint8_t> octets);
    /// Replaces this frame by another. False, and it stays as it is, when the octets are not a whole frame of this
    /// build.
    [[nodiscard]] bool replace(std::span<const std::uint8_t> octets);

    StateHeader header() const { return header_of(octets()); }
    /// Reads the header of octets that may or may not be a frame.
    static StateHeader header_of(std::span<const std::uint8_t> octets);

    /// Reads the state. False when it does not fill the frame exactly: then `state` must not be used.
    template <typename State>
    [[nodiscard]] bool restore(State& state) const {
        StateHeader header;
        StateExchange exchange{content()};
        exchange(header, state);
        return exchange.ok() && exchange.size() == content().size();
    }

    /// Sends the frame in parts that fit a message, in order.
    template <typename Send>
    void in_parts(Send&& send) const {
        state_parts(octets(), header().time, send);
    }

  private:
    static constexpr std::size_t prefix_octets = 4;
    static constexpr std::size_t checksum_octets = 8;

    void seal(std::size_t checksum_at);
    std::span<const std::uint8_t> content() const {
        return octets().subspan(prefix_octets, octets_.size() - prefix_octets - checksum_octets);
    }

    FixedVector<std::uint8_t, state_octets_max> octets_;
};

/// Reassembles parts. A part that is out of order discards the parts before it.
class StateAssembly {
  public:
    /// The frame that this part completes, if it does.
    std::optional<StateFrame> on(const StatePart& part);

    /// Takes a part. True when it is the last, and octets() holds the whole frame, unchecked.
    bool take(const StatePart& part);
    std::span<const std::uint8_t> octets() const { return octets_.span(); }

  private:
    FixedVector<std::uint8_t, state_octets_max> octets_;
    std::uint8_t next_ = 0;
    Sclk time_;
};

}  // namespace aeolis::flight
