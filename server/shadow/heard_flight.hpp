// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"
#include "dictionaries/dictionary.hpp"
#include "telemetry/station/received.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
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

/// What ground has heard of a flight's course, from nothing but what the station received.
///
/// In       each cycle's Received     Out   navigated states, the newest always; what the vehicle has done by its own word
/// Memory   a state each ten seconds; the names of what fired
class HeardFlight {
  public:
    /// The dictionary must outlive this.
    explicit HeardFlight(const dictionary::Dictionary& dictionary);

    void hear(const telemetry::Received& received);
    void hear(std::span<const std::uint8_t> packet);

    /// By time: at least `states_apart_s` apart, but for the last, which is the newest.
    std::vector<NavigatedState> states() const;
    /// Timepoints that had fired by then, as told by then or later.
    std::set<std::string> fired_by(Sclk sclk) const;
    int bank_reversals_by(Sclk sclk) const;
    /// Whether the radar had locked by then: from there on the height above ground is measured.
    bool radar_locked_by(Sclk sclk) const;

    static constexpr double states_apart_s =
        10.0;  ///< chosen: the ground's own flight departs by some metres meanwhile

  private:
    struct Fields {  ///< of a packet, by the names of its channels
        std::size_t packet = 0;
        std::vector<std::size_t> at;
    };
    struct Told {
        std::string name;
        Sclk sclk;
    };
    static std::optional<Fields> fields_of(const dictionary::Dictionary& dictionary, const std::string& packet,
                                           const std::vector<std::string>& names);
    void take(const telemetry::DecodedPacket& decoded);

    const dictionary::Dictionary& dictionary_;
    telemetry::PacketDecoder decoder_;
    std::optional<Fields> navigation_, firing_;
    std::vector<NavigatedState> states_;
    std::optional<NavigatedState> newest_;
    std::vector<Told> fired_, reversals_, locks_;
};

}  // namespace aeolis::server::shadow
