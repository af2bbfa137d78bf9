// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/check.hpp"

#include <array>
#include <cstddef>

namespace aeolis {

/// First-in, first-out queue of at most N values, held in place.
template <typename T, std::size_t N>
class FixedQueue {
  public:
    static constexpr std::size_t capacity() { return N; }
    constexpr std::size_t size() const { return size_; }
    constexpr bool empty() const { return size_ == 0; }
    constexpr bool full() const { return size_ == N; }

    /// Adds `value` at the end; returns false and adds nothing when full.
    [[nodiscard]] constexpr bool try_push(const T& value) {
        if (full()) return false;
        values_[(first_ + size_) % N] = value;
        ++size_;
        return true;
    }
    /// Adds an element at the end for the caller to fill; it still holds an old value. Null when full.
    [[nodiscard]] constexpr T* try_grow() {
        if (full()) return nullptr;
        return &values_[(first_ + size_++) % N];
    }
    constexpr const T& front() const {
        AEOLIS_CHECK(!empty());
        return values_[first_];
    }
    constexpr void pop() {
        AEOLIS_CHECK(!empty());
        // When emptied, start again at the first place: a mostly short queue then stays in the cache.
        first_ = --size_ == 0 ? 0 : (first_ + 1) % N;
    }

  private:
    std::array<T, N> values_{};
    std::size_t first_ = 0;
    std::size_t size_ = 0;
};

}  // namespace aeolis
