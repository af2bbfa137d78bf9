// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"
#include "flight/devices/device_messages.hpp"
#include "flight/gnc/navigation/strapdown.hpp"
#include "telemetry/decommutator.hpp"

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace aeolis::reconstruction {

/// The state that flight navigated, as of a tick.
struct Navigated {
    Sclk at;
    flight::gnc::NavigatedState state;
};

/// Flight's own estimate of its navigation's error due to silences of the IMU; zero before the first.
struct Believed {
    Sclk at;
    double attitude_rad = 0.0, velocity_mps = 0.0, altitude_m = 0.0;
};

/// Readings of the radar's beams with one tick.
struct BeamsAt {
    Sclk at;
    std::vector<flight::RadarBeam> beams;
};

/// How much was recorded of a packet.
struct Recorded {
    std::uint64_t packets = 0, octets = 0;
    std::map<std::int64_t, std::uint64_t> octets_in;  ///< by whole second of SCLK
};

/// The data of a recording that concern the path: each reading of IMU and radar, the navigated state, ground's
/// solution. R52
///
/// In       packets of one landing, in any order, each any number of times       Out   each reading once, in order
/// Faults   a packet that cannot be decoded is left out and counted
class RecordedLanding {
  public:
    /// Fails when the dictionary lacks a packet or a field that is needed.
    static Result<RecordedLanding> with(const dictionary::Dictionary& dictionary);

    void add(std::span<const std::uint8_t> packet);

    const std::map<std::uint32_t, flight::ImuSample>& imu() const { return imu_; }  ///< by their count
    std::vector<BeamsAt> beams() const;
    std::vector<Navigated> navigated() const;
    /// The first such estimate recorded from `time` on, else the last before it; none: none was recorded.
    std::optional<Believed> believed(Sclk time) const;
    /// When the reading with count 0 ended. A packet's time is the first tick after its last reading. So the earliest
    /// of all packets' times, each less 5 ms a reading, is right to 1/1600 s, the common grid of ticks and readings.
    Sclk imu_began() const { return imu_began_; }
    std::optional<double> target_radius_m() const { return target_radius_m_; }
    std::optional<Sclk> entry() const { return entry_; }  ///< of the last parameters
    /// When each pair of the entry balance masses that went was first reported gone, in order.
    std::vector<Sclk> balance_pairs_gone() const;
    /// When flight first reported an event, by the name of its packet.
    std::optional<Sclk> reported(const std::string& event) const;
    std::uint64_t not_decoded() const { return not_decoded_; }
    /// Packets of each name.
    const std::map<std::string, Recorded>& packets() const { return packets_; }

  private:
    /// Places of the wanted fields in a packet.
    struct Fields {
        std::size_t packet = 0;
        std::vector<std::size_t> places;
    };
    explicit RecordedLanding(const dictionary::Dictionary& dictionary)
        : dictionary_(&dictionary), decommutator_(dictionary) {}

    double value(const Fields& fields, std::size_t which) const {
        return decoded_.value[fields.places[which]].value_or(0.0);
    }
    void add_rows(std::span<const std::uint8_t> packet);
    void add_imu_row(Sclk packet_time);
    void add_beam();
    void add_navigated();
    void add_belief();
    void add_solution();
    void add_balances(Sclk at);

    const dictionary::Dictionary* dictionary_;
    telemetry::Decommutator decommutator_;
    telemetry::Decoded decoded_;
    Fields imu_table_, radar_table_, imu_row_, beam_row_, navigation_, belief_, solution_, pyros_;
    std::map<std::uint32_t, flight::ImuSample> imu_;
    std::map<std::int64_t, std::map<std::uint8_t, flight::RadarBeam>> beams_;  ///< by tick and beam
    std::map<std::int64_t, flight::gnc::NavigatedState> navigated_;            ///< by tick
    std::map<std::int64_t, Believed> beliefs_;                                 ///< by tick
    Sclk imu_began_;
    std::array<std::optional<Sclk>, 3> balances_;
    std::optional<double> target_radius_m_;
    std::optional<Sclk> entry_;
    Sclk solution_at_;
    std::map<std::string, Recorded> packets_;
    std::map<std::string, Sclk> reported_;
    std::uint64_t not_decoded_ = 0;
};

}  // namespace aeolis::reconstruction
