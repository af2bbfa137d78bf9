// SPDX-License-Identifier: Apache-2.0
#include "server/base/clock_watch.hpp"

#include "server/base/wall_clock.hpp"

#include <cmath>

namespace aeolis::server {
namespace {

constexpr std::int64_t unix_to_2000_s = 946'728'000;  // 1970-01-01 to 2000-01-01T12:00:00

template <typename Clock>
std::int64_t microseconds_of() {
    using namespace std::chrono;
    return duration_cast<microseconds>(Clock::now().time_since_epoch()).count();
}

std::string utc(std::int64_t system_us) {
    return utc_text(std::chrono::system_clock::time_point{std::chrono::microseconds{system_us}});
}

}  // namespace

ClockReading read_clocks() {
    const auto before_us = microseconds_of<std::chrono::steady_clock>();
    const auto system_us = microseconds_of<std::chrono::system_clock>();
    const auto taken_us = microseconds_of<std::chrono::steady_clock>() - before_us;
    return {system_us, before_us + taken_us / 2, taken_us};
}

Ert EarthClock::now() const {
    const auto since_begun_us = read_().monotonic_us - began_.monotonic_us;
    return Ert{began_.system_us - unix_to_2000_s * 1'000'000 + since_begun_us};
}

std::string text_of(const ClockJump& jump) {
    return fmt::format("the system's clock jumped {:.3f} s {}, from {} to {}: it was set, or the machine slept",
                       std::abs(static_cast<double>(jump.by_us)) * 1e-6, jump.by_us < 0 ? "back" : "forward",
                       utc(jump.system_us - jump.by_us), utc(jump.system_us));
}

ClockWatch::ClockWatch(ReadClocks read) : read_(std::move(read)) {
    const auto first = read_();
    apart_us_ = first.system_us - first.monotonic_us;
}

std::optional<ClockJump> ClockWatch::look() {
    const auto now = read_();
    if (now.taken_us > blurred_us) return std::nullopt;
    const auto by_us = now.system_us - now.monotonic_us - apart_us_;
    if (std::abs(by_us) < least_us) return std::nullopt;
    apart_us_ += by_us;
    moved_us_ += by_us;
    ++jumps_;
    return ClockJump{by_us, now.system_us};
}

}  // namespace aeolis::server
