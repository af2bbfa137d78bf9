// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <thread>

namespace aeolis::tests {

/// Time as a thread that does nothing but sleep has had it: on a busy machine, where each sleep lasts longer than asked
/// for, less than by the clock. So a bound on how long something may take fails for what waits, not for what others do.
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
