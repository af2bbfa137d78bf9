// SPDX-License-Identifier: Apache-2.0
#include "server/cli/long_work.hpp"

#include <csignal>
#include <fmt/format.h>
#include <unistd.h>

namespace aeolis::server {

std::atomic<bool>& stop_asked() {
    static std::atomic<bool> asked{false};
    return asked;
}
static_assert(std::atomic<bool>::is_always_lock_free);  // a signal handler sets it

void stop_at_interrupt() {
    std::signal(SIGINT, [](int) {
        stop_asked() = true;
        std::signal(SIGINT, SIG_DFL);
    });
    std::signal(SIGTERM, [](int) { stop_asked() = true; });
}

ProgressLine::ProgressLine() : on_terminal_(isatty(STDERR_FILENO) == 1) {}

ProgressLine::~ProgressLine() {
    if (drawn_) fmt::print(stderr, "\r\033[K");
}

void ProgressLine::draw(std::string_view text) {
    if (!on_terminal_) return;
    fmt::print(stderr, "\r{}\033[K", text);
    drawn_ = true;
}

}  // namespace aeolis::server
