// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/check.hpp"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace aeolis::telemetry {

/// Received octets of a stream that are not yet used: added at the end, used from the front. Used octets are removed at
/// the next add(); spans stay valid until then.
class OctetWindow {
  public:
    void add(std::span<const std::uint8_t> octets) {
        octets_.erase(octets_.begin(), octets_.begin() + static_cast<std::ptrdiff_t>(used_));
        used_ = 0;
        octets_.insert(octets_.end(), octets.begin(), octets.end());
    }
    std::span<const std::uint8_t> rest() const { return std::span{octets_}.subspan(used_); }
    void use(std::size_t octets) {
        AEOLIS_CHECK(octets <= octets_.size() - used_);
        used_ += octets;
    }

  private:
    std::vector<std::uint8_t> octets_;
    std::size_t used_ = 0;
};

/// Position of the first octet equal to `wanted`; the size of `octets` when there is none.
inline std::size_t find_octet(std::span<const std::uint8_t> octets, std::uint8_t wanted) {
    if (octets.empty()) return 0;
    const void* found = std::memchr(octets.data(), wanted, octets.size());
    return found == nullptr ? octets.size()
                            : static_cast<std::size_t>(static_cast<const std::uint8_t*>(found) - octets.data());
}

}  // namespace aeolis::telemetry
