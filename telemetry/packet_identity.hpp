// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/ids.hpp"

#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

namespace aeolis::telemetry {

/// The identity of a packet in its run. The 14-bit count wraps; with SCLK it does not repeat.
struct PacketIdentity {
    Apid apid;
    std::uint64_t sclk_65536 = 0;  ///< SCLK in its own unit, 1/65536 s: all 48 bits
    std::uint16_t count = 0;
    std::uint16_t crc = 0;
    constexpr auto operator<=>(const PacketIdentity&) const = default;
};

/// Identifies a telemetry packet that has been decoded, so that its length and CRC are right.
PacketIdentity identity_of(std::span<const std::uint8_t> packet);

enum class Path : std::uint8_t { realtime, recorded };

/// A packet's relation to the earlier packets of its run.
enum class Standing : std::uint8_t {
    first,        ///< not seen before
    again,        ///< equal octets on the same path before
    duplicate,    ///< equal octets on the other path only: real time is confirmed by the recording, or the reverse
    differs,      ///< same APID, SCLK and count as an earlier one, other octets
    unregistered  ///< the register is full: unknown
};
const char* name_of(Standing standing);

/// Every packet of one run, by identity, with the paths on which it was received.
///
/// In       packets of one run, in any order                 Out   each packet's relation to the others
/// Memory   about 64 octets a packet (a nominal landing: some 100 000 packets, 6 MB), at most `packets_max`, the rest
///          unregistered; made for one run and dropped with it
/// Octets are compared by length, CRC-16 and a 64-bit digest: two different packets pass as equal once in 2^64 random
/// cases
class PacketRegister {
  public:
    static constexpr std::size_t packets_max_default = 1'000'000;  ///< chosen: ten landings' packets, 64 MB

    explicit PacketRegister(std::size_t packets_max = packets_max_default) : packets_max_(packets_max) {}

    Standing add(std::span<const std::uint8_t> packet, Path path);

    struct Counts {
        std::uint64_t realtime = 0;  ///< distinct packets received in real time
        std::uint64_t recorded = 0;  ///< distinct packets of the recording
        std::uint64_t both = 0;      ///< on both paths, octets equal or not
        std::uint64_t differs = 0;   ///< of `both`: different octets
        std::uint64_t again = 0;     ///< repeats on the same path
        std::uint64_t unregistered = 0;
    };
    const Counts& counts() const { return counts_; }

    /// The first few packets whose octets differ, for the message to the controller.
    static constexpr std::size_t differing_max = 16;
    const std::vector<PacketIdentity>& differing() const { return differing_; }

  private:
    struct Key {
        std::uint64_t sclk_65536 = 0;
        std::uint16_t apid = 0;
        std::uint16_t count = 0;
        bool operator==(const Key&) const = default;
    };
    struct KeyHash {
        std::size_t operator()(const Key& key) const noexcept;
    };
    struct Seen {
        std::uint64_t digest = 0;
        bool realtime = false, recorded = false, differs = false;
    };

    std::size_t packets_max_;
    std::unordered_map<Key, Seen, KeyHash> seen_;
    Counts counts_;
    std::vector<PacketIdentity> differing_;
};

}  // namespace aeolis::telemetry
