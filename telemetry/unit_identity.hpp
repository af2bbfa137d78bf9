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

/// What names a unit within its run. The 14-bit count wraps; together with SCLK it does not repeat.
struct UnitIdentity {
    Apid apid;
    std::uint64_t sclk_65536 = 0;  ///< SCLK in its own unit, 1/65536 s: 48 bits as they stand
    std::uint16_t count = 0;
    std::uint16_t crc = 0;
    constexpr auto operator<=>(const UnitIdentity&) const = default;
};

/// Of a telemetry packet that has been decoded, i.e. whose length and CRC are right.
UnitIdentity identity_of(std::span<const std::uint8_t> packet);

enum class Path : std::uint8_t { realtime, recorded };

/// How a unit stands to those that came before it in its run.
enum class Standing : std::uint8_t {
    first,      ///< never seen
    again,      ///< the same octets came before on the same path
    duplicate,  ///< the same octets came before, on the other path only: live is found in the recording, or the reverse
    differs,    ///< same APID, SCLK and count as one before, other octets
    unregistered  ///< the register is full: nothing can be said
};
const char* name_of(Standing standing);

/// Every unit of one run, by identity, and by which path its octets have come.
///
/// In       units of one run, in any order                 Out   how each stands to the others
/// Memory   about 64 octets a unit (a nominal landing: some 100 000 units, 6 MB), at most `units_max` of them, then
///          unregistered; made for one run and dropped with it
/// Octets are compared by length, CRC-16 and a 64-bit digest: two units that differ pass for one in 2^64 cases at
/// random
class UnitRegister {
  public:
    static constexpr std::size_t units_max_default = 1'000'000;  ///< ours: ten landings' worth, 64 MB

    explicit UnitRegister(std::size_t units_max = units_max_default) : units_max_(units_max) {}

    Standing add(std::span<const std::uint8_t> packet, Path path);

    struct Counts {
        std::uint64_t realtime = 0;  ///< distinct units seen in real time
        std::uint64_t recorded = 0;  ///< distinct units of the recording
        std::uint64_t both = 0;      ///< on both paths, octets equal or not
        std::uint64_t differs = 0;   ///< of `both`: octets differ
        std::uint64_t again = 0;     ///< repeats on the same path
        std::uint64_t unregistered = 0;
    };
    const Counts& counts() const { return counts_; }

    /// The first few units whose octets differ, for the message to the controller.
    static constexpr std::size_t differing_max = 16;
    const std::vector<UnitIdentity>& differing() const { return differing_; }

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

    std::size_t units_max_;
    std::unordered_map<Key, Seen, KeyHash> seen_;
    Counts counts_;
    std::vector<UnitIdentity> differing_;
};

}  // namespace aeolis::telemetry
