// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"
#include "dictionaries/dictionary.hpp"
#include "telemetry/decoded_packet.hpp"
#include "telemetry/station/received.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace aeolis::server::shadow {

/// Where the vehicle believes to be, as it told in a packet of its navigation.
struct NavigatedState {
    Sclk sclk;  ///< of the cycle
    std::array<double, 3> p_MoB_M_m{};
    std::array<double, 3> v_MB_M_mps{};
    std::array<double, 4> q_MB{1, 0, 0, 0};
};

/// Where the timeline stood, as the vehicle told in its status.
struct TimelineStand {
    Sclk sclk;
    std::uint16_t timepoint = 0;  ///< its row; beyond the timeline: none
};

/// What ground has heard of a flight's course, from nothing but what the station received.
///
/// In       each cycle's Received, or packets
/// Out      navigated states, the newest always; where the timeline stood; what fired; what warnings the vehicle told
/// Memory   a state each ten seconds, each status of the timeline, each firing, each warning
class HeardFlight {
  public:
    static constexpr double states_apart_s = 10.0;  ///< chosen: the work of moving a flight, against what it departs by

    /// The dictionary must outlive this.
    explicit HeardFlight(const dictionary::Dictionary& dictionary);

    void hear(const telemetry::Received& received);
    void hear(std::span<const std::uint8_t> packet);
    void hear(const telemetry::DecodedPacket& decoded);

    const std::optional<NavigatedState>& newest() const { return newest_; }
    /// By time: at least `states_apart_s` apart, but for the last, which is the newest.
    std::vector<NavigatedState> states() const;
    /// By time. What came late is left out.
    const std::vector<TimelineStand>& stands() const { return stands_; }
    /// The newest by then.
    std::optional<TimelineStand> stand_by(Sclk sclk) const;

    /// A timepoint that was told to have fired, in the order of arrival; it may be told twice, live and recorded.
    struct Fired {
        std::size_t row = 0;
        Sclk sclk;
    };
    const std::vector<Fired>& fired() const { return fired_; }

    struct Warning {
        std::string name;  ///< of the event
        Sclk sclk;
    };
    /// Events of a warning's level and above, in the order of their arrival.
    const std::vector<Warning>& warnings() const { return warnings_; }
    /// Whether the radar had locked by then: from there on the height above ground is measured.
    bool radar_locked_by(Sclk sclk) const;

  private:
    struct Fields {  ///< of a packet, by the names of its channels
        std::size_t packet = 0;
        std::vector<std::size_t> at;
    };
    static std::optional<Fields> fields_of(const dictionary::Dictionary& dictionary, const std::string& packet,
                                           const std::vector<std::string>& names);
    void take_state(const telemetry::Decoded& content);

    telemetry::PacketDecoder decoder_;
    std::optional<Fields> navigation_, timeline_, firing_;
    std::vector<NavigatedState> states_;
    std::optional<NavigatedState> newest_;
    std::vector<TimelineStand> stands_;
    std::vector<Fired> fired_;
    std::vector<Warning> warnings_;
    std::optional<Sclk> locked_;  ///< when the radar first had
};

}  // namespace aeolis::server::shadow
