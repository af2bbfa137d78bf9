// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <filesystem>
#include <utility>

namespace aeolis::archive {

/// The exclusive right to write an archive, across processes. SQLite itself lets writers alternate; two rehearsals in
/// one file would then take each other's run numbers and slow each other down unnoticed.
///
/// The kernel's lock is on a file beside the archive ("FILE-writer"); kill -9 releases it. The archive itself is not
/// locked: closing any descriptor of it would drop SQLite's own locks. [sqlite-howtocorrupt]
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
