// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/check.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

namespace aeolis {

/// Vector of at most N values, held in place. Copying it copies the values; it never allocates.
template <typename T, std::size_t N>
class FixedVector {
  public:
    static constexpr std::size_t capacity() { return N; }
    constexpr std::size_t size() const { return size_; }
    constexpr bool empty() const { return size_ == 0; }
    constexpr bool full() const { return size_ == N; }
    constexpr void clear() { size_ = 0; }
    /// Sets the size; what is added holds old values, for the caller to fill. More than N is a bug.
    constexpr void resize(std::size_t size) {
        AEOLIS_CHECK(size <= N);
        size_ = size;
    }

    /// Adds `value` at the end; returns false and adds nothing when full.
    [[nodiscard]] constexpr bool try_push_back(const T& value) {
        if (full()) return false;
        values_[size_++] = value;
        return true;
    }
    /// Adds an element at the end for the caller to fill; it still holds an old value. Null when full.
    [[nodiscard]] constexpr T* try_grow() {
        if (full()) return nullptr;
        return &values_[size_++];
    }
    /// Adds `value` at the end; calling it when full is a bug.
    constexpr void push_back(const T& value) {
        AEOLIS_CHECK(!full());
        values_[size_++] = value;
    }
    /// Adds all of `values` at the end; calling it without room for them is a bug.
    constexpr void append(std::span<const T> values) {
        AEOLIS_CHECK(values.size() <= N - size_);
        std::copy(values.begin(), values.end(), values_.data() + size_);
        size_ += values.size();
    }
    constexpr void pop_back() {
        AEOLIS_CHECK(!empty());
        --size_;
    }
    /// Removes one value and keeps the order of the rest.
    constexpr void erase_at(std::size_t index) {
        AEOLIS_CHECK(index < size_);
        for (std::size_t i = index + 1; i < size_; ++i) values_[i - 1] = values_[i];
        --size_;
    }

    constexpr T& operator[](std::size_t index) {
        AEOLIS_CHECK(index < size_);
        return values_[index];
    }
    constexpr const T& operator[](std::size_t index) const {
        AEOLIS_CHECK(index < size_);
        return values_[index];
    }
    constexpr T& back() { return (*this)[size_ - 1]; }
    constexpr const T& back() const { return (*this)[size_ - 1]; }
    constexpr T* begin() { return values_.data(); }
    constexpr T* end() { return values_.data() + size_; }
    constexpr const T* begin() const { return values_.data(); }
    constexpr const T* end() const { return values_.data() + size_; }
    constexpr std::span<const T> span() const { return {values_.data(), size_}; }
    constexpr std::span<T> span() { return {values_.data(), size_}; }

  private:
    std::array<T, N> values_{};
    std::size_t size_ = 0;
};

}  // namespace aeolis
