// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

namespace aeolis::server {

/// A first-in, first-out queue between threads, of at most `limit` values. A full queue blocks push(): nothing is lost.
template <typename T>
class BoundedQueue {
  public:
    explicit BoundedQueue(std::size_t limit) : limit_(limit) {}

    /// Waits while full. False, and nothing added, once closed.
    bool push(T value) {
        std::unique_lock lock{mutex_};
        room_.wait(lock, [&] { return values_.size() < limit_ || closed_; });
        if (closed_) return false;
        values_.push_back(std::move(value));
        lock.unlock();
        filled_.notify_one();
        return true;
    }

    /// Never waits. False, and nothing added, when full or closed.
    bool try_push(T value) {
        {
            const std::scoped_lock lock{mutex_};
            if (values_.size() >= limit_ || closed_) return false;
            values_.push_back(std::move(value));
        }
        filled_.notify_one();
        return true;
    }

    /// Waits for a value. None at `deadline`, or when closed and empty.
    std::optional<T> pop_until(std::chrono::steady_clock::time_point deadline) {
        std::unique_lock lock{mutex_};
        filled_.wait_until(lock, deadline, [&] { return !values_.empty() || closed_; });
        return take(lock);
    }
    /// Waits for a value. None when closed and empty.
    std::optional<T> pop() {
        std::unique_lock lock{mutex_};
        filled_.wait(lock, [&] { return !values_.empty() || closed_; });
        return take(lock);
    }

    /// Refuses further values; those in the queue can still be taken.
    void close() {
        {
            const std::scoped_lock lock{mutex_};
            closed_ = true;
        }
        filled_.notify_all();
        room_.notify_all();
    }
    bool closed() const {
        const std::scoped_lock lock{mutex_};
        return closed_;
    }
    std::size_t size() const {
        const std::scoped_lock lock{mutex_};
        return values_.size();
    }
    /// Calls `what` for each queued value, oldest first, while the queue is locked.
    template <typename Do>
    void each(Do what) {
        const std::scoped_lock lock{mutex_};
        for (T& value : values_) what(value);
    }

  private:
    std::optional<T> take(std::unique_lock<std::mutex>& lock) {
        if (values_.empty()) return std::nullopt;
        std::optional<T> value{std::move(values_.front())};
        values_.pop_front();
        lock.unlock();
        room_.notify_one();
        return value;
    }

    mutable std::mutex mutex_;
    std::condition_variable filled_, room_;
    std::deque<T> values_;
    std::size_t limit_;
    bool closed_ = false;
};

}  // namespace aeolis::server
