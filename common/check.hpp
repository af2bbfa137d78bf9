// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <exception>

namespace aeolis {

/// Thrown by a failed AEOLIS_CHECK, that is, by a bug.
/// On board it becomes a FATAL event and a reset of that computer; it never ends the process.
class CheckFailed : public std::exception {
  public:
    CheckFailed(const char* condition, const char* file, std::uint32_t line)
        : condition_(condition), file_(file), line_(line) {}
    const char* what() const noexcept override { return condition_; }
    const char* file() const { return file_; }
    std::uint32_t line() const { return line_; }

  private:
    const char* condition_;
    const char* file_;
    std::uint32_t line_;
};

}  // namespace aeolis

/// Throws CheckFailed when `condition` is false. On in every build. Allocates nothing unless it fails.
#define AEOLIS_CHECK(condition)                                                                                        \
    do {                                                                                                               \
        if (!(condition)) [[unlikely]]                                                                                 \
            throw ::aeolis::CheckFailed(#condition, __FILE__, __LINE__);                                               \
    } while (false)
