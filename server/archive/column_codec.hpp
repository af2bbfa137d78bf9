// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace aeolis::archive {

/// Packs a column of doubles, the times or the values of a segment, exact to the bit: also NaN payloads, -0 and
/// infinities. The bit patterns are taken as whole numbers of 64 bits; they, their differences or the differences of
/// those are split into planes of octets, which zstd packs. docs/archive.md has the layout octet by octet.
///
/// Memory  a zstd context each way, some 200 KB, and 16 octets a sample of the longest column so far
/// Threads one owner
class ColumnCodec {
  public:
    ColumnCodec();
    ColumnCodec(ColumnCodec&&) noexcept;
    ColumnCodec& operator=(ColumnCodec&&) noexcept;
    ~ColumnCodec();

    /// Valid until the next call.
    std::span<const std::uint8_t> pack(std::span<const double> column);

    /// Fills `column`, whose size the caller knows. Fails with what is wrong with the octets: any octet that was
    /// changed is found by the checksums.
    Result<void> unpack(std::span<const std::uint8_t> packed, std::span<double> column);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace aeolis::archive
