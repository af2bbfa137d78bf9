// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/space_packet.hpp"
#include "dictionaries/decoded.hpp"
#include "dictionaries/dictionary.hpp"

#include <compare>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace aeolis::telemetry {

/// Reasons for not decoding a packet.
enum class Refusal {
    not_a_packet,  ///< no primary header of our format, a telecommand, or a length that disagrees with the octets
    bad_crc,
    other_dictionary,  ///< made with another version of the dictionary: its fields may have other meanings
    unknown_apid,
    unknown_event,  ///< an event packet whose event id the dictionary lacks
    wrong_length,   ///< the packet is longer or shorter than its container
};
inline constexpr std::size_t refusal_count = 6;
const char* name_of(Refusal refusal);

using dictionary::Decoded;

/// Decodes packets into calibrated values by a flat plan, compiled once from the dictionary's containers.
///
/// In       the octets of one space packet, any octets          Out   Decoded, or the reason for refusal
/// Values   enumerated: the raw number; boolean: 0 or 1; a float that is not finite is undefined
/// Rate     over a million packets a second on one core (bench/decommutate_bench.cpp)
/// Memory   a plan of some 32 octets a field; decode() allocates nothing once `into` has held the largest packet
/// Faults   none: reads nothing outside the octets, whatever they are. Many threads may share one.
class Decommutator {
  public:
    /// `dictionary` must have passed the loader's rules. Its plan is copied, so it need not outlive this.
    explicit Decommutator(const dictionary::Dictionary& dictionary);

    /// Decodes a packet. Returns none on success; after a refusal `into` is unspecified.
    std::optional<Refusal> decode(std::span<const std::uint8_t> packet, Decoded& into) const;

  private:
    enum class Form : std::uint8_t { unsigned_integer, signed_integer, float32, float64 };
    struct Step {
        std::uint32_t position_bits = 0;
        std::uint32_t validity_bit = 0;  ///< no_validity_bit: always defined
        std::uint32_t first_coefficient = 0;
        std::uint16_t coefficients = 0;  ///< 0: calibrated is raw
        std::uint8_t bits = 0;
        Form form{};
    };
    struct Plan {
        std::uint32_t first_step = 0;
        std::uint32_t steps = 0;
        std::uint32_t octets = 0;
    };
    struct EventPlan {
        std::uint16_t apid = 0;
        std::uint16_t event = 0;
        std::uint32_t packet = 0;
        auto operator<=>(const EventPlan&) const = default;
    };
    static constexpr std::uint32_t no_validity_bit = 0xFFFFFFFF;
    static constexpr std::uint16_t no_packet = 0xFFFF;

    Step compile(const dictionary::Field& field, const dictionary::Packet& packet);
    std::optional<std::size_t> event_packet(Apid apid, std::span<const std::uint8_t> packet) const;
    std::optional<double> calibrated(const Step& step, std::uint64_t raw) const;

    std::uint16_t dictionary_id_ = 0;
    std::vector<Plan> plans_;  ///< by index in Dictionary::packets
    std::vector<Step> steps_;
    std::vector<double> coefficients_;
    std::vector<std::uint16_t> by_apid_;  ///< 2048: index of the packet, or no_packet
    std::vector<bool> holds_events_;      ///< 2048
    std::vector<EventPlan> events_;       ///< sorted by APID, then event id
};

using dictionary::field_index;

}  // namespace aeolis::telemetry
