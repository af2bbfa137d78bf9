// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace aeolis::archive {

/// Packs a column of doubles, the times or values of a segment, exact to the bit. NaN payloads, -0 and infinities are
/// kept. The bit patterns are taken as 64-bit integers; they, their differences or their second differences are split
/// into planes of octets, which zstd packs. docs/archive.md has the layout octet by octet.
///
/// Memory   a zstd context each way, about 200 KB, and 16 octets per sample of the longest column so far
/// Threads  one owner
class ColumnCodec {
  public:
    ColumnCodec();
    ColumnCodec(ColumnCodec&&) noexcept;
    ColumnCodec& operator=(ColumnCodec&&) noexcept;
    ~ColumnCodec();

    /// Packs a column. The result is valid until the next call.
    std::span<const std::uint8_t> pack(std::span<const double> column);

    /// Fills `column`, whose size the caller knows. Fails with the fault; checksums detect any changed octet.
    Result<void> unpack(std::span<const std::uint8_t> packed, std::span<double> column);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace aeolis::archive
