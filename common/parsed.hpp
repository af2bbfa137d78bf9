// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/check.hpp"

#include <cstdint>
#include <utility>

namespace aeolis {

/// Reason why octets from a link could not be parsed as the expected packet, frame, CLTU, PLTU or PDU.
enum class Malformed : std::uint8_t {
    none,
    too_short,      ///< ends before its header, its length field or one of its fields requires
    too_long,       ///< longer than allowed, or than its length field says
    other_version,  ///< the version bits are those of another protocol
    bad_checksum,   ///< CRC or parity
    no_start,       ///< does not begin with the expected marker
    bad_field,      ///< a field has a value to which the standard gives no meaning
};

constexpr const char* name_of(Malformed why) {
    switch (why) {
    case Malformed::none: return "none";
    case Malformed::too_short: return "too_short";
    case Malformed::too_long: return "too_long";
    case Malformed::other_version: return "other_version";
    case Malformed::bad_checksum: return "bad_checksum";
    case Malformed::no_start: return "no_start";
    case Malformed::bad_field: return "bad_field";
    }
    return "";
}

/// Parsed value, or the reason why parsing failed. Never allocates, so that flight may use it.
template <typename T>
class [[nodiscard]] Parsed {
  public:
    constexpr Parsed(T value) : value_(std::move(value)) {}
    constexpr Parsed(Malformed why) : why_(why) { AEOLIS_CHECK(why != Malformed::none); }

    constexpr explicit operator bool() const { return why_ == Malformed::none; }
    constexpr Malformed why() const { return why_; }

    constexpr const T& operator*() const {
        AEOLIS_CHECK(why_ == Malformed::none);
        return value_;
    }
    constexpr const T* operator->() const { return &**this; }

  private:
    T value_{};
    Malformed why_ = Malformed::none;
};

}  // namespace aeolis
