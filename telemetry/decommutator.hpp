// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/space_packet.hpp"
#include "dictionaries/decoded.hpp"
#include "dictionaries/dictionary.hpp"
#include "telemetry/container_plan.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
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

/// Decodes packets of our own mission into calibrated values: checks what they carry beyond their containers (CRC, id
/// of the dictionary, whole length) and has them decoded by the plan that is compiled for every mission.
///
/// In       the octets of one space packet, any octets          Out   Decoded, or the reason for refusal
/// Values   enumerated: the raw number; boolean: 0 or 1; a float that is not finite is undefined
/// Rate     over a million packets a second on one core (bench/decommutate_bench.cpp)
/// Memory   the plan's; decode() allocates nothing once `into` has held the largest packet
/// Faults   none: reads nothing outside the octets, whatever they are. Many threads may share one.
class Decommutator {
  public:
    /// `dictionary` must have passed the loader's rules. It need not outlive this.
    explicit Decommutator(const dictionary::Dictionary& dictionary);

    /// Decodes a packet. Returns none on success; after a refusal `into` is unspecified.
    std::optional<Refusal> decode(std::span<const std::uint8_t> packet, Decoded& into) const;

  private:
    /// What a container is of Dictionary::packets.
    struct Described {
        std::size_t packet = no_packet;
        std::size_t octets = 0;
    };
    static constexpr std::size_t no_packet = static_cast<std::size_t>(-1);

    std::uint16_t dictionary_id_ = 0;
    std::shared_ptr<const dictionary::xtce::PacketModel> model_;  ///< the plan refers to it
    std::vector<Described> described_;                            ///< by container
    std::vector<Apid> event_apids_;
    std::optional<ContainerPlan> plan_;  ///< none: there are no packets
};

using dictionary::field_index;

}  // namespace aeolis::telemetry
