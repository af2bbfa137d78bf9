// SPDX-License-Identifier: Apache-2.0
#include "telemetry/packet_identity.hpp"

#include "common/bytes.hpp"
#include "common/space_packet.hpp"

namespace aeolis::telemetry {
namespace {

std::uint64_t mixed(std::uint64_t word) {
    // The finaliser of splitmix64. [steele-2014]
    word ^= word >> 30;
    word *= 0xBF58476D1CE4E5B9ULL;
    word ^= word >> 27;
    word *= 0x94D049BB133111EBULL;
    return word ^ (word >> 31);
}

/// Digests eight octets at a time: the proof may cost a few tens of nanoseconds a packet, not more.
std::uint64_t digest_of(std::span<const std::uint8_t> octets) {
    std::uint64_t digest = mixed(octets.size());
    std::uint64_t word = 0;
    std::size_t held = 0;
    for (const std::uint8_t octet : octets) {
        word = word << 8 | octet;
        if (++held % 8 == 0) digest = mixed(digest ^ word);
    }
    return mixed(digest ^ (word << 1 | 1U));
}

}  // namespace

PacketIdentity identity_of(std::span<const std::uint8_t> packet) {
    AEOLIS_CHECK(packet.size() >= tm_overhead_octets);
    return {Apid{static_cast<std::uint16_t>(read_bits(packet, 5, 11))}, read_bits(packet, 48, 48),
            static_cast<std::uint16_t>(read_bits(packet, 18, 14)),
            static_cast<std::uint16_t>(read_bits(packet, (packet.size() - packet_crc_octets) * 8, 16))};
}

const char* name_of(Standing standing) {
    switch (standing) {
    case Standing::first: return "first";
    case Standing::again: return "again";
    case Standing::duplicate: return "duplicate";
    case Standing::differs: return "differs";
    case Standing::unregistered: return "unregistered";
    }
    return "";
}

std::size_t PacketRegister::KeyHash::operator()(const Key& key) const noexcept {
    return mixed(key.sclk_65536 ^ (static_cast<std::uint64_t>(key.apid) << 53) ^
                 (static_cast<std::uint64_t>(key.count) << 48 >> 14));
}

Standing PacketRegister::add(std::span<const std::uint8_t> packet, Path path) {
    const PacketIdentity identity = identity_of(packet);
    const Key key{identity.sclk_65536, identity.apid.value, identity.count};
    const std::uint64_t digest = digest_of(packet);
    auto known = seen_.find(key);
    if (known == seen_.end()) {
        if (seen_.size() >= packets_max_) {
            ++counts_.unregistered;
            return Standing::unregistered;
        }
        seen_.emplace(key, Seen{digest, path == Path::realtime, path == Path::recorded, false});
        ++(path == Path::realtime ? counts_.realtime : counts_.recorded);
        return Standing::first;
    }

    Seen& seen = known->second;
    bool& on_this_path = path == Path::realtime ? seen.realtime : seen.recorded;
    const bool repeated = on_this_path;
    if (!repeated) {
        on_this_path = true;
        ++(path == Path::realtime ? counts_.realtime : counts_.recorded);
        ++counts_.both;
    }
    if (seen.digest != digest) {
        if (!seen.differs) {
            seen.differs = true;
            ++counts_.differs;
            if (differing_.size() < differing_max) differing_.push_back(identity);
        }
        return Standing::differs;
    }
    if (repeated) ++counts_.again;
    return repeated ? Standing::again : Standing::duplicate;
}

}  // namespace aeolis::telemetry
