// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <thread>

namespace aeolis::tests {

/// Measures time by the number of sleeps of 10 ms in a thread that does nothing else. On a busy machine each sleep
/// lasts longer, so less time passes than by the clock. A bound on how long something may take thus fails when it
/// waits, not when the machine is busy.
class SleptTime {
  public:
    [[nodiscard]] std::chrono::milliseconds passed() const { return slept_.load() * one; }

  private:
    static constexpr std::chrono::milliseconds one{10};

    std::atomic<int> slept_{0};
    std::jthread sleeper_{[this](const std::stop_token& ended) {
        while (!ended.stop_requested()) {
            std::this_thread::sleep_for(one);
            ++slept_;
        }
    }};
};

}  // namespace aeolis::tests
