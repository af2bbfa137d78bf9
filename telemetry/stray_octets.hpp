// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace aeolis::telemetry {

/// Counts the skipped octets that are not fill. Proximity-1 sends fill before, between and after PLTUs: 352EF853 over
/// and over, from any of its octets on. [ccsds-211.2-b]
class StrayOctets {
  public:
    /// Takes skipped octets, which directly follow those of the last call.
    void skipped(std::span<const std::uint8_t> octets) {
        for (const std::uint8_t octet : octets) {
            const auto place = static_cast<std::size_t>(std::ranges::find(fill, octet) - fill.begin());
            const bool of_fill = place < fill.size();
            if (run_ > 0 && (!of_fill || place != next_)) {
                if (run_ < fill.size()) number_ += run_;  // an octet of the fill by chance
                run_ = 0;
            }
            run_ += of_fill ? 1 : 0;
            number_ += of_fill ? 0 : 1;
            next_ = (place + 1) % fill.size();
        }
    }
    /// Notes that a frame separates the octets skipped so far from those skipped next.
    void frame() { run_ = 0; }
    std::uint64_t number() const { return number_; }

  private:
    static constexpr std::array<std::uint8_t, 4> fill{0x35, 0x2E, 0xF8, 0x53};
    std::size_t next_ = 0;  ///< place in the fill of the octet that continues it
    std::size_t run_ = 0;   ///< octets of fill before
    std::uint64_t number_ = 0;
};

}  // namespace aeolis::telemetry
