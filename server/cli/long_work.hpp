// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <string_view>

namespace aeolis::server {

/// Set by the first Ctrl-C or SIGTERM once stop_at_interrupt() was called. Long work then stops and keeps what is
/// complete.
std::atomic<bool>& stop_asked();
/// Installs the handlers of Ctrl-C and SIGTERM. The second Ctrl-C ends the program.
void stop_at_interrupt();

/// A progress line, redrawn in place on a terminal and erased at the end; draws nothing elsewhere.
class ProgressLine {
  public:
    ProgressLine();
    ~ProgressLine();
    ProgressLine(const ProgressLine&) = delete;
    ProgressLine& operator=(const ProgressLine&) = delete;

    void draw(std::string_view text);

  private:
    bool on_terminal_;
    bool drawn_ = false;
};

}  // namespace aeolis::server
