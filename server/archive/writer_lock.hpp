// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <filesystem>
#include <utility>

namespace aeolis::archive {

/// The right to write an archive: one holder among all processes. SQLite itself lets writers alternate; two rehearsals
/// in one file would then take each other's run numbers and slow each other without anyone being told.
///
/// A file beside the archive ("FILE-writer") carries the kernel's lock; it is released by the kernel at kill -9.
/// It is not the archive itself: closing any descriptor of that would drop SQLite's own locks. [sqlite-howtocorrupt]
class WriterLock {
  public:
    static Result<WriterLock> take(const std::filesystem::path& archive);

    WriterLock(WriterLock&& other) noexcept
        : file_(std::move(other.file_)), descriptor_(std::exchange(other.descriptor_, -1)) {}
    WriterLock& operator=(WriterLock&&) = delete;
    ~WriterLock();

  private:
    WriterLock(std::filesystem::path file, int descriptor) : file_(std::move(file)), descriptor_(descriptor) {}

    std::filesystem::path file_;
    int descriptor_ = -1;
};

}  // namespace aeolis::archive
