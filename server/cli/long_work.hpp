// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <string_view>

namespace aeolis::server {

/// Set by the first Ctrl-C, or by SIGTERM, once stop_at_interrupt() was called: work that takes long then ends with
/// what is whole.
std::atomic<bool>& stop_asked();
/// The second Ctrl-C ends the program.
void stop_at_interrupt();

/// One line that is drawn over on a terminal, and taken away at the end; elsewhere nothing.
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
